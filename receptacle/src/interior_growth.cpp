#include "anthesis/receptacle/interior_growth.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"
#include "anthesis/geometry/predicates.h"
#include "section_laplacian.h"
#include "section_mesh.h"

namespace anthesis {
namespace {

/// A mesh is given up when a triangle's height becomes less than this share of its base (14 per cent: angles of some 8
/// degrees; a fresh one has 23), or less than half the worst of the fresh mesh, which a sharp section sets.
constexpr double kLeastShape = 0.14;
/// ... or an edge more than twice as long as in a fresh one.
constexpr double kMostStretch = 2.0;

constexpr double kBoundaryTolerance = 1e-9;  ///< of the section's size

// Frames whose fields are solved side by side: enough for any number of threads, and little memory.
constexpr std::size_t kMostFramesAtOnce = 32;
constexpr std::size_t kMostBytesAtOnce = std::size_t{1} << 24;

constexpr std::size_t kChunk = 512;  ///< points that a thread carries at once

struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  std::size_t piece = 0;
  double t = 0.0;
};

/// The place of a polyline nearest to `p`.
Nearest nearest_place(std::span<const Vec2> line, Vec2 p) {
  Nearest best;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec2 along = line[i + 1] - line[i];
    const double square = dot(along, along);
    const double t = square > 0.0 ? std::clamp(dot(p - line[i], along) / square, 0.0, 1.0) : 0.0;
    const double distance = length(lerp(line[i], line[i + 1], t) - p);
    if (distance < best.distance) {
      best = {distance, i, t};
    }
  }
  return best;
}

/// Which triangles to look at for a point: a grid of cells with the triangles whose boxes meet them.
class TriangleGrid {
 public:
  void assign(const SectionMesh& mesh) {
    Vec2 high = mesh.points.front();
    low_ = high;
    for (const Vec2 p : mesh.points) {
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const Vec2 extent = high - low_;
    const double cell_size = std::sqrt(extent.x * extent.y / static_cast<double>(mesh.triangles.size()));
    across_ = std::clamp<std::size_t>(static_cast<std::size_t>(extent.x / cell_size), 1, 4096);
    up_ = std::clamp<std::size_t>(static_cast<std::size_t>(extent.y / cell_size), 1, 4096);
    per_length_ = {static_cast<double>(across_) / extent.x, static_cast<double>(up_) / extent.y};
    boxes_.resize(mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec2 a = mesh.points[mesh.triangles[t][0]];
      const Vec2 b = mesh.points[mesh.triangles[t][1]];
      const Vec2 c = mesh.points[mesh.triangles[t][2]];
      boxes_[t] = {column(std::min({a.x, b.x, c.x})), column(std::max({a.x, b.x, c.x})), row(std::min({a.y, b.y, c.y})),
                   row(std::max({a.y, b.y, c.y}))};
    }
    const auto for_cells = [&](std::uint32_t t, const auto& body) {
      const Box& box = boxes_[t];
      for (std::size_t j = box.j0; j <= box.j1; ++j) {
        for (std::size_t i = box.i0; i <= box.i1; ++i) {
          body(j * across_ + i);
        }
      }
    };
    first_.assign(across_ * up_ + 1, 0);
    for (std::uint32_t t = 0; t < boxes_.size(); ++t) {
      for_cells(t, [&](std::size_t cell) { ++first_[cell]; });
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& first : first_) {
      sum += std::exchange(first, sum);
    }
    triangles_.resize(sum);
    next_ = first_;
    for (std::uint32_t t = 0; t < boxes_.size(); ++t) {
      for_cells(t, [&](std::size_t cell) { triangles_[next_[cell]++] = t; });
    }
  }

  std::span<const std::uint32_t> near(Vec2 p) const {
    const std::size_t cell = row(p.y) * across_ + column(p.x);
    return std::span(triangles_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }

 private:
  static std::size_t index(double position, std::size_t count) {
    return position > 0.0 ? static_cast<std::size_t>(std::min(position, static_cast<double>(count - 1))) : 0;
  }
  std::size_t column(double x) const { return index((x - low_.x) * per_length_.x, across_); }
  std::size_t row(double y) const { return index((y - low_.y) * per_length_.y, up_); }

  struct Box {
    std::size_t i0, i1, j0, j1;
  };

  Vec2 low_;
  Vec2 per_length_;
  std::size_t across_ = 1;
  std::size_t up_ = 1;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> triangles_;
  std::vector<Box> boxes_;
};

}  // namespace

struct InteriorGrowth::State {
  std::shared_ptr<const SectionSequence> sections;
  InteriorGrowthParams params;

  std::size_t frame = 0;
  std::size_t triangulations = 0;
  SectionMesh mesh;
  SectionLaplacian laplacian;
  double least_shape = 0.0;    ///< for which the mesh is kept
  std::vector<double> values;  ///< displacement to the next frame: x, y for each point of the mesh

  // What only carrying needs is made when it is first asked for: growth alone would spend a fifth of its time on it.
  mutable std::mutex carry_mutex;
  mutable std::atomic<bool> can_carry = false;
  mutable TriangleGrid grid;
  mutable std::vector<bool> stays_inside;  ///< of each triangle: what is in it will be in the next section
  mutable std::vector<Vec2> boundary;      ///< the mesh's points on contour and base

  std::span<const Vec2> controls(std::size_t i) const { return sections->frame(i); }
  Vec2 displacement(std::size_t v) const { return {values[2 * v], values[2 * v + 1]}; }
  bool is_last() const { return frame + 1 == sections->frames(); }

  std::optional<Error> begin() {
    frame = 0;
    triangulations = 0;
    mesh = {};
    return prepare();
  }

  /// The worst shape, and whether an edge is too long.
  struct Shape {
    double least = std::numeric_limits<double>::infinity();
    bool is_stretched = false;
  };
  Shape shape() const {
    Shape result;
    const double most = kMostStretch * params.mesh.max_edge * section_size(controls(frame));
    for (const Triangle& triangle : mesh.triangles) {
      const Vec2 ab = mesh.points[triangle[1]] - mesh.points[triangle[0]];
      const Vec2 ac = mesh.points[triangle[2]] - mesh.points[triangle[0]];
      const Vec2 bc = ac - ab;
      const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
      result.least = std::min(result.least, cross(ab, ac) / longest);
      result.is_stretched = result.is_stretched || longest > most * most;
    }
    return result;
  }

  std::optional<Error> triangulate() {
    Expected<SectionMesh> made = triangulate_section(controls(frame), params.mesh);
    if (!made) {
      made.error().where.insert(0, "frame " + std::to_string(frame) + ": ");
      return std::move(made.error());
    }
    mesh = std::move(*made);
    laplacian.reset(mesh);
    laplacian.refresh(mesh, params.axis == AxisCondition::kZero);
    least_shape = std::min(kLeastShape, 0.5 * shape().least);
    ++triangulations;
    return std::nullopt;
  }

  /// Makes mesh and displacement of the present frame ready; the mesh's points have been moved there.
  std::optional<Error> prepare() {
    can_carry = false;
    bool is_kept = !mesh.points.empty();
    if (is_kept && mesh.controls.size() < controls(frame).size()) {
      is_kept = distinct_controls(controls(frame)) == mesh.controls;
    }
    // A thousandth is far from folding over, and still such that flips can mend it.
    if (is_kept && shape().least > 1e-3) {
      laplacian.refresh(mesh, params.axis == AxisCondition::kZero);
      const Shape now = shape();
      is_kept = now.least > least_shape && !now.is_stretched && laplacian.axis_is_sound();
    } else {
      is_kept = false;
    }
    if (!is_kept) {
      if (std::optional<Error> error = triangulate()) {
        return error;
      }
    }
    if (!is_last()) {
      extend();
    }
    return std::nullopt;
  }

  void extend() {
    const std::span<const Vec2> next = controls(frame + 1);
    const std::size_t given = mesh.contour_points();
    values.resize(2 * mesh.points.size());
    for (std::size_t i = 0; i < given; ++i) {
      const Vec2 along = mesh.contour_point(i, next) - mesh.points[i];
      values[2 * i] = along.x;
      values[2 * i + 1] = along.y;
    }
    if (params.axis == AxisCondition::kNatural) {
      laplacian.extend<2>(mesh, AxisCondition::kNatural, values);
      return;
    }
    std::vector<double> one(mesh.points.size());
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      for (std::size_t i = 0; i < given; ++i) {
        one[i] = values[2 * i + k];
      }
      laplacian.extend<1>(mesh, k == 0 ? AxisCondition::kZero : AxisCondition::kNatural, one);
      for (std::size_t v = given; v < one.size(); ++v) {
        values[2 * v + k] = one[v];
      }
    }
  }

  /// The mesh goes with the tissue.
  std::optional<Error> step() {
    const std::size_t given = mesh.contour_points();
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
      if (v < given) {
        mesh.points[v] = mesh.contour_point(v, controls(frame + 1));
      } else {
        mesh.points[v] += displacement(v);
        if (v < given + mesh.axis_points) {
          mesh.points[v].x = 0.0;
        }
      }
    }
    ++frame;
    return prepare();
  }

  void prepare_carry() const {
    if (can_carry.load(std::memory_order_acquire)) {
      return;
    }
    const std::lock_guard lock(carry_mutex);
    if (can_carry.load(std::memory_order_relaxed)) {
      return;
    }
    grid.assign(mesh);
    boundary.assign(mesh.points.begin(), mesh.points.begin() + static_cast<std::ptrdiff_t>(mesh.contour_points()));
    // Where no moved triangle is turned over, they fill the next section without overlap, and what is in one of them
    // cannot leave. Those at the axis are another matter: their points on the axis stay there, what is beside does not.
    const std::size_t axis_begin = mesh.contour_points();
    const std::size_t axis_end = axis_begin + mesh.axis_points;
    const auto on_axis = [&](std::uint32_t v) {
      return v == 0 || v + 1 == axis_begin || (v >= axis_begin && v < axis_end);
    };
    std::vector<Vec2> moved(mesh.points.size());
    for (std::size_t v = 0; v < moved.size(); ++v) {
      moved[v] = v < axis_begin ? mesh.contour_point(v, controls(frame + 1)) : mesh.points[v] + displacement(v);
      if (v >= axis_begin && v < axis_end) {
        moved[v].x = 0.0;
      }
    }
    stays_inside.assign(mesh.triangles.size(), true);
    bool is_embedded = true;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Triangle& triangle = mesh.triangles[t];
      is_embedded = is_embedded && orient2d(moved[triangle[0]], moved[triangle[1]], moved[triangle[2]]) > 0;
      stays_inside[t] = std::none_of(triangle.begin(), triangle.end(), on_axis);
    }
    if (!is_embedded) {
      stays_inside.assign(mesh.triangles.size(), false);
    }
    can_carry.store(true, std::memory_order_release);
  }

  struct Carried {
    Vec2 point;
    bool is_brought_back = false;
  };

  Carried carried(Vec2 p) const {
    std::uint32_t triangle = kNoTriangle;
    double best = -kBoundaryTolerance;
    double share[3] = {};
    for (const std::uint32_t t : grid.near(p)) {
      const Vec2 a = mesh.points[mesh.triangles[t][0]];
      const Vec2 b = mesh.points[mesh.triangles[t][1]];
      const Vec2 c = mesh.points[mesh.triangles[t][2]];
      const double area = cross(b - a, c - a);
      const double parts[3] = {cross(b - p, c - p), cross(c - p, a - p), cross(a - p, b - p)};
      if (std::min({parts[0], parts[1], parts[2]}) < -2.0 * kBoundaryTolerance * area) {
        continue;  // far outside: spares the divisions
      }
      const double of[3] = {parts[0] / area, parts[1] / area, parts[2] / area};
      const double least = std::min({of[0], of[1], of[2]});
      if (least > best) {
        triangle = t;
        best = least;
        std::copy_n(of, 3, share);
        if (least >= 0.0) {
          break;  // the first that holds it, whatever the others say
        }
      }
    }
    Vec2 along;
    if (triangle != kNoTriangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        along += share[k] * displacement(mesh.triangles[triangle][k]);
      }
    } else {
      const Nearest place = nearest_place(boundary, p);
      along = lerp(displacement(place.piece), displacement(place.piece + 1), place.t);
    }
    Vec2 moved = p + along;
    moved.x = p.x > 0.0 ? std::max(moved.x, 0.0) : 0.0;
    if (triangle != kNoTriangle && stays_inside[triangle]) {
      return {moved, false};
    }
    const std::span<const Vec2> next = controls(frame + 1);
    if (is_in_section(next, moved)) {
      return {moved, false};
    }
    const Nearest place = nearest_place(next, moved);
    if (place.distance <= kBoundaryTolerance * section_size(next)) {
      return {moved, false};
    }
    return {lerp(next[place.piece], next[place.piece + 1], place.t), true};
  }

  /// move(i) carries point i.
  template <class Move>
  std::size_t carry_all(std::size_t count, const Move& move) const {
    if (is_last() || count == 0) {
      return 0;
    }
    prepare_carry();
    const std::size_t chunks = (count + kChunk - 1) / kChunk;
    std::vector<std::size_t> back(chunks, 0);
    const auto body = [&](std::size_t chunk) {
      const std::size_t end = std::min(count, (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i) {
        back[chunk] += move(i) ? 1 : 0;
      }
    };
    if (chunks > 4) {
      parallel_for(chunks, body);
    } else {
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        body(chunk);
      }
    }
    std::size_t sum = 0;
    for (const std::size_t n : back) {
      sum += n;
    }
    return sum;
  }
};

SectionSequence with_base(const ContourSequence& contours, std::size_t base_points) {
  ANTHESIS_ASSERT(base_points >= 1);
  SectionSequence sections;
  sections.points_per_frame = contours.points_per_frame() + base_points;
  sections.points.reserve(contours.frames() * sections.points_per_frame);
  for (std::size_t f = 0; f < contours.frames(); ++f) {
    double size = 0.0;
    for (const ContourPoint& point : contours.frame(f)) {
      size = std::max({size, std::fabs(point.position.x), std::fabs(point.position.y)});
    }
    for (const ContourPoint& point : contours.frame(f)) {
      const bool is_apex = sections.points.size() % sections.points_per_frame == 0;
      Vec2 p = point.position;
      // Series miss the axis by a rounding, at a sharp tip by more.
      if (std::fabs(p.x) < (is_apex ? 1e-4 : 1e-12) * size) {
        p.x = 0.0;
      }
      sections.points.push_back(p);
    }
    const Vec2 rim = sections.points.back();
    for (std::size_t i = 1; i <= base_points; ++i) {
      const double left = static_cast<double>(base_points - i) / static_cast<double>(base_points);
      sections.points.push_back({rim.x * left, rim.y});
    }
  }
  return sections;
}

InteriorGrowth::InteriorGrowth(std::unique_ptr<State> state) : state_(std::move(state)) {}
InteriorGrowth::InteriorGrowth(InteriorGrowth&&) noexcept = default;
InteriorGrowth& InteriorGrowth::operator=(InteriorGrowth&&) noexcept = default;
InteriorGrowth::~InteriorGrowth() = default;

Expected<InteriorGrowth> InteriorGrowth::make(SectionSequence sections, const InteriorGrowthParams& params) {
  if (std::optional<Error> error = check(params.mesh)) {
    return unexpected(std::move(*error));
  }
  if (sections.frames() < 2) {
    return unexpected(invalid_parameter("frames", "must be at least 2", static_cast<double>(sections.frames())));
  }
  if (sections.points.size() % sections.points_per_frame != 0) {
    return unexpected(Error{ErrorCode::kInvalidParameter, "points", "must be whole frames"});
  }
  for (std::size_t f = 0; f < sections.frames(); ++f) {
    if (std::optional<Error> error = check_section(sections.frame(f))) {
      error->where = "frame " + std::to_string(f) + ": " + error->where;
      return unexpected(std::move(*error));
    }
  }
  auto state = std::make_unique<State>();
  state->sections = std::make_shared<const SectionSequence>(std::move(sections));
  state->params = params;
  if (std::optional<Error> error = state->begin()) {
    return unexpected(std::move(*error));
  }
  return InteriorGrowth(std::move(state));
}

std::size_t InteriorGrowth::frames() const {
  return state_->sections->frames();
}

std::size_t InteriorGrowth::frame() const {
  return state_->frame;
}

std::span<const Vec2> InteriorGrowth::section(std::size_t frame) const {
  return state_->controls(frame);
}

const SectionMesh& InteriorGrowth::mesh() const {
  return state_->mesh;
}

std::size_t InteriorGrowth::triangulations() const {
  return state_->triangulations;
}

std::optional<Error> InteriorGrowth::advance(std::size_t frame) {
  ANTHESIS_ASSERT(frame < frames());
  std::optional<Error> error;
  if (frame < state_->frame) {
    error = state_->begin();
  }
  while (!error && state_->frame < frame) {
    error = state_->step();
  }
  if (error) {
    (void)state_->begin();  // it began well before
  }
  return error;
}

std::size_t InteriorGrowth::carry(std::span<Vec2> points) const {
  return state_->carry_all(points.size(), [&](std::size_t i) {
    const State::Carried result = state_->carried(points[i]);
    points[i] = result.point;
    return result.is_brought_back;
  });
}

std::size_t InteriorGrowth::carry(std::span<Vec3> points) const {
  return state_->carry_all(points.size(), [&](std::size_t i) {
    Vec3& p = points[i];
    const double radius = std::sqrt(p.x * p.x + p.y * p.y);
    const State::Carried result = state_->carried({radius, p.z});
    const double factor = radius > 0.0 ? result.point.x / radius : 0.0;
    p = {factor * p.x, factor * p.y, result.point.y};
    return result.is_brought_back;
  });
}

std::optional<Error> InteriorGrowth::weights(const std::function<bool(const HarmonicFrame&)>& write) const {
  // Growth goes from frame to frame; the fields of some frames are then solved side by side.
  struct Pending {
    std::size_t frame = 0;
    SectionMesh mesh;
    SectionLaplacian laplacian;
    std::vector<double> weights;
  };
  State state;
  state.sections = state_->sections;
  state.params = state_->params;
  const std::size_t controls = state.sections->points_per_frame;
  const std::size_t blocks = (controls + kFieldBlock - 1) / kFieldBlock;
  std::vector<Pending> window;
  std::optional<Error> error = state.begin();
  for (bool is_done = error.has_value(); !is_done;) {
    std::size_t count = 0;
    std::size_t bytes = 0;
    do {
      if (window.size() == count) {
        window.emplace_back();
      }
      Pending& pending = window[count++];
      pending.frame = state.frame;
      pending.mesh = state.mesh;
      pending.laplacian = state.laplacian;
      pending.weights.assign(controls * state.mesh.points.size(), 0.0);
      bytes += pending.weights.size() * sizeof(double);
      is_done = state.is_last();
      if (!is_done) {
        error = state.step();
        is_done = error.has_value();
      }
    } while (!is_done && count < kMostFramesAtOnce && bytes < kMostBytesAtOnce);
    parallel_for(count * blocks, [&](std::size_t i) {
      Pending& pending = window[i / blocks];
      harmonic_weight_block(pending.mesh, pending.laplacian, controls, i % blocks, pending.weights);
    });
    for (std::size_t i = 0; i < count; ++i) {
      const Pending& pending = window[i];
      if (!write({pending.frame, pending.mesh, state.controls(pending.frame), pending.weights})) {
        return std::nullopt;
      }
    }
  }
  return error;
}

}  // namespace anthesis
