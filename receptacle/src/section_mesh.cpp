// Delaunay refinement of a polygon, in rounds: triangulate all points, split what part of the boundary is missing or in
// the way, put points into bad triangles that are far enough from one another, and again. The whole triangulation is
// built anew each time: for some hundred points that is cheaper than the care an incremental one needs.
#include <algorithm>
#include <cmath>
#include <limits>

#include "anthesis/geometry/delaunay.h"
#include "anthesis/geometry/predicates.h"
#include "anthesis/receptacle/harmonic_section.h"
#include "section_mesh.h"

namespace anthesis {
namespace {

constexpr std::size_t kMostPoints = 200000;
constexpr int kMostRounds = 300;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Largest ratio of circumradius to shortest edge: 1 / (2 sin 25 degrees).
constexpr double kMostRadiusToEdge = 1.1831;

/// The axis is split where a triangle sees it under more than about 80 degrees: beyond a right angle its weight would
/// be negative, and the mesh will move.
constexpr double kMostCosAtAxis = 0.17;

/// The contour is not split finer than this for the sake of angles (where the polygon is sharp that would never end),
/// but down to the second where it has to be, to become part of the triangulation.
constexpr double kFinestShare = 1.0 / 32.0;
constexpr double kFinestShareAtNeed = 1.0 / 4096.0;

/// A part of the boundary between neighbouring points of the mesh.
struct Piece {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t side = 0;  ///< of the polygon
  double t0 = 0.0;
  double t1 = 1.0;
};

struct Bad {
  double radius = 0.0;  ///< of the circumcircle
  double clear = 0.0;   ///< distance of the new point from the triangle's corners
  Vec2 centre;
};

std::uint64_t directed(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint64_t>(a) << 32 | b;
}

class Refinement {
 public:
  Refinement(std::span<const Vec2> controls, const SectionMeshParams& params)
      : controls_(controls), kept_(distinct_controls(controls)) {
    low_ = {0.0, controls.front().y};
    for (const Vec2 p : controls) {
      low_.y = std::min(low_.y, p.y);
    }
    size_ = section_size(controls);
    max_edge_ = params.max_edge * size_;
  }

  Expected<SectionMesh> run() {
    if (kept_.size() < 3) {
      return unexpected(Error{ErrorCode::kInvalidParameter, "section", "must have three control points that differ"});
    }
    if (std::optional<Error> error = crossing()) {
      return unexpected(std::move(*error));
    }
    start();
    for (int round = 0; round < kMostRounds; ++round) {
      if (points_.size() > kMostPoints) {
        return unexpected(Error{ErrorCode::kTooLarge, "section", "must need at most 200000 points"});
      }
      if (triangulate()) {
        if (!improve()) {
          return finish();
        }
      } else if (!split_missing()) {
        break;
      }
    }
    return unexpected(Error{ErrorCode::kInvalidParameter, "section", "must be wide enough to be triangulated"});
  }

 private:
  std::size_t sides() const { return kept_.size(); }
  Vec2 corner(std::size_t i) const { return controls_[kept_[i % kept_.size()]]; }
  bool is_axis(std::uint32_t side) const { return side + 1 == sides(); }
  Vec2 on_side(std::uint32_t side, double t) const { return lerp(corner(side), corner(side + 1), t); }

  std::optional<Error> crossing() const {
    std::vector<Vec2> corners;
    for (std::size_t i = 0; i < sides(); ++i) {
      corners.push_back(corner(i));
    }
    const auto found = crossing_pieces(corners, true);
    if (!found) {
      return std::nullopt;
    }
    return Error{ErrorCode::kInvalidParameter, "section",
                 "must not touch or cross itself, but its parts after control points " +
                     std::to_string(kept_[(*found)[0]]) + " and " + std::to_string(kept_[(*found)[1]]) + " do"};
  }

  /// Corners, and sides cut to the longest edge allowed.
  void start() {
    for (std::size_t i = 0; i < sides(); ++i) {
      points_.push_back(corner(i));
      side_of_.push_back(kNone);
    }
    shortest_side_ = std::numeric_limits<double>::infinity();
    for (std::uint32_t side = 0; side < sides(); ++side) {
      const double span = length(corner(side + 1) - corner(side));
      shortest_side_ = std::min(shortest_side_, span);
      const auto parts = static_cast<std::uint32_t>(std::max(std::ceil(span / max_edge_), 1.0));
      std::uint32_t from = side;
      for (std::uint32_t k = 1; k <= parts; ++k) {
        std::uint32_t to = static_cast<std::uint32_t>((side + 1) % sides());
        if (k < parts) {
          to = add(on_side(side, static_cast<double>(k) / parts), side);
        }
        pieces_.push_back({from, to, side, (k - 1.0) / parts, static_cast<double>(k) / parts});
        from = to;
      }
    }
  }

  std::uint32_t add(Vec2 p, std::uint32_t side) {
    points_.push_back(p);
    side_of_.push_back(side);
    return static_cast<std::uint32_t>(points_.size() - 1);
  }

  Vec2 middle(const Piece& piece) const { return on_side(piece.side, 0.5 * (piece.t0 + piece.t1)); }

  /// Splits the marked pieces at their middles.
  void split(const std::vector<bool>& marked) {
    const std::size_t count = pieces_.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (marked[i]) {
        Piece second = pieces_[i];
        const double t = 0.5 * (second.t0 + second.t1);
        const std::uint32_t v = add(on_side(second.side, t), second.side);
        pieces_[i].to = v;
        pieces_[i].t1 = t;
        second.from = v;
        second.t0 = t;
        pieces_.push_back(second);
      }
    }
  }

  bool may_split(const Piece& piece) const {
    if (is_axis(piece.side)) {
      return length(points_[piece.to] - points_[piece.from]) > 0.25 * std::min(shortest_side_, max_edge_);
    }
    const double span = length(corner(piece.side + 1) - corner(piece.side));
    // ... or as fine as the sides beside it, if they are finer.
    const double before = length(corner(piece.side) - corner(piece.side + sides() - 1));
    const double after = length(corner(piece.side + 2) - corner(piece.side + 1));
    const double finest = std::min({kFinestShare * std::min(span, max_edge_), 0.5 * before, 0.5 * after});
    return (piece.t1 - piece.t0) * span > finest;
  }

  /// The Delaunay triangles inside. False if some piece of the boundary is no edge of them; `missing_` tells.
  bool triangulate() {
    std::vector<Vec2> unit(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      unit[i] = (points_[i] - low_) / size_;
    }
    const std::vector<Triangle> all = delaunay(unit);
    struct Half {
      std::uint64_t key;
      std::uint32_t triangle;
    };
    std::vector<Half> halves;
    halves.reserve(3 * all.size());
    for (std::uint32_t t = 0; t < all.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        halves.push_back({directed(all[t][k], all[t][(k + 1) % 3]), t});
      }
    }
    const auto less = [](const Half& x, const Half& y) { return x.key < y.key; };
    std::sort(halves.begin(), halves.end(), less);
    const auto triangle_at = [&](std::uint32_t a, std::uint32_t b) {
      const auto found = std::lower_bound(halves.begin(), halves.end(), Half{directed(a, b), 0}, less);
      return found != halves.end() && found->key == directed(a, b) ? found->triangle : kNone;
    };
    // The boundary runs clockwise: what lies inside has its edges the other way round.
    missing_.assign(pieces_.size(), false);
    bool complete = true;
    std::vector<std::uint64_t> walls;
    std::vector<std::uint32_t> open;
    std::vector<bool> inside(all.size(), false);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const std::uint32_t t = triangle_at(pieces_[i].to, pieces_[i].from);
      if (t == kNone) {
        missing_[i] = true;
        complete = false;
      } else if (!inside[t]) {
        inside[t] = true;
        open.push_back(t);
      }
      walls.push_back(directed(pieces_[i].to, pieces_[i].from));
    }
    if (!complete) {
      return false;
    }
    std::sort(walls.begin(), walls.end());
    while (!open.empty()) {
      const Triangle triangle = all[open.back()];
      open.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangle[k];
        const std::uint32_t b = triangle[(k + 1) % 3];
        if (std::binary_search(walls.begin(), walls.end(), directed(a, b))) {
          continue;
        }
        const std::uint32_t t = triangle_at(b, a);
        if (t != kNone && !inside[t]) {
          inside[t] = true;
          open.push_back(t);
        }
      }
    }
    triangles_.clear();
    for (std::size_t t = 0; t < all.size(); ++t) {
      if (inside[t]) {
        triangles_.push_back(all[t]);
      }
    }
    // Opposite each piece, the corner of the triangle inside.
    tops_.resize(pieces_.size());
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const Triangle& triangle = all[triangle_at(pieces_[i].to, pieces_[i].from)];
      tops_[i] = triangle[0] + triangle[1] + triangle[2] - pieces_[i].from - pieces_[i].to;
    }
    return true;
  }

  bool split_missing() {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (missing_[i] && pieces_[i].t1 - pieces_[i].t0 < kFinestShareAtNeed) {
        return false;
      }
    }
    split(missing_);
    return true;
  }

  bool are_neighbours(std::uint32_t p, std::uint32_t q) const {
    return p != kNone && q != kNone && ((p + 1) % sides() == q || (q + 1) % sides() == p);
  }

  bool find_bad(const Triangle& triangle, Bad& bad) const {
    std::size_t shortest = 0;
    double least = std::numeric_limits<double>::infinity();
    double most = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 along = points_[triangle[(k + 1) % 3]] - points_[triangle[k]];
      const double square = dot(along, along);
      most = std::max(most, square);
      if (square < least) {
        least = square;
        shortest = k;
      }
    }
    const Vec2 a = points_[triangle[shortest]];
    const Vec2 ab = points_[triangle[(shortest + 1) % 3]] - a;
    const Vec2 ac = points_[triangle[(shortest + 2) % 3]] - a;
    const double twice_area = cross(ab, ac);
    if (twice_area <= 0.0) {
      return false;  // three points of one side, a triangle by rounding only: the axis test or a later round removes it
    }
    const Vec2 to_centre =
        Vec2{ac.y * dot(ab, ab) - ab.y * dot(ac, ac), ab.x * dot(ac, ac) - ac.x * dot(ab, ab)} / (2.0 * twice_area);
    const double edge = std::sqrt(least);
    bad.radius = length(to_centre);
    bad.centre = a + to_centre;
    bad.clear = bad.radius;
    if (bad.radius > kMostRadiusToEdge * edge) {
      if (are_neighbours(side_of_[triangle[shortest]], side_of_[triangle[(shortest + 1) % 3]])) {
        return false;  // held by a sharp corner of the polygon: no splitting makes it better
      }
      // The off-centre: as near as it may be for the new triangle on the shortest edge to be good.
      const double reach = edge * (kMostRadiusToEdge + std::sqrt(kMostRadiusToEdge * kMostRadiusToEdge - 0.25)) * 0.999;
      const Vec2 foot = a + 0.5 * ab;
      const Vec2 across = bad.centre - foot;
      const double distance = length(across);
      if (distance > reach) {
        bad.centre = foot + (reach / distance) * across;
        bad.clear = length(bad.centre - a);
      }
      return true;
    }
    return most > max_edge_ * max_edge_;
  }

  bool is_inside(Vec2 p) const {
    bool inside = false;
    for (std::size_t i = 0; i < sides(); ++i) {
      const Vec2 a = corner(i);
      const Vec2 b = corner(i + 1);
      if ((a.y > p.y) != (b.y > p.y) && (orient2d(a, b, p) > 0) == (b.y > a.y)) {
        inside = !inside;
      }
    }
    return inside;
  }

  /// Whether the triangle beside a piece of the boundary has too wide an angle opposite it.
  bool is_seen_wide(const Piece& piece, std::uint32_t top) const {
    const Vec2 p = points_[piece.from] - points_[top];
    const Vec2 q = points_[piece.to] - points_[top];
    if (is_axis(piece.side)) {
      return dot(p, q) < kMostCosAtAxis * length(p) * length(q);
    }
    return dot(p, q) < 0.0 && !are_neighbours(side_of_[top], piece.side);
  }

  /// One round of refinement. False if there is nothing to improve.
  bool improve() {
    std::vector<bool> marked(pieces_.size(), false);
    std::vector<Vec2> middles;
    const auto mark = [&](std::size_t i) {
      if (!marked[i]) {
        marked[i] = true;
        middles.push_back(middle(pieces_[i]));
      }
    };
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (is_seen_wide(pieces_[i], tops_[i]) && may_split(pieces_[i])) {
        mark(i);
      }
    }
    std::vector<Bad> bads;
    for (const Triangle& triangle : triangles_) {
      Bad bad;
      if (find_bad(triangle, bad)) {
        bads.push_back(bad);
      }
    }
    std::stable_sort(bads.begin(), bads.end(), [](const Bad& x, const Bad& y) { return x.radius > y.radius; });
    std::vector<Vec2> added;
    for (const Bad& bad : bads) {
      bool in_the_way = false;
      bool is_splitting = false;
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        const Vec2 p = points_[pieces_[i].from] - bad.centre;
        const Vec2 q = points_[pieces_[i].to] - bad.centre;
        if (dot(p, q) < 0.0) {
          in_the_way = true;
          if (may_split(pieces_[i])) {
            mark(i);
            is_splitting = true;
          }
        }
      }
      if (in_the_way || is_splitting) {
        continue;
      }
      const double distance = 0.8 * bad.clear;
      const auto is_near = [&](Vec2 p) { return length(p - bad.centre) < distance; };
      if (std::any_of(middles.begin(), middles.end(), is_near) || std::any_of(added.begin(), added.end(), is_near) ||
          !is_inside(bad.centre)) {
        continue;
      }
      added.push_back(bad.centre);
    }
    for (const Vec2 p : added) {
      add(p, kNone);
    }
    split(marked);
    return !added.empty() || !middles.empty();
  }

  Expected<SectionMesh> finish() {
    // Boundary in order, then the rest in the order it came.
    std::sort(pieces_.begin(), pieces_.end(),
              [](const Piece& x, const Piece& y) { return x.side != y.side ? x.side < y.side : x.t0 < y.t0; });
    std::vector<std::uint32_t> renumbered(points_.size(), kNone);
    SectionMesh mesh;
    const auto take = [&](std::uint32_t v) {
      renumbered[v] = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(points_[v]);
    };
    for (const Piece& piece : pieces_) {
      if (is_axis(piece.side) && piece.t0 > 0.0) {
        take(piece.from);
        ++mesh.axis_points;
      } else {
        const std::uint32_t from = kept_[piece.side];
        const std::uint32_t to = piece.t0 > 0.0 ? kept_[piece.side + 1] : from;
        take(piece.from);
        mesh.places.push_back({from, to, piece.t0});
      }
    }
    for (std::uint32_t v = 0; v < points_.size(); ++v) {
      if (renumbered[v] == kNone) {
        take(v);
      }
    }
    mesh.controls = kept_;
    for (Triangle triangle : triangles_) {
      for (std::uint32_t& v : triangle) {
        v = renumbered[v];
      }
      if (orient2d(mesh.points[triangle[0]], mesh.points[triangle[1]], mesh.points[triangle[2]]) <= 0) {
        return unexpected(Error{ErrorCode::kInvalidParameter, "section", "must be wide enough to be triangulated"});
      }
      mesh.triangles.push_back(triangle);
    }
    return mesh;
  }

  std::span<const Vec2> controls_;
  std::vector<std::uint32_t> kept_;  ///< control points, those that differ
  Vec2 low_;
  double size_ = 0.0;
  double max_edge_ = 0.0;
  double shortest_side_ = 0.0;
  std::vector<Vec2> points_;            ///< corners first
  std::vector<std::uint32_t> side_of_;  ///< kNone for corners and for points inside
  std::vector<Piece> pieces_;
  std::vector<bool> missing_;
  std::vector<std::uint32_t> tops_;
  std::vector<Triangle> triangles_;
};

}  // namespace

std::vector<std::uint32_t> distinct_controls(std::span<const Vec2> controls) {
  const double distance = kMergeDistance * section_size(controls);
  std::vector<std::uint32_t> kept{0};
  std::uint32_t first = 0;  // of the points that become one
  for (std::uint32_t i = 1; i < controls.size(); ++i) {
    if (length(controls[i] - controls[first]) > distance) {
      first = i;
      kept.push_back(i);
    } else if (kept.size() > 1) {
      kept.back() = i;  // the last counts: at the rim, where young sections repeat points, the base begins with it
    }
  }
  return kept;
}

double section_size(std::span<const Vec2> controls) {
  double width = 0.0;
  double low = controls.front().y;
  double high = low;
  for (const Vec2 p : controls) {
    width = std::max(width, p.x);
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  return std::max(width, high - low);
}

std::optional<Error> check_section(std::span<const Vec2> controls) {
  if (controls.size() < 3) {
    return invalid_parameter("points", "must be at least 3", static_cast<double>(controls.size()));
  }
  for (std::size_t i = 0; i < controls.size(); ++i) {
    const std::string where = "points[" + std::to_string(i) + "]";
    if (!std::isfinite(controls[i].x) || !std::isfinite(controls[i].y) || std::fabs(controls[i].x) > 1e50 ||
        std::fabs(controls[i].y) > 1e50) {
      return Error{ErrorCode::kInvalidParameter, where, "must be finite"};
    }
    if (controls[i].x < 0.0) {
      return invalid_parameter(where, "must have a radius >= 0", controls[i].x);
    }
    if ((i == 0 || i + 1 == controls.size()) && controls[i].x != 0.0) {
      return invalid_parameter(where, "must lie on the axis, at radius 0", controls[i].x);
    }
  }
  if (!(controls.front().y > controls.back().y)) {
    return Error{ErrorCode::kInvalidParameter, "points[0]", "must stand above the last point"};
  }
  return std::nullopt;
}

bool is_in_section(std::span<const Vec2> controls, Vec2 p) {
  // By the number of times that a ray outwards, away from the axis, meets contour and base.
  bool inside = false;
  for (std::size_t i = 0; i + 1 < controls.size(); ++i) {
    const Vec2 a = controls[i];
    const Vec2 b = controls[i + 1];
    if ((a.y > p.y) != (b.y > p.y) && (orient2d(a, b, p) > 0) == (b.y > a.y)) {
      inside = !inside;
    }
  }
  return inside;
}

std::optional<Error> check(const SectionMeshParams& params) {
  if (!(params.max_edge >= 0.002 && params.max_edge <= 1.0)) {
    return invalid_parameter("max_edge", "must be between 0.002 and 1", params.max_edge);
  }
  return std::nullopt;
}

Expected<SectionMesh> triangulate_section(std::span<const Vec2> controls, const SectionMeshParams& params) {
  if (std::optional<Error> error = check(params)) {
    return unexpected(std::move(*error));
  }
  if (std::optional<Error> error = check_section(controls)) {
    return unexpected(std::move(*error));
  }
  return Refinement(controls, params).run();
}

}  // namespace anthesis
