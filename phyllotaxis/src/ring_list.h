#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace anthesis::detail {

/// Primordia in the order of their material coordinates, which is that of their places on the profile at any time:
/// those near the ring are a stretch of it, mostly its beginning.
class RingList {
 public:
  void insert(std::uint32_t primordium, double material) {
    const auto place = std::lower_bound(entries_.begin(), entries_.end(), material,
                                        [](const Entry& entry, double value) { return entry.material < value; });
    entries_.insert(place, {material, primordium});
  }

  struct Entry {
    double material = 0.0;
    std::uint32_t primordium = 0;
  };
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Entry> entries_;
};

/// An angle within one turn of 0: [0, 2 pi).
double one_turn(double angle_rad);

/// The smaller angle between two directions given within [0, 2 pi].
double angle_between(double a_rad, double b_rad);

}  // namespace anthesis::detail
