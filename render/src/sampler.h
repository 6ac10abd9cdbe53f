#pragma once
#include <cstdint>

namespace anthesis {

inline std::uint32_t mixed(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x21F0AAADu;
  h ^= h >> 15;
  h *= 0xD35A2D97u;
  return h ^ (h >> 15);
}

inline std::uint32_t bits_reversed(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x >> 4) & 0x0F0F0F0Fu) | ((x & 0x0F0F0F0Fu) << 4);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

/// Turns over each bit of a fraction whose bits are given lowest first, depending on the bits before it only (after
/// Laine and Karras 2011, constants of Vegdahl 2021): an Owen scramble.
inline std::uint32_t scrambled_from_low(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3D20ADEAu;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526C56u;
  x ^= x * 0x53A22864u;
  return x;
}

/// The second Sobol dimension of `index`, bits lowest first: binomials mod 2, which is five exchanges.
inline std::uint32_t sobol_second(std::uint32_t index) {
  index ^= (index & 0xAAAAAAAAu) >> 1;
  index ^= (index & 0xCCCCCCCCu) >> 2;
  index ^= (index & 0xF0F0F0F0u) >> 4;
  index ^= (index & 0xFF00FF00u) >> 8;
  return index ^ (index >> 16);
}

/// Points for one sample of one pixel, a function of (pixel, sample) alone. Each call takes the next pair out of an
/// endless row of independent, Owen-scrambled, index-shuffled (0, 2)-sequences (Burley 2020).
class Sampler {
 public:
  struct Pair {
    float x;
    float y;
  };

  Sampler(std::uint32_t pixel, std::uint32_t sample)
      : key_(mixed(pixel ^ 0xA511E9B3u)), reversed_sample_(bits_reversed(sample)) {}

  /// In [0, 1)^2.
  Pair next() {
    key_ += 0x9E3779B9u;
    const std::uint32_t seed = mixed(key_);
    const std::uint32_t index = bits_reversed(scrambled_from_low(reversed_sample_, seed));
    const std::uint32_t x = bits_reversed(scrambled_from_low(index, seed * 0x2C1B3C6Du + 1u));
    const std::uint32_t y = bits_reversed(scrambled_from_low(sobol_second(index), seed * 0x297A2D39u + 3u));
    return {static_cast<float>(x >> 8) * 0x1p-24F, static_cast<float>(y >> 8) * 0x1p-24F};
  }

 private:
  std::uint32_t key_;
  std::uint32_t reversed_sample_;
};

}  // namespace anthesis
