#include "anthesis/contact/elastic_batch.h"

#include <algorithm>
#include <cstring>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"

// Highway compiles what lies between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set, by
// including this file again and again, and chooses while the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/elastic_batch.cpp"
#include "elastic_kernel.h"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// The same bits for every instruction set: only operations that IEEE 754 rounds exactly, no fused multiply-add, no
// reciprocal estimates, nothing across lanes.
HWY_BEFORE_NAMESPACE();
namespace anthesis::elastic::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, kLanes>;
using V = hn::Vec<Tag>;

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 operator-(V3 a, V3 b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 operator+(V3 a, V3 b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator*(V k, V3 a) {
  return {hn::Mul(k, a.x), hn::Mul(k, a.y), hn::Mul(k, a.z)};
}
HWY_INLINE V dot(V3 a, V3 b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE V3 cross(V3 a, V3 b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE V3 load(const Lanes* lanes, std::size_t index, std::size_t lane) {
  const Tag d;
  const Lanes* first = lanes + 3 * index;
  return {hn::Load(d, first[0].value + lane), hn::Load(d, first[1].value + lane), hn::Load(d, first[2].value + lane)};
}
HWY_INLINE void store(V3 v, Lanes* lanes, std::size_t index, std::size_t lane) {
  const Tag d;
  Lanes* first = lanes + 3 * index;
  hn::Store(v.x, d, first[0].value + lane);
  hn::Store(v.y, d, first[1].value + lane);
  hn::Store(v.z, d, first[2].value + lane);
}

HWY_INLINE void project_edge(const Edge& edge, const Lanes& rest, Lanes* positions, std::size_t lane) {
  const Tag d;
  const V3 a = load(positions, edge.vertices[0], lane);
  const V3 b = load(positions, edge.vertices[1], lane);
  const V3 along = b - a;
  const V length = hn::Sqrt(dot(along, along));
  const V error = hn::Sub(length, hn::Load(d, rest.value + lane));
  const V share = hn::Div(hn::Mul(hn::Set(d, edge.half_share), error), length);
  // Coincident ends have no direction to part in; hinges and other edges must do it.
  const V3 shift = hn::IfThenElseZero(hn::Gt(length, hn::Zero(d)), share) * along;
  store(a + shift, positions, edge.vertices[0], lane);
  store(b - shift, positions, edge.vertices[1], lane);
}

/// What angle, gradients and step of a hinge are made of. See docs/growing-position-based-dynamics.md.
struct Bend {
  V3 normal, other_normal;  ///< times twice the area
  V size, other_size;       ///< squares of their lengths
  V edge_square, edge_length;
  V foot, other_foot;      ///< where the apexes stand above the edge, from its first vertex, times the edge's length
  V reach, other_reach;    ///< the same from its second vertex
  V spread, other_spread;  ///< sums of the squares of edge, foot and reach
  V cosine, minus_sine;    ///< of the angle, times both normals' lengths
};

HWY_INLINE Bend measure(V3 p, V3 q, V3 apex, V3 other_apex) {
  const V3 edge = q - p;
  const V3 one = apex - p;
  const V3 other = other_apex - p;
  Bend bend;
  bend.normal = cross(edge, one);
  bend.other_normal = cross(other, edge);
  bend.size = dot(bend.normal, bend.normal);
  bend.other_size = dot(bend.other_normal, bend.other_normal);
  bend.edge_square = dot(edge, edge);
  bend.edge_length = hn::Sqrt(bend.edge_square);
  bend.foot = dot(one, edge);
  bend.other_foot = dot(other, edge);
  bend.reach = hn::Sub(bend.edge_square, bend.foot);
  bend.other_reach = hn::Sub(bend.edge_square, bend.other_foot);
  const V edge_fourth = hn::Mul(bend.edge_square, bend.edge_square);
  bend.spread = hn::Add(hn::Add(edge_fourth, hn::Mul(bend.foot, bend.foot)), hn::Mul(bend.reach, bend.reach));
  bend.other_spread = hn::Add(hn::Add(edge_fourth, hn::Mul(bend.other_foot, bend.other_foot)),
                              hn::Mul(bend.other_reach, bend.other_reach));
  bend.cosine = dot(bend.normal, bend.other_normal);
  // The normals' cross product is along the edge, so its length needs no cross product.
  bend.minus_sine = hn::Mul(bend.edge_length, dot(bend.normal, other));
  return bend;
}

/// Whether both triangles have a normal worth the name: their height over the edge is not rounding.
HWY_INLINE hn::Mask<Tag> is_sound(const Bend& bend) {
  const Tag d;
  const V bound = hn::Set(d, 1e-20);  // heights of 1e-10 of the triangle's extent along the edge
  return hn::And(hn::Gt(bend.size, hn::Mul(bound, bend.spread)),
                 hn::Gt(bend.other_size, hn::Mul(bound, bend.other_spread)));
}

/// The angle of the vector (cosine, sine) where it is below pi/8, and +-pi/8 beyond: no single projection turns
/// further, so that a hinge that is far from rest, or folded, cannot throw its vertices about. Zero for the zero
/// vector.
HWY_INLINE V limited_angle(V sine, V cosine) {
  const Tag d;
  const V reach = hn::Mul(hn::Set(d, 0.41421356237309503), cosine);  // tan(pi/8)
  const V size = hn::Abs(sine);
  const V t = hn::Div(sine, cosine);
  const V z = hn::Mul(t, t);
  // The series of the arc tangent up to t^13, by pairs: 3e-7 of the angle at most, and a step need be no better than
  // that as long as it vanishes with the error.
  const V z2 = hn::Mul(z, z);
  const V z4 = hn::Mul(z2, z2);
  const V first = hn::Sub(hn::Set(d, 1.0), hn::Mul(hn::Set(d, 1.0 / 3.0), z));
  const V second = hn::Sub(hn::Set(d, 1.0 / 5.0), hn::Mul(hn::Set(d, 1.0 / 7.0), z));
  const V third = hn::Sub(hn::Set(d, 1.0 / 9.0), hn::Mul(hn::Set(d, 1.0 / 11.0), z));
  const V fourth = hn::Mul(hn::Set(d, 1.0 / 13.0), z2);
  const V series = hn::Add(hn::Add(first, hn::Mul(second, z2)), hn::Mul(hn::Add(third, fourth), z4));
  const V beyond = hn::IfThenElseZero(hn::Gt(size, reach), hn::CopySign(hn::Set(d, 0.39269908169872414), sine));
  return hn::IfThenElse(hn::Lt(size, reach), hn::Mul(t, series), beyond);
}

HWY_INLINE void project_hinge(const Hinge& hinge, const Lanes* rest, Lanes* positions, std::size_t lane) {
  const Tag d;
  const V3 p = load(positions, hinge.vertices[0], lane);
  const V3 q = load(positions, hinge.vertices[1], lane);
  const V3 apex = load(positions, hinge.vertices[2], lane);
  const V3 other_apex = load(positions, hinge.vertices[3], lane);
  const Bend bend = measure(p, q, apex, other_apex);
  // The angle between the present and the rest direction instead of the difference of two angles: it is wrapped as it
  // stands, exactly zero at rest, and takes one arc tangent of a small argument.
  const V rest_cosine = hn::Load(d, rest[0].value + lane);
  const V rest_minus_sine = hn::Load(d, rest[1].value + lane);
  const V sine = hn::Sub(hn::Mul(bend.cosine, rest_minus_sine), hn::Mul(bend.minus_sine, rest_cosine));
  const V cosine = hn::Add(hn::Mul(bend.cosine, rest_cosine), hn::Mul(bend.minus_sine, rest_minus_sine));
  const V error = limited_angle(sine, cosine);
  // All gradients over one denominator: the sum of their squares is `gradients` / (edge^2 size other_size).
  const V mixed = hn::Add(hn::Mul(bend.foot, bend.other_foot), hn::Mul(bend.reach, bend.other_reach));
  const V gradients = hn::Add(hn::Add(hn::Mul(bend.spread, bend.other_size), hn::Mul(bend.other_spread, bend.size)),
                              hn::Mul(hn::Add(mixed, mixed), bend.cosine));
  // Divided before the angle is known, so that the processor can do both divisions at a time.
  const V lever =
      hn::IfThenElseZero(is_sound(bend), hn::Div(hn::Mul(hn::Set(d, hinge.share), bend.edge_length), gradients));
  const V step = hn::Mul(error, lever);
  const V3 turn = hn::Mul(step, bend.other_size) * bend.normal;
  const V3 other_turn = hn::Mul(step, bend.size) * bend.other_normal;
  store(p - (bend.reach * turn + bend.other_reach * other_turn), positions, hinge.vertices[0], lane);
  store(q - (bend.foot * turn + bend.other_foot * other_turn), positions, hinge.vertices[1], lane);
  store(apex + bend.edge_square * turn, positions, hinge.vertices[2], lane);
  store(other_apex + bend.edge_square * other_turn, positions, hinge.vertices[3], lane);
}

HWY_INLINE void project_all(const Constraints& constraints, const Block& block) {
  const Tag d;
  const std::size_t width = hn::Lanes(d);
  for (std::size_t k = 0; k < constraints.edges.size(); ++k) {
    for (std::size_t lane = 0; lane < kLanes; lane += width) {
      project_edge(constraints.edges[k], block.lengths[k], block.positions, lane);
    }
  }
  for (std::size_t k = 0; k < constraints.hinges.size(); ++k) {
    for (std::size_t lane = 0; lane < kLanes; lane += width) {
      project_hinge(constraints.hinges[k], block.bends + 2 * k, block.positions, lane);
    }
  }
  for (std::size_t k = 0; k < constraints.attachments.size(); ++k) {
    const Attachment& attachment = constraints.attachments[k];
    const V share = hn::Set(d, attachment.share);
    for (std::size_t lane = 0; lane < kLanes; lane += width) {
      const V3 anchor = load(block.anchors, k, lane);
      const V3 at = load(block.positions, attachment.vertex, lane);
      // A share of 1 meets the anchor to the last bit, which the sum would not.
      store(attachment.share == 1.0 ? anchor : at + share * (anchor - at), block.positions, attachment.vertex, lane);
    }
  }
}

void sweep_block(const Constraints& constraints, const Block& block, int sweeps) {
  for (int i = 0; i < sweeps; ++i) {
    project_all(constraints, block);
  }
}

/// Sweeps from where each organ would be if it went on moving as it did (Nesterov 1983). An organ that was carried too
/// far, so that the sweep took it back, starts from standstill again (O'Donoghue and Candes 2015).
void settle_block(const Constraints& constraints, const Block& block, int sweeps) {
  const Tag d;
  const std::size_t width = hn::Lanes(d);
  const std::size_t numbers = 3 * block.vertex_count;
  for (int i = 0; i < sweeps; ++i) {
    for (std::size_t lane = 0; lane < kLanes; lane += width) {
      const V age = hn::Load(d, block.momentum_ages->value + lane);
      const V kept = hn::Div(age, hn::Add(age, hn::Set(d, 3.0)));
      const auto moves = hn::Gt(age, hn::Zero(d));  // before that, `before` holds nothing
      for (std::size_t k = 0; k < numbers; ++k) {
        const V now = hn::Load(d, block.positions[k].value + lane);
        const V before = hn::Load(d, block.before[k].value + lane);
        const V ahead = hn::Add(now, hn::IfThenElseZero(moves, hn::Mul(kept, hn::Sub(now, before))));
        hn::Store(now, d, block.before[k].value + lane);
        hn::Store(ahead, d, block.ahead[k].value + lane);
        hn::Store(ahead, d, block.positions[k].value + lane);
      }
    }
    project_all(constraints, block);
    for (std::size_t lane = 0; lane < kLanes; lane += width) {
      V back = hn::Zero(d);
      for (std::size_t k = 0; k < numbers; ++k) {
        const V now = hn::Load(d, block.positions[k].value + lane);
        const V before = hn::Load(d, block.before[k].value + lane);
        const V ahead = hn::Load(d, block.ahead[k].value + lane);
        back = hn::Add(back, hn::Mul(hn::Sub(ahead, now), hn::Sub(now, before)));
      }
      double* ages = block.momentum_ages->value + lane;
      const V older = hn::Add(hn::Load(d, ages), hn::Set(d, 1.0));
      hn::Store(hn::IfThenElse(hn::Gt(back, hn::Zero(d)), hn::Zero(d), older), d, ages);
    }
  }
}

/// Takes lengths, bends and anchors from the block's positions.
void measure_block(const Constraints& constraints, const Block& block) {
  const Tag d;
  for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
    for (std::size_t k = 0; k < constraints.edges.size(); ++k) {
      const auto& vertices = constraints.edges[k].vertices;
      const V3 along = load(block.positions, vertices[1], lane) - load(block.positions, vertices[0], lane);
      hn::Store(hn::Sqrt(dot(along, along)), d, block.lengths[k].value + lane);
    }
    for (std::size_t k = 0; k < constraints.hinges.size(); ++k) {
      const auto& vertices = constraints.hinges[k].vertices;
      const Bend bend = measure(load(block.positions, vertices[0], lane), load(block.positions, vertices[1], lane),
                                load(block.positions, vertices[2], lane), load(block.positions, vertices[3], lane));
      // Zero for both leaves the hinge out: see limited_angle.
      const auto sound = is_sound(bend);
      hn::Store(hn::IfThenElseZero(sound, bend.cosine), d, block.bends[2 * k].value + lane);
      hn::Store(hn::IfThenElseZero(sound, bend.minus_sine), d, block.bends[2 * k + 1].value + lane);
    }
    for (std::size_t k = 0; k < constraints.attachments.size(); ++k) {
      store(load(block.positions, constraints.attachments[k].vertex, lane), block.anchors, k, lane);
    }
  }
}

}  // namespace anthesis::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anthesis {
namespace elastic {

HWY_EXPORT(sweep_block);
HWY_EXPORT(settle_block);
HWY_EXPORT(measure_block);

}  // namespace elastic

namespace {

using elastic::kLanes;
using elastic::Lanes;

/// Puts two others between constraints that share a vertex, where a near one can be found. A processor works on several
/// constraints at a time unless one waits for the result of another: this saves a third of the time of a sweep.
template <class Constraint>
void spread(std::vector<Constraint>& constraints) {
  constexpr std::size_t kDistance = 2;
  constexpr std::size_t kLookAhead = 64;
  const auto meet = [](const Constraint& a, const Constraint& b) {
    return std::any_of(a.vertices.begin(), a.vertices.end(), [&](std::uint32_t v) {
      return std::find(b.vertices.begin(), b.vertices.end(), v) != b.vertices.end();
    });
  };
  for (std::size_t i = 1; i < constraints.size(); ++i) {
    const auto place = constraints.begin() + static_cast<std::ptrdiff_t>(i);
    const auto end = place + static_cast<std::ptrdiff_t>(std::min(kLookAhead, constraints.size() - i));
    const auto before = place - static_cast<std::ptrdiff_t>(std::min(kDistance, i));
    const auto next = std::find_if(place, end, [&](const Constraint& candidate) {
      return std::none_of(before, place, [&](const Constraint& earlier) { return meet(candidate, earlier); });
    });
    if (next != end) {
      std::rotate(place, next, next + 1);
    }
  }
}

}  // namespace

struct ElasticBatch::State {
  std::size_t vertex_count = 0;
  elastic::Constraints constraints;
  std::vector<std::uint32_t> first_vertex;
  std::size_t block_count = 0;
  std::vector<Lanes> positions;
  std::vector<Lanes> lengths;
  std::vector<Lanes> bends;
  std::vector<Lanes> anchors;
  std::vector<Lanes> before;
  std::vector<Lanes> ahead;
  std::vector<Lanes> momentum_ages;

  elastic::Block block(std::size_t i) {
    const std::size_t numbers = 3 * vertex_count;
    return {vertex_count,
            positions.data() + i * numbers,
            lengths.data() + i * constraints.edges.size(),
            bends.data() + i * 2 * constraints.hinges.size(),
            anchors.data() + i * 3 * constraints.attachments.size(),
            before.data() + i * numbers,
            ahead.data() + i * numbers,
            momentum_ages.data() + i};
  }

  /// The organ in a lane; lanes left over in the last block repeat the last organ, so that they hold sound numbers.
  std::size_t organ(std::size_t block_index, std::size_t lane) const {
    return std::min(block_index * kLanes + lane, first_vertex.size() - 1);
  }

  void load_block(std::size_t block_index, std::span<const Vec3> source) {
    Lanes* to = positions.data() + block_index * 3 * vertex_count;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t first = first_vertex[organ(block_index, lane)];
      ANTHESIS_ASSERT(first + vertex_count <= source.size());
      const Vec3* from = source.data() + first;
      for (std::size_t v = 0; v < vertex_count; ++v) {
        to[3 * v].value[lane] = from[v].x;
        to[3 * v + 1].value[lane] = from[v].y;
        to[3 * v + 2].value[lane] = from[v].z;
      }
    }
  }
};

ElasticBatch::ElasticBatch(const Sheet& sheet) : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.vertex_count = sheet.vertex_count;
  ANTHESIS_ASSERT(sheet.edge_stiffness.size() == sheet.edges.size());
  ANTHESIS_ASSERT(sheet.hinge_stiffness.size() == sheet.hinges.size());
  ANTHESIS_ASSERT(sheet.attachment_stiffness.size() == sheet.attached.size());
  for (std::size_t k = 0; k < sheet.edges.size(); ++k) {
    if (sheet.edge_stiffness[k] > 0.0) {
      state.constraints.edges.push_back({sheet.edges[k], 0.5 * sheet.edge_stiffness[k]});
    }
  }
  for (std::size_t k = 0; k < sheet.hinges.size(); ++k) {
    if (sheet.hinge_stiffness[k] > 0.0) {
      state.constraints.hinges.push_back({sheet.hinges[k], sheet.hinge_stiffness[k]});
    }
  }
  spread(state.constraints.edges);
  spread(state.constraints.hinges);
  for (std::size_t k = 0; k < sheet.attached.size(); ++k) {
    if (sheet.attachment_stiffness[k] > 0.0) {
      state.constraints.attachments.push_back({sheet.attached[k], sheet.attachment_stiffness[k]});
    }
  }
}

ElasticBatch::ElasticBatch(ElasticBatch&&) noexcept = default;
ElasticBatch& ElasticBatch::operator=(ElasticBatch&&) noexcept = default;
ElasticBatch::~ElasticBatch() = default;

void ElasticBatch::set_rest(std::span<const Vec3> targets_mm, std::span<const std::uint32_t> first_vertex) {
  State& state = *state_;
  state.first_vertex.assign(first_vertex.begin(), first_vertex.end());
  state.block_count = (first_vertex.size() + kLanes - 1) / kLanes;
  state.positions.resize(state.block_count * 3 * state.vertex_count);
  state.before.resize(state.positions.size());
  state.ahead.resize(state.positions.size());
  state.momentum_ages.assign(state.block_count, Lanes{});
  state.lengths.resize(state.block_count * state.constraints.edges.size());
  state.bends.resize(state.block_count * 2 * state.constraints.hinges.size());
  state.anchors.resize(state.block_count * 3 * state.constraints.attachments.size());
  const auto measure = HWY_DYNAMIC_DISPATCH(elastic::measure_block);
  parallel_for(state.block_count, [&](std::size_t i) {
    state.load_block(i, targets_mm);
    measure(state.constraints, state.block(i));
  });
}

void ElasticBatch::load(std::span<const Vec3> positions_mm) {
  parallel_for(state_->block_count, [&](std::size_t i) { state_->load_block(i, positions_mm); });
}

void ElasticBatch::sweep(int sweeps) {
  State& state = *state_;
  const auto sweep_block = HWY_DYNAMIC_DISPATCH(elastic::sweep_block);
  parallel_for(state.block_count, [&](std::size_t i) { sweep_block(state.constraints, state.block(i), sweeps); });
}

void ElasticBatch::settle(int sweeps) {
  State& state = *state_;
  const auto settle_block = HWY_DYNAMIC_DISPATCH(elastic::settle_block);
  parallel_for(state.block_count, [&](std::size_t i) { settle_block(state.constraints, state.block(i), sweeps); });
}

void ElasticBatch::store(std::span<Vec3> positions_mm) const {
  const State& state = *state_;
  parallel_for(state.block_count, [&](std::size_t i) {
    const Lanes* from = state.positions.data() + i * 3 * state.vertex_count;
    for (std::size_t lane = 0; lane < kLanes && i * kLanes + lane < state.first_vertex.size(); ++lane) {
      Vec3* to = positions_mm.data() + state.first_vertex[i * kLanes + lane];
      for (std::size_t v = 0; v < state.vertex_count; ++v) {
        to[v] = {from[3 * v].value[lane], from[3 * v + 1].value[lane], from[3 * v + 2].value[lane]};
      }
    }
  });
}

}  // namespace anthesis
#endif  // HWY_ONCE
