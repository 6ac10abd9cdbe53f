#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/receptacle/contour_sequence.h"
#include "anthesis/receptacle/harmonic_section.h"

namespace anthesis {

/// The same section frame by frame; control point i is the same piece of tissue in all of them.
struct SectionSequence {
  std::size_t points_per_frame = 0;
  std::vector<Vec2> points;  ///< (radius, height), frame after frame, each as harmonic_section.h says

  std::size_t frames() const { return points_per_frame == 0 ? 0 : points.size() / points_per_frame; }
  std::span<const Vec2> frame(std::size_t i) const {
    return std::span(points).subspan(i * points_per_frame, points_per_frame);
  }
};

/// Closes contours by a level base: `base_points` more control points, equally far apart from the rim to the axis.
/// Radii of the apex, and others below 1e-9 of the section's size, become 0 as rounding in a file may require.
/// Precondition: at least one base point.
SectionSequence with_base(const ContourSequence& contours, std::size_t base_points = 20);

struct InteriorGrowthParams {
  SectionMeshParams mesh;

  /// Of the displacement away from the axis; that along the axis is always natural. kNatural is O24: what lies beside
  /// the axis, however near, is pushed outwards, and only what lies on it stays. With kZero the push fades out towards
  /// the axis and the whole movement is continuous.
  AxisCondition axis = AxisCondition::kNatural;
};

/// All harmonic coordinates of one frame.
struct HarmonicFrame {
  std::size_t frame = 0;
  const SectionMesh& mesh;
  std::span<const Vec2> controls;
  std::span<const double> weights;  ///< of control c at point v: weights[c * mesh.points.size() + v]
};

/// The G-model of O24: the inside of a head moves with the harmonic extension of its boundary's displacement from one
/// frame to the next. See docs/harmonic-interior.md.
///
/// One mesh is kept as long as it is good and moves with the tissue. Two solutions a frame: about 0.1 ms with 100
/// control points. What happens from a frame to the next depends on nothing but the sections and the parameters, and is
/// the same for any number of threads.
class InteriorGrowth {
 public:
  /// At frame 0. Errors: fewer than 2 frames; points that are no whole frames; what check_section and
  /// triangulate_section find (`where` names the frame).
  static Expected<InteriorGrowth> make(SectionSequence sections, const InteriorGrowthParams& params = {});

  InteriorGrowth(InteriorGrowth&&) noexcept;
  InteriorGrowth& operator=(InteriorGrowth&&) noexcept;
  ~InteriorGrowth();

  std::size_t frames() const;
  std::size_t frame() const;                               ///< the present one
  std::span<const Vec2> section(std::size_t frame) const;  ///< the polygon
  const SectionMesh& mesh() const;                         ///< of the present frame
  std::size_t triangulations() const;                      ///< how often a new mesh was needed since frame 0

  /// Goes to a frame: through all frames between; from the beginning if it lies behind. Errors name the frame whose
  /// section cannot be triangulated; the growth then stands at frame 0 again.
  /// Precondition: frame < frames().
  std::optional<Error> advance(std::size_t frame);

  /// Moves points from the present frame to the next; nothing happens at the last frame. Returns how many would have
  /// left the section by more than 1e-9 of its size and were brought back to the nearest place of its boundary.
  ///
  /// What is on the boundary keeps its place on it, what is on the axis stays there. A point outside moves like the
  /// nearest place of the boundary. Each point moves as if it were alone. About 0.06 microseconds a point, and
  /// some 0.03 ms for the first call at a frame; parallel; may be called from several threads at once.
  /// Precondition: finite, radii >= 0.
  std::size_t carry(std::span<Vec2> points) const;

  /// The same for points in space around the axis +z, each within its own half plane.
  std::size_t carry(std::span<Vec3> points) const;

  /// All harmonic coordinates, frame by frame: `write` gets each frame in order, on the caller's thread, and may answer
  /// false to stop. Fields of up to 32 frames are solved in parallel before they are handed over: memory for those, or
  /// for 16 MB of weights and one frame more. The growth itself does not move. Errors as advance; frames before the one
  /// named have then been written.
  std::optional<Error> weights(const std::function<bool(const HarmonicFrame&)>& write) const;

 private:
  struct State;
  explicit InteriorGrowth(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace anthesis
