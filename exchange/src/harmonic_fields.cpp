#include "anthesis/exchange/harmonic_fields.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/file.h"

namespace anthesis {
namespace {

/// The bytes of one frame. The processors we build for hold numbers as the format does, little end first.
class FrameBytes {
 public:
  void assign(const HarmonicFrame& frame) {
    const SectionMesh& mesh = frame.mesh;
    const std::size_t size =
        4 * (3 + 2 * mesh.points.size() + 3 * mesh.triangles.size() + 2 * frame.controls.size() + frame.weights.size());
    bytes_.clear();
    bytes_.reserve(size);
    count(mesh.points.size());
    points(mesh.points);
    count(mesh.triangles.size());
    append(mesh.triangles.data(), 3 * mesh.triangles.size());
    count(frame.controls.size());
    points(frame.controls);
    numbers_.resize(frame.weights.size());
    std::transform(frame.weights.begin(), frame.weights.end(), numbers_.begin(),
                   [](double value) { return static_cast<float>(value); });
    append(numbers_.data(), numbers_.size());
    ANTHESIS_ASSERT(bytes_.size() == size);
  }

  std::string_view bytes() const { return bytes_; }

 private:
  template <class Value>
  void append(const Value* values, std::size_t words) {
    bytes_.append(reinterpret_cast<const char*>(values), 4 * words);
  }

  void count(std::size_t size) {
    const auto number = static_cast<std::uint32_t>(size);
    append(&number, 1);
  }

  void points(std::span<const Vec2> values) {
    for (const Vec2 p : values) {
      const float both[2] = {static_cast<float>(p.x), static_cast<float>(p.y)};
      append(both, 2);
    }
  }

  std::string bytes_;
  std::vector<float> numbers_;
};

}  // namespace

std::optional<Error> write_harmonic_fields(const InteriorGrowth& growth, const ByteSink& sink,
                                           const Progress& progress) {
  const auto frames = static_cast<std::uint32_t>(growth.frames());
  std::size_t written = sizeof(frames);
  std::optional<Error> stopped = sink({reinterpret_cast<const char*>(&frames), sizeof(frames)});
  if (stopped) {
    return stopped;
  }
  FrameBytes frame_bytes;
  std::optional<Error> error = growth.weights([&](const HarmonicFrame& frame) {
    frame_bytes.assign(frame);
    written += frame_bytes.bytes().size();
    if (written > kVlabRawLimit) {
      stopped = Error{ErrorCode::kTooLarge, "frame " + std::to_string(frame.frame),
                      "harmonic fields must have at most " + std::to_string(kVlabRawLimit) +
                          " bytes; a larger max_edge makes fewer"};
      return false;
    }
    stopped = sink(frame_bytes.bytes());
    if (!stopped && !report(progress, "harmonic fields", static_cast<double>(frame.frame + 1) / frames)) {
      stopped = Error{ErrorCode::kCancelled, "harmonic fields", "were cancelled"};
    }
    return !stopped;
  });
  return error ? error : stopped;
}

std::optional<Error> write_harmonic_fields(const InteriorGrowth& growth, const std::string& path,
                                           const Progress& progress) {
  Expected<FileWriter> file = FileWriter::create(path);
  if (!file) {
    return std::move(file.error());
  }
  const ByteSink sink = [&](std::string_view bytes) { return file->write(bytes); };
  if (std::optional<Error> error = write_harmonic_fields(growth, sink, progress)) {
    return error;
  }
  return file->finish();
}

std::optional<Error> write_harmonic_fields(const SectionSequence& sections, const std::string& path,
                                           const SectionMeshParams& mesh, const Progress& progress) {
  Expected<InteriorGrowth> growth = InteriorGrowth::make(sections, {.mesh = mesh, .axis = AxisCondition::kNatural});
  if (!growth) {
    return std::move(growth.error());
  }
  return write_harmonic_fields(*growth, path, progress);
}

VlabContourSequence vlab_contour_sequence(const ContourSequence& contours) {
  VlabContourSequence sequence;
  sequence.landmarks = contours.landmarks;
  sequence.ring = contours.ring;
  sequence.points.reserve(contours.points.size());
  for (const ContourPoint& point : contours.points) {
    sequence.points.push_back({point.position.x, point.position.y, point.s});
  }
  return sequence;
}

VlabPrimordia vlab_primordia(std::span<const RingPrimordium> primordia, VlabPrimordiaMoment moment,
                             VlabOrganCodes codes, double time_step) {
  ANTHESIS_ASSERT(time_step > 0.0);
  VlabPrimordia all;
  for (std::uint32_t id = 0; id < primordia.size(); ++id) {
    const RingPrimordium& one = primordia[id];
    const RingMoment& at = moment == VlabPrimordiaMoment::kInitial  ? one.born
                           : moment == VlabPrimordiaMoment::kStable ? one.stable
                                                                    : one.last;
    VlabPrimordium row;
    row.id = id;
    row.step = at.step != 0 ? at.step : 1 + static_cast<std::uint32_t>(std::lround(at.time / time_step));
    row.s = at.s;
    row.azimuth_rad = at.azimuth_rad;
    row.type =
        codes == VlabOrganCodes::kGerbera ? static_cast<int>(at.kind) : (at.kind == PrimordiumKind::kBract ? 1 : 0);
    all.primordia.push_back(row);
  }
  if (moment == VlabPrimordiaMoment::kStable) {
    std::stable_sort(all.primordia.begin(), all.primordia.end(),
                     [](const VlabPrimordium& a, const VlabPrimordium& b) { return a.step < b.step; });
  }
  return all;
}

}  // namespace anthesis
