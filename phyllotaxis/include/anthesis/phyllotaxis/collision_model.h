#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/geometry/function_graph.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "anthesis/phyllotaxis/vogel.h"

namespace anthesis {

/// Radius against the relative position s along the profile: an organ is as large as its place says. Values > 0.
struct RadiusAlongProfile {
  FunctionGraph radius_mm{{{0.0, 1.0}, {1.0, 1.0}}};
};

/// Radius against the number of the organ, 0 for the first; finite, > 0. Called once an organ, in order.
struct RadiusByIndex {
  std::function<double(std::size_t)> radius_mm;
};

/// The spheres' radii: one for all; a sequence, with whose end the pattern ends; by number; by place.
using CollisionRadii = std::variant<double, std::vector<double>, RadiusByIndex, RadiusAlongProfile>;

/// When an organ may not lie further below the one before it than `CollisionParams::fall_radii` says.
enum class FallLimit {
  kWhereRadiiDecrease,  ///< an organ with a given radius smaller than some radius before it; never with radii by place
  kAlways,
  kNever,
};

/// Phyllotaxis by collisions (F92): spheres on a surface of revolution, each as near to the base as those before it
/// allow. See docs/collision-model.md.
struct CollisionParams {
  SurfaceOfRevolution surface;
  CollisionRadii radius_mm = 1.0;
  double divergence_rad = kGoldenAngleRad;  ///< Finite. F92's 137.5 degrees are 55/144 of a turn: large patterns break.
  double contact_factor = 1.0;              ///< Finite, > 0. Centres stay this times the sum of the radii apart.
  FallLimit fall_limit = FallLimit::kWhereRadiiDecrease;
  double fall_radii = 1.0;  ///< Finite, >= 0. F92's delta as arc length, in radii of the new organ; with radii by
                            ///< place, which follow from the place, in radii of the organ before.
};

/// What is wrong with `params`, if anything. Radii by number are looked at when they are used.
std::optional<Error> check(const CollisionParams& params);

inline constexpr std::uint32_t kNoOrgan = 0xffffffff;

struct CollisionOrgan {
  double t = 0.0;  ///< profile parameter of the surface, 0 apex, 1 base: surface.frame(t, azimuth_rad) is the organ's
  double s = 0.0;  ///< share of the profile's arc length, 0 apex, 1 base
  double azimuth_rad = 0.0;  ///< number times divergence, in [0, 2 pi)
  double radius_mm = 0.0;

  /// Numbers of the organs that hold it from below: touched, and nearer if it sank towards the base. Ascending,
  /// kNoOrgan where there are fewer than two; both are kNoOrgan if it lies at the base or its fall limit and touches
  /// none. Usually one: only where a pair of parastichies changes do two hold an organ.
  std::array<std::uint32_t, 2> contacts{kNoOrgan, kNoOrgan};
};

struct CollisionPattern {
  std::vector<CollisionOrgan> organs;  ///< in order of birth
  std::size_t base_ring = 0;           ///< organs laid at the base before the first collision
};

/// Lays organs from the base until one finds no place below the tip.
///
/// Organ n lies at azimuth n * divergence, at the least distance from the base along the profile where its centre is
/// contact_factor * (its radius + theirs) from the centres of all organs before it, and not below its fall limit. That
/// least place is exact: every stretch of the profile that an organ forbids is solved for, none is sampled. Centres are
/// never closer than that by more than some 1e-14 of the surface's size. No randomness, one thread, the same bits
/// everywhere.
///
/// About 0.5 microseconds an organ, whatever their number, where radii are much alike; see docs/collision-model.md.
/// More than `limit` organs are kTooLarge; so are more than 2^32 - 2. Progress is reported under "pattern".
Expected<CollisionPattern> place_by_collision(const CollisionParams& params, std::size_t limit,
                                              const Progress& progress = {});

/// How far an organ is from what a phyllotactic pattern is made of (F92 section 4 asks for such a measure).
struct OrganValidity {
  /// Organ radius over the radius of curvature of the surface. Along the meridian: half the angle by which the profile
  /// turns within one organ radius of the organ, so that a crease counts by its angle; or around the axis.
  double curvature = 0.0;
  double radius_ratio = 1.0;  ///< of the organ and its two lower neighbours, the largest, >= 1
  double gap = 0.0;  ///< clearance to the further of its two lower neighbours, over the contact distance; 0 at the base
  double jump =
      0.0;  ///< way along the profile from the organ before, over the organ's diameter times the contact factor
  /// The organ that holds it is no parastichy number earlier: no denominator of a fraction near the divergence.
  bool is_irregular = false;
};

enum class PatternFlaw { kCurvature, kRadiusRatio, kGap, kJump, kIrregular };

/// "curvature", "radius_ratio", "gap", "jump", "irregular".
const char* flaw_name(PatternFlaw flaw);

/// A stretch of the profile where the pattern is no phyllotactic one.
struct PatternWarning {
  PatternFlaw flaw = PatternFlaw::kCurvature;
  double s_from = 0.0;  ///< nearer the apex
  double s_to = 1.0;
  double measure = 0.0;    ///< the worst of the stretch
  double threshold = 0.0;  ///< of ValidityLimits
};

/// Above these a stretch gets a warning; stretches are about one round of the pattern, 16 organs at least. Curvature
/// and ratio of radii: the largest of a stretch; gap and jump: what a fifth of its organs exceed; irregular: the share
/// of such organs. The defaults let pass what discs, spheres, cylinders and gentle cones give, see
/// docs/collision-model.md.
struct ValidityLimits {
  double curvature = 0.7;
  double radius_ratio = 2.0;
  double gap = 0.65;
  double jump = 0.75;
  double irregular = 0.5;
};

struct CollisionValidity {
  std::vector<OrganValidity> organs;     ///< of the pattern, in its order
  std::vector<PatternWarning> warnings;  ///< by flaw, then from the apex; empty: a phyllotactic pattern all over
};

/// Judges a pattern that place_by_collision made of `params`. About 2 microseconds an organ.
CollisionValidity judge_pattern(const CollisionParams& params, const CollisionPattern& pattern,
                                const ValidityLimits& limits = {});

}  // namespace anthesis
