#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "anthesis/corolla/organ_template.h"
#include "anthesis/geometry/vec.h"

namespace anthesis::detail {

/// A moving shape as a chain of key shapes, for readers that only add weighted differences.
///
/// Key 0 is the base and the others are morph targets. The shape at a place (a stage or a time) is a point on the
/// chain: coordinate k + f stands for (1 - f) key_k + f key_{k+1}.
struct MorphChain {
  std::vector<std::size_t> keys;    ///< the samples that keys are at, ascending; one: nothing moves
  std::vector<double> places;       ///< of the samples, ascending
  std::vector<double> coordinates;  ///< of the samples on the chain
  bool fitted = false;              ///< inner keys are KeyFit's; otherwise they are the samples themselves
  double deviation_mm = 0.0;        ///< largest distance of a sample's vertex from the chain
  double size_mm = 0.0;             ///< largest diagonal of a sample's bounding box

  std::size_t target_count() const { return keys.empty() ? 0 : keys.size() - 1; }

  /// Linear between samples, constant beyond them.
  double coordinate_at(double place) const;

  /// Writes the weights of the targets at a coordinate; they are those of one segment, the rest are 0.
  void weights_at(double coordinate, std::span<float> weights) const;
};

/// The key shapes of a chain, from the samples one by one. For a fitted chain they are those whose chain lies nearest
/// to the samples in the sense of least squares. A chord cuts the corner of an arc that it joins; these keys stand a
/// little outside, and the shape between them strays half as far. The first and the last key are the samples
/// themselves: bud and bloom are exact.
class KeyFit {
 public:
  explicit KeyFit(const MorphChain& chain, std::size_t vertex_count);

  /// Each sample of the chain once, in any order.
  void add(std::size_t sample, std::span<const Vec3> positions_mm);

  /// [key][vertex]
  std::vector<std::vector<Vec3>> solve();

 private:
  const MorphChain& chain_;
  std::vector<double> diagonal_;                ///< of the normal equations, which are tridiagonal
  std::vector<double> beside_;                  ///< their entry (k, k + 1)
  std::vector<std::vector<Vec3>> right_sides_;  ///< [key][vertex]
};

/// Chooses the keys among samples of a moving shape (`samples[i]` at `places[i]`, equally long): the sample farthest
/// from the chain becomes a key until all lie within `tolerance` x size or there are `max_targets` targets; the inner
/// keys slide to where the largest deviation is least. They are then fitted if that brings the chain nearer.
/// O(samples^2 x vertices) at worst.
MorphChain choose_morph_keys(std::span<const std::vector<Vec3>> samples, std::span<const double> places,
                             double tolerance, int max_targets);

/// The same for a template between two stages. Sampled at 33 stages and at `kinks` between them, where the motion may
/// turn abruptly. At most 4096 vertices, evenly chosen, are looked at.
MorphChain choose_morph_keys(const OrganTemplate& shape, double low, double high, std::span<const double> kinks,
                             double tolerance, int max_targets);

/// The stages of the key poses of everything in `shape`, ascending.
std::vector<double> kink_stages(const OrganShape& shape);

}  // namespace anthesis::detail
