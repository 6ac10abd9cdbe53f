#pragma once
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "anthesis/inflorescence/development.h"

namespace anthesis::test {

/// The nearest multiple of 2^-14 mm: exact in single precision below 1024 mm, and so are most differences.
inline double on_lattice(double mm) {
  return std::nearbyint(mm * 16384.0) / 16384.0;
}

/// The plant at `time` as if its organs had been bent by touching: each vertex pushed along by a smooth wave of
/// `amplitude_mm` that runs through the world, and everything set on the lattice.
inline Canopy bent(const Development& development, double time, double amplitude_mm = 0.3) {
  Canopy canopy = development.at(time);
  const auto wave = [&](Vec3 p) {
    return p + amplitude_mm * Vec3{std::sin(0.7 * p.y + 3.0 * time), std::cos(0.5 * p.z), std::sin(0.6 * p.x - time)};
  };
  for (OrganState& state : canopy.organs) {
    const OrganTemplate& shape = development.templates()[development.organs()[state.id.value - 1].template_index];
    std::vector<Vec3> positions_mm(shape.vertex_count());
    std::vector<Vec3> normals(shape.vertex_count());
    shape.pose(state.stage, positions_mm, normals);
    for (const Vec3 p : positions_mm) {
      const Vec3 q = wave(apply(state.world_from_organ, p));
      state.deformed_mm.push_back({static_cast<float>(on_lattice(q.x)), static_cast<float>(on_lattice(q.y)),
                                   static_cast<float>(on_lattice(q.z))});
    }
  }
  for (Body& body : canopy.bodies) {
    for (Vec3& p : body.mesh.positions_mm) {
      p = {on_lattice(p.x), on_lattice(p.y), on_lattice(p.z)};
    }
  }
  return canopy;
}

inline std::vector<Canopy> bent_at(const Development& development, std::span<const double> times) {
  std::vector<Canopy> canopies;
  for (const double time : times) {
    canopies.push_back(bent(development, time));
  }
  return canopies;
}

}  // namespace anthesis::test
