#pragma once
#include <array>
#include <cstddef>
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

/// Where a ray crosses a veil.
struct VeilHit {
  Hit hit;
  Vec3f normal;          ///< unit, smooth, to the side that the ray comes from
  float stopped = 0.0F;  ///< share of the light
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

  bool intersect(const Ray& ray, Hit& hit) const;  ///< the first surface that is no veil
  bool occluded(const Ray& ray) const;             ///< by such a surface

  /// Calls meet(VeilHit), nearest first, for the veils that stop some of the light of a ray before `reach`, until it
  /// answers false. Of more than kMostVeils some are passed over.
  template <class Meet>
  void cross_veils(const Ray& ray, float reach, Meet&& meet) const {
    if (veils_ == nullptr) {
      return;
    }
    std::array<Hit, kMostVeils> hits;
    const std::size_t count = all_veils(ray, reach, hits);
    for (std::size_t i = 0; i < count; ++i) {
      const VeilHit veil = veil_at(ray, hits[i]);
      if (veil.stopped > 0.0F && !meet(veil)) {
        return;
      }
    }
  }

  /// Share of light that the veils between a ray's origin and `reach` let through.
  float passed(const Ray& ray, float reach) const {
    float share = 1.0F;
    cross_veils(ray, reach, [&](const VeilHit& veil) {
      share *= 1.0F - veil.stopped;
      return share > 0.0F;
    });
    return share;
  }

  /// A surface that was met, veil or not.
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
  static constexpr std::size_t kMostVeils = 16;
  World();

  /// Where a ray meets veils before `reach`, nearest first; how many.
  std::size_t all_veils(const Ray& ray, float reach, std::array<Hit, kMostVeils>& hits) const;
  VeilHit veil_at(const Ray& ray, const Hit& hit) const;

  const Scene* scene_ = nullptr;
  std::unique_ptr<Embree> embree_;
  RTCSceneTy* top_ = nullptr;
  RTCSceneTy* veils_ = nullptr;  ///< apart, so that rays need not stop there; none: nullptr
  std::vector<Shape> shapes_;
  std::vector<Stand> stands_;
  std::vector<Ball> balls_;
  double radius_ = 1.0;
};

}  // namespace anthesis
