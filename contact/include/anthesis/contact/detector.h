#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "anthesis/contact/sheet.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// A thing whose triangles can touch others': an organ, or a body such as the receptacle. Its vertices are at
/// first_vertex and after in the scene's positions, in the order of its sheet.
struct ContactBody {
  std::uint32_t sheet = 0;         ///< index into the detector's sheets
  std::uint32_t first_vertex = 0;  ///< in the scene's positions
  double reach_mm = 0.0;           ///< >= 0: how far it looks around; contacts of two bodies span the sum of both
  /// How far each of its vertices looks around, if that differs; points of edges and triangles look as far as those of
  /// their vertices, in proportion. Empty: all of them `reach_mm`. Only for bodies that are awake.
  std::span<const double> vertex_reach_mm = {};
  /// Two bodies that are asleep have no contacts with each other, nor with themselves. Precondition: none of them moves
  /// from the first call that says it sleeps to the next that says it is awake; its positions are read in the first
  /// alone.
  bool awake = true;
  bool within = true;  ///< its own triangles may touch each other
  bool among = true;   ///< and those of other bodies
  /// Where it looks from: from all places that its vertices may get to, each by any share of its own way, together with
  /// any share, the same for all, of the ride. Only for bodies that are awake. No ways: none.
  Vec3 ride_mm = {};
  std::span<const Vec3> vertex_way_mm = {};
  double within_less_mm = 0.0;  ///< so much less far its vertices look for parts of their own body, >= 0
};

/// A vertex near a triangle, or an edge near an edge.
struct Contact {
  /// Indices into the scene's positions: the vertex, then the triangle's three; or the two of each edge. The edge or
  /// triangle from `first_body` comes first; for vertex and triangle the first body is the vertex's.
  std::array<std::uint32_t, 4> vertices = {};
  /// Signed barycentric coordinates of the nearest points: the sum of weight x position is the vector from the second
  /// nearest point to the first, gap_mm * normal. (1, -a, -b, -c) or (1 - s, s, -(1 - t), -t).
  std::array<double, 4> weights = {};
  Vec3 normal;          ///< unit, from the second to the first; any unit vector where gap_mm is 0
  double gap_mm = 0.0;  ///< distance, >= 0
  std::uint32_t first_body = 0;
  std::uint32_t second_body = 0;
  bool edges = false;  ///< edge near edge
};

/// An untested pair of the broad phase, of the same shape as a contact.
struct CandidatePair {
  std::array<std::uint32_t, 4> vertices = {};
  std::uint32_t first_body = 0;
  std::uint32_t second_body = 0;
  bool edges = false;
};

/// Finds what is near or on collision course in a scene of bodies that share sheets. Each sheet has one hierarchy of
/// k-DOPs, built from the first positions it is given and refitted to each body's positions ever after; a top level
/// holds the bodies. Pairs that share a vertex index are never reported.
/// Vertices and edges are those of triangles; others are no part of the surface. Bodies are known again by sheet and
/// first_vertex. See docs/contact-detection.md.
class Detector {
 public:
  /// `sheets` must outlive the detector.
  explicit Detector(std::span<const Sheet> sheets);
  Detector(Detector&&) noexcept;
  Detector& operator=(Detector&&) noexcept;
  ~Detector();

  /// Every vertex-triangle and edge-edge pair whose distance is, or by their bodies' rides and ways may become, at most
  /// the sum of its bodies' reaches (a body and itself: twice its reach, and no ride), once, in an order that depends
  /// on the bodies and the sheets only. Never misses one for rounding; pairs a little farther may be among them.
  void find_near(std::span<const Vec3> positions_mm, std::span<const ContactBody> bodies,
                 std::vector<Contact>& contacts);

  /// A superset of all pairs that touch while the vertices move in straight lines from `from_mm` to `to_mm`, grown by
  /// the bodies' reaches. The broad phase alone: pass each to `first_touch` (contact/continuous.h).
  void find_on_course(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm, std::span<const ContactBody> bodies,
                      std::vector<CandidatePair>& pairs);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace anthesis
