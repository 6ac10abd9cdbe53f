#include "world.h"

#include <embree3/rtcore.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "anthesis/base/parallel.h"

namespace anthesis {

struct World::Shape {
  std::vector<Vec3f> positions;  ///< one more than there are: Embree reads 16 bytes at each
  std::vector<Vec3f> normals;    ///< may be empty
  std::vector<Vec2> uvs;         ///< may be empty
  std::vector<Triangle> triangles;
  std::vector<std::uint16_t> spans;  ///< of each triangle: 1 + index, or 0
  RTCScene scene = nullptr;
};

struct World::Stand {
  const Instance* instance = nullptr;
  const Shape* shape = nullptr;
  const SceneMesh* mesh = nullptr;
  float facing = 0.0F;  ///< the three of a veil
  float edge = 0.0F;
  int doublings = 0;
  Vec3f axis_x;  ///< columns of the rotation
  Vec3f axis_y;
  Vec3f axis_z;
  Vec3f origin;
  float scale = 1.0F;

  Vec3f turned(Vec3f v) const { return v.x * axis_x + v.y * axis_y + v.z * axis_z; }
};

struct World::Embree {
  RTCDevice device = nullptr;
  std::vector<RTCScene> scenes;

  ~Embree() {
    for (RTCScene scene : scenes) {
      rtcReleaseScene(scene);
    }
    if (device != nullptr) {
      rtcReleaseDevice(device);
    }
  }
};

namespace {

constexpr std::size_t kMostTriangles = 100'000'000;
const RTCSceneFlags kRobustWithFilter = RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

/// Builds on one thread: with more, the order in which Embree's tree holds equal hits depends on how work was shared
/// out.
void commit_alone(RTCScene scene) {
  tbb::task_arena alone(1);
  alone.execute([&] { rtcJoinCommitScene(scene); });
}

/// How far new rays keep off a surface.
float gap_at(Vec3f p, double radius) {
  const float largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return 1e-5F * static_cast<float>(radius) + 2e-6F * largest;
}

RTCRay embree_ray(const Ray& ray) {
  RTCRay r;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tnear = 0.0F;
  r.tfar = std::numeric_limits<float>::infinity();
  r.time = 0.0F;
  r.mask = ~0U;
  r.id = 0;
  r.flags = 0;
  return r;
}

Error embree_error(RTCDevice device) {
  const RTCError code = rtcGetDeviceError(device);
  return {code == RTC_ERROR_OUT_OF_MEMORY ? ErrorCode::kTooLarge : ErrorCode::kIo, "render",
          code == RTC_ERROR_OUT_OF_MEMORY ? "not enough memory for the triangles" : "the ray tracer could not start"};
}

}  // namespace

World::World() = default;
World::World(World&&) noexcept = default;
World::~World() = default;

Expected<World> World::build(const Scene& scene, const Progress& progress) {
  World world;
  world.scene_ = &scene;
  world.embree_ = std::make_unique<Embree>();
  Embree& embree = *world.embree_;
  std::size_t triangles = 0;
  for (const SceneMesh& mesh : scene.meshes) {
    triangles += mesh.mesh.triangles.size();
  }
  if (triangles > kMostTriangles) {
    return unexpected(Error{ErrorCode::kTooLarge, "meshes", "must have at most 100 million triangles in all"});
  }
  // One instruction set for all processors: hits differ in their last bits between Embree's versions.
  embree.device = rtcNewDevice("isa=sse4.2,max_isa=sse4.2");
  if (embree.device == nullptr) {
    return unexpected(embree_error(nullptr));
  }

  world.shapes_.resize(scene.meshes.size());
  embree.scenes.resize(scene.meshes.size());
  for (RTCScene& made : embree.scenes) {
    made = rtcNewScene(embree.device);
  }
  std::vector<std::uint8_t> veiled(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) {
    if (instance.veil) {
      veiled[instance.mesh] = 1;
    }
  }
  const bool finished = parallel_for(
      scene.meshes.size(),
      [&](std::size_t i) {
        const SceneMesh& from = scene.meshes[i];
        Shape& shape = world.shapes_[i];
        shape.scene = embree.scenes[i];
        shape.positions.reserve(from.mesh.positions_mm.size() + 1);
        for (const Vec3& p : from.mesh.positions_mm) {
          shape.positions.emplace_back(p);
        }
        shape.positions.emplace_back();
        for (const Vec3& n : from.mesh.normals) {
          shape.normals.emplace_back(n);
        }
        shape.uvs = from.mesh.uvs;
        shape.triangles = from.mesh.triangles;
        shape.spans.assign(shape.triangles.size(), 0);
        for (std::size_t s = 0; s < from.spans.size(); ++s) {
          std::fill_n(shape.spans.begin() + from.spans[s].first_triangle, from.spans[s].triangle_count,
                      static_cast<std::uint16_t>(s + 1));
        }
        RTCGeometry geometry = rtcNewGeometry(embree.device, RTC_GEOMETRY_TYPE_TRIANGLE);
        if (!shape.triangles.empty()) {
          rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, shape.positions.data(), 0,
                                     sizeof(Vec3f), shape.positions.size() - 1);
          rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, shape.triangles.data(), 0,
                                     sizeof(Triangle), shape.triangles.size());
        }
        rtcCommitGeometry(geometry);
        rtcSetSceneFlags(shape.scene, veiled[i] != 0 ? kRobustWithFilter : RTC_SCENE_FLAG_ROBUST);
        rtcAttachGeometry(shape.scene, geometry);
        rtcReleaseGeometry(geometry);
        commit_alone(shape.scene);
      },
      progress, "geometry");
  if (!finished) {
    return unexpected(Error{ErrorCode::kCancelled, "render", "cancelled"});
  }

  const auto add_scene = [&](RTCSceneFlags flags) {
    RTCScene added = rtcNewScene(embree.device);
    embree.scenes.push_back(added);
    rtcSetSceneFlags(added, flags);
    return added;
  };
  world.top_ = add_scene(RTC_SCENE_FLAG_ROBUST);
  Vec3 low = {1e30, 1e30, 1e30};
  Vec3 high = {-1e30, -1e30, -1e30};
  std::vector<Ball> local(scene.meshes.size());
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    Vec3 a = {1e30, 1e30, 1e30};
    Vec3 b = {-1e30, -1e30, -1e30};
    for (const Vec3& p : scene.meshes[i].mesh.positions_mm) {
      a = {std::min(a.x, p.x), std::min(a.y, p.y), std::min(a.z, p.z)};
      b = {std::max(b.x, p.x), std::max(b.y, p.y), std::max(b.z, p.z)};
    }
    local[i] = {0.5 * (a + b), 0.5 * length(b - a)};
  }
  for (const Instance& instance : scene.instances) {
    const Shape& shape = world.shapes_[instance.mesh];
    const bool clear = instance.veil && instance.veil->facing == 0.0 && instance.veil->edge == 0.0;
    if (shape.triangles.empty() || clear) {
      continue;
    }
    Stand stand;
    stand.instance = &instance;
    stand.shape = &shape;
    stand.mesh = &scene.meshes[instance.mesh];
    const Placement& placement = instance.world_from_mesh;
    stand.axis_x = Vec3f(rotate(placement.rotation, {1, 0, 0}));
    stand.axis_y = Vec3f(rotate(placement.rotation, {0, 1, 0}));
    stand.axis_z = Vec3f(rotate(placement.rotation, {0, 0, 1}));
    stand.origin = Vec3f(placement.position_mm);
    stand.scale = static_cast<float>(placement.scale);
    if (instance.veil) {
      stand.facing = static_cast<float>(instance.veil->facing);
      stand.edge = static_cast<float>(instance.veil->edge);
      stand.doublings = instance.veil->doublings;
      if (world.veils_ == nullptr) {
        world.veils_ = add_scene(kRobustWithFilter);
      }
    }
    RTCGeometry geometry = rtcNewGeometry(embree.device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, shape.scene);
    const Vec3f x = stand.scale * stand.axis_x;
    const Vec3f y = stand.scale * stand.axis_y;
    const Vec3f z = stand.scale * stand.axis_z;
    const float columns[12] = {x.x,           x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z, stand.origin.x, stand.origin.y,
                               stand.origin.z};
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    rtcCommitGeometry(geometry);
    // Both scenes count through all instances, so that a hit tells which it is.
    rtcAttachGeometryByID(instance.veil ? world.veils_ : world.top_, geometry,
                          static_cast<unsigned>(world.stands_.size()));
    rtcReleaseGeometry(geometry);
    const Ball ball = {apply(placement, local[instance.mesh].centre), placement.scale * local[instance.mesh].radius};
    const Vec3 reach = {ball.radius, ball.radius, ball.radius};
    const Vec3 a = ball.centre - reach;
    const Vec3 b = ball.centre + reach;
    low = {std::min(low.x, a.x), std::min(low.y, a.y), std::min(low.z, a.z)};
    high = {std::max(high.x, b.x), std::max(high.y, b.y), std::max(high.z, b.z)};
    world.stands_.push_back(stand);
    world.balls_.push_back(ball);
  }
  commit_alone(world.top_);
  if (world.veils_ != nullptr) {
    commit_alone(world.veils_);
  }
  if (!world.balls_.empty()) {
    world.radius_ = 0.5 * length(high - low);
  }
  if (rtcGetDeviceError(embree.device) != RTC_ERROR_NONE) {
    return unexpected(embree_error(embree.device));
  }
  return world;
}

bool World::intersect(const Ray& ray, Hit& hit) const {
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(top_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    return false;
  }
  hit = {query.ray.tfar, query.hit.instID[0], query.hit.primID, query.hit.u, query.hit.v};
  return true;
}

std::size_t World::all_veils(const Ray& ray, float reach, std::array<Hit, kMostVeils>& hits) const {
  // One walk through the tree that turns every hit down and remembers it.
  struct Collector {
    RTCIntersectContext context;  // first: Embree hands back a pointer to it
    std::array<Hit, kMostVeils>& hits;
    std::size_t count;
  } collector = {{}, hits, 0};
  rtcInitIntersectContext(&collector.context);
  collector.context.filter = [](const RTCFilterFunctionNArguments* arguments) {
    auto& all = *reinterpret_cast<Collector*>(arguments->context);
    const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
    if (all.count < kMostVeils) {
      all.hits[all.count++] = {reinterpret_cast<const RTCRay*>(arguments->ray)->tfar, hit.instID[0], hit.primID, hit.u,
                               hit.v};
    }
    arguments->valid[0] = 0;
  };
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.ray.tfar = reach;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(veils_, &collector.context, &query);

  const auto end = hits.begin() + static_cast<std::ptrdiff_t>(collector.count);
  std::sort(hits.begin(), end, [](const Hit& a, const Hit& b) {
    return std::tie(a.distance, a.instance, a.triangle) < std::tie(b.distance, b.instance, b.triangle);
  });
  // A seam that was met on both sides counts once.
  const auto once = std::unique(hits.begin(), end, [&](const Hit& a, const Hit& b) {
    return a.instance == b.instance &&
           b.distance - a.distance < gap_at(ray.origin + a.distance * ray.direction, radius_);
  });
  return static_cast<std::size_t>(once - hits.begin());
}

VeilHit World::veil_at(const Ray& ray, const Hit& hit) const {
  const Stand& stand = stands_[hit.instance];
  const Shape& shape = *stand.shape;
  const auto [i0, i1, i2] = shape.triangles[hit.triangle];
  Vec3f normal;
  if (shape.normals.empty()) {
    normal = cross(shape.positions[i1] - shape.positions[i0], shape.positions[i2] - shape.positions[i0]);
  } else {
    normal = (1.0F - hit.b1 - hit.b2) * shape.normals[i0] + hit.b1 * shape.normals[i1] + hit.b2 * shape.normals[i2];
  }
  normal = stand.turned(normalized(normal));
  const float cosine = -dot(normal, ray.direction);
  float steepness = 1.0F - std::min(1.0F, std::abs(cosine));
  for (int i = 0; i < stand.doublings; ++i) {
    steepness *= steepness;
  }
  return {hit, cosine < 0.0F ? -normal : normal, stand.facing + (stand.edge - stand.facing) * steepness};
}

bool World::occluded(const Ray& ray) const {
  RTCRay query = embree_ray(ray);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(top_, &context, &query);
  return query.tfar < 0.0F;
}

Surface World::surface(const Ray& ray, const Hit& hit) const {
  const Stand& stand = stands_[hit.instance];
  const Shape& shape = *stand.shape;
  const auto [i0, i1, i2] = shape.triangles[hit.triangle];
  const float b0 = 1.0F - hit.b1 - hit.b2;
  const Vec3f p0 = shape.positions[i0];
  const Vec3f p1 = shape.positions[i1];
  const Vec3f p2 = shape.positions[i2];
  const Vec3f local = b0 * p0 + hit.b1 * p1 + hit.b2 * p2;

  Surface surface;
  surface.position = stand.origin + stand.scale * stand.turned(local);
  Vec3f facet = stand.turned(normalized(cross(p1 - p0, p2 - p0)));
  const bool upper_side = dot(facet, ray.direction) <= 0.0F;
  surface.facet = upper_side ? facet : -facet;
  surface.normal = surface.facet;
  surface.lifted = surface.position;
  surface.sunk = surface.position;
  if (!shape.normals.empty()) {
    const Vec3f n0 = shape.normals[i0];
    const Vec3f n1 = shape.normals[i1];
    const Vec3f n2 = shape.normals[i2];
    Vec3f normal = normalized(stand.turned(b0 * n0 + hit.b1 * n1 + hit.b2 * n2));
    normal = upper_side ? normal : -normal;
    // A smooth normal may look away from the eye where the triangle does not: bend it back until it just does not.
    const float toward_eye = -dot(normal, ray.direction);
    constexpr float kLeast = 0.02F;
    if (toward_eye < kLeast) {
      normal = normalized(normal + (kLeast - toward_eye) * -1.0F * ray.direction);
    }
    surface.normal = normal;
    // Flat triangles that are lit as if curved shade themselves in facets. Rays leave from the curved surface instead:
    // the mean of the point's projections on the corners' tangent planes, where that lies outside (Hanika 2021).
    const auto lift = [&](float side) {
      const auto above = [&](Vec3f corner, Vec3f n) {
        const Vec3f outward = side * n;
        return std::min(0.0F, dot(local - corner, outward)) * outward;
      };
      return -(b0 * above(p0, n0) + hit.b1 * above(p1, n1) + hit.b2 * above(p2, n2));
    };
    const float seen = upper_side ? 1.0F : -1.0F;
    surface.lifted += stand.scale * stand.turned(lift(seen));
    surface.sunk += stand.scale * stand.turned(lift(-seen));
  }

  const Instance& instance = *stand.instance;
  const std::uint16_t span = shape.spans[hit.triangle];
  const std::uint32_t pigment = span == 0 ? 0 : stand.mesh->spans[span - 1U].pigment;
  surface.pigment = &scene_->pigments[pigment];
  if (instance.colour) {
    surface.colour = Vec3f(*instance.colour);
  } else {
    Vec2 uv = {0.5, 0.5};
    if (!shape.uvs.empty()) {
      uv = double(b0) * shape.uvs[i0] + double(hit.b1) * shape.uvs[i1] + double(hit.b2) * shape.uvs[i2];
    }
    const bool varied = span != 0 && !instance.variations.empty();
    surface.colour = Vec3f(
        colour_at(*surface.pigment, varied ? instance.variations[span - 1U] : PigmentVariation{}, uv, upper_side));
  }
  surface.gap = gap_at(surface.position, radius_);
  return surface;
}

}  // namespace anthesis
