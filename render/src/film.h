#pragma once
#include <cstdint>
#include <vector>

#include "float_math.h"

namespace anthesis {

/// What the light paths bring home, before it becomes a picture. One element a pixel, rows from the top.
struct Film {
  int width = 0;
  int height = 0;
  std::vector<Vec3f> light[2];   ///< means over the first and the second half of the samples, plant only
  std::vector<float> shadow[2];  ///< light taken from the ground, as a share of the pixel
  std::vector<float> coverage;   ///< share of samples that met the plant
  std::vector<float> scatter;    ///< variance of the mean luminance of `light`
  std::vector<Vec3f> colour;     ///< mean diffuse colour of what was met, times coverage
  std::vector<Vec3f> normal;     ///< mean normal, times coverage
  std::vector<float> depth;      ///< mean distance in scene radii, times coverage

  Film(int width_, int height_) : width(width_), height(height_) {
    const std::size_t n = std::size_t(width) * height;
    for (int half = 0; half < 2; ++half) {
      light[half].resize(n);
      shadow[half].resize(n);
    }
    coverage.resize(n);
    scatter.resize(n);
    colour.resize(n);
    normal.resize(n);
    depth.resize(n);
  }
};

}  // namespace anthesis
