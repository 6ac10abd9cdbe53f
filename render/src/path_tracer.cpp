#include "anthesis/render/path_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "bsdf.h"
#include "denoise.h"
#include "film.h"
#include "float_math.h"
#include "sampler.h"
#include "world.h"

namespace anthesis {

namespace {

constexpr int kMaxSide = 16384;
constexpr int kMaxSamples = 65536;
constexpr int kTile = 16;
constexpr float kEndless = std::numeric_limits<float>::infinity();
constexpr float kFilterRadius = 1.6F;       // pixels
constexpr float kFilmPaths = 4.0F;          // paths that are followed from a veil for each that it stops
constexpr float kBrightestIndirect = 3.0F;  // times white: what a single path may bring after its first surface

/// Pixel offsets with the density of a Blackman and Harris window: sharp, no ringing, no weights to carry.
class PixelFilter {
 public:
  PixelFilter() {
    constexpr int kFine = 4096;
    std::array<double, kFine + 1> sum{};
    for (int i = 0; i < kFine; ++i) {
      const double angle = math::kTurnRad * (i + 0.5) / kFine;
      const double window =
          0.35875 - 0.48829 * math::cos(angle) + 0.14128 * math::cos(2.0 * angle) - 0.01168 * math::cos(3.0 * angle);
      sum[i + 1] = sum[i] + window;
    }
    int at = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const double wanted = sum[kFine] * i / kSteps;
      while (at < kFine - 1 && sum[at + 1] < wanted) {
        ++at;
      }
      const double t = (wanted - sum[at]) / (sum[at + 1] - sum[at]);
      offset_[i] = static_cast<float>(((at + t) / kFine * 2.0 - 1.0) * kFilterRadius);
    }
  }

  float operator()(float u) const {
    const float at = u * kSteps;
    const int i = std::min(static_cast<int>(at), kSteps - 1);
    const float t = at - static_cast<float>(i);
    return (1.0F - t) * offset_[i] + t * offset_[i + 1];
  }

 private:
  static constexpr int kSteps = 256;
  std::array<float, kSteps + 1> offset_;
};

struct FastLamp {
  Frame frame;
  Vec3f irradiance;
  Vec3f radiance_times_angle;  ///< what one direction of even density over the cone stands for
  float cos_limit;
  float sin_limit;

  explicit FastLamp(const Lamp& lamp) : frame(Vec3f(lamp.towards)), irradiance(lamp.irradiance) {
    const auto [sine, cosine] = math::sin_cos(lamp.half_angle_rad);
    cos_limit = static_cast<float>(cosine);
    sin_limit = static_cast<float>(sine);
    // Radiance E / (pi sin^2), solid angle 2 pi (1 - cos).
    const double factor = 2.0 / (1.0 + cosine);
    radiance_times_angle = static_cast<float>(factor) * irradiance;
  }

  Vec3f direction(float u, float v) const {
    // A disc of equal areas lifted to the cap: its height falls with the square of the radius.
    const DiscPoint d = disc_from_square(u, v);
    const float r2 = d.x * d.x + d.y * d.y;
    const float drop = (1.0F - cos_limit) * r2;
    const float k = std::sqrt(std::max(0.0F, (1.0F - cos_limit) * (2.0F - drop)));
    return frame.from_local({k * d.x, k * d.y, 1.0F - drop});
  }
};

struct FastSky {
  Vec3f up;
  Vec3f zenith;
  Vec3f horizon;
  Vec3f nadir;
  struct FastGlow {
    Vec3f towards;
    Vec3f radiance;
    int doublings;
  };
  std::vector<FastGlow> glows;

  explicit FastSky(const Sky& sky) : up(sky.up), zenith(sky.zenith), horizon(sky.horizon), nadir(sky.nadir) {
    for (const Glow& glow : sky.glows) {
      glows.push_back({Vec3f(glow.towards), Vec3f(glow.radiance), glow.doublings});
    }
  }

  Vec3f radiance(Vec3f towards) const {
    const float rise = dot(up, towards);
    const float height = std::min(std::abs(rise), 1.0F);
    const float t = height * (2.0F - height);
    Vec3f sum = (1.0F - t) * horizon + t * (rise >= 0.0F ? zenith : nadir);
    for (const FastGlow& glow : glows) {
      float strength = std::max(0.0F, dot(glow.towards, towards));
      for (int i = 0; i < glow.doublings; ++i) {
        strength *= strength;
      }
      sum += strength * glow.radiance;
    }
    return sum;
  }
};

/// What the first surface of a path looks like, and the veils before it.
struct FirstHit {
  float coverage = 0.0F;  ///< 1 if there is a surface, else the share of light that comes from veils
  Vec3f colour;           ///< the rest times coverage
  Vec3f normal;
  float depth = 0.0F;
};

class Tracer {
 public:
  Tracer(const Scene& scene, const World& world, const Camera& camera, const RenderOptions& options, double exposure)
      : world_(world),
        options_(options),
        exposure_(static_cast<float>(exposure)),
        sky_(scene.lighting.sky),
        position_(camera.position_mm),
        right_(camera.right),
        up_(camera.up),
        back_(camera.back),
        slope_x_(static_cast<float>(camera.tan_half_width)),
        slope_y_(static_cast<float>(camera.tan_half_height)),
        focus_(static_cast<float>(camera.focus_mm)),
        lens_(static_cast<float>(camera.lens_radius_mm)),
        depth_scale_(static_cast<float>(1.0 / world.radius_mm())) {
    for (const Lamp& lamp : scene.lighting.lamps) {
      if (max_channel(Vec3f(lamp.irradiance)) > 0.0F) {
        lamps_.emplace_back(lamp);
      }
    }
    if (scene.haze) {
      haze_towards_ = Vec3f(scene.haze->towards);
      haze_clear_ = static_cast<float>(scene.haze->clear_mm);
      haze_per_mm_ = static_cast<float>(1.0 / (scene.haze->clear_mm - scene.haze->dense_mm));
      haze_share_ = static_cast<float>(scene.haze->share);
    }
    // Seen from below, a ground would only hide the plant's lower side from the light.
    if (scene.ground && camera.position_mm.z >= scene.ground->height_mm) {
      ground_ = true;
      ground_height_ = static_cast<float>(scene.ground->height_mm);
      ground_colour_ = Vec3f(scene.ground->colour);
      ground_light_ = luminance(Vec3f(open_irradiance(scene.lighting, {0.0, 0.0, 1.0})));
    }
  }

  void paint(int x, int y, Film& film) const {
    const std::size_t at = std::size_t(y) * film.width + x;
    const int samples = options_.samples;
    const int half = samples / 2;
    Vec3f light[2];
    float shadow[2] = {0.0F, 0.0F};
    Vec3f colour;
    Vec3f normal;
    float depth = 0.0F;
    float coverage = 0.0F;
    float luminances = 0.0F;
    float squares = 0.0F;
    // The pixel's number does not depend on the picture's size alone: 16384 rows and columns fit 28 bits.
    const std::uint32_t key = static_cast<std::uint32_t>(y) * 16384U + static_cast<std::uint32_t>(x);
    for (int s = 0; s < samples; ++s) {
      Sampler sampler(key, static_cast<std::uint32_t>(s));
      // Veils have numbers of their own: what is behind them is drawn with the same ones as without.
      Sampler veil_sampler(key | 0x80000000U, static_cast<std::uint32_t>(s));
      const Ray ray = camera_ray(x, y, film, sampler);
      FirstHit first;
      float taken = 0.0F;
      const Vec3f found = exposure_ * follow(ray, sampler, veil_sampler, first, taken);
      const int which = s < half ? 0 : 1;
      light[which] += found;
      shadow[which] += taken;
      coverage += first.coverage;
      colour += first.colour;
      normal += first.normal;
      depth += first.depth;
      const float lum = luminance(found);
      luminances += lum;
      squares += lum * lum;
    }
    const float n = static_cast<float>(samples);
    const float counts[2] = {static_cast<float>(std::max(half, 1)), static_cast<float>(samples - half)};
    for (int which = 0; which < 2; ++which) {
      film.light[which][at] = (1.0F / counts[which]) * light[which];
      film.shadow[which][at] = shadow[which] / counts[which];
    }
    film.coverage[at] = coverage / n;
    film.colour[at] = (1.0F / n) * colour;
    film.normal[at] = (1.0F / n) * normal;
    film.depth[at] = depth / n;
    film.scatter[at] = std::max(0.0F, squares / n - (luminances / n) * (luminances / n)) / n;
  }

 private:
  Ray camera_ray(int x, int y, const Film& film, Sampler& sampler) const {
    static const PixelFilter filter;
    const auto pair = sampler.next();
    const float px = (static_cast<float>(x) + 0.5F + filter(pair.x)) / static_cast<float>(film.width);
    const float py = (static_cast<float>(y) + 0.5F + filter(pair.y)) / static_cast<float>(film.height);
    const Vec3f aim = (2.0F * px - 1.0F) * slope_x_ * right_ + (1.0F - 2.0F * py) * slope_y_ * up_ - back_;
    if (lens_ <= 0.0F) {
      return {position_, normalized(aim)};
    }
    const auto on_lens = sampler.next();
    const DiscPoint d = disc_from_square(on_lens.x, on_lens.y);
    const Vec3f shift = lens_ * d.x * right_ + lens_ * d.y * up_;
    return {position_ + shift, normalized(focus_ * aim - shift)};
  }

  /// Distance to the ground along a ray, or a negative number.
  float ground_distance(const Ray& ray) const {
    if (!ground_ || ray.direction.z >= 0.0F) {
      return -1.0F;
    }
    return (ground_height_ - ray.origin.z) / ray.direction.z;
  }

  /// Share of the light of a place that no haze takes from the camera.
  float clear_share(Vec3f place) const {
    const float depth = (haze_clear_ - dot(haze_towards_, place)) * haze_per_mm_;
    return 1.0F - haze_share_ * std::clamp(depth, 0.0F, 1.0F);
  }

  /// Share of a distant lamp's light that arrives along a ray.
  float open_share(const Ray& ray) const {
    if ((ground_ && ray.direction.z < 0.0F && ray.origin.z > ground_height_) || world_.occluded(ray)) {
      return 0.0F;
    }
    return world_.passed(ray, kEndless);
  }

  /// Lets chance decide whether a path that goes on along `ray` ends in a veil before `reach`, which `hit` then tells.
  bool stopped_by_veil(const Ray& ray, float reach, Sampler& sampler, Hit& hit) const {
    bool stopped = false;
    float u = -1.0F;
    world_.cross_veils(ray, reach, [&](const VeilHit& veil) {
      if (u < 0.0F) {
        u = sampler.next().x;
      }
      if (u < veil.stopped) {
        hit = veil.hit;
        stopped = true;
        return false;
      }
      u = (u - veil.stopped) / (1.0F - veil.stopped);
      return true;
    });
    return stopped;
  }

  /// Light from the veils before `reach`, of all of them by the look of one. `passed`: share of what is behind that is
  /// seen. What the camera sees of a film that stops little is no matter of chance: it would be all noise.
  Vec3f veil_light(const Ray& ray, float reach, Sampler& sampler, FirstHit& first, float& passed) const {
    VeilHit nearest;
    Hit chosen;
    float u = -1.0F;
    passed = 1.0F;
    world_.cross_veils(ray, reach, [&](const VeilHit& veil) {
      if (u < 0.0F) {
        u = sampler.next().x;
        nearest = veil;
      }
      const float share = passed * veil.stopped;
      passed *= 1.0F - veil.stopped;
      // One of the veils so far, by their shares; what is left of the number is as good as new.
      const float newest = std::min(1.0F, share / (1.0F - passed));
      if (u < newest) {
        chosen = veil.hit;
        u /= newest;
      } else {
        u = (u - newest) / (1.0F - newest);
      }
      return passed > 0.0F;
    });
    if (u < 0.0F) {
      return {};
    }
    const float stopped = 1.0F - passed;
    first.coverage = stopped;
    first.colour = stopped * world_.surface(ray, chosen).colour;
    first.normal = stopped * nearest.normal;
    first.depth = stopped * nearest.hit.distance * depth_scale_;
    // Thin films give little light: it is enough to follow it for some of the samples, which stand for the others.
    const float followed = std::min(1.0F, kFilmPaths * stopped);
    if (sampler.next().x >= followed) {
      return {};
    }
    FirstHit unused;
    return (stopped / followed) * gather(ray, chosen, sampler, sampler, &unused);
  }

  /// Light that a path from the camera brings, from the plant only. `taken`: share of its light that the ground misses.
  Vec3f follow(Ray ray, Sampler& sampler, Sampler& veil_sampler, FirstHit& first, float& taken) const {
    Hit hit;
    const bool met = world_.intersect(ray, hit);
    const float to_ground = ground_distance(ray);
    const bool on_ground = to_ground > 0.0F && (!met || to_ground < hit.distance);
    float passed = 1.0F;
    const Vec3f veiled = veil_light(ray,
                                    on_ground ? to_ground
                                    : met     ? hit.distance
                                              : kEndless,
                                    veil_sampler, first, passed);
    if (on_ground) {
      taken = passed * (1.0F - ground_share(ray.origin + to_ground * ray.direction, sampler, veil_sampler));
      return veiled;
    }
    if (!met || !(passed > 0.0F)) {
      return veiled;
    }
    // The filter of noise goes by the surface behind the veils, or it would smear what shows through them.
    const Vec3f colour = first.colour;
    const float stopped = first.coverage;
    const Vec3f light = gather(ray, hit, sampler, veil_sampler, &first);
    const float clear = clear_share(ray.origin + hit.distance * ray.direction);
    const float seen = passed * clear;
    first.colour = colour + seen * first.colour;
    if (clear < 1.0F) {
      first.coverage = stopped + seen;
      first.normal = first.coverage * first.normal;
      first.depth *= first.coverage;
    }
    return veiled + seen * light;
  }

  /// Light that leaves the surface met by `ray` back along it.
  Vec3f gather(Ray ray, Hit hit, Sampler& sampler, Sampler& veil_sampler, FirstHit* first) const {
    Vec3f sum;
    Vec3f throughput(1.0F);
    const auto add = [&](Vec3f light, bool direct) {
      Vec3f part = throughput * light;
      if (!direct) {
        const float bright = exposure_ * max_channel(part);
        if (bright > kBrightestIndirect) {
          part = (kBrightestIndirect / bright) * part;
        }
      }
      sum += part;
    };
    for (int bounce = 0;; ++bounce) {
      const Surface surface = world_.surface(ray, hit);
      const Pigment& pigment = *surface.pigment;
      const Frame frame(surface.normal);
      const Bsdf bsdf({.colour = surface.colour,
                       .roughness = static_cast<float>(pigment.roughness),
                       .specular = static_cast<float>(pigment.specular),
                       .sheen = static_cast<float>(pigment.sheen),
                       .translucency = static_cast<float>(pigment.translucency)},
                      frame.to_local(-ray.direction));
      if (bounce == 0 && first != nullptr) {
        first->coverage = 1.0F;
        first->colour = surface.colour;
        first->normal = surface.normal;
        first->depth = hit.distance * depth_scale_;
      }
      const bool direct = bounce == 0 && first != nullptr;
      const auto choice = sampler.next();
      if (!lamps_.empty()) {
        add(lamp_light(surface, frame, bsdf, choice.x, sampler), direct);
      }
      const auto at = sampler.next();
      const auto next = bsdf.sample(choice.y, at.x, at.y);
      if (!next) {
        break;
      }
      throughput *= next->weight;
      if (bounce >= 1) {
        // Paths that carry little end early; those that go on carry what they stood for.
        const float survive = std::min(0.95F, max_channel(throughput) * 1.4F);
        const float u = sampler.next().x;
        if (u >= survive) {
          break;
        }
        throughput = (1.0F / survive) * throughput;
      }
      const Vec3f direction = frame.from_local(next->direction);
      ray = {leave(surface, direction), direction};
      bool met = world_.intersect(ray, hit);
      const float to_ground = ground_distance(ray);
      bool on_ground = to_ground > 0.0F && (!met || to_ground < hit.distance);
      if (stopped_by_veil(ray, on_ground ? to_ground : met ? hit.distance : kEndless, veil_sampler, hit)) {
        met = true;
        on_ground = false;
      }
      if (on_ground) {
        // The ground's own light, as if nothing shaded it: its colour cast on the plant's underside needs no more.
        add((ground_light_ / kPiF) * ground_colour_, false);
        break;
      }
      if (!met) {
        add(sky_.radiance(direction), direct);
        break;
      }
      if (bounce + 1 >= options_.max_bounces) {
        break;
      }
    }
    return sum;
  }

  static Vec3f leave(const Surface& surface, Vec3f direction) {
    const bool seen_side = dot(direction, surface.facet) >= 0.0F;
    return (seen_side ? surface.lifted : surface.sunk) + (seen_side ? surface.gap : -surface.gap) * surface.facet;
  }

  /// Light from one lamp, chosen by how much it would bring if nothing stood in its way.
  Vec3f lamp_light(const Surface& surface, const Frame& frame, const Bsdf& bsdf, float u, Sampler& sampler) const {
    const float front = luminance(bsdf.reflected()) + 0.05F * bsdf.clear_share();
    const float behind = luminance(bsdf.transmitted());
    std::array<float, 8> weights;
    float total = 0.0F;
    for (std::size_t i = 0; i < lamps_.size(); ++i) {
      const FastLamp& lamp = lamps_[i];
      const float cosine = dot(lamp.frame.z, surface.normal);
      const float spread = lamp.sin_limit * 0.5F;
      weights[i] = luminance(lamp.irradiance) * (std::max(cosine, std::max(0.0F, spread + 0.5F * cosine)) * front +
                                                 std::max(-cosine, std::max(0.0F, spread - 0.5F * cosine)) * behind);
      total += weights[i];
    }
    const auto at = sampler.next();  // taken in any case: the row of pairs must not depend on the scene's darkness
    if (!(total > 0.0F)) {
      return {};
    }
    float rest = u * total;
    std::size_t chosen = 0;
    while (chosen + 1 < lamps_.size() && rest >= weights[chosen]) {
      rest -= weights[chosen];
      ++chosen;
    }
    if (!(weights[chosen] > 0.0F)) {
      return {};
    }
    const FastLamp& lamp = lamps_[chosen];
    const Vec3f towards = lamp.direction(at.x, at.y);
    const Vec3f local = frame.to_local(towards);
    const Vec3f light = (total / weights[chosen] * std::abs(local.z)) * (bsdf.value(local) * lamp.radiance_times_angle);
    if (!(max_channel(light) > 0.0F)) {
      return {};
    }
    return open_share({leave(surface, towards), towards}) * light;
  }

  /// Light at a point of the ground over the light there without the plant.
  float ground_share(Vec3f point, Sampler& sampler, Sampler& veil_sampler) const {
    if (!(ground_light_ > 0.0F)) {
      return 1.0F;
    }
    const float gap = 2e-5F / depth_scale_;
    const Vec3f origin = point + Vec3f(0.0F, 0.0F, gap);
    float light = 0.0F;
    float total = 0.0F;
    for (const FastLamp& lamp : lamps_) {
      total += luminance(lamp.irradiance) * std::max(0.0F, lamp.frame.z.z);
    }
    const auto choice = sampler.next();
    const auto at = sampler.next();
    if (total > 0.0F) {
      float rest = choice.x * total;
      for (const FastLamp& lamp : lamps_) {
        const float weight = luminance(lamp.irradiance) * std::max(0.0F, lamp.frame.z.z);
        if (rest < weight) {
          const Vec3f towards = lamp.direction(at.x, at.y);
          if (towards.z > 0.0F) {
            light +=
                open_share({origin, towards}) * (total / weight * towards.z * luminance(lamp.radiance_times_angle));
          }
          break;
        }
        rest -= weight;
      }
    }
    const auto around = sampler.next();
    const Ray up = {origin, cosine_direction(around.x, around.y)};
    Hit hit;
    const bool met = world_.intersect(up, hit);
    if (stopped_by_veil(up, met ? hit.distance : kEndless, veil_sampler, hit) || met) {
      light += kPiF * luminance(gather(up, hit, sampler, veil_sampler, nullptr));
    } else {
      light += kPiF * luminance(sky_.radiance(up.direction));
    }
    return std::min(light / ground_light_, 2.0F);
  }

  const World& world_;
  const RenderOptions& options_;
  float exposure_;
  std::vector<FastLamp> lamps_;
  FastSky sky_;
  Vec3f position_;
  Vec3f right_;
  Vec3f up_;
  Vec3f back_;
  float slope_x_;
  float slope_y_;
  float focus_;
  float lens_;
  float depth_scale_;
  bool ground_ = false;
  float ground_height_ = 0.0F;
  Vec3f ground_colour_;
  float ground_light_ = 0.0F;
  Vec3f haze_towards_;
  float haze_clear_ = 0.0F;
  float haze_per_mm_ = 0.0F;
  float haze_share_ = 0.0F;
};

/// The tiles that a ray from the camera could meet anything in; all of them if there is a ground or a lens.
std::vector<std::uint32_t> busy_tiles(const Scene& scene, const World& world, const Camera& camera, int width,
                                      int height) {
  const int across = (width + kTile - 1) / kTile;
  const int down = (height + kTile - 1) / kTile;
  std::vector<std::uint8_t> busy(std::size_t(across) * down, 0);
  const auto mark = [&](double x0, double y0, double x1, double y1) {
    const double reach = kFilterRadius + 1.0;
    const int left = static_cast<int>(std::clamp((x0 * width - reach) / kTile, 0.0, double(across)));
    const int right = static_cast<int>(std::clamp((x1 * width + reach) / kTile, -1.0, double(across - 1)));
    const int top = static_cast<int>(std::clamp((y0 * height - reach) / kTile, 0.0, double(down)));
    const int bottom = static_cast<int>(std::clamp((y1 * height + reach) / kTile, -1.0, double(down - 1)));
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        busy[std::size_t(y) * across + x] = 1;
      }
    }
  };
  if (scene.ground || camera.lens_radius_mm > 0.0) {
    mark(0.0, 0.0, 1.0, 1.0);
  } else {
    for (const World::Ball& ball : world.balls()) {
      const Vec3 centre = camera.project(ball.centre);
      const double nearest = centre.z - ball.radius;
      if (nearest <= 1e-3 * ball.radius) {
        if (centre.z + ball.radius > 0.0) {
          mark(0.0, 0.0, 1.0, 1.0);
        }
        continue;
      }
      // A box about the ball, its front as near as the ball: wider than the ball's outline.
      const Vec3 p = ball.centre - camera.position_mm;
      const auto range = [&](double at, double slope) {
        const double low = std::min((at - ball.radius) / nearest, (at - ball.radius) / (centre.z + ball.radius));
        const double high = std::max((at + ball.radius) / nearest, (at + ball.radius) / (centre.z + ball.radius));
        return std::pair{0.5 + 0.5 * low / slope, 0.5 + 0.5 * high / slope};
      };
      const auto [x0, x1] = range(dot(p, camera.right), camera.tan_half_width);
      const auto [y0, y1] = range(-dot(p, camera.up), camera.tan_half_height);
      mark(x0, y0, x1, y1);
    }
  }
  std::vector<std::uint32_t> tiles;
  for (std::uint32_t i = 0; i < busy.size(); ++i) {
    if (busy[i] != 0) {
      tiles.push_back(i);
    }
  }
  return tiles;
}

std::optional<Error> check_whole(const char* where, int value, int most) {
  if (value < 1 || value > most) {
    return invalid_parameter(where, "must be from 1 to " + std::to_string(most), value);
  }
  return std::nullopt;
}

std::optional<Error> check(const Camera& camera) {
  const double numbers = dot(camera.position_mm, camera.position_mm) + dot(camera.right, camera.right) +
                         dot(camera.up, camera.up) + dot(camera.back, camera.back) + camera.focus_mm +
                         camera.lens_radius_mm;
  if (!std::isfinite(numbers) || !(camera.tan_half_width > 0.0) || !(camera.tan_half_height > 0.0)) {
    return Error{ErrorCode::kInvalidParameter, "camera", "must be finite and have a width and a height"};
  }
  return std::nullopt;
}

}  // namespace

RenderOptions RenderOptions::draft(int width, int height) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.samples = 8;
  options.max_bounces = 3;
  return options;
}

RenderOptions RenderOptions::final_quality(int width, int height) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.samples = 48;
  options.max_bounces = 5;
  return options;
}

std::optional<Error> check(const RenderOptions& options) {
  if (auto error = check_whole("width", options.width, kMaxSide)) {
    return error;
  }
  if (auto error = check_whole("height", options.height, kMaxSide)) {
    return error;
  }
  if (auto error = check_whole("samples", options.samples, kMaxSamples)) {
    return error;
  }
  if (auto error = check_whole("max_bounces", options.max_bounces, 64)) {
    return error;
  }
  if (options.exposure && !(std::isfinite(*options.exposure) && *options.exposure > 0.0)) {
    return invalid_parameter("exposure", "must be finite and > 0", *options.exposure);
  }
  if (options.denoise && options.samples < 2) {
    return invalid_parameter("samples", "must be at least 2 to denoise", options.samples);
  }
  return std::nullopt;
}

double metered_exposure(const Lighting& lighting, const Camera& camera) {
  Vec3 normal = camera.back;
  if (!lighting.lamps.empty() && length(lighting.lamps[0].towards + camera.back) > 0.1) {
    normal = normalized(lighting.lamps[0].towards + camera.back);
  }
  const Colour light = open_irradiance(lighting, normal);
  const double white = (0.2126 * light.r + 0.7152 * light.g + 0.0722 * light.b) / math::kPi;
  constexpr double kWhite = 1.6;  // the tone curve takes this just below white
  return white > 1e-12 ? kWhite / white : 1.0;
}

Expected<Picture> trace(const Scene& scene, const Camera& camera, const RenderOptions& options,
                        const Progress& progress) {
  if (auto error = check(options)) {
    return unexpected(*error);
  }
  if (auto error = check(camera)) {
    return unexpected(*error);
  }
  if (auto error = check(scene)) {
    return unexpected(*error);
  }
  const Error cancelled = {ErrorCode::kCancelled, "render", "cancelled"};
  const Expected<World> world = World::build(scene, progress);
  if (!world) {
    return unexpected(world.error());
  }
  const double exposure = options.exposure ? *options.exposure : metered_exposure(scene.lighting, camera);
  Film film(options.width, options.height);
  const Tracer tracer(scene, *world, camera, options, exposure);
  const std::vector<std::uint32_t> tiles = busy_tiles(scene, *world, camera, options.width, options.height);
  const std::uint32_t across = static_cast<std::uint32_t>((options.width + kTile - 1) / kTile);
  const bool finished = parallel_for(
      tiles.size(),
      [&](std::size_t i) {
        const int left = static_cast<int>(tiles[i] % across) * kTile;
        const int top = static_cast<int>(tiles[i] / across) * kTile;
        for (int y = top; y < std::min(top + kTile, options.height); ++y) {
          for (int x = left; x < std::min(left + kTile, options.width); ++x) {
            tracer.paint(x, y, film);
          }
        }
      },
      progress, "light");
  if (!finished) {
    return unexpected(cancelled);
  }
  Picture picture;
  picture.width = options.width;
  picture.height = options.height;
  picture.backdrop = scene.backdrop;
  picture.rgba.resize(std::size_t(options.width) * options.height * 4);
  if (options.denoise) {
    if (!denoise(film, options.samples, progress)) {
      return unexpected(cancelled);
    }
  }
  const int first_half = options.samples / 2;  // the film keeps two halves; with one sample it is all in the second
  const float weight0 = static_cast<float>(first_half) / static_cast<float>(options.samples);
  for (std::size_t i = 0; i < film.coverage.size(); ++i) {
    const Vec3f light = weight0 * film.light[0][i] + (1.0F - weight0) * film.light[1][i];
    const float shadow = std::clamp(weight0 * film.shadow[0][i] + (1.0F - weight0) * film.shadow[1][i], 0.0F, 1.0F);
    picture.rgba[4 * i] = light.x;
    picture.rgba[4 * i + 1] = light.y;
    picture.rgba[4 * i + 2] = light.z;
    picture.rgba[4 * i + 3] = std::min(1.0F, film.coverage[i] + shadow);
  }
  return picture;
}

}  // namespace anthesis
