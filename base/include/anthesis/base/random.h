#pragma once
#include <cstdint>

namespace anthesis {

/// What a random number is for. Each purpose has its own stream, so that a new use never changes an old one.
enum class RandomPurpose : std::uint32_t {
  kVariant = 1,
  kSize,
  kPitch,
  kYaw,
  kRoll,
  kStage,
  kCurl,
  kTwist,
  kColour,
  kWidth,
  kLight,
  kSurface,
  kHair,
  kVeinBirth = 64,
  kVeinInitial = 65,
  kVeinStrand = 66,
  kVeinReticulation = 67,
  kVeinSource = 68,
  kVeinColonisation = 69,
  kTest = 1000,
};

/// Random numbers keyed by (seed, organ, purpose): a function of the key, not of the order of calls.
///
/// Philox 4x32-10 of Salmon et al. 2011 (counter based): equal on every machine and for any number of threads.
class Rng {
 public:
  Rng(std::uint64_t seed, std::uint64_t organ, RandomPurpose purpose);

  std::uint32_t bits();                     ///< 32 random bits
  double uniform();                         ///< in [0, 1), 53 bits
  double uniform(double low, double high);  ///< in [low, high)
  double normal();                          ///< mean 0, standard deviation 1

 private:
  void refill();

  std::uint32_t key_[2];
  std::uint32_t counter_[4];
  std::uint32_t block_[4];
  int used_ = 4;
};

}  // namespace anthesis
