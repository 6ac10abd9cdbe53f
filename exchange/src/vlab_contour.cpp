#include "anthesis/exchange/vlab_contour.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "text.h"
#include "vlab_text.h"

namespace anthesis {
namespace {

using detail::append_fixed;
using detail::TextPlace;
using detail::VlabText;

constexpr std::int64_t kMostPoints = 10'000;
constexpr std::size_t kFewestPoints = 4;
constexpr std::size_t kLongestName = 30;
constexpr std::size_t kLongestBackground = 40;  // VLab's buffer holds 63 characters; paths may be moved

// ---- reading --------------------------------------------------------------------------------------------------------

bool read_point(VlabText& text, std::int64_t dimensions, bool with_multiplicity, VlabContour& contour) {
  VlabContourPoint point;
  std::int64_t multiplicity = 1;
  if (!text.number("x", point.position.x) || !text.number("y", point.position.y) ||
      (dimensions > 2 && !text.number("z", point.position.z)) ||
      (with_multiplicity && !text.whole("multiplicity", multiplicity, 1, kMostPoints)) || !text.end_line()) {
    return false;
  }
  point.multiplicity = static_cast<int>(multiplicity);
  contour.points.push_back(point);
  return true;
}

/// Repeated points written out: at least a cubic's, at most the limit, and, if the file states it, as many as that.
bool check_count(VlabText& text, TextPlace place, const VlabContour& contour, std::int64_t stated) {
  std::int64_t sum = 0;
  for (const VlabContourPoint& point : contour.points) {
    sum += point.multiplicity;
  }
  if (stated >= 0 && sum != stated) {
    return text.fail_at(
        place, "points",
        "must state the sum of the multiplicities, " + std::to_string(sum) + ", got " + std::to_string(stated));
  }
  if (sum < static_cast<std::int64_t>(kFewestPoints) || sum > kMostPoints) {
    return text.fail_at(place, "points", "must be 4 to 10000 with their multiplicities, got " + std::to_string(sum));
  }
  return true;
}

bool read_points(VlabText& text, TextPlace place, std::int64_t count, std::int64_t stated, VlabContour& contour) {
  for (std::int64_t i = 0; i < count; ++i) {
    if (!read_point(text, 3, true, contour)) {
      return false;
    }
  }
  return check_count(text, place, contour, stated);
}

bool read_type(VlabText& text, std::int64_t minor, VlabContour& contour) {
  if (!text.expect("type:")) {
    return false;
  }
  const TextPlace place = text.place();
  const std::string_view type = text.take_word();
  if (minor == 1) {
    if (type != "open" && type != "closed") {
      return text.fail_at(place, "type", "must be open or closed, got " + detail::shown_value(type));
    }
    contour.closed = type == "closed";
    return text.end_line();
  }
  if (type.size() != 2 || (type[0] != 'o' && type[0] != 'c') || (type[1] != 'r' && type[1] != 'e')) {
    return text.fail_at(place, "type", "must be one of or, cr, oe, ce, got " + detail::shown_value(type));
  }
  contour.closed = type[0] == 'c';
  contour.through_ends = type[1] == 'e';
  return text.end_line();
}

bool read_extras(VlabText& text, VlabContour& contour) {
  if (text.next_is("background:")) {
    text.take_word();
    contour.background = text.rest_of_line();
    if (!text.expect("backgroundXY:") || !text.number("backgroundXY", contour.background_offset.x) ||
        !text.number("backgroundXY", contour.background_offset.y) || !text.end_line()) {
      return false;
    }
  }
  if (text.next_is("markers:")) {
    text.take_word();
    std::int64_t count = 0;
    if (!text.whole("markers", count, 0, kMostPoints) || !text.end_line()) {
      return false;
    }
    for (std::int64_t i = 0; i < count; ++i) {
      VlabMarker marker;
      std::int64_t index = 0;
      if (!text.whole("marker", index, i, i) || !text.number("s", marker.s, 0.0, 1.0) ||
          !text.number("x", marker.position.x) || !text.number("y", marker.position.y) || !text.end_line()) {
        return false;
      }
      contour.markers.push_back(marker);
    }
  }
  return true;
}

/// From "cver" on.
bool read_contour(VlabText& text, VlabContour& contour) {
  std::int64_t major = 0;
  std::int64_t minor = 0;
  if (!text.expect("cver") || !text.whole("version", major, 1, 1) || !text.whole("version", minor, 1, 3) ||
      !text.end_line() || !text.expect("name:")) {
    return false;
  }
  contour.name = text.rest_of_line();
  const TextPlace place = text.place();
  std::int64_t count = 0;
  std::int64_t stated = 0;
  if (!text.expect("points:") || !text.whole("points", count, 1, kMostPoints) ||
      !text.whole("points", stated, 1, kMostPoints) || !text.end_line() || !read_type(text, minor, contour)) {
    return false;
  }
  if (minor >= 3) {
    std::int64_t samples = 0;
    if (!text.expect("samples:") || !text.whole("samples", samples, 1, 1'000'000) || !text.end_line() ||
        !read_extras(text, contour)) {
      return false;
    }
    contour.samples = static_cast<int>(samples);
  }
  return read_points(text, place, count, stated, contour);
}

bool read_numbers(VlabText& text, std::string_view key, int count) {
  double ignored = 0.0;
  if (!text.expect(key)) {
    return false;
  }
  for (int i = 0; i < count; ++i) {
    if (!text.number(key.substr(0, key.size() - 1), ignored)) {
      return false;
    }
  }
  return text.end_line();
}

/// "version: 1.4": the format of the older simulator. Its frame and range say nothing about the curve.
bool read_contour_1_4(VlabText& text, VlabContour& contour) {
  double version = 0.0;
  std::int64_t count = 0;
  std::int64_t dimension = 0;
  if (!text.expect("version:") || !text.number("version", version, 1.4, 1.4) || !text.end_line() ||
      !read_numbers(text, "contact:", 3) || !read_numbers(text, "end:", 3) || !read_numbers(text, "heading:", 3) ||
      !read_numbers(text, "up:", 3) || !read_numbers(text, "size:", 1)) {
    return false;
  }
  const TextPlace place = text.place();
  if (!text.expect("points:") || !text.whole("points", count, 1, kMostPoints) || !text.end_line() ||
      !read_numbers(text, "range:", 2) || !text.expect("dimension:") || !text.whole("dimension", dimension, 4, 4) ||
      !text.end_line() || !text.expect("type:") || !text.expect("bspline") || !text.end_line()) {
    return false;
  }
  return read_points(text, place, count, -1, contour);
}

/// "<n> <dimensions> open|closed": the oldest format.
bool read_oldest(VlabText& text, VlabContour& contour) {
  const TextPlace place = text.place();
  std::int64_t count = 0;
  std::int64_t dimensions = 0;
  if (!text.whole("points", count, 1, kMostPoints) || !text.whole("dimensions", dimensions, 2, 3)) {
    return false;
  }
  if (!text.next_is("open") && !text.next_is("closed")) {
    return text.fail("type", "must be open or closed");
  }
  contour.closed = text.take_word() == "closed";
  if (!text.end_line()) {
    return false;
  }
  for (std::int64_t i = 0; i < count; ++i) {
    if (!read_point(text, dimensions, false, contour)) {
      return false;
    }
  }
  return check_count(text, place, contour, -1);
}

bool read_all(VlabText& text, std::vector<VlabContour>& contours) {
  if (text.next_is("contourgalleryver")) {
    std::int64_t version = 0;
    std::int64_t items = 0;
    text.take_word();
    if (!text.whole("version", version, 1, 1) || !text.whole("version", version, 1, 1) || !text.end_line() ||
        !text.expect("items:") || !text.whole("items", items, 0, 1'000'000) || !text.end_line()) {
      return false;
    }
    for (std::int64_t i = 0; i < items; ++i) {
      if (!read_contour(text, contours.emplace_back())) {
        return false;
      }
    }
    return text.expect_end();
  }
  VlabContour& contour = contours.emplace_back();
  const bool read = text.next_is("cver")       ? read_contour(text, contour)
                    : text.next_is("version:") ? read_contour_1_4(text, contour)
                                               : read_oldest(text, contour);
  return read && text.expect_end();
}

// ---- writing --------------------------------------------------------------------------------------------------------

template <class... Numbers>
void append_row(std::string& text, Numbers... numbers) {
  const char* gap = "";
  const auto one = [&](double value) {
    text += gap;
    append_fixed(text, value);
    gap = " ";
  };
  (one(numbers), ...);
}

std::size_t expanded_size(const VlabContour& contour) {
  std::size_t sum = 0;
  for (const VlabContourPoint& point : contour.points) {
    sum += static_cast<std::size_t>(std::max(point.multiplicity, 0));
  }
  return sum;
}

void append_contour(std::string& text, const VlabContour& contour) {
  detail::append(text, "cver 1 3\nname: ", contour.name, "\npoints: ", contour.points.size(), " ",
                 expanded_size(contour), "\ntype: ", contour.closed ? "c" : "o", contour.through_ends ? "e" : "r",
                 "\nsamples: ", contour.samples > 0 ? contour.samples : 8, "\n");
  if (!contour.background.empty()) {
    detail::append(text, "background: ", contour.background, "\nbackgroundXY: ");
    append_row(text, contour.background_offset.x, contour.background_offset.y);
    text += '\n';
  }
  if (!contour.markers.empty()) {
    detail::append(text, "markers: ", contour.markers.size(), "\n");
    for (std::size_t i = 0; i < contour.markers.size(); ++i) {
      const VlabMarker& marker = contour.markers[i];
      detail::append(text, i, " ");
      append_row(text, marker.s, marker.position.x, marker.position.y);
      text += '\n';
    }
  }
  for (const VlabContourPoint& point : contour.points) {
    append_row(text, point.position.x, point.position.y, point.position.z);
    detail::append(text, " ", point.multiplicity, "\n");
  }
}

std::optional<Error> check_writable(const VlabContour& contour) {
  if (auto error = check(contour)) {
    return error;
  }
  if (contour.name.empty() || contour.name.size() > kLongestName || detail::one_word(contour.name) != contour.name) {
    return invalid_parameter("name", "must have 1 to 30 characters and no blanks", detail::shown_value(contour.name));
  }
  if (contour.background.size() > kLongestBackground || detail::one_line(contour.background) != contour.background) {
    return invalid_parameter(contour.name + ".background", "must be one line of at most 40 characters",
                             detail::shown_value(contour.background));
  }
  return std::nullopt;
}

// ---- geometry -------------------------------------------------------------------------------------------------------

/// The control polygon with repeated points written out; for closed curves, closed as VLab closes them.
std::vector<Vec3> polygon(const VlabContour& contour) {
  std::vector<Vec3> expanded;
  expanded.reserve(expanded_size(contour) + 3);
  for (const VlabContourPoint& point : contour.points) {
    expanded.insert(expanded.end(), static_cast<std::size_t>(point.multiplicity), point.position);
  }
  if (contour.closed && contour.through_ends) {
    expanded.push_back(Vec3(expanded.front()));
  } else if (contour.closed) {
    const std::vector<Vec3> last(expanded.end() - 3, expanded.end());
    expanded.insert(expanded.begin(), last.begin(), last.end());
  }
  return expanded;
}

/// Point and derivative of a uniform cubic B-spline's piece on the four controls from `p` on, t in [0, 1].
struct PointAndTangent {
  Vec3 point;
  Vec3 tangent;
};
PointAndTangent uniform_piece(const Vec3* p, double t) {
  const double r = 1.0 - t;
  const double b0 = r * r * r / 6.0;
  const double b1 = (4.0 + t * t * (3.0 * t - 6.0)) / 6.0;
  const double b2 = (1.0 + t * (3.0 + t * (3.0 - 3.0 * t))) / 6.0;
  const double b3 = t * t * t / 6.0;
  const double d0 = -0.5 * r * r;
  const double d1 = t * (1.5 * t - 2.0);
  const double d2 = 0.5 + t * (1.0 - 1.5 * t);
  const double d3 = 0.5 * t * t;
  return {b0 * p[0] + b1 * p[1] + b2 * p[2] + b3 * p[3], d0 * p[0] + d1 * p[1] + d2 * p[2] + d3 * p[3]};
}

/// Polar form of the uniform cubic B-spline `p`'s piece `piece` (parameters piece to piece + 1) at (a, b, c): the
/// control point that the curve has for the knots a, b, c (Ramshaw). de Boor's recursion with one argument a level.
Vec3 polar_form(const std::vector<Vec3>& p, int piece, double a, double b, double c) {
  Vec3 d[4] = {p[piece], p[piece + 1], p[piece + 2], p[piece + 3]};
  const double arguments[3] = {a, b, c};
  for (int level = 1; level <= 3; ++level) {
    for (int i = 3; i >= level; --i) {
      // The two combined share all arguments but one, knot `low` of the one and `high` of the other; knot k is k.
      const double low = piece - 3 + i;
      const double high = low + 4 - level;
      const double share = (arguments[level - 1] - low) / (high - low);
      d[i] = (1.0 - share) * d[i - 1] + share * d[i];
    }
  }
  return d[3];
}

}  // namespace

std::optional<Error> check(const VlabContour& contour) {
  std::size_t sum = 0;
  for (const VlabContourPoint& point : contour.points) {
    if (point.multiplicity < 1 || point.multiplicity > kMostPoints) {
      return invalid_parameter(contour.name + ".multiplicity", "must be between 1 and 10000", point.multiplicity);
    }
    sum += static_cast<std::size_t>(point.multiplicity);
    for (const double value : {point.position.x, point.position.y, point.position.z}) {
      if (!(std::abs(value) <= 1e30)) {
        return invalid_parameter(contour.name + ".points", "must be between -1e+30 and 1e+30", value);
      }
    }
  }
  if (sum < kFewestPoints || sum > static_cast<std::size_t>(kMostPoints)) {
    return invalid_parameter(contour.name + ".points", "must be 4 to 10000 with their multiplicities",
                             static_cast<double>(sum));
  }
  for (const VlabMarker& marker : contour.markers) {
    if (!(marker.s >= 0.0 && marker.s <= 1.0)) {
      return invalid_parameter(contour.name + ".markers", "must be between 0 and 1", marker.s);
    }
  }
  return std::nullopt;
}

Expected<std::vector<VlabContour>> read_vlab_contours(std::string_view text, std::string_view file_name) {
  VlabText reader(text, file_name);
  std::vector<VlabContour> contours;
  if (!reader.fits(kVlabTextLimit) || !read_all(reader, contours)) {
    return unexpected(reader.error);
  }
  return contours;
}

Expected<std::string> write_vlab_contour(const VlabContour& contour) {
  if (auto error = check_writable(contour)) {
    return unexpected(*error);
  }
  std::string text;
  append_contour(text, contour);
  return text;
}

Expected<std::string> write_vlab_contours(const std::vector<VlabContour>& contours) {
  std::string text;
  detail::append(text, "contourgalleryver 1 1\nitems: ", contours.size(), "\n");
  for (const VlabContour& contour : contours) {
    if (auto error = check_writable(contour)) {
      return unexpected(*error);
    }
    append_contour(text, contour);
  }
  return text;
}

BSplineCurve<Vec3> vlab_spline(const VlabContour& contour) {
  std::vector<Vec3> controls = polygon(contour);
  if (contour.through_ends) {
    return {3, std::move(controls)};
  }
  // A uniform curve is clamped by raising its end knots to multiplicity 4; the knots between stay as they are, so only
  // the three control points at each end change.
  const std::vector<Vec3> uniform = controls;
  const int count = static_cast<int>(uniform.size());
  const int pieces = count - 3;
  const auto knot = [pieces](int i) { return static_cast<double>(std::clamp(i - 3, 0, pieces)); };
  for (int i = 0; i < count; ++i) {
    if (i < 3 || i >= count - 3) {
      const int piece = std::clamp(i - 1, 0, pieces - 1);  // any piece that the control point has a share in
      controls[i] = polar_form(uniform, piece, knot(i + 1), knot(i + 2), knot(i + 3));
    }
  }
  return {3, std::move(controls)};
}

VlabCurve::VlabCurve(const VlabContour& contour) {
  ANTHESIS_ASSERT(!check(contour));
  constexpr int kSteps = 1000;  // VLab's own
  const std::size_t size = static_cast<std::size_t>(std::clamp(contour.samples == 0 ? 8 : contour.samples, 3, 10'000));
  points_.resize(size);
  normals_.assign(size, Vec3{});
  if (contour.through_ends) {
    const BSplineCurve<Vec3> spline = vlab_spline(contour);
    for (std::size_t i = 0; i < size; ++i) {
      points_[i] = spline.at(static_cast<double>(i) / static_cast<double>(size - 1));
    }
    const std::size_t chords = kSteps * (spline.controls.size() - 3);
    Vec3 before = spline.at(0.0);
    for (std::size_t i = 1; i <= chords; ++i) {
      const Vec3 here = spline.at(static_cast<double>(i) / static_cast<double>(chords));
      length_ += anthesis::length(here - before);
      before = here;
    }
    return;
  }
  const std::vector<Vec3> controls = polygon(contour);
  std::vector<Vec3> dense;
  std::vector<Vec3> tangents;
  dense.reserve(kSteps * (controls.size() - 3) + 1);
  tangents.reserve(dense.capacity());
  for (std::size_t piece = 0; piece + 3 < controls.size(); ++piece) {
    for (int i = 0; i < kSteps; ++i) {  // the last point of a piece belongs to the next; VLab lacks the very last
      const PointAndTangent here = uniform_piece(&controls[piece], static_cast<double>(i) / kSteps);
      dense.push_back(here.point);
      tangents.push_back(here.tangent);
    }
  }
  if (contour.closed) {
    dense.push_back(Vec3(dense.front()));
    tangents.push_back(Vec3(tangents.front()));
  }
  double fastest = 0.0;
  for (const Vec3 tangent : tangents) {
    fastest = std::max(fastest, anthesis::length(tangent));
  }
  // Repeated control points stop the curve for a moment: no direction there. At the ends VLab takes the normal of the
  // table's next entry.
  const double still = 1e-5 * fastest;
  const bool starts_still = anthesis::length(tangents.front()) <= still;
  const bool ends_still = anthesis::length(tangents.back()) <= still;
  for (std::size_t i = 0; i < dense.size(); ++i) {
    if (tangents[i] == Vec3{} && i + 1 < dense.size()) {
      tangents[i] = dense[i + 1] - dense[i];
    }
    tangents[i] = normalized(tangents[i]);
  }
  std::vector<double> so_far(dense.size(), 0.0);
  for (std::size_t i = 1; i < dense.size(); ++i) {
    so_far[i] = so_far[i - 1] + anthesis::length(dense[i] - dense[i - 1]);
  }
  length_ = so_far.back();
  std::size_t chord = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const double target = length_ * static_cast<double>(i) / static_cast<double>(size - 1);
    while (chord + 2 < dense.size() && so_far[chord + 1] < target) {
      ++chord;
    }
    const double step = so_far[chord + 1] - so_far[chord];
    const double share = step > 0.0 ? std::clamp((target - so_far[chord]) / step, 0.0, 1.0) : 0.0;
    points_[i] = lerp(dense[chord], dense[chord + 1], share);
    const Vec3 tangent = lerp(tangents[chord], tangents[chord + 1], share);
    normals_[i] = cross(Vec3{0.0, 0.0, 1.0}, tangent);
  }
  points_.back() = dense.back();
  if (starts_still) {
    normals_.front() = Vec3(normals_[1]);
  }
  if (ends_still) {
    normals_.back() = Vec3(normals_[size - 2]);
  }
}

Vec3 VlabCurve::looked_up(const std::vector<Vec3>& table, double s) {
  const double place = (s > 0.0 ? std::min(s, 1.0) : 0.0) * static_cast<double>(table.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), table.size() - 2);
  return lerp(table[i], table[i + 1], place - static_cast<double>(i));
}

Expected<std::vector<Vec2>> vlab_profile(const VlabContour& contour) {
  if (auto error = check(contour)) {
    return unexpected(*error);
  }
  if (contour.closed) {
    return unexpected(invalid_parameter(contour.name, "must be an open curve to be turned about the axis", "closed"));
  }
  std::vector<Vec2> controls;
  double widest = 0.0;
  for (const Vec3 point : vlab_spline(contour).controls) {
    if (point.z != 0.0) {
      return unexpected(invalid_parameter(contour.name, "must lie in the plane z = 0", point.z));
    }
    controls.push_back({point.x, point.y});
    widest = std::max(widest, point.x);
  }
  if (controls.back().x < controls.front().x) {
    std::reverse(controls.begin(), controls.end());
  }
  for (Vec2& control : controls) {
    if (control.x < 0.0 && control.x >= -0.01 * widest) {
      control.x = 0.0;
    }
  }
  if (auto error = check_profile(contour.name, controls)) {
    return unexpected(*error);
  }
  return controls;
}

}  // namespace anthesis
