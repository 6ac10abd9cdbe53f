#include "anthesis/receptacle/contour_sequence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"

namespace anthesis {
namespace {

constexpr std::size_t kMostFrames = 1'000'000;

/// Parts that the stretch inside landmark `number` (0: the base) is cut into.
std::vector<std::size_t> parts_of(const GrowingReceptacle& head) {
  const GrownProfile last = head.at(1.0);
  std::vector<double> lengths;
  for (std::size_t number = 0; number <= head.landmarks(); ++number) {
    lengths.push_back(last.length_to(head.landmark(1.0, number)) - last.length_to(head.landmark(1.0, number + 1)));
  }
  const auto [least, most] = std::minmax_element(lengths.begin(), lengths.end());
  std::vector<std::size_t> parts;
  for (const double length : lengths) {
    const double share = *most > *least ? (length - *least) / (*most - *least) : 0.0;
    parts.push_back(static_cast<std::size_t>(2.0 + 4.0 * share));
  }
  return parts;
}

/// The published way along a profile: steps of 0.0001 in s whose chords are added up. On a polygon all steps within a
/// side are equal and are taken at once.
class PublishedWalk {
 public:
  explicit PublishedWalk(const GrownProfile& profile) {
    for (std::size_t i = 0; i <= kSides; ++i) {
      corners_.push_back(profile.point(static_cast<double>(i) / kSides));
    }
  }

  /// From s until the chords add up to `length`.
  double place_after(double s, double length) const { return walk(s, 1.0, length).s; }

  /// Chords from s until `end` is reached or passed.
  double length_between(double s, double end) const {
    return walk(s, end, std::numeric_limits<double>::infinity()).length;
  }

 private:
  static constexpr std::size_t kSides = 99;
  static constexpr double kStep = 0.0001;

  struct Walked {
    double s = 0.0;
    double length = 0.0;
  };

  std::size_t side_of(double s) const { return std::min(static_cast<std::size_t>(s * kSides), kSides - 1); }

  Vec2 point(double s) const {
    s = std::min(s, 1.0);
    const std::size_t side = side_of(s);
    return lerp(corners_[side], corners_[side + 1], s * kSides - static_cast<double>(side));
  }

  Walked walk(double s, double end, double length) const {
    Walked walked{s, 0.0};
    while (walked.s < end && walked.length < length) {
      const std::size_t side = side_of(walked.s);
      const double chord = kStep * kSides * anthesis::length(corners_[side + 1] - corners_[side]);
      const double side_end = static_cast<double>(side + 1) / kSides;
      double steps = std::floor((side_end - walked.s) / kStep);
      steps = std::min(steps, std::ceil((end - walked.s) / kStep));
      if (chord > 0.0) {
        steps = std::min(steps, std::ceil((length - walked.length) / chord));
      }
      if (steps >= 1.0) {
        walked.s += steps * kStep;
        walked.length += steps * chord;
      } else {  // the step around a corner
        walked.length += anthesis::length(point(walked.s + kStep) - point(walked.s));
        walked.s += kStep;
      }
    }
    walked.s = std::min(walked.s, 1.0);
    return walked;
  }

  std::vector<Vec2> corners_;
};

void sample_frame(const GrowingReceptacle& head, double time, std::span<const std::size_t> parts,
                  std::span<ContourPoint> points, Vec2& ring) {
  const GrownProfile profile = head.at(time);
  const bool published = head.lookup() == SectionLookup::kAsPublished;
  const PublishedWalk walk(profile);
  std::size_t at = 0;
  const auto put = [&](double s) { points[at++] = {profile.point(s), s}; };
  for (std::size_t number = head.landmarks() + 1; number > 0; --number) {
    double s = head.landmark(time, number);
    const double end = head.landmark(time, number - 1);
    const double from = profile.length_to(s);
    const double length = published ? walk.length_between(s, end) : profile.length_to(end) - from;
    const double part = length / static_cast<double>(parts[number - 1]);
    put(s);
    for (std::size_t i = 1; i < parts[number - 1]; ++i) {
      s = published ? walk.place_after(s, part) : profile.s_at_length(from + static_cast<double>(i) * part);
      put(s);
    }
  }
  put(1.0);
  ring = profile.point(head.ring(time));
}

}  // namespace

Expected<std::vector<double>> contour_times(const std::function<double(double)>& pace, double step) {
  if (!(step > 0.0)) {
    return unexpected(invalid_parameter("step", "must be > 0", step));
  }
  std::vector<double> times;
  for (double time = 0.0; time < 1.0;) {
    times.push_back(time);
    const double here = pace(time);
    if (!(here > 0.0)) {
      return unexpected(invalid_parameter("pace", "must be > 0", here));
    }
    if (times.size() >= kMostFrames) {
      return unexpected(Error{ErrorCode::kTooLarge, "pace", "must not ask for more than 1000000 frames"});
    }
    time += step * here;
  }
  times.push_back(1.0);
  return times;
}

ContourSequence sample_contours(const GrowingReceptacle& head, std::span<const double> times) {
  const std::vector<std::size_t> parts = parts_of(head);
  ContourSequence sequence;
  sequence.times.assign(times.begin(), times.end());
  for (std::size_t number = head.landmarks() + 1; number > 0; --number) {
    sequence.landmarks.push_back(true);
    sequence.landmarks.insert(sequence.landmarks.end(), parts[number - 1] - 1, false);
  }
  sequence.landmarks.push_back(true);
  const std::size_t size = sequence.points_per_frame();
  sequence.points.resize(size * times.size());
  sequence.ring.resize(times.size());
  parallel_for(times.size(), [&](std::size_t i) {
    ANTHESIS_ASSERT(times[i] >= 0.0 && times[i] <= 1.0);
    sample_frame(head, times[i], parts, std::span(sequence.points).subspan(i * size, size), sequence.ring[i]);
  });
  return sequence;
}

}  // namespace anthesis
