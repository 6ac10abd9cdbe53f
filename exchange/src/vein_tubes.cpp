// Strands of a head as tubes of triangles.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "anthesis/base/check.h"
#include "anthesis/base/math.h"
#include "anthesis/exchange/vein_files.h"
#include "provenance.h"
#include "text.h"

namespace anthesis {
namespace {

constexpr std::uint64_t kMostVertices = 50'000'000;
constexpr int kSmoothings = 8;

struct TubePoint {
  Vec3 position;
  double radius = 0.0;
  std::uint32_t vertex = 0;
  VeinKind kind = VeinKind::kAbaxial;
};

using Tube = std::vector<TubePoint>;  ///< tip first

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

/// Radii of edges become radii of points, evened out along the tube.
void smooth_radii(Tube& tube) {
  const std::size_t last = tube.size() - 1;
  tube[last].radius = tube[last - 1].radius;
  std::vector<double> before(tube.size());
  const auto keep = [&] { std::transform(tube.begin(), tube.end(), before.begin(), [](auto& p) { return p.radius; }); };
  keep();
  for (std::size_t i = 1; i < last; ++i) {
    tube[i].radius = 0.5 * (before[i - 1] + before[i]);
  }
  for (int pass = 0; pass < kSmoothings; ++pass) {
    keep();
    for (std::size_t i = 1; i < last; ++i) {
      tube[i].radius = 0.25 * (before[i - 1] + 2.0 * before[i] + before[i + 1]);
    }
  }
}

/// Adds a tube unless it has no length or no width.
void add(std::vector<Tube>& tubes, Tube tube) {
  const auto same = [](const TubePoint& a, const TubePoint& b) { return a.position == b.position; };
  tube.erase(std::unique(tube.begin(), tube.end(), same), tube.end());
  if (tube.size() < 2 || !std::all_of(tube.begin(), tube.end() - 1, [](const auto& p) { return p.radius > 0.0; })) {
    return;
  }
  smooth_radii(tube);
  tubes.push_back(std::move(tube));
}

std::vector<Tube> tubes_of(const Vasculature& veins, double radius_factor) {
  const std::vector<std::uint32_t> thickest = thickest_children(veins);
  const auto point = [&](std::uint32_t v, double diameter, VeinKind kind) {
    return TubePoint{veins.vertices[v].position, 0.5 * radius_factor * diameter, v, kind};
  };
  std::vector<Tube> tubes;
  for (std::uint32_t tip = 0; tip < veins.vertices.size(); ++tip) {
    if (thickest[tip] != kNoVertex || veins.vertices[tip].parent == kNoVertex) {
      continue;
    }
    Tube tube;
    std::uint32_t v = tip;
    for (;;) {
      const VeinVertex& vertex = veins.vertices[v];
      tube.push_back(point(v, vertex.diameter, vertex.kind));
      if (veins.vertices[vertex.parent].parent == kNoVertex || thickest[vertex.parent] != v) {
        tube.push_back(point(vertex.parent, vertex.diameter, vertex.kind));
        break;
      }
      v = vertex.parent;
    }
    add(tubes, std::move(tube));
  }
  for (const SecondConnection& second : veins.second_connections) {
    const VeinKind kind = veins.vertices[second.from].kind;
    add(tubes, {point(second.from, second.diameter, kind), point(second.to, second.diameter, kind)});
  }
  return tubes;
}

/// Some direction across.
Vec3 across(Vec3 tangent) {
  const Vec3 least = std::abs(tangent.x) <= std::abs(tangent.y) && std::abs(tangent.x) <= std::abs(tangent.z)
                         ? Vec3{1.0, 0.0, 0.0}
                     : std::abs(tangent.y) <= std::abs(tangent.z) ? Vec3{0.0, 1.0, 0.0}
                                                                  : Vec3{0.0, 0.0, 1.0};
  return normalized(cross(tangent, least));
}

/// The tangent at each point: the mean of the directions of the edges there.
std::vector<Vec3> tangents_of(const Tube& tube) {
  std::vector<Vec3> tangents(tube.size());
  for (std::size_t i = 0; i < tube.size(); ++i) {
    const Vec3 in = i == 0 ? Vec3{} : normalized(tube[i].position - tube[i - 1].position);
    const Vec3 out = i + 1 == tube.size() ? Vec3{} : normalized(tube[i + 1].position - tube[i].position);
    const Vec3 sum = in + out;
    tangents[i] = length(sum) > 1e-6 ? normalized(sum) : in;  // right back
  }
  return tangents;
}

/// Directions across that do not turn about the tube: each the one before, reflected twice (Wang et al. 2008).
std::vector<Vec3> normals_of(const Tube& tube, const std::vector<Vec3>& tangents) {
  std::vector<Vec3> normals = {across(tangents[0])};
  for (std::size_t i = 0; i + 1 < tube.size(); ++i) {
    const auto reflected = [](Vec3 v, Vec3 across_plane) {
      const double square = dot(across_plane, across_plane);
      return square > 0.0 ? v - (2.0 * dot(across_plane, v) / square) * across_plane : v;
    };
    const Vec3 step = tube[i + 1].position - tube[i].position;
    const Vec3 normal = reflected(normals.back(), step);
    const Vec3 tangent = reflected(tangents[i], step);
    const Vec3 turned = reflected(normal, tangents[i + 1] - tangent);
    const Vec3 flat = turned - dot(turned, tangents[i + 1]) * tangents[i + 1];  // against rounding
    normals.push_back(length(flat) > 1e-6 ? normalized(flat) : across(tangents[i + 1]));
  }
  return normals;
}

template <class Value>
void put(std::string& bytes, Value value) {  // x86-64 is little-endian
  char raw[sizeof(value)];
  std::memcpy(raw, &value, sizeof(value));
  bytes.append(raw, sizeof(value));
}

void put(std::string& bytes, Vec3 v) {
  put(bytes, static_cast<float>(v.x));
  put(bytes, static_cast<float>(v.y));
  put(bytes, static_cast<float>(v.z));
}

void put_vertex(std::string& bytes, Vec3 position, Vec3 normal, const TubePoint& at) {
  constexpr std::uint8_t kColours[3][3] = {{128, 60, 170}, {235, 200, 40}, {205, 40, 35}};
  put(bytes, position);
  put(bytes, normal);
  for (const std::uint8_t channel : kColours[static_cast<std::size_t>(at.kind)]) {
    put(bytes, channel);
  }
  put(bytes, at.vertex);
  put(bytes, static_cast<std::uint8_t>(at.kind));
}

void put_tube(std::string& bytes, const Tube& tube, int sides) {
  const std::vector<Vec3> tangents = tangents_of(tube);
  const std::vector<Vec3> normals = normals_of(tube, tangents);
  put_vertex(bytes, tube.front().position, -tangents.front(), tube.front());
  for (std::size_t i = 0; i < tube.size(); ++i) {
    const Vec3 binormal = cross(tangents[i], normals[i]);
    for (int j = 0; j < sides; ++j) {
      const math::SinCos angle = math::sin_cos(math::kTurnRad * j / sides);
      const Vec3 outwards = angle.cos * normals[i] + angle.sin * binormal;
      put_vertex(bytes, tube[i].position + tube[i].radius * outwards, outwards, tube[i]);
    }
  }
  put_vertex(bytes, tube.back().position, tangents.back(), tube.back());
}

std::size_t vertices_of(const Tube& tube, int sides) {
  return tube.size() * static_cast<std::size_t>(sides) + 2;
}

std::size_t triangles_of(const Tube& tube, int sides) {
  return 2 * tube.size() * static_cast<std::size_t>(sides);
}

void put_triangles(std::string& bytes, const Tube& tube, int sides, std::uint32_t first) {
  const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    put(bytes, std::uint8_t{3});
    put(bytes, first + a);
    put(bytes, first + b);
    put(bytes, first + c);
  };
  const auto around = static_cast<std::uint32_t>(sides);
  const auto rings = static_cast<std::uint32_t>(tube.size());
  const auto at = [&](std::uint32_t ring, std::uint32_t j) { return 1 + ring * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    triangle(0, at(0, j + 1), at(0, j));
    for (std::uint32_t i = 0; i + 1 < rings; ++i) {
      triangle(at(i, j), at(i, j + 1), at(i + 1, j + 1));
      triangle(at(i, j), at(i + 1, j + 1), at(i + 1, j));
    }
    triangle(1 + rings * around, at(rings - 1, j), at(rings - 1, j + 1));
  }
}

}  // namespace

Expected<std::string> veins_ply(const Vasculature& veins, const VeinTubeParams& params, const MadeFrom& made_from) {
  if (params.sides < 3 || params.sides > 64) {
    return unexpected(invalid_parameter("sides", "must be between 3 and 64", params.sides));
  }
  if (!(params.radius_factor > 0.0 && params.radius_factor <= 1e6)) {
    return unexpected(invalid_parameter("radius_factor", "must be > 0 and at most 1e6", params.radius_factor));
  }
  const std::vector<Tube> tubes = tubes_of(veins, params.radius_factor);
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  for (const Tube& tube : tubes) {
    vertices += vertices_of(tube, params.sides);
    triangles += triangles_of(tube, params.sides);
  }
  if (vertices > kMostVertices) {
    return unexpected(Error{ErrorCode::kTooLarge, "veins",
                            "must make at most 50000000 vertices of tubes, got " + std::to_string(vertices)});
  }
  std::string bytes = "ply\nformat binary_little_endian 1.0\n";
  detail::append(bytes, "comment generator: ", detail::generator(), "\n");
  for (const auto& [key, value] : made_from) {
    detail::append(bytes, "comment ", detail::one_line(key), ": ", detail::one_line(value), "\n");
  }
  detail::append(bytes, "comment +z is up\n");
  for (const VeinKind kind : {VeinKind::kFloret, VeinKind::kAbaxial, VeinKind::kAdaxial}) {
    detail::append(bytes, "comment kind ", static_cast<int>(kind), ": ", vein_kind_name(kind), "\n");
  }
  detail::append(bytes, "element vertex ", vertices,
                 "\nproperty float x\nproperty float y\nproperty float z\n"
                 "property float nx\nproperty float ny\nproperty float nz\n"
                 "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                 "property uint vein\nproperty uchar kind\n"
                 "element face ",
                 triangles, "\nproperty list uchar int vertex_indices\nend_header\n");
  bytes.reserve(bytes.size() + vertices * 32 + triangles * 13);
  for (const Tube& tube : tubes) {
    put_tube(bytes, tube, params.sides);
  }
  std::uint32_t first = 0;
  for (const Tube& tube : tubes) {
    put_triangles(bytes, tube, params.sides, first);
    first += static_cast<std::uint32_t>(vertices_of(tube, params.sides));
  }
  return bytes;
}

}  // namespace anthesis
