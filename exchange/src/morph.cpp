#include "morph.h"

#include <algorithm>
#include <cmath>

namespace anthesis::detail {
namespace {

constexpr std::size_t kStages = 33;
constexpr std::size_t kMaxKinks = 64;
constexpr std::size_t kMaxVertices = 4096;

double diagonal(const std::vector<Vec3>& points) {
  if (points.empty()) {
    return 0.0;
  }
  Vec3 low = points.front();
  Vec3 high = points.front();
  for (const Vec3 p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return length(high - low);
}

/// The fraction f that brings (1 - f) a + f b nearest to p, in the sense of least squares, within [0, 1]. Better than
/// the fraction of time: a petal that bends between two keys does not move along the chord at constant speed.
double best_fraction(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const std::vector<Vec3>& p) {
  double along = 0.0;
  double whole = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 chord = b[i] - a[i];
    along += dot(p[i] - a[i], chord);
    whole += dot(chord, chord);
  }
  return whole > 0.0 ? std::clamp(along / whole, 0.0, 1.0) : 0.0;
}

double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction, const std::vector<Vec3>& p) {
  double largest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 gap = p[i] - lerp(a[i], b[i], fraction);
    largest = std::max(largest, dot(gap, gap));
  }
  return std::sqrt(largest);
}

/// Deviations of the samples between two keys, each pair of keys looked at once.
class Segments {
 public:
  struct Worst {
    double deviation = -1.0;  ///< < 0: not yet known
    std::size_t sample = 0;
  };

  explicit Segments(std::span<const std::vector<Vec3>> samples)
      : samples_(samples), known_(samples.size() * samples.size()) {}

  const Worst& between(std::size_t a, std::size_t b) {
    Worst& worst = known_[a * samples_.size() + b];
    if (worst.deviation < 0.0) {
      worst = {0.0, a};
      for (std::size_t i = a + 1; i < b; ++i) {
        const double fraction = best_fraction(samples_[a], samples_[b], samples_[i]);
        const double deviation = distance(samples_[a], samples_[b], fraction, samples_[i]);
        if (deviation > worst.deviation) {
          worst = {deviation, i};
        }
      }
    }
    return worst;
  }

 private:
  std::span<const std::vector<Vec3>> samples_;
  std::vector<Worst> known_;
};

/// Moves each inner key to the place between its neighbours where the larger of its two deviations is least.
void slide(std::vector<std::size_t>& keys, Segments& segments) {
  constexpr int kSweeps = 3;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t k = 1; k + 1 < keys.size(); ++k) {
      const auto cost = [&](std::size_t i) {
        return std::max(segments.between(keys[k - 1], i).deviation, segments.between(i, keys[k + 1]).deviation);
      };
      // Downhill from where it is: the cost has one valley for all practical motions, and looking everywhere would
      // price every pair of samples.
      for (const int step : {-1, 1}) {
        for (;;) {
          const std::size_t next = keys[k] + static_cast<std::size_t>(step);
          if (next <= keys[k - 1] || next >= keys[k + 1] || cost(next) >= cost(keys[k])) {
            break;
          }
          keys[k] = next;
        }
      }
    }
  }
}

std::size_t segment_of(double coordinate, std::size_t targets) {
  return std::min(static_cast<std::size_t>(coordinate), targets - 1);
}

double deviation(const MorphChain& chain, const std::vector<std::vector<Vec3>>& keys,
                 std::span<const std::vector<Vec3>> samples) {
  double largest = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t k = segment_of(chain.coordinates[i], chain.target_count());
    const double fraction = chain.coordinates[i] - static_cast<double>(k);
    largest = std::max(largest, distance(keys[k], keys[k + 1], fraction, samples[i]));
  }
  return largest;
}

/// Finds the samples' coordinates on the chain of the given keys, and how far they are from it.
void place(MorphChain& chain, const std::vector<std::vector<Vec3>>& keys, std::span<const std::vector<Vec3>> samples) {
  for (std::size_t k = 0; k < chain.target_count(); ++k) {
    for (std::size_t i = chain.keys[k]; i < chain.keys[k + 1]; ++i) {
      chain.coordinates[i] = static_cast<double>(k) + best_fraction(keys[k], keys[k + 1], samples[i]);
    }
  }
  chain.coordinates.back() = static_cast<double>(chain.target_count());
  chain.deviation_mm = deviation(chain, keys, samples);
}

}  // namespace

KeyFit::KeyFit(const MorphChain& chain, std::size_t vertex_count)
    : chain_(chain),
      diagonal_(chain.keys.size(), 0.0),
      beside_(chain.keys.size(), 0.0),
      right_sides_(chain.keys.size(), std::vector<Vec3>(vertex_count)) {}

void KeyFit::add(std::size_t sample, std::span<const Vec3> positions_mm) {
  const auto put = [&](std::size_t key, double weight) {
    for (std::size_t i = 0; i < positions_mm.size(); ++i) {
      right_sides_[key][i] += weight * positions_mm[i];
    }
  };
  if (!chain_.fitted) {
    const auto key = std::lower_bound(chain_.keys.begin(), chain_.keys.end(), sample);
    if (key != chain_.keys.end() && *key == sample) {
      put(static_cast<std::size_t>(key - chain_.keys.begin()), 1.0);
    }
    return;
  }
  // The ends are given: one sample each, which does not count for their neighbours.
  if (sample == 0 || sample + 1 == chain_.places.size()) {
    const std::size_t key = sample == 0 ? 0 : chain_.target_count();
    std::copy(positions_mm.begin(), positions_mm.end(), right_sides_[key].begin());
    return;
  }
  const std::size_t k = segment_of(chain_.coordinates[sample], chain_.target_count());
  const double f = chain_.coordinates[sample] - static_cast<double>(k);
  diagonal_[k] += (1.0 - f) * (1.0 - f);
  diagonal_[k + 1] += f * f;
  beside_[k] += f * (1.0 - f);
  if (k > 0) {
    put(k, 1.0 - f);
  }
  if (k + 1 < chain_.target_count()) {
    put(k + 1, f);
  }
}

std::vector<std::vector<Vec3>> KeyFit::solve() {
  const std::size_t last = chain_.target_count();
  if (!chain_.fitted || last < 2) {
    return std::move(right_sides_);
  }
  const auto subtract = [&](std::size_t from, double factor, std::size_t what) {
    for (std::size_t i = 0; i < right_sides_[from].size(); ++i) {
      right_sides_[from][i] += -factor * right_sides_[what][i];
    }
  };
  // The known ends go to the right; then elimination downwards and substitution upwards (Thomas).
  subtract(1, beside_[0], 0);
  subtract(last - 1, beside_[last - 1], last);
  for (std::size_t k = 2; k < last; ++k) {
    const double factor = beside_[k - 1] / diagonal_[k - 1];
    diagonal_[k] -= factor * beside_[k - 1];
    subtract(k, factor, k - 1);
  }
  for (std::size_t k = last - 1; k >= 1; --k) {
    if (k + 1 < last) {
      subtract(k, beside_[k], k + 1);
    }
    for (Vec3& p : right_sides_[k]) {
      p = p / diagonal_[k];
    }
  }
  return std::move(right_sides_);
}

double MorphChain::coordinate_at(double place) const {
  const auto after = std::upper_bound(places.begin(), places.end(), place);
  if (after == places.begin()) {
    return coordinates.front();
  }
  if (after == places.end()) {
    return coordinates.back();
  }
  const std::size_t i = static_cast<std::size_t>(after - places.begin());
  const double f = (place - places[i - 1]) / (places[i] - places[i - 1]);
  return (1.0 - f) * coordinates[i - 1] + f * coordinates[i];
}

void MorphChain::weights_at(double coordinate, std::span<float> weights) const {
  std::fill(weights.begin(), weights.end(), 0.0f);
  if (weights.empty()) {
    return;
  }
  const double last = static_cast<double>(weights.size());
  const double at = std::clamp(coordinate, 0.0, last);
  const std::size_t segment = std::min(static_cast<std::size_t>(at), weights.size() - 1);
  const float fraction = static_cast<float>(at - static_cast<double>(segment));
  weights[segment] = fraction;
  if (segment > 0) {
    weights[segment - 1] = 1.0f - fraction;
  }
}

MorphChain choose_morph_keys(std::span<const std::vector<Vec3>> samples, std::span<const double> places,
                             double tolerance, int max_targets) {
  MorphChain chain;
  chain.places.assign(places.begin(), places.end());
  chain.coordinates.assign(places.size(), 0.0);
  for (const std::vector<Vec3>& sample : samples) {
    chain.size_mm = std::max(chain.size_mm, diagonal(sample));
  }
  // What single precision cannot tell apart does not move.
  const double still_mm = 1e-6 * chain.size_mm;
  double motion_mm = 0.0;
  for (const std::vector<Vec3>& sample : samples) {
    motion_mm = std::max(motion_mm, distance(samples.front(), samples.front(), 0.0, sample));
  }
  chain.keys = {0};
  if (samples.size() < 2 || motion_mm <= still_mm) {
    chain.deviation_mm = motion_mm;
    return chain;
  }

  Segments segments(samples);
  chain.keys.push_back(samples.size() - 1);
  const double tolerance_mm = tolerance * chain.size_mm;
  const auto worst_segment = [&] {
    std::size_t worst = 0;
    for (std::size_t k = 0; k + 1 < chain.keys.size(); ++k) {
      if (segments.between(chain.keys[k], chain.keys[k + 1]).deviation >
          segments.between(chain.keys[worst], chain.keys[worst + 1]).deviation) {
        worst = k;
      }
    }
    return worst;
  };
  for (;;) {
    const std::size_t k = worst_segment();
    const Segments::Worst& worst = segments.between(chain.keys[k], chain.keys[k + 1]);
    if (worst.deviation <= tolerance_mm || chain.target_count() >= static_cast<std::size_t>(max_targets)) {
      break;
    }
    chain.keys.insert(chain.keys.begin() + static_cast<std::ptrdiff_t>(k) + 1, worst.sample);
    slide(chain.keys, segments);
  }

  std::vector<std::vector<Vec3>> keys;
  for (const std::size_t key : chain.keys) {
    keys.push_back(samples[key]);
  }
  place(chain, keys, samples);
  // Where the samples lie on the chain, and the chain's keys, depend on each other: in turns.
  constexpr int kTurns = 3;
  MorphChain fitted = chain;
  fitted.fitted = true;
  for (int turn = 0; turn < kTurns && chain.target_count() > 1; ++turn) {
    KeyFit fit(fitted, samples.front().size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      fit.add(i, samples[i]);
    }
    keys = fit.solve();
    const std::vector<double> coordinates = fitted.coordinates;
    place(fitted, keys, samples);
    // The keys follow from the coordinates, so those that count are the ones from before.
    if (turn + 1 == kTurns) {
      fitted.coordinates = coordinates;
      fitted.deviation_mm = deviation(fitted, keys, samples);
    }
  }
  // Least squares look at the mean; an abrupt motion may be served worse at its worst.
  if (chain.target_count() > 1 && fitted.deviation_mm < chain.deviation_mm) {
    return fitted;
  }
  return chain;
}

MorphChain choose_morph_keys(const OrganTemplate& shape, double low, double high, std::span<const double> kinks,
                             double tolerance, int max_targets) {
  std::vector<double> stages;
  if (high > low) {
    for (std::size_t i = 0; i < kStages; ++i) {
      stages.push_back(std::lerp(low, high, static_cast<double>(i) / (kStages - 1)));
    }
    for (const double kink : kinks.first(std::min(kinks.size(), kMaxKinks))) {
      if (kink > low && kink < high) {
        stages.push_back(kink);
      }
    }
    std::sort(stages.begin(), stages.end());
    // Samples closer than this add nothing but division by small numbers.
    const double least = 1e-6 * (high - low);
    stages.erase(std::unique(stages.begin(), stages.end(), [&](double a, double b) { return b - a < least; }),
                 stages.end());
    stages.back() = high;
  } else {
    stages.push_back(low);
  }

  const std::size_t count = shape.vertex_count();
  const std::size_t stride = std::max<std::size_t>(1, (count + kMaxVertices - 1) / kMaxVertices);
  std::vector<Vec3> positions_mm(count);
  std::vector<Vec3> normals(count);
  std::vector<std::vector<Vec3>> samples(stages.size());
  for (std::size_t s = 0; s < stages.size(); ++s) {
    shape.pose(stages[s], positions_mm, normals);
    for (std::size_t i = 0; i < count; i += stride) {
      samples[s].push_back(positions_mm[i]);
    }
  }
  return choose_morph_keys(samples, stages, tolerance, max_targets);
}

std::vector<double> kink_stages(const OrganShape& shape) {
  std::vector<double> stages;
  for (const Petals& petals : shape.petals) {
    for (const PetalPose& pose : petals.poses) {
      stages.push_back(pose.stage);
    }
  }
  for (const Column& column : shape.columns) {
    for (const ColumnPose& pose : column.poses) {
      stages.push_back(pose.stage);
    }
  }
  std::sort(stages.begin(), stages.end());
  stages.erase(std::unique(stages.begin(), stages.end()), stages.end());
  return stages;
}

}  // namespace anthesis::detail
