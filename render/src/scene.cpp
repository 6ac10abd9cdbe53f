#include "anthesis/render/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "anthesis/base/math.h"

namespace anthesis {

namespace {

/// Single precision must hold it with room for its square: a kilometre of millimetres is plenty.
constexpr double kFarthest_mm = 1e9;
bool finite(Vec3 v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) <= kFarthest_mm && v == v;
}
bool light(Colour c) {
  return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b) && c.r >= 0.0 && c.g >= 0.0 && c.b >= 0.0;
}
bool unit(Vec3 v) {
  return finite(v) && std::abs(length(v) - 1.0) < 1e-3;
}
bool share(double x) {
  return x >= 0.0 && x <= 1.0;
}

std::string element(const char* list, std::size_t i) {
  return std::string(list) + "[" + std::to_string(i) + "]";
}

Error wrong(std::string where, std::string message) {
  return {ErrorCode::kInvalidParameter, std::move(where), std::move(message)};
}

std::optional<Error> check(const SceneMesh& mesh, const std::string& where, std::size_t pigments) {
  const std::size_t vertices = mesh.mesh.positions_mm.size();
  for (const Vec3& p : mesh.mesh.positions_mm) {
    if (!finite(p)) {
      return wrong(where + ".positions_mm", "must be finite");
    }
  }
  if (!mesh.mesh.normals.empty() && mesh.mesh.normals.size() != vertices) {
    return wrong(where + ".normals", "must be empty or one for each vertex");
  }
  if (!mesh.mesh.uvs.empty() && mesh.mesh.uvs.size() != vertices) {
    return wrong(where + ".uvs", "must be empty or one for each vertex");
  }
  for (const Vec3& n : mesh.mesh.normals) {
    if (!finite(n)) {
      return wrong(where + ".normals", "must be finite");
    }
  }
  for (const Vec2& uv : mesh.mesh.uvs) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
      return wrong(where + ".uvs", "must be finite");
    }
  }
  for (const Triangle& t : mesh.mesh.triangles) {
    if (std::max({t[0], t[1], t[2]}) >= vertices) {
      return wrong(where + ".triangles", "must name vertices of the mesh");
    }
  }
  for (const PigmentSpan& span : mesh.spans) {
    if (span.pigment >= pigments ||
        std::uint64_t{span.first_triangle} + span.triangle_count > mesh.mesh.triangles.size()) {
      return wrong(where + ".spans", "must name triangles of the mesh and a pigment of the scene");
    }
  }
  return std::nullopt;
}

std::optional<Error> check(const Pigment& pigment, const std::string& where) {
  if (pigment.colour.empty()) {
    return wrong(where + ".colour", "must have at least one stop");
  }
  for (const ColourStop& stop : pigment.colour) {
    if (!light(stop.colour) || !std::isfinite(stop.at)) {
      return wrong(where + ".colour", "must be finite and >= 0");
    }
  }
  const std::pair<const char*, double> shares[] = {{".roughness", pigment.roughness},
                                                   {".specular", pigment.specular},
                                                   {".sheen", pigment.sheen},
                                                   {".translucency", pigment.translucency}};
  for (const auto& [name, value] : shares) {
    if (!share(value)) {
      return invalid_parameter(where + name, "must be from 0 to 1", value);
    }
  }
  return std::nullopt;
}

std::optional<Error> check(const Veil& veil, const std::string& where) {
  if (!share(veil.facing)) {
    return invalid_parameter(where + ".facing", "must be from 0 to 1", veil.facing);
  }
  if (!share(veil.edge)) {
    return invalid_parameter(where + ".edge", "must be from 0 to 1", veil.edge);
  }
  if (veil.doublings < 0 || veil.doublings > 5) {
    return invalid_parameter(where + ".doublings", "must be from 0 to 5", veil.doublings);
  }
  return std::nullopt;
}

std::optional<Error> check(const Lighting& lighting) {
  if (lighting.lamps.size() > 8) {
    return wrong("lighting.lamps", "must be at most 8");
  }
  for (std::size_t i = 0; i < lighting.lamps.size(); ++i) {
    const Lamp& lamp = lighting.lamps[i];
    const std::string where = element("lighting.lamps", i);
    if (!unit(lamp.towards)) {
      return wrong(where + ".towards", "must be a unit vector");
    }
    if (!(lamp.half_angle_rad > 0.0) || lamp.half_angle_rad > math::kPi / 2.0) {
      return invalid_parameter(where + ".half_angle_rad", "must be > 0 and at most a quarter turn",
                               lamp.half_angle_rad);
    }
    if (!light(lamp.irradiance)) {
      return wrong(where + ".irradiance", "must be finite and >= 0");
    }
  }
  const Sky& sky = lighting.sky;
  if (!unit(sky.up)) {
    return wrong("lighting.sky.up", "must be a unit vector");
  }
  if (!light(sky.zenith) || !light(sky.horizon) || !light(sky.nadir)) {
    return wrong("lighting.sky", "must be finite and >= 0");
  }
  for (std::size_t i = 0; i < sky.glows.size(); ++i) {
    const Glow& glow = sky.glows[i];
    if (!unit(glow.towards) || !light(glow.radiance) || glow.doublings < 0 || glow.doublings > 5) {
      return wrong(element("lighting.sky.glows", i), "must have a unit direction, a radiance >= 0, 0 to 5 doublings");
    }
  }
  return std::nullopt;
}

}  // namespace

Backdrop Backdrop::light() {
  return {};
}

Backdrop Backdrop::dark() {
  Backdrop backdrop;
  backdrop.centre = {0.030, 0.034, 0.036};
  backdrop.corner = {0.004, 0.005, 0.006};
  return backdrop;
}

Backdrop Backdrop::none() {
  Backdrop backdrop;
  backdrop.transparent = true;
  return backdrop;
}

std::optional<Error> check(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    if (auto error = check(scene.meshes[i], element("meshes", i), scene.pigments.size())) {
      return error;
    }
  }
  for (std::size_t i = 0; i < scene.pigments.size(); ++i) {
    if (auto error = check(scene.pigments[i], element("pigments", i))) {
      return error;
    }
  }
  if (scene.pigments.empty() && !scene.meshes.empty()) {
    return wrong("pigments", "must be at least one");
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const std::string where = element("instances", i);
    if (instance.mesh >= scene.meshes.size()) {
      return wrong(where + ".mesh", "must be a mesh of the scene");
    }
    const Placement& placement = instance.world_from_mesh;
    const Quaternion& q = placement.rotation;
    if (!finite(placement.position_mm) || !std::isfinite(q.w + q.x + q.y + q.z) || !std::isfinite(placement.scale) ||
        !(placement.scale > 0.0)) {
      return wrong(where + ".world_from_mesh", "must be finite with a scale > 0");
    }
    if (!instance.variations.empty() && instance.variations.size() != scene.meshes[instance.mesh].spans.size()) {
      return wrong(where + ".variations", "must be empty or one for each span of the mesh");
    }
    if (instance.colour && !light(*instance.colour)) {
      return wrong(where + ".colour", "must be finite and >= 0");
    }
    if (instance.veil) {
      if (auto error = check(*instance.veil, where + ".veil")) {
        return error;
      }
    }
  }
  if (scene.ground && (!std::isfinite(scene.ground->height_mm) || !light(scene.ground->colour))) {
    return wrong("ground", "must be finite, its colour >= 0");
  }
  if (scene.haze) {
    const Haze& haze = *scene.haze;
    if (!unit(haze.towards)) {
      return wrong("haze.towards", "must be a unit vector");
    }
    if (!(std::abs(haze.clear_mm) <= kFarthest_mm && haze.dense_mm < haze.clear_mm && haze.dense_mm >= -kFarthest_mm)) {
      return wrong("haze", "must be finite, dense_mm < clear_mm");
    }
    if (!share(haze.share)) {
      return invalid_parameter("haze.share", "must be from 0 to 1", haze.share);
    }
  }
  if (!light(scene.backdrop.centre) || !light(scene.backdrop.corner)) {
    return wrong("backdrop", "must be finite and >= 0");
  }
  return check(scene.lighting);
}

Mesh unit_sphere() {
  // An icosahedron, each triangle split in four three times, pushed out to the sphere.
  constexpr double kA = 0.52573111211913361;
  constexpr double kB = 0.85065080835203993;
  Mesh mesh;
  mesh.positions_mm = {{-kA, 0, kB}, {kA, 0, kB},   {-kA, 0, -kB}, {kA, 0, -kB}, {0, kB, kA},  {0, kB, -kA},
                       {0, -kB, kA}, {0, -kB, -kA}, {kB, kA, 0},   {-kB, kA, 0}, {kB, -kA, 0}, {-kB, -kA, 0}};
  mesh.triangles = {{0, 1, 4}, {0, 4, 9},  {9, 4, 5},  {4, 8, 5},  {4, 1, 8},  {8, 1, 10}, {8, 10, 3},
                    {5, 8, 3}, {5, 3, 2},  {2, 3, 7},  {7, 3, 10}, {7, 10, 6}, {7, 6, 11}, {11, 6, 0},
                    {0, 6, 1}, {6, 10, 1}, {9, 11, 0}, {9, 2, 11}, {9, 5, 2},  {7, 11, 2}};
  for (int level = 0; level < 3; ++level) {
    std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, added] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(mesh.positions_mm.size()));
      if (added) {
        mesh.positions_mm.push_back(normalized(mesh.positions_mm[a] + mesh.positions_mm[b]));
      }
      return place->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  mesh.normals = mesh.positions_mm;
  for (const Vec3& p : mesh.positions_mm) {
    mesh.uvs.push_back({0.5, 0.5 * (p.z + 1.0)});
  }
  return mesh;
}

Colour sky_radiance(const Sky& sky, Vec3 towards) {
  const double rise = dot(sky.up, towards);
  const double t = std::abs(rise) * (2.0 - std::abs(rise));  // quick at the horizon, flat overhead
  Colour radiance = (1.0 - t) * sky.horizon + t * (rise >= 0.0 ? sky.zenith : sky.nadir);
  for (const Glow& glow : sky.glows) {
    double strength = std::max(0.0, dot(glow.towards, towards));
    for (int i = 0; i < glow.doublings; ++i) {
      strength *= strength;
    }
    radiance = radiance + strength * glow.radiance;
  }
  return radiance;
}

Colour open_irradiance(const Lighting& lighting, Vec3 normal) {
  Colour sum;
  for (const Lamp& lamp : lighting.lamps) {
    sum = sum + std::max(0.0, dot(lamp.towards, normal)) * lamp.irradiance;
  }
  const Vec3 x = any_perpendicular(normal);
  const Vec3 y = cross(normal, x);
  constexpr int kRings = 32;
  constexpr int kSpokes = 128;
  for (int i = 0; i < kRings; ++i) {
    const double radius = std::sqrt((i + 0.5) / kRings);
    const double rise = std::sqrt(1.0 - radius * radius);
    for (int j = 0; j < kSpokes; ++j) {
      const auto [sine, cosine] = math::sin_cos(math::kTurnRad * (j + 0.5) / kSpokes);
      const Vec3 towards = radius * cosine * x + radius * sine * y + rise * normal;
      sum = sum + (math::kPi / (kRings * kSpokes)) * sky_radiance(lighting.sky, towards);
    }
  }
  return sum;
}

}  // namespace anthesis
