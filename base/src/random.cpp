#include "anthesis/base/random.h"

#include <cmath>

#include "anthesis/base/math.h"

namespace anthesis {

Rng::Rng(std::uint64_t seed, std::uint64_t organ, RandomPurpose purpose)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      counter_{0, static_cast<std::uint32_t>(purpose), static_cast<std::uint32_t>(organ),
               static_cast<std::uint32_t>(organ >> 32)} {}

void Rng::refill() {
  // Constants of Philox 4x32: two multipliers, two Weyl increments for the key.
  constexpr std::uint32_t kMultiplier0 = 0xD2511F53;
  constexpr std::uint32_t kMultiplier1 = 0xCD9E8D57;
  constexpr std::uint32_t kWeyl0 = 0x9E3779B9;
  constexpr std::uint32_t kWeyl1 = 0xBB67AE85;
  std::uint32_t c[4] = {counter_[0], counter_[1], counter_[2], counter_[3]};
  std::uint32_t key0 = key_[0];
  std::uint32_t key1 = key_[1];
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product0 = std::uint64_t{kMultiplier0} * c[0];
    const std::uint64_t product1 = std::uint64_t{kMultiplier1} * c[2];
    const std::uint32_t next[4] = {
        static_cast<std::uint32_t>(product1 >> 32) ^ c[1] ^ key0, static_cast<std::uint32_t>(product1),
        static_cast<std::uint32_t>(product0 >> 32) ^ c[3] ^ key1, static_cast<std::uint32_t>(product0)};
    for (int i = 0; i < 4; ++i) {
      c[i] = next[i];
    }
    key0 += kWeyl0;
    key1 += kWeyl1;
  }
  for (int i = 0; i < 4; ++i) {
    block_[i] = c[i];
  }
  ++counter_[0];
  used_ = 0;
}

std::uint32_t Rng::bits() {
  if (used_ == 4) {
    refill();
  }
  return block_[used_++];
}

double Rng::uniform() {
  const std::uint64_t high = bits() >> 5;
  const std::uint64_t low = bits() >> 6;
  return static_cast<double>((high << 26) | low) * 0x1p-53;
}

double Rng::uniform(double low, double high) {
  return low + (high - low) * uniform();
}

double Rng::normal() {
  // Box and Muller; the second value is thrown away so that the stream stays a function of the call's index.
  const double radius = std::sqrt(-2.0 * math::log(1.0 - uniform()));
  return radius * math::cos(math::kTurnRad * uniform());
}

}  // namespace anthesis
