#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/contact/detector.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// A body's part in a move.
struct MovingBody {
  std::uint32_t first_vertex = 0;
  std::uint32_t end_vertex = 0;
  Vec3 ride_mm;         ///< what all its vertices have in common: the motion of what it stands on
  bool relaxes = true;  ///< or it does nothing beyond its ride
};

/// What of `move` no share of `way`, from 0 to 1, comes nearer to.
Vec3 beside_way(Vec3 move, Vec3 way);

/// Cuts moves short so that nothing crosses: docs/contact.md has the proof.
///
/// A vertex moves by its body's ride and by its own move beyond that. Either is cut, each by its own share: the parts
/// of one organ ride together, so a ride is no danger among them.
class StepFilter {
 public:
  /// What each vertex looked around for: any share of its body's ride and of its own way, and so far beside that.
  struct Lookout {
    std::span<const Vec3> way_mm;  ///< empty: none
    std::span<const double> reach_mm;
    std::span<const double> within_reach_mm;  ///< for parts of its own body, without the ride
  };

  /// `contacts`: at `from_mm`, which is crossing-free, all pairs that see each other by `lookout`. A reach is at least
  /// half the least gap. `bodies` in the order of the contacts' indices. Shortens the moves from `from_mm` to `to_mm`;
  /// returns the number of vertices whose move was cut.
  std::uint64_t apply(std::span<const Contact> contacts, std::span<const MovingBody> bodies, const Lookout& lookout,
                      std::span<const Vec3> from_mm, std::span<Vec3> to_mm);

 private:
  /// Shares of what may be done, and which of them changed in the last round and in this one.
  struct Shares {
    std::vector<double> share;
    std::vector<std::uint8_t> changed;
    std::vector<std::uint8_t> changes;
    void reset(std::size_t count);
    bool cut(std::uint32_t index, double to);
  };

  void split(std::span<const MovingBody> bodies, const Lookout& lookout, std::span<const Vec3> from_mm,
             std::span<const Vec3> to_mm);

  /// A contact along its normal, from the second towards the first.
  struct Along {
    std::array<double, 4> behind;  ///< how far each vertex lies behind the nearest point of its own side
    std::array<double, 4> own;     ///< own move of each vertex
    double first_ride = 0.0;       ///< 0 within a body
    double second_ride = 0.0;
    double room = 0.0;  ///< what the two may use
  };
  Along along(const Contact& contact, std::span<const MovingBody> bodies, std::span<const Vec3> from_mm) const;
  bool would_meet(const Contact& contact, const Along& line) const;
  bool hold(const Contact& contact, const Along& line);

  std::vector<Vec3> own_;                            ///< by vertex: its move beyond the ride
  Shares own_shares_;                                ///< by vertex
  Shares ride_shares_;                               ///< by body
  std::vector<std::uint8_t> held_;                   ///< contacts whose plane stands still
  std::vector<std::vector<std::uint32_t>> meeting_;  ///< contacts of a round, by chunk
  std::vector<std::uint64_t> shortened_;             ///< by body: vertices whose move was cut
};

}  // namespace anthesis
