#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/render/scene.h"
#include "float_math.h"

struct RTCSceneTy;

namespace anthesis {

struct Ray {
  Vec3f origin;
  Vec3f direction;
};

struct Hit {
  float distance = 0.0F;
  std::uint32_t instance = 0;
  std::uint32_t triangle = 0;
  float b1 = 0.0F;  ///< barycentric coordinates of the second and third corner
  float b2 = 0.0F;
};

/// A point of a surface, seen from somewhere.
struct Surface {
  Vec3f position;  ///< on the triangle, recomputed from its corners
  Vec3f lifted;    ///< towards where the smooth surface would be, on the seen side: where shadows are asked for
  Vec3f sunk;      ///< the same on the other side
  Vec3f facet;     ///< unit normal of the triangle, to the seen side
  Vec3f normal;    ///< unit smooth normal, to the seen side
  const Pigment* pigment = nullptr;
  Vec3f colour;      ///< diffuse
  float gap = 0.0F;  ///< distance by which new rays keep off the surface
};

/// The scene made ready for rays.
class World {
 public:
  /// `scene` must outlive the world. Errors: cancelled, kTooLarge, kIo for Embree's own.
  static Expected<World> build(const Scene& scene, const Progress& progress);
  World(World&&) noexcept;
  ~World();

  bool intersect(const Ray& ray, Hit& hit) const;
  bool occluded(const Ray& ray) const;
  Surface surface(const Ray& ray, const Hit& hit) const;

  /// Centre and radius of each instance that has triangles.
  struct Ball {
    Vec3 centre;
    double radius;
  };
  std::span<const Ball> balls() const { return balls_; }
  double radius_mm() const { return radius_; }

 private:
  struct Shape;
  struct Stand;
  struct Embree;
  World();

  const Scene* scene_ = nullptr;
  std::unique_ptr<Embree> embree_;
  RTCSceneTy* top_ = nullptr;
  std::vector<Shape> shapes_;
  std::vector<Stand> stands_;
  std::vector<Ball> balls_;
  double radius_ = 1.0;
};

}  // namespace anthesis
