#include "denoise.h"

#include <algorithm>
#include <array>
#include <vector>

#include "anthesis/base/parallel.h"

namespace anthesis {

namespace {

constexpr int kTile = 32;
constexpr int kPatch = 1;    // patches of 3 x 3 pixels are compared
constexpr int kBorder = 12;  // of zero weight about the picture: no pixel looks past the end
constexpr int kGuides = 7;   // normal, colour, depth

using Plane = std::vector<float>;

/// What is filtered, in planes with a border.
struct Planes {
  int width;
  int height;
  int stride;
  std::array<Plane, 3> value[2];     ///< the two halves
  Plane bright[2];                   ///< what patches are compared by
  Plane variance;                    ///< of `bright` of one half
  Plane weight;                      ///< how much of the pixel the value stands for, 0 to 1
  std::array<Plane, kGuides> guide;  ///< scaled so that a distance of 1 is one standard width
  Plane depth_slope;                 ///< change of depth from one pixel to the next, in the same scale

  Planes(int width_, int height_) : width(width_), height(height_), stride(width_ + 2 * kBorder) {
    const std::size_t size = std::size_t(stride) * (height + 2 * kBorder);
    for (int half = 0; half < 2; ++half) {
      for (Plane& plane : value[half]) {
        plane.resize(size);
      }
      bright[half].resize(size);
    }
    variance.resize(size);
    weight.resize(size);
    for (Plane& plane : guide) {
      plane.resize(size);
    }
    depth_slope.resize(size);
  }
  std::size_t at(int x, int y) const { return std::size_t(y + kBorder) * stride + (x + kBorder); }
};

/// Mean over a square of pixels, by weight. Separable; rows in parallel.
void blur(Plane& plane, const Planes& planes, int reach) {
  Plane sums(plane.size());
  Plane counts(plane.size());
  parallel_for(std::size_t(planes.height), [&](std::size_t row) {
    for (int x = 0; x < planes.width; ++x) {
      const std::size_t i = planes.at(x, static_cast<int>(row));
      for (int d = -reach; d <= reach; ++d) {
        sums[i] += planes.weight[i + d] * plane[i + d];
        counts[i] += planes.weight[i + d];
      }
    }
  });
  parallel_for(std::size_t(planes.height), [&](std::size_t row) {
    for (int x = 0; x < planes.width; ++x) {
      const std::size_t i = planes.at(x, static_cast<int>(row));
      float sum = 0.0F;
      float count = 0.0F;
      for (int d = -reach; d <= reach; ++d) {
        const std::size_t j = i + static_cast<std::size_t>(static_cast<std::ptrdiff_t>(d) * planes.stride);
        sum += sums[j];
        count += counts[j];
      }
      plane[i] = count > 0.0F ? sum / count : 0.0F;
    }
  });
}

/// Replaces each half by means over like pixels. Likeness is judged by the other half, so that noise does not choose
/// its own company, and by the guides.
bool filter(Planes& planes, int reach, float strength, bool guided, const Progress& progress) {
  const int across = (planes.width + kTile - 1) / kTile;
  const int down = (planes.height + kTile - 1) / kTile;
  std::array<Plane, 3> result[2];
  for (int half = 0; half < 2; ++half) {
    for (std::size_t c = 0; c < 3; ++c) {
      result[half][c] = planes.value[half][c];
    }
  }
  const float spread = strength * strength;
  const auto tile = [&](std::size_t index) {
    const int left = static_cast<int>(index % across) * kTile;
    const int top = static_cast<int>(index / across) * kTile;
    const int wide = std::min(kTile, planes.width - left);
    const int high = std::min(kTile, planes.height - top);
    float covered = 0.0F;
    for (int y = 0; y < high; ++y) {
      for (int x = 0; x < wide; ++x) {
        covered += planes.weight[planes.at(left + x, top + y)];
      }
    }
    if (covered == 0.0F) {
      return;
    }
    constexpr int kRow = kTile + 2 * kPatch;
    float sums[2][4][kTile * kTile] = {};  // three channels and the weights
    float differences[2][kRow * kRow];
    float columns[kRow * kTile];
    float likeness[kTile];
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const std::ptrdiff_t step = std::ptrdiff_t(dy) * planes.stride + dx;
        const float away = std::sqrt(static_cast<float>(dx * dx + dy * dy));
        for (int half = 0; half < 2; ++half) {
          for (int y = 0; y < high + 2 * kPatch; ++y) {
            const std::size_t first = planes.at(left - kPatch, top - kPatch + y);
            const float* bright = &planes.bright[half][first];
            const float* variance = &planes.variance[first];
            const float* weight = &planes.weight[first];
            float* out = &differences[half][y * kRow];
            for (int x = 0; x < wide + 2 * kPatch; ++x) {
              const float d = bright[x] - bright[x + step];
              const float v = variance[x];
              const float w = variance[x + step];
              const float both = std::min(weight[x], weight[x + step]);
              out[x] = both * (d * d - (v + std::min(v, w))) / (1e-8F + spread * (v + w));
            }
          }
        }
        for (int half = 0; half < 2; ++half) {
          const float* other = differences[1 - half];
          for (int y = 0; y < high; ++y) {
            for (int x = 0; x < wide + 2 * kPatch; ++x) {
              columns[y * kRow + x] = other[y * kRow + x] + other[(y + 1) * kRow + x] + other[(y + 2) * kRow + x];
            }
          }
          for (int y = 0; y < high; ++y) {
            const std::size_t first = planes.at(left, top + y);
            const float* weight = &planes.weight[first];
            for (int x = 0; x < wide; ++x) {
              const float* c = &columns[y * kRow + x];
              const float d = (c[0] + c[1] + c[2]) * (1.0F / 9.0F);
              likeness[x] = weight[x + step] * fast_fade(std::max(0.0F, d));
            }
            if (guided) {
              float unlike[kTile] = {};
              for (int g = 0; g < kGuides - 1; ++g) {
                const float* guide = &planes.guide[static_cast<std::size_t>(g)][first];
                for (int x = 0; x < wide; ++x) {
                  const float d = guide[x] - guide[x + step];
                  unlike[x] += d * d;
                }
              }
              const float* depth = &planes.guide[kGuides - 1][first];
              const float* slope = &planes.depth_slope[first];
              for (int x = 0; x < wide; ++x) {
                const float d = std::max(0.0F, std::abs(depth[x] - depth[x + step]) - 1.5F * away * slope[x]);
                likeness[x] *= fast_fade(unlike[x] + d * d);
              }
            }
            float* total = &sums[half][3][y * kTile];
            for (int x = 0; x < wide; ++x) {
              total[x] += likeness[x];
            }
            for (std::size_t c = 0; c < 3; ++c) {
              const float* value = &planes.value[half][c][first];
              float* sum = &sums[half][c][y * kTile];
              for (int x = 0; x < wide; ++x) {
                sum[x] += likeness[x] * value[x + step];
              }
            }
          }
        }
      }
    }
    for (int half = 0; half < 2; ++half) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (int y = 0; y < high; ++y) {
          for (int x = 0; x < wide; ++x) {
            const float total = sums[half][3][y * kTile + x];
            if (total > 0.0F) {
              result[half][c][planes.at(left + x, top + y)] = sums[half][c][y * kTile + x] / total;
            }
          }
        }
      }
    }
  };
  if (!parallel_for(std::size_t(across) * down, tile, progress, "noise")) {
    return false;
  }
  for (int half = 0; half < 2; ++half) {
    planes.value[half] = std::move(result[half]);
  }
  return true;
}

/// How much weaker the noise of the mean is than independent samples would have it, by the difference of the halves.
/// `noise` and `expected` are sums over the picture in rows' order.
float evenness(const Film& film) {
  double noise = 0.0;
  double expected = 0.0;
  for (std::size_t i = 0; i < film.coverage.size(); ++i) {
    const float d = luminance(film.light[0][i]) - luminance(film.light[1][i]);
    noise += 0.25 * d * d;
    expected += film.scatter[i];
  }
  return expected > 0.0 ? static_cast<float>(std::clamp(noise / expected, 0.02, 2.0)) : 1.0F;
}

bool denoise_plant(Film& film, int samples, const Progress& progress) {
  Planes planes(film.width, film.height);
  const float even = evenness(film);
  std::vector<Vec3f> pigment(film.coverage.size());
  parallel_for(std::size_t(film.height), [&](std::size_t row) {
    for (int x = 0; x < film.width; ++x) {
      const std::size_t from = row * film.width + x;
      const std::size_t to = planes.at(x, static_cast<int>(row));
      const float coverage = film.coverage[from];
      planes.weight[to] = coverage;
      if (coverage <= 0.0F) {
        continue;
      }
      // Light divided by the pigment's colour is smooth where the pigment is not; what is filtered has no veins to
      // lose.
      const Vec3f colour = film.colour[from];
      const float least = 0.06F * max_channel(colour) + 1e-3F * coverage;
      const Vec3f by = {std::max(colour.x, least), std::max(colour.y, least), std::max(colour.z, least)};
      pigment[from] = by;
      for (int half = 0; half < 2; ++half) {
        const Vec3f light = film.light[half][from];
        planes.value[half][0][to] = light.x / by.x;
        planes.value[half][1][to] = light.y / by.y;
        planes.value[half][2][to] = light.z / by.z;
        planes.bright[half][to] = luminance(light) / luminance(by);
      }
      planes.variance[to] = 2.0F * even * film.scatter[from] / (luminance(by) * luminance(by));
      const float k = 1.0F / coverage;
      constexpr float kPerNormal = 1.0F / 0.16F;
      constexpr float kPerColour = 1.0F / 0.15F;
      constexpr float kPerDepth = 1.0F / 0.01F;
      planes.guide[0][to] = kPerNormal * k * film.normal[from].x;
      planes.guide[1][to] = kPerNormal * k * film.normal[from].y;
      planes.guide[2][to] = kPerNormal * k * film.normal[from].z;
      planes.guide[3][to] = kPerColour * k * colour.x;
      planes.guide[4][to] = kPerColour * k * colour.y;
      planes.guide[5][to] = kPerColour * k * colour.z;
      planes.guide[6][to] = kPerDepth * k * film.depth[from];
    }
  });
  const Plane& depth = planes.guide[kGuides - 1];
  parallel_for(std::size_t(film.height), [&](std::size_t row) {
    for (int x = 0; x < film.width; ++x) {
      const std::size_t i = planes.at(x, static_cast<int>(row));
      // The lesser of the two sides: an edge on one side is no slope.
      const auto slope = [&](std::ptrdiff_t step) {
        return std::min(std::abs(depth[i + step] - depth[i]), std::abs(depth[i] - depth[i - step]));
      };
      planes.depth_slope[i] = std::max(slope(1), slope(planes.stride));
    }
  });
  blur(planes.variance, planes, 2);
  const int reach = samples >= 32 ? 6 : samples >= 16 ? 7 : 8;
  if (!filter(planes, reach, 0.8F, true, progress)) {
    return false;
  }
  parallel_for(std::size_t(film.height), [&](std::size_t row) {
    for (int x = 0; x < film.width; ++x) {
      const std::size_t to = row * film.width + x;
      if (film.coverage[to] <= 0.0F) {
        continue;
      }
      const std::size_t from = planes.at(x, static_cast<int>(row));
      for (int half = 0; half < 2; ++half) {
        film.light[half][to] =
            pigment[to] * Vec3f(planes.value[half][0][from], planes.value[half][1][from], planes.value[half][2][from]);
      }
    }
  });
  return true;
}

bool denoise_shadow(Film& film, const Progress& progress) {
  const auto dark = [](float s) { return s != 0.0F; };
  if (std::ranges::none_of(film.shadow[0], dark) && std::ranges::none_of(film.shadow[1], dark)) {
    return true;
  }
  Planes planes(film.width, film.height);
  for (int y = 0; y < film.height; ++y) {
    for (int x = 0; x < film.width; ++x) {
      const std::size_t from = std::size_t(y) * film.width + x;
      const std::size_t to = planes.at(x, y);
      const float bare = 1.0F - film.coverage[from];
      planes.weight[to] = bare;
      if (bare <= 0.0F) {
        continue;
      }
      for (int half = 0; half < 2; ++half) {
        const float shadow = film.shadow[half][from] / bare;
        planes.value[half][0][to] = shadow;
        planes.bright[half][to] = shadow;
      }
      const float d = planes.bright[0][to] - planes.bright[1][to];
      planes.variance[to] = 0.5F * d * d;
    }
  }
  blur(planes.variance, planes, 4);
  if (!filter(planes, 10, 1.0F, false, progress)) {
    return false;
  }
  for (int y = 0; y < film.height; ++y) {
    for (int x = 0; x < film.width; ++x) {
      const std::size_t to = std::size_t(y) * film.width + x;
      for (int half = 0; half < 2; ++half) {
        film.shadow[half][to] = (1.0F - film.coverage[to]) * planes.value[half][0][planes.at(x, y)];
      }
    }
  }
  return true;
}

}  // namespace

bool denoise(Film& film, int samples, const Progress& progress) {
  return denoise_plant(film, samples, progress) && denoise_shadow(film, progress);
}

}  // namespace anthesis
