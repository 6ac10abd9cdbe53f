#include "anthesis/exchange/vlab_head.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "anthesis/base/assert.h"
#include "text.h"
#include "vlab_text.h"

namespace anthesis {
namespace {

using detail::append_short;
using detail::TextPlace;
using detail::VlabText;

constexpr std::int64_t kMostFrames = 1'000'000;
constexpr std::int64_t kMostPointsPerFrame = 100'000;
constexpr std::int64_t kMostKnots = 10'000;

bool read_primordia(VlabText& text, VlabPrimordia& all) {
  const TextPlace place = text.place();
  std::int64_t stated = 0;
  if (!text.whole("count", stated, 0, 10'000'000) || !text.end_line()) {
    return false;
  }
  std::vector<std::uint32_t> ids;
  while (!text.at_end()) {
    VlabPrimordium one;
    std::int64_t id = 0;
    std::int64_t step = 0;
    std::int64_t type = 0;
    if (!text.whole("id", id, 0, 9'999'999) || !text.whole("step", step, 0, 1'000'000'000) ||
        !text.number("s", one.s, 0.0, 1.0) || !text.number("azimuth", one.azimuth_rad, 0.0, 6.28319)) {
      return false;
    }
    // Five columns or six, as in the first row. A radius is no whole number in general, but may be: count the words.
    VlabText look_ahead = text;
    look_ahead.take_word();
    const bool with_radius = !look_ahead.next_is("");
    if (all.primordia.empty()) {
      all.with_radius = with_radius;
    }
    if ((all.with_radius && !text.number("radius", one.radius, 0.0)) || !text.whole("type", type, 0, 255) ||
        !text.end_line()) {
      return false;
    }
    one.id = static_cast<std::uint32_t>(id);
    one.step = static_cast<std::uint32_t>(step);
    one.type = static_cast<int>(type);
    all.primordia.push_back(one);
    ids.push_back(one.id);
  }
  if (stated != 0 && static_cast<std::size_t>(stated) != ids.size()) {
    return text.fail_at(
        place, "count",
        "must be the number of rows, " + std::to_string(ids.size()) + ", or 0, got " + std::to_string(stated));
  }
  std::sort(ids.begin(), ids.end());
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  return twice == ids.end() || text.fail("id", "must stand in one row only, " + std::to_string(*twice) + " is in two");
}

bool read_sequence(VlabText& text, VlabContourSequence& sequence) {
  std::int64_t frames = 0;
  std::int64_t points = 0;
  if (!text.whole("frames", frames, 1, kMostFrames) || !text.end_line() ||
      !text.whole("points", points, 2, kMostPointsPerFrame) || !text.end_line()) {
    return false;
  }
  for (std::int64_t i = 0; i < points; ++i) {
    std::int64_t landmark = 0;
    if (!text.whole("landmark", landmark, 0, 1) || !text.end_line()) {
      return false;
    }
    sequence.landmarks.push_back(landmark == 1);
  }
  for (std::int64_t i = 0; i < frames * points; ++i) {  // as many as the text has: memory keeps to its size
    VlabSequencePoint point;
    if (!text.number("x", point.radius) || !text.number("y", point.height) || !text.number("s", point.s, 0.0, 1.0) ||
        !text.end_line()) {
      return false;
    }
    sequence.points.push_back(point);
  }
  for (std::int64_t i = 0; i < frames; ++i) {
    Vec2 ring;
    if (!text.number("x", ring.x) || !text.number("y", ring.y) || !text.end_line()) {
      return false;
    }
    sequence.ring.push_back(ring);
  }
  return text.expect_end();
}

bool read_knots(VlabText& text, std::vector<double>& knots) {
  double ignored = 0.0;
  while (!text.at_end()) {
    const auto index = static_cast<std::int64_t>(knots.size());
    if (index == kMostKnots) {
      return text.fail("knots", "must be at most 10000");
    }
    double knot = 0.0;
    if (!text.expect(std::to_string(index) + ":")) {
      return false;
    }
    const TextPlace place = text.place();
    if (!text.number("knot", knot) || !text.number("y", ignored) || !text.number("z", ignored) || !text.end_line()) {
      return false;
    }
    knot = std::clamp(knot, 0.0, 1.0);  // the editor's handles can be dragged beyond the ends
    if (!knots.empty() && knot < knots.back()) {
      return text.fail_at(place, "knot",
                          "must not be below the knot before, " + to_text(knots.back()) + ", got " + to_text(knot));
    }
    knots.push_back(knot);
  }
  return !knots.empty() || text.fail("knots", "must be at least 1");
}

// ---- cages ----------------------------------------------------------------------------------------------------------

/// Reads little-endian 32-bit numbers, as the program's only processors hold them.
class CageReader {
 public:
  CageReader(std::string_view bytes, std::string_view file_name) : bytes_(bytes), file_name_(file_name) {}

  bool read(std::vector<VlabCage>& cages) {
    if (bytes_.size() > kVlabRawLimit) {
      return fail("file",
                  "must have at most " + std::to_string(kVlabRawLimit) + " bytes, got " + std::to_string(bytes_.size()),
                  ErrorCode::kTooLarge);
    }
    std::uint32_t frames = 0;
    if (!count("frames", 12, frames)) {
      return false;
    }
    for (frame_ = 1; frame_ <= frames; ++frame_) {
      if (!read_cage(cages.emplace_back())) {
        return false;
      }
    }
    frame_ = 0;
    return at_ == bytes_.size() || fail("file", "must end here, got " + std::to_string(bytes_.size() - at_) + " bytes");
  }

  Error error;

 private:
  bool read_cage(VlabCage& cage) {
    std::uint32_t size = 0;
    if (!count("vertices", 8, size) || !floats("vertices", size, cage.vertices) || !count("triangles", 12, size)) {
      return false;
    }
    cage.triangles.resize(size);
    for (auto& triangle : cage.triangles) {
      std::memcpy(triangle.data(), bytes_.data() + at_, 12);
      for (const std::uint32_t vertex : triangle) {
        if (vertex >= cage.vertices.size()) {
          return fail("triangles", "must name vertices below " + std::to_string(cage.vertices.size()) + ", got " +
                                       std::to_string(vertex));
        }
      }
      at_ += 12;
    }
    if (!count("controls", 8, size) || !floats("controls", size, cage.controls)) {
      return false;
    }
    const std::uint64_t weights = std::uint64_t{size} * cage.vertices.size();
    if (weights > (bytes_.size() - at_) / 4) {
      return fail("weights", "must be " + std::to_string(weights) + " numbers, got the end of the file");
    }
    cage.weights.resize(weights);
    return finite("weights", cage.weights.data(), weights);
  }

  /// A number of things of `bytes_each`, which must still fit into the file.
  bool count(std::string_view what, std::size_t bytes_each, std::uint32_t& value) {
    if (bytes_.size() - at_ < 4) {
      return fail(what, "must be counted, got the end of the file");
    }
    std::memcpy(&value, bytes_.data() + at_, 4);
    if (value > (bytes_.size() - at_ - 4) / bytes_each) {
      return fail(what, "must be no more than the file has, got " + std::to_string(value));
    }
    at_ += 4;
    return true;
  }

  bool floats(std::string_view what, std::uint32_t size, std::vector<std::array<float, 2>>& values) {
    values.resize(size);
    return finite(what, values.empty() ? nullptr : values.front().data(), std::uint64_t{2} * size);
  }

  bool finite(std::string_view what, float* values, std::uint64_t size) {
    for (std::uint64_t i = 0; i < size; ++i, at_ += 4) {
      std::memcpy(values + i, bytes_.data() + at_, 4);
      if (!std::isfinite(values[i])) {
        return fail(what, "must be finite numbers");
      }
    }
    return true;
  }

  bool fail(std::string_view what, std::string message, ErrorCode code = ErrorCode::kParse) {
    error.code = code;
    error.where.clear();
    detail::append(error.where, file_name_, ":byte ", at_, ": ");
    if (frame_ > 0) {
      detail::append(error.where, "frame ", frame_, ": ");
    }
    error.where += what;
    error.message = std::move(message);
    return false;
  }

  std::string_view bytes_;
  std::string_view file_name_;
  std::size_t at_ = 0;
  std::uint32_t frame_ = 0;
};

template <class Value>
void append_bytes(std::string& bytes, const Value* values, std::size_t count) {
  if (count > 0) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(Value));
  }
}

void append_count(std::string& bytes, std::size_t count) {
  const auto number = static_cast<std::uint32_t>(count);
  append_bytes(bytes, &number, 1);
}

}  // namespace

Expected<VlabPrimordia> read_vlab_primordia(std::string_view text, std::string_view file_name) {
  VlabText reader(text, file_name);
  VlabPrimordia primordia;
  if (!reader.fits(kVlabTextLimit) || !read_primordia(reader, primordia)) {
    return unexpected(reader.error);
  }
  return primordia;
}

std::string write_vlab_primordia(const VlabPrimordia& primordia) {
  std::string text = std::to_string(primordia.primordia.size());
  text.insert(0, 5 - std::min<std::size_t>(text.size(), 5), '0');
  text += '\n';
  for (const VlabPrimordium& one : primordia.primordia) {
    detail::append(text, one.id, " ", one.step, " ");
    append_short(text, one.s);
    text += ' ';
    append_short(text, one.azimuth_rad);
    if (primordia.with_radius) {
      text += ' ';
      append_short(text, one.radius);
    }
    detail::append(text, " ", one.type, "\n");
  }
  return text;
}

Expected<VlabContourSequence> read_vlab_contour_sequence(std::string_view text, std::string_view file_name) {
  VlabText reader(text, file_name);
  VlabContourSequence sequence;
  if (!reader.fits(kVlabTextLimit) || !read_sequence(reader, sequence)) {
    return unexpected(reader.error);
  }
  return sequence;
}

std::string write_vlab_contour_sequence(const VlabContourSequence& sequence) {
  ANTHESIS_ASSERT(sequence.points.size() == sequence.frames() * sequence.points_per_frame());
  std::string text;
  detail::append(text, sequence.frames(), "\n", sequence.points_per_frame(), "\n");
  for (const bool landmark : sequence.landmarks) {
    text += landmark ? "1\n" : "0\n";
  }
  for (const VlabSequencePoint& point : sequence.points) {
    append_short(text, point.radius);
    text += ' ';
    append_short(text, point.height);
    text += ' ';
    append_short(text, point.s);
    text += '\n';
  }
  for (const Vec2 ring : sequence.ring) {
    append_short(text, ring.x);
    text += ' ';
    append_short(text, ring.y);
    text += '\n';
  }
  return text;
}

Expected<std::vector<double>> read_vlab_knots(std::string_view text, std::string_view file_name) {
  VlabText reader(text, file_name);
  std::vector<double> knots;
  if (!reader.fits(kVlabTextLimit) || !read_knots(reader, knots)) {
    return unexpected(reader.error);
  }
  return knots;
}

Expected<std::vector<VlabCage>> read_vlab_cages(std::string_view bytes, std::string_view file_name) {
  CageReader reader(bytes, file_name);
  std::vector<VlabCage> cages;
  if (!reader.read(cages)) {
    return unexpected(reader.error);
  }
  return cages;
}

std::string write_vlab_cages(std::span<const VlabCage> cages) {
  std::string bytes;
  append_count(bytes, cages.size());
  for (const VlabCage& cage : cages) {
    ANTHESIS_ASSERT(cage.weights.size() == cage.controls.size() * cage.vertices.size());
    append_count(bytes, cage.vertices.size());
    append_bytes(bytes, cage.vertices.data(), cage.vertices.size());
    append_count(bytes, cage.triangles.size());
    append_bytes(bytes, cage.triangles.data(), cage.triangles.size());
    append_count(bytes, cage.controls.size());
    append_bytes(bytes, cage.controls.data(), cage.controls.size());
    append_bytes(bytes, cage.weights.data(), cage.weights.size());
  }
  return bytes;
}

std::vector<double> VlabStages::weights(double time) const {
  // Cox and de Boor's recursion for degree 2 on the span that holds the time.
  constexpr std::size_t kDegree = 2;
  const std::size_t stages = contours.size();
  std::vector<double> result(stages, 0.0);
  const double t = std::clamp(time, knots[kDegree], knots[stages]);
  std::size_t span = kDegree;
  while (span + 1 < stages && t >= knots[span + 1]) {
    ++span;
  }
  double basis[kDegree + 1] = {1.0, 0.0, 0.0};
  for (std::size_t degree = 1; degree <= kDegree; ++degree) {
    double carried = 0.0;
    for (std::size_t i = 0; i < degree; ++i) {
      const double right = knots[span + i + 1];
      const double left = knots[span + 1 + i - degree];
      const double share = right > left ? basis[i] / (right - left) : 0.0;
      basis[i] = carried + (right - t) * share;
      carried = (t - left) * share;
    }
    basis[degree] = carried;
  }
  for (std::size_t i = 0; i <= kDegree; ++i) {
    result[span - kDegree + i] = basis[i];
  }
  return result;
}

Expected<VlabStages> vlab_stages(std::vector<VlabContour> contours, std::vector<double> knots) {
  constexpr std::size_t kFewest = 3;
  while (!contours.empty() && contours.back().markers.empty()) {
    contours.pop_back();
  }
  if (contours.size() < kFewest) {
    return unexpected(invalid_parameter("contours", "must have at least 3 stages with markers",
                                        static_cast<double>(contours.size())));
  }
  VlabStages stages;
  for (const VlabContour& contour : contours) {
    if (contour.markers.empty()) {
      return unexpected(invalid_parameter(contour.name + ".markers", "must end with the active ring", "no markers"));
    }
    std::vector<double>& landmarks = stages.landmarks.emplace_back();
    for (const VlabMarker& marker : contour.markers) {
      if (!landmarks.empty() && !(marker.s < landmarks.back())) {
        return unexpected(invalid_parameter(contour.name + ".markers", "must descend from the base inwards", marker.s));
      }
      landmarks.push_back(marker.s);
    }
    stages.ring.push_back(landmarks.back());
    landmarks.pop_back();
  }
  const std::size_t count = contours.size();
  if (knots.empty()) {
    for (std::size_t i = 0; i < count + 3; ++i) {
      const double inner = static_cast<double>(i) - 2.0;
      knots.push_back(std::clamp(inner / static_cast<double>(count - 2), 0.0, 1.0));
    }
  }
  if (knots.size() != count + 3) {
    return unexpected(invalid_parameter("knots", "must be three more than the " + std::to_string(count) + " stages",
                                        static_cast<double>(knots.size())));
  }
  if (!std::is_sorted(knots.begin(), knots.end()) || !(knots[2] < knots[count])) {
    return unexpected(invalid_parameter("knots", "must ascend and span some time", knots[count]));
  }
  stages.contours = std::move(contours);
  stages.knots = std::move(knots);
  return stages;
}

}  // namespace anthesis
