#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/phyllotaxis/cylinder_lattice.h"

namespace anthesis {

/// Models of phyllotaxis that can be asked the same question: given the size of the organs, what divergence and what
/// parastichies? F92 (section 4) leaves the comparison open. See docs/divergence-study.md.
enum class StudyModel {
  kContactPressure,  ///< Adler: the rise is given, contact moves the divergence
  kCollision,        ///< F92: the divergence is given, contact moves the rise
  kInhibition,       ///< Douady and Couder: the period is given, inhibition chooses the place on a ring
};
inline constexpr std::size_t kStudyModels = 3;

/// "contact pressure", "collision", "inhibition"
const char* model_name(StudyModel model);

struct DivergenceStudyParams {
  /// Diameters of the organs, in circumferences of the surface where they are; each in [0.02, 0.5], at most 1000.
  std::vector<double> sizes = study_sizes(0.05, 0.5, 46);

  /// The surface, (radius, height) from apex to base, a B-spline of degree min(3, n - 1); empty: a cylinder. Lattices
  /// and contact pressure live on its unrolled, conformal image, where it makes no difference.
  std::vector<Vec2> profile_mm = {};

  double collision_divergence_rad = kGoldenAngleRad;  ///< given to the collision model; finite
  double first_divergence_rad = 2.0;                  ///< contact pressure begins with it; finite, not 0
  int inhibition_exponent = 3;                        ///< in [1, 12]

  /// Organs born while rise and period fall to 1 / e of themselves, in [5, 1000]: how slowly the growing patterns come
  /// to their size. They begin with organs in two rows.
  double births_per_fold = 70.0;

  /// Sizes in equal ratios, smallest first. Precondition: 0 < smallest <= largest, count >= 2.
  static std::vector<double> study_sizes(double smallest, double largest, std::size_t count);
};

std::optional<Error> check(const DivergenceStudyParams& params);

/// What one model makes of one size.
struct DivergenceResult {
  StudyModel model = StudyModel::kContactPressure;
  double size = 0.0;  ///< asked for
  double rise = 0.0;  ///< mean conformal distance between levels, in circumferences: what one organ has for itself
  PatternMeasure pattern;
  bool measured = false;  ///< false: too few organs found room for a measure
};

struct DivergenceStudy {
  std::vector<DivergenceResult> results;  ///< by model, then as `sizes`
  std::vector<LatticeArc> arcs;           ///< van Iterson's diagram over the range of sizes
};

/// Every model at every size, each run alone and in parallel with the others.
///
/// Contact pressure and inhibition are given the rise at which a lattice of touching organs of that size stands on the
/// Fibonacci branch (fibonacci_lattice); the collision model is given the size itself. What is measured is how the
/// organs then lie, sizes included (pattern.distance), in conformal coordinates. Cost: 2 seconds of a core for the
/// default, most of it inhibition at the smallest sizes, which goes with 1 / size^4. Errors: those of check,
/// kCancelled.
Expected<DivergenceStudy> study_divergence(const DivergenceStudyParams& params, const Progress& progress = {});

}  // namespace anthesis
