#pragma once
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/geometry/function_graph.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {

/// The half section of the growing surface at one time. Only its shape counts.
struct KeyProfile {
  double time = 0.0;
  std::vector<Vec2> controls;  ///< (radius, height), apex to base, of a clamped B-spline of degree min(3, n - 1)
};

/// Centripetal fractionation (O16 section 4, fig. 11a): a naked meristem is covered by primordia from its rim inwards.
struct FractionationParams {
  std::vector<KeyProfile> profiles;  ///< at least one; times ascending; equal numbers of controls
  double divergence_rad = kGoldenAngleRad;
  double interval = 0.001;                                  ///< time between two primordia, > 0
  double meristem_area_mm2 = 1.0;                           ///< naked at time 0, > 0
  FunctionGraph meristem_growth{{{0.0, 1.0}, {1.0, 1.0}}};  ///< factor of the naked area against time, > 0
  FunctionGraph area_mm2{{{0.0, 1.0}, {1.0, 1.0}}};         ///< mature area against the position s at birth, > 0
  FunctionGraph area_growth{{{0.0, 1.0}, {1.0, 1.0}}};      ///< share of the mature area against age, > 0
};

std::optional<Error> check(const FractionationParams& params);

/// A primordium, in order of birth from the rim inwards. Primordium i is born at i * interval.
struct Primordium {
  double birth = 0.0;
  double azimuth_rad = 0.0;  ///< i * divergence, in [0, 2 pi)
  double mature_area_mm2 = 0.0;
  double s_at_birth = 0.0;
};

/// Where a primordium is at one time.
struct PrimordiumPlace {
  double t = 0.0;         ///< profile parameter of the surface at that time
  double area_mm2 = 0.0;  ///< of its band
};

/// A pattern as a function of time: every event has its exact time, nothing is stepped, so any frame rate shows the
/// same primordia at the same places.
class Fractionation {
 public:
  /// Produces primordia until the naked region is smaller than one of them, or until time 1.
  /// More than `limit` primordia are kTooLarge. O(n^2) additions and O(n) surfaces: 1,000 primordia in about 40 ms.
  static Expected<Fractionation> run(FractionationParams params, std::size_t limit, const Progress& progress = {});

  std::span<const Primordium> primordia() const { return primordia_; }

  /// Number of primordia born by `time`; they are the first so many.
  std::size_t born(double time) const;

  /// Area of the naked inner region.
  double naked_area_mm2(double time) const;

  /// The surface: its profile interpolated between key profiles and scaled so that its area is the sum of the areas of
  /// the naked region and of all primordia.
  SurfaceOfRevolution surface(double time) const;

  /// Places of the first born(time) primordia on surface(time): consecutive bands from the base, O16 eq. 2.
  std::vector<PrimordiumPlace> places(double time, const SurfaceOfRevolution& surface) const;

 private:
  explicit Fractionation(FractionationParams params) : params_(std::move(params)) {}
  std::vector<Vec2> profile(double time) const;
  double area(std::size_t primordium, double time) const;

  FractionationParams params_;
  std::vector<Primordium> primordia_;
  std::vector<double>
      taken_;  ///< taken_[i]: naked area lost to the first i primordia, each over the growth factor then
};

}  // namespace anthesis
