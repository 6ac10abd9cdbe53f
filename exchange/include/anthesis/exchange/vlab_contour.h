#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/geometry/bspline.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Files of the Virtual Laboratory (VLab). docs/vlab.md says what each format holds and what is exact.
///
/// Every reader takes the bytes and the name that messages shall call them by, gives one error with file, line, column,
/// rule and value ("head.cset:14:8: multiplicity must be a whole number from 1 to 10000, got "x""), and is bounded in
/// time and memory for any bytes.
inline constexpr std::size_t kVlabTextLimit = std::size_t{64} << 20;  ///< bytes of a text file; more are kTooLarge

struct VlabContourPoint {
  Vec3 position;
  int multiplicity = 1;  ///< how often the point stands in the control polygon, 1 to 10,000
};

/// A place that was marked on a contour: a landmark of the tissue, or the active ring.
struct VlabMarker {
  double s = 0.0;  ///< share of the arc length
  Vec2 position;   ///< the point there, as the editor stated it
};

/// A drawn curve: `.con`, or one item of a `.cset`.
struct VlabContour {
  std::string name;
  std::vector<VlabContourPoint> points;
  bool closed = false;
  bool through_ends = false;  ///< clamped to its end points ("e") instead of uniform ("r")
  int samples = 0;            ///< points of VLab's table, which keeps to 3 to 10,000; 0: not stated, VLab takes 8
  std::string background;     ///< picture under the editor's drawing; empty: none
  Vec2 background_offset;
  std::vector<VlabMarker> markers;  ///< in the order of the file
};

/// What is wrong with a contour that was made in code, if anything: at least 4 control points and at most 10,000 when
/// repeated points are written out, finite numbers. Contours that were read pass.
std::optional<Error> check(const VlabContour& contour);

/// The contours of a gallery (`.cset`), or the one of a `.con` file, in all versions VLab has had.
Expected<std::vector<VlabContour>> read_vlab_contours(std::string_view text, std::string_view file_name);

/// A `.con` file ("cver 1 3") and a `.cset` gallery. Coordinates get six digits after the point, as VLab writes them.
/// Errors: check(contour), and what VLab could not read back: a name that is not 1 to 30 characters without blanks, a
/// background of more than 40 characters.
Expected<std::string> write_vlab_contour(const VlabContour& contour);
Expected<std::string> write_vlab_contours(const std::vector<VlabContour>& contours);

/// The curve itself, exactly, as a clamped uniform cubic B-spline: VLab's four types of curve are all of that kind.
/// A closed uniform curve begins, like VLab's, at (P[n-3] + 4 P[n-2] + P[n-1]) / 6. Precondition: check(contour) finds
/// nothing.
BSplineCurve<Vec3> vlab_spline(const VlabContour& contour);

/// A contour as models in VLab see it: a table of points with straight lines between, equally spaced in arc length
/// (uniform types) or in the parameter (types through their end points).
///
/// Positions agree with VLab's to 2e-5 of the curve's size, the rest being VLab's single precision. Construction costs
/// 1,000 evaluations of the curve for each control point, about 10 microseconds a point; questions cost nothing.
class VlabCurve {
 public:
  /// Precondition: check(contour) finds nothing.
  explicit VlabCurve(const VlabContour& contour);

  Vec3 at(double s) const { return looked_up(points_, s); }  ///< curveXYZ; s is clamped to [0, 1]

  /// curveNormal: (0, 0, 1) x tangent, interpolated and so a little shorter than 1 in bends. Zero, as in VLab, for
  /// curves through their end points.
  Vec3 normal(double s) const { return looked_up(normals_, s); }

  /// curveGAL: length of the curve. For curves through their end points VLab has no value; this is the right one.
  double length() const { return length_; }

  const std::vector<Vec3>& table() const { return points_; }  ///< s = i / (size - 1)

 private:
  static Vec3 looked_up(const std::vector<Vec3>& table, double s);

  std::vector<Vec3> points_;
  std::vector<Vec3> normals_;
  double length_ = 0.0;
};

/// The half section of a surface of revolution: control points (radius, height) of a clamped uniform cubic B-spline,
/// apex first, for SurfaceOfRevolution. A contour drawn from the base up is turned round. Drawings overshoot the axis:
/// radii down to -1 % of the widest are put on it.
/// Errors (`where` names the contour): closed curves, curves out of the plane z = 0, radii below that, no extent.
Expected<std::vector<Vec2>> vlab_profile(const VlabContour& contour);

}  // namespace anthesis
