#include "anthesis/vasculature/vein_tubes.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

constexpr std::uint64_t kMostVertices = 50'000'000;
constexpr int kRadiusPasses = 16;
constexpr int kRoundingPasses = 32;
constexpr double kRounding = 0.5;  // how far rounding moves a vertex, of the tube's radius
constexpr double kBulge = 0.25;    // how far a point put into a bend may stand off the line, of the radius
constexpr int kBendRounds = 3;
constexpr double kSoftTurn_rad = 0.4;   // bends above get more points
constexpr double kSharpTurn_rad = 0.8;  // bends above that still are become ball joints
constexpr double kJointTurn_rad = 0.4;  // between the rings of a ball joint
constexpr double kFlat = 0.02;          // what rings that are left out were off, of the radius
constexpr double kRingTurn_rad = 0.25;
constexpr double kRingDistance = 4.0;  // of the radius
constexpr std::size_t kMostLeftOut = 32;
constexpr double kHidden = 0.9;  // radius of an end within another tube, of what the other's facets leave free

struct TubePoint {
  Vec3 position;
  double radius = 0.0;
  std::uint32_t vertex = 0;
  VeinKind kind = VeinKind::kAbaxial;
};

/// From the tip inwards; kinds are those of the edges to the next point.
struct Tube {
  std::vector<TubePoint> points;
  bool free_tip = false;  ///< and not within another tube
};

/// For each vertex the one that goes on outwards from it in the same tube: the thickest, of equals the first.
std::vector<std::uint32_t> thickest_children(const Vasculature& veins) {
  std::vector<std::uint32_t> thickest(veins.vertices.size(), kNoVertex);
  for (std::uint32_t v = 0; v < veins.vertices.size(); ++v) {
    const std::uint32_t parent = veins.vertices[v].parent;
    if (parent != kNoVertex &&
        (thickest[parent] == kNoVertex || veins.vertices[v].diameter > veins.vertices[thickest[parent]].diameter)) {
      thickest[parent] = v;
    }
  }
  return thickest;
}

/// Tubes of first connections, where the vertices stand and with the radii of edges.
std::vector<Tube> first_tubes(const Vasculature& veins, const std::vector<std::uint32_t>& thickest, double factor) {
  const auto point = [&](std::uint32_t v, const VeinVertex& edge) {
    return TubePoint{veins.vertices[v].position, 0.5 * factor * edge.diameter, v, edge.kind};
  };
  std::vector<Tube> tubes;
  for (std::uint32_t tip = 0; tip < veins.vertices.size(); ++tip) {
    if (thickest[tip] != kNoVertex || veins.vertices[tip].parent == kNoVertex) {
      continue;
    }
    Tube& tube = tubes.emplace_back();
    tube.free_tip = true;
    for (std::uint32_t v = tip;;) {
      const VeinVertex& vertex = veins.vertices[v];
      tube.points.push_back(point(v, vertex));
      if (veins.vertices[vertex.parent].parent == kNoVertex || thickest[vertex.parent] != v) {
        tube.points.push_back(point(vertex.parent, vertex));
        break;
      }
      v = vertex.parent;
    }
  }
  return tubes;
}

/// Radii of edges become radii of points, evened out along the tube.
void smooth_radii(std::vector<TubePoint>& points) {
  const std::size_t last = points.size() - 1;
  points[last].radius = points[last - 1].radius;
  std::vector<double> before(points.size());
  const auto keep = [&] {
    std::transform(points.begin(), points.end(), before.begin(), [](const auto& p) { return p.radius; });
  };
  keep();
  for (std::size_t i = 1; i < last; ++i) {
    points[i].radius = 0.5 * (before[i - 1] + before[i]);
  }
  for (int pass = 0; pass < kRadiusPasses; ++pass) {
    keep();
    for (std::size_t i = 1; i < last; ++i) {
      points[i].radius = 0.25 * (before[i - 1] + 2.0 * before[i] + before[i + 1]);
    }
  }
}

/// The vertices' places with the kinks of the strands rounded off. Edges are often shorter than the tube is wide, so
/// that a ring at each kink would make a crumpled tube. Ends stay, joints move with the thicker strand, and each vertex
/// stays within kRounding of its tube's radius from where it was.
std::vector<Vec3> rounded_places(const Vasculature& veins, const std::vector<std::uint32_t>& thickest,
                                 const std::vector<double>& radius) {
  std::vector<Vec3> places;
  places.reserve(veins.vertices.size());
  for (const VeinVertex& vertex : veins.vertices) {
    places.push_back(vertex.position);
  }
  std::vector<Vec3> before;
  for (int pass = 0; pass < kRoundingPasses; ++pass) {
    before = places;
    for (std::size_t v = 0; v < places.size(); ++v) {
      const VeinVertex& vertex = veins.vertices[v];
      if (vertex.parent == kNoVertex || thickest[v] == kNoVertex) {
        continue;
      }
      const Vec3 moved = 0.25 * (before[thickest[v]] + 2.0 * before[v] + before[vertex.parent]) - vertex.position;
      const double far = length(moved);
      const double most = kRounding * radius[v];
      places[v] = vertex.position + (far > most ? most / far : 1.0) * moved;
    }
  }
  return places;
}

/// Direction of each edge; of an edge without length that of the one before.
std::vector<Vec3> directions_of(const std::vector<TubePoint>& points) {
  std::vector<Vec3> directions(points.size() - 1);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    directions[i] = normalized(points[i + 1].position - points[i].position);
  }
  return directions;
}

double turn_between(Vec3 a, Vec3 b) {
  return math::atan2(length(cross(a, b)), dot(a, b));
}

/// The middle of two unit vectors; of opposite ones, some vector across.
Vec3 between(Vec3 a, Vec3 b) {
  const Vec3 sum = a + b;
  return length(sum) > 1e-6 ? normalized(sum) : any_perpendicular(a);
}

/// Drops points that stand where the one before does.
void drop_doubles(std::vector<TubePoint>& points) {
  const auto same = [](const TubePoint& a, const TubePoint& b) {
    return length(b.position - a.position) <= 1e-6 * std::max(a.radius, b.radius);
  };
  // The last point is where the tube is joined, and stays.
  const TubePoint last = points.back();
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  points.back() = last;
}

/// Where a strand has come within `reach` of its inner end it goes straight there: what it winds within the thicker
/// strand would stick out here and there.
void cut_within(std::vector<TubePoint>& points, double reach) {
  const Vec3 end = points.back().position;
  const auto inner =
      std::find_if(points.begin(), points.end(), [&](const auto& p) { return length(p.position - end) < reach; });
  if (inner != points.end() && points.end() - inner > 2) {
    points.erase(inner + 1, points.end() - 1);
  }
}

/// Puts points into bends, on the cubic curve through their neighbours.
void round_bends(std::vector<TubePoint>& points) {
  for (int round = 0; round < kBendRounds; ++round) {
    const std::vector<Vec3> directions = directions_of(points);
    const auto sharp = [&](std::size_t i) {
      return i > 0 && i + 1 < points.size() && turn_between(directions[i - 1], directions[i]) > kSoftTurn_rad;
    };
    const auto tangent = [&](std::size_t i) {
      return i == 0                   ? directions.front()
             : i + 1 == points.size() ? directions.back()
                                      : between(directions[i - 1], directions[i]);
    };
    std::vector<TubePoint> finer;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      finer.push_back(points[i]);
      const double edge = length(points[i + 1].position - points[i].position);
      TubePoint middle = points[i];
      middle.radius = 0.5 * (points[i].radius + points[i + 1].radius);
      if ((sharp(i) || sharp(i + 1)) && edge > 0.1 * middle.radius) {
        const Vec3 bulge = (edge / 8.0) * (tangent(i) - tangent(i + 1));
        const double far = length(bulge);
        const double most = kBulge * middle.radius / (1 << round);
        middle.position = 0.5 * (points[i].position + points[i + 1].position) + (far > most ? most / far : 1.0) * bulge;
        finer.push_back(middle);
      }
    }
    finer.push_back(points.back());
    if (finer.size() == points.size()) {
      return;
    }
    points = std::move(finer);
  }
}

/// Whether points between `a` and `b` add nothing to the surface.
bool straight(const std::vector<TubePoint>& points, const std::vector<Vec3>& directions, std::size_t a, std::size_t b) {
  const Vec3 chord = points[b].position - points[a].position;
  const double square = dot(chord, chord);
  if (!(square > 0.0) || square > kRingDistance * kRingDistance * points[a].radius * points[a].radius) {
    return false;
  }
  if (points[b].kind != points[a].kind) {
    return false;  // colours of vertices blend from a ring to the next: over one short edge
  }
  double turn = 0.0;
  for (std::size_t i = a + 1; i < b; ++i) {
    turn += turn_between(directions[i - 1], directions[i]);
    const double along = dot(points[i].position - points[a].position, chord) / square;
    const double off = length(points[i].position - lerp(points[a].position, points[b].position, along));
    const double thick = (1.0 - along) * points[a].radius + along * points[b].radius;
    if (turn > kRingTurn_rad || off > kFlat * points[i].radius ||
        std::abs(points[i].radius - thick) > kFlat * points[i].radius) {
      return false;
    }
  }
  return true;
}

void drop_straight(std::vector<TubePoint>& points) {
  const std::vector<Vec3> directions = directions_of(points);
  std::vector<TubePoint> kept = {points.front()};
  for (std::size_t a = 0; a + 1 < points.size();) {
    std::size_t b = a + 1;
    while (b + 1 < points.size() && b - a < kMostLeftOut && straight(points, directions, a, b + 1)) {
      ++b;
    }
    kept.push_back(points[b]);
    a = b;
  }
  points = std::move(kept);
}

struct Ring {
  TubePoint at;
  Vec3 tangent;        ///< inwards
  double slope = 0.0;  ///< of the radius
};

/// A ring across the bend at each point; about sharp bends several, turned step by step.
std::vector<Ring> rings_of(const std::vector<TubePoint>& points) {
  const std::vector<Vec3> directions = directions_of(points);
  std::vector<Ring> rings;
  const std::size_t last = points.size() - 1;
  rings.push_back({points.front(), directions.front()});
  for (std::size_t i = 1; i < last; ++i) {
    const Vec3 in = directions[i - 1];
    const Vec3 out = directions[i];
    const double turn = turn_between(in, out);
    if (turn > kSharpTurn_rad) {
      const Vec3 axis = length(cross(in, out)) > 1e-6 ? normalized(cross(in, out)) : any_perpendicular(in);
      const int steps = static_cast<int>(turn / kJointTurn_rad) + 1;
      for (int k = 0; k <= steps; ++k) {
        rings.push_back({points[i], rotate(rotation_about(axis, turn * k / steps), in)});
      }
      continue;
    }
    const double way =
        length(points[i].position - points[i - 1].position) + length(points[i + 1].position - points[i].position);
    const double slope = (points[i + 1].radius - points[i - 1].radius) / way;
    rings.push_back({points[i], between(in, out), std::clamp(slope, -1.0, 1.0)});
  }
  rings.push_back({points.back(), directions.back()});
  return rings;
}

/// Rings of the half sphere of a free tip, besides its pole and the ring of the tip.
int cap_rings(const Tube& tube, int sides) {
  return tube.free_tip ? std::max(1, (sides + 1) / 4) : 0;
}

/// Adds what `rings` bound.
void add_tube(VeinTubes& tubes, const Tube& tube, const std::vector<Ring>& rings, int sides) {
  Mesh& mesh = tubes.mesh;
  const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
  const auto vertex = [&](Vec3 position, Vec3 normal, const TubePoint& at) {
    mesh.positions_mm.push_back(position);
    mesh.normals.push_back(normal);
    tubes.vein.push_back(at.vertex);
    tubes.kind.push_back(at.kind);
  };
  std::vector<math::SinCos> angles;
  for (int j = 0; j < sides; ++j) {
    angles.push_back(math::sin_cos(math::kTurnRad * j / sides));
  }

  const Ring& tip = rings.front();
  Vec3 across = any_perpendicular(tip.tangent);
  const int caps = cap_rings(tube, sides);
  vertex(tip.at.position - (tube.free_tip ? tip.at.radius : 0.0) * tip.tangent, -tip.tangent, tip.at);
  for (int k = 1; k <= caps; ++k) {
    const math::SinCos latitude = math::sin_cos(0.5 * math::kPi * k / (caps + 1));
    for (const math::SinCos& angle : angles) {
      const Vec3 outwards = angle.cos * across + angle.sin * cross(tip.tangent, across);
      const Vec3 normal = latitude.sin * outwards - latitude.cos * tip.tangent;
      vertex(tip.at.position + tip.at.radius * normal, normal, tip.at);
    }
  }
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const Ring& ring = rings[i];
    if (i > 0) {  // without turning about the tube
      const Vec3 before = rings[i - 1].tangent;
      across = rotate(rotation_between(before, ring.tangent, across), across);
      across = normalized(across - dot(across, ring.tangent) * ring.tangent);  // against rounding
    }
    for (const math::SinCos& angle : angles) {
      const Vec3 outwards = angle.cos * across + angle.sin * cross(ring.tangent, across);
      vertex(ring.at.position + ring.at.radius * outwards, normalized(outwards - ring.slope * ring.tangent), ring.at);
    }
  }
  vertex(rings.back().at.position, rings.back().tangent, rings.back().at);

  // The first corner of each triangle is on the side of the tip.
  const auto around = static_cast<std::uint32_t>(sides);
  const auto count = static_cast<std::uint32_t>(rings.size()) + static_cast<std::uint32_t>(caps);
  const auto at = [&](std::uint32_t ring, std::uint32_t j) { return first + 1 + ring * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    mesh.triangles.push_back({first, at(0, j + 1), at(0, j)});
    for (std::uint32_t i = 0; i + 1 < count; ++i) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
    mesh.triangles.push_back({first + 1 + count * around, at(count - 1, j), at(count - 1, j + 1)});
  }
}

template <class Unwanted>
void drop_if(std::vector<Tube>& tubes, const Unwanted& unwanted) {
  tubes.erase(std::remove_if(tubes.begin(), tubes.end(), unwanted), tubes.end());
}

/// Tubes with their centre lines rounded, ends that lie within others narrowed.
std::vector<Tube> tubes_of(const Vasculature& veins, const VeinTubeParams& params) {
  const std::vector<std::uint32_t> thickest = thickest_children(veins);
  std::vector<Tube> tubes = first_tubes(veins, thickest, params.radius_factor);
  const auto has_no_width = [](const Tube& tube) {
    return !std::all_of(tube.points.begin(), tube.points.end(), [](const auto& p) { return p.radius > 0.0; });
  };
  drop_if(tubes, has_no_width);
  std::vector<double> radius(veins.vertices.size(), 0.0);
  for (Tube& tube : tubes) {
    smooth_radii(tube.points);
    for (auto point = tube.points.begin(); point + 1 != tube.points.end(); ++point) {
      radius[point->vertex] = point->radius;
    }
  }
  const std::vector<Vec3> places = rounded_places(veins, thickest, radius);
  for (const SecondConnection& second : veins.second_connections) {
    const double half = 0.5 * params.radius_factor * second.diameter;
    const VeinKind kind = veins.vertices[second.from].kind;
    if (!(half > 0.0)) {
      continue;
    }
    tubes.push_back({{{{}, half, second.from, kind}, {{}, half, second.to, kind}}, false});
  }
  const double free = kHidden * math::cos(math::kPi / params.sides);
  for (Tube& tube : tubes) {
    for (TubePoint& point : tube.points) {
      point.position = places[point.vertex];
    }
    const auto hide = [&](TubePoint& end) {
      if (radius[end.vertex] > 0.0) {
        end.radius = std::min(end.radius, free * radius[end.vertex]);
      }
    };
    hide(tube.points.back());
    if (!tube.free_tip) {
      hide(tube.points.front());
    }
    cut_within(tube.points, radius[tube.points.back().vertex]);
    drop_doubles(tube.points);
  }
  drop_if(tubes, [](const Tube& tube) { return tube.points.size() < 2; });
  return tubes;
}

}  // namespace

std::optional<Error> check(const VeinTubeParams& params) {
  if (params.sides < 3 || params.sides > 64) {
    return invalid_parameter("sides", "must be between 3 and 64", params.sides);
  }
  if (!(params.radius_factor > 0.0 && params.radius_factor <= 1e6)) {
    return invalid_parameter("radius_factor", "must be > 0 and at most 1e6", params.radius_factor);
  }
  return std::nullopt;
}

Expected<VeinTubes> vein_tubes(const Vasculature& veins, const VeinTubeParams& params) {
  if (std::optional<Error> error = check(params)) {
    return unexpected(*error);
  }
  std::vector<Tube> tubes = tubes_of(veins, params);
  std::vector<std::vector<Ring>> rings;
  rings.reserve(tubes.size());
  std::uint64_t vertices = 0;
  for (Tube& tube : tubes) {
    round_bends(tube.points);
    drop_straight(tube.points);
    rings.push_back(rings_of(tube.points));
    tube.points = {};
    const std::uint64_t count = rings.back().size() + static_cast<std::uint64_t>(cap_rings(tube, params.sides));
    vertices += count * static_cast<std::uint64_t>(params.sides) + 2;
  }
  if (vertices > kMostVertices) {
    return unexpected(Error{ErrorCode::kTooLarge, "veins",
                            "must make at most 50000000 vertices of tubes, got " + std::to_string(vertices)});
  }
  VeinTubes result;
  result.mesh.positions_mm.reserve(vertices);
  result.mesh.normals.reserve(vertices);
  result.vein.reserve(vertices);
  result.kind.reserve(vertices);
  result.mesh.triangles.reserve(2 * vertices);
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    add_tube(result, tubes[i], rings[i], params.sides);
  }
  return result;
}

std::array<std::uint8_t, 3> vein_colour(VeinKind kind) {
  switch (kind) {
    case VeinKind::kFloret:
      return {128, 60, 170};
    case VeinKind::kAbaxial:
      return {230, 220, 110};
    case VeinKind::kAdaxial:
      break;
  }
  return {205, 40, 35};
}

}  // namespace anthesis
