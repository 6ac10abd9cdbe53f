#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/contact/crossings.h"
#include "anthesis/contact/sheet.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// No two vertices, edges or triangles come nearer than this by what GrowingSheets does; so positions may be rounded to
/// a lattice of a quarter of it without a crossing (two points close in by at most 0.43 of it). Things that are nearer
/// from the start are not brought nearer.
inline constexpr double kLeastGap_mm = 2.5e-4;

/// An organ among others, or a body such as the receptacle.
struct GrowingBody {
  std::uint32_t sheet = 0;    ///< index into the sheets
  double thickness_mm = 0.1;  ///< > kLeastGap_mm: two bodies keep the mean of theirs between them where they can
  bool fixed = false;         ///< pushes others and is not pushed by them
};

struct GrowingOptions {
  int sweeps = 10;            ///< of all constraints in one pass, 1 to 1000
  double piece = 0.25;        ///< longest move of a vertex in one pass, as a share of its organ's mean edge, (0, 1]
  int settling_passes = 8;    ///< at most, once the targets are reached, 0 to 10000
  double residual_mm = 0.02;  ///< steady: no vertex moves farther than this in a pass, nor than 3 % of a mean edge
};

/// What a step of growth took.
struct GrowthStep {
  int passes = 0;
  std::uint64_t contacts = 0;   ///< pairs near enough to matter, summed over the passes
  std::uint64_t shortened = 0;  ///< moves of vertices cut short by the guarantee, summed over the passes
  double residual_mm = 0.0;     ///< longest move of a vertex beyond growth in the last pass
};

/// Growing position-based dynamics with contact (O16 section 3): sheets follow target shapes that grow, and give way to
/// each other.
///
/// The guarantee: no crossing ever arises. Bodies enter crossing-free, and every move is cut short where it would let
/// a vertex pass a plane that parts it from what is near. See docs/contact.md for the proof.
///
/// The result depends on the sheets, the bodies, the options and the sequence of targets; not on threads.
class GrowingSheets {
 public:
  GrowingSheets(std::vector<Sheet> sheets, const GrowingOptions& options);
  GrowingSheets(GrowingSheets&&) noexcept;
  GrowingSheets& operator=(GrowingSheets&&) noexcept;
  ~GrowingSheets();

  /// What entering took.
  struct Entry {
    double scale = 0.0;                   ///< of the target shape, about its attachment; 0: no room, the body is not in
    std::vector<std::uint32_t> in_place;  ///< bodies that crossed it at the smallest scale tried, ascending
    bool crosses_itself = false;          ///< in its target shape, and so at every scale
  };

  /// Puts a body in at the largest of the scales 1, 1/2, 1/4, .. 1/1024 about `attachment_mm` at which it crosses
  /// nothing; it grows to the target shape with the next advance(). `positions_mm`: its target shape, one for each
  /// vertex of its sheet. Vertices are numbered on from those of the bodies before it.
  Entry enter(const GrowingBody& body, std::span<const Vec3> positions_mm, Vec3 attachment_mm);

  /// Organs grow thicker; > kLeastGap_mm.
  void set_thickness(std::size_t index, double thickness_mm);

  std::size_t body_count() const;
  const GrowingBody& body(std::size_t index) const;
  std::uint32_t first_vertex(std::size_t index) const;
  std::span<const Sheet> sheets() const;
  std::span<const Vec3> positions_mm() const;  ///< of all bodies, one after the other
  std::span<const Vec3> targets_mm() const;    ///< shapes that the bodies have where nothing touches them

  /// Lets the targets grow to `targets_mm` (as long as positions_mm()) in pieces, and the bodies follow, until the
  /// state is steady. Errors: kCancelled, with everything as far as it had come.
  Expected<GrowthStep> advance(std::span<const Vec3> targets_mm, const Progress& progress = {});

  /// Every pair of triangles that cross now, exactly; triangles numbered body after body. Empty, or this class is at
  /// fault.
  Expected<CrossingReport> audit(const Progress& progress = {}) const;

  /// Everything that the future depends on, and back. `restore` wants the same sheets and options.
  struct Snapshot {
    std::vector<GrowingBody> bodies;
    std::vector<Vec3> positions_mm;
    std::vector<Vec3> targets_mm;
    std::vector<std::uint8_t> awake;  ///< one for each body
    std::vector<std::uint8_t> bent;   ///< as many as were there at the last pass: not as the target is
    std::vector<double> wanted_mm;    ///< one for each vertex: how far beside its way the last pass wanted it to go
  };
  Snapshot snapshot() const;
  void restore(Snapshot snapshot);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace anthesis
