#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/geometry/function_graph.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "anthesis/phyllotaxis/growth.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {

/// The half section of the growing surface at one time. Only its shape counts.
struct KeyProfile {
  double time = 0.0;
  std::vector<Vec2> controls;  ///< (radius, height), apex to base, of a clamped B-spline of degree min(3, n - 1)
};

/// The control points at a time: those of the profiles before and after it, in shares; at least one profile.
std::vector<Vec2> profile_at(std::span<const KeyProfile> profiles, double time);

/// How a meristem comes to be covered by primordia (O16 fig. 11).
enum class MeristemMode {
  kCentripetal,  ///< fractionation: a naked meristem is covered from its rim inwards, one primordium each interval
  kDivergent,    ///< fractionation: from the line between a naked inner and a naked outer region, both ways at once
  kSegregation,  ///< a small inner region grows; each time it reaches the threshold it gives off a primordium
};

/// A meristem of three regions: naked inner, primordium-carrying, naked outer (O16 section 4). Times run from 0 to 1.
struct MeristemDynamicsParams {
  MeristemMode mode = MeristemMode::kCentripetal;
  std::vector<KeyProfile> profiles;  ///< at least one; times ascending; equal numbers of controls
  double divergence_rad = kGoldenAngleRad;

  double meristem_area_mm2 = 1.0;  ///< of the naked inner region at time 0, > 0
  GrowthFunction meristem_growth = FunctionGraph{{{0.0, 1.0}, {1.0, 1.0}}};  ///< of the naked inner region with time

  FunctionGraph area_mm2{{{0.0, 1.0}, {1.0, 1.0}}};  ///< mature area against position s at birth, > 0
  GrowthFunction area_growth = FunctionGraph{{{0.0, 1.0}, {1.0, 1.0}}};  ///< factor of the mature area with age

  /// Fractionation: time between two primordia that move the same way, > 0. Divergent, the outer front takes its turns
  /// half an interval after the inner one.
  double interval = 0.001;

  double outer_area_mm2 = 1.0;  ///< divergent: of the naked outer region at time 0, > 0
  GrowthFunction outer_growth = FunctionGraph{{{0.0, 1.0}, {1.0, 1.0}}};  ///< divergent: of the naked outer region

  /// Segregation: area of the inner region at which it gives off a primordium, >= meristem_area_mm2 and greater than
  /// every newborn primordium. The inner region's growth must never turn back.
  double threshold_area_mm2 = 1.0;
};

/// The first thing wrong with `params`, if anything. Functions are the caller's to keep in range.
std::optional<Error> check(const MeristemDynamicsParams& params);

/// A primordium, in order of birth.
struct Primordium {
  double birth = 0.0;
  double azimuth_rad = 0.0;  ///< index * divergence, in [0, 2 pi)
  double mature_area_mm2 = 0.0;
  double s_at_birth = 0.0;  ///< of the border it is born at
  std::int32_t index = 0;   ///< place in the spiral from base to apex; negative for the outer front of divergent mode
};

/// Where a primordium is at one time.
struct PrimordiumPlace {
  double t = 0.0;         ///< profile parameter of the surface at that time
  double area_mm2 = 0.0;  ///< of its band
};

/// A pattern as a function of time: every event has its exact time, nothing is stepped, so any frame rate shows the
/// same primordia at the same places. See docs/meristem-dynamics.md.
class MeristemDynamics {
 public:
  /// Produces primordia until each naked region is smaller than one of them (fractionation), or until time 1.
  /// More than `limit` primordia are kTooLarge; a threshold too small for the primordia is kInvalidParameter.
  /// O(n^2) additions (in segregation, polynomials) and, if the profile changes, O(n) surfaces: 1,000 primordia in
  /// about 15 and 60 ms.
  static Expected<MeristemDynamics> run(MeristemDynamicsParams params, std::size_t limit,
                                        const Progress& progress = {});

  const MeristemDynamicsParams& params() const { return params_; }
  std::span<const Primordium> primordia() const { return primordia_; }

  /// Number of primordia born by `time`; they are the first so many.
  std::size_t born(double time) const;

  /// Area of the naked inner region.
  double naked_area_mm2(double time) const;

  /// Area of the naked outer region: 0 except in divergent mode.
  double outer_area_mm2(double time) const;

  /// The surface: its profile interpolated between key profiles and scaled so that its area is the sum of the areas of
  /// the naked regions and of all primordia.
  SurfaceOfRevolution surface(double time) const;

  /// Places of the first born(time) primordia on surface(time): consecutive bands from the base, O16 eq. 2, the naked
  /// outer region below them and the inner region above.
  std::vector<PrimordiumPlace> places(double time, const SurfaceOfRevolution& surface) const;

 private:
  explicit MeristemDynamics(MeristemDynamicsParams params) : params_(std::move(params)) {}
  std::optional<Error> fractionate(std::size_t limit, const Progress& progress);
  std::optional<Error> segregate(std::size_t limit, const Progress& progress);
  SurfaceOfRevolution shape(double time) const;
  double area(std::size_t primordium, double time) const;
  double inner_after(std::size_t primordia, double time) const;
  double outer_after(std::size_t primordia, double time) const;

  MeristemDynamicsParams params_;
  std::vector<Primordium> primordia_;

  // What the first i primordia have left, for each i. Fractionation: area lost to them, each over the growth factor at
  // its birth. Segregation: the inner region's area just after birth i - 1.
  std::vector<double> taken_;
  std::vector<double> outer_taken_;  ///< divergent only
  std::vector<double> remaining_;    ///< segregation only
};

}  // namespace anthesis
