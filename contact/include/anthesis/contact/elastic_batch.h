#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "anthesis/contact/sheet.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

/// Position-based elasticity of many organs that share one sheet (O16 section 3): lengths of edges, signed dihedral
/// angles and attachments are projected one after the other, in an order that depends on the sheet alone, for eight
/// organs side by side. See docs/growing-position-based-dynamics.md.
///
/// Positions of all organs are in one array; organ k has its vertices at first_vertex[k] and after. Each organ's result
/// depends on its own positions and targets only: not on the others, on their number, on threads, or on the processor.
class ElasticBatch {
 public:
  /// Copies what it needs of `sheet`. Constraints of stiffness 0 cost nothing.
  explicit ElasticBatch(const Sheet& sheet);
  ElasticBatch(ElasticBatch&&) noexcept;
  ElasticBatch& operator=(ElasticBatch&&) noexcept;
  ~ElasticBatch();

  /// Chooses the organs, takes their rest lengths, rest angles and attachment places from `targets_mm`, the shape that
  /// each has where nothing touches it, and lets them stand still in it; load() follows. Costs about one sweep; memory
  /// is kept for the next call.
  void set_rest(std::span<const Vec3> targets_mm, std::span<const std::uint32_t> first_vertex);

  /// Reads the positions of the chosen organs.
  void load(std::span<const Vec3> positions_mm);

  /// Projects every constraint `sweeps` times: edges, hinges, attachments, edges, ... Parallel over organs. Leaves an
  /// organ that is at rest untouched, to the last bit.
  void sweep(int sweeps);

  /// The same, but each organ gathers momentum from sweep to sweep, and loses it when it overshoots: it bends in
  /// hundreds of sweeps where sweep() needs tens of thousands. Momentum lasts until set_rest(): positions loaded in
  /// between, such as those that contacts have corrected, count as where the last sweep led. For stiffnesses up to 1.
  void settle(int sweeps);

  /// Writes the positions back; nothing else in `positions_mm` changes.
  void store(std::span<Vec3> positions_mm) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace anthesis
