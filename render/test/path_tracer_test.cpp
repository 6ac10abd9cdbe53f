#include "anthesis/render/path_tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "../src/bsdf.h"
#include "../src/sampler.h"
#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"

namespace anthesis {
namespace {

/// A square sheet in the plane z = 0, far wider than what the camera sees.
Scene sheet(const Pigment& pigment) {
  Scene scene;
  scene.pigments = {pigment};
  SceneMesh mesh;
  mesh.mesh.positions_mm = {{-100, -100, 0}, {100, -100, 0}, {100, 100, 0}, {-100, 100, 0}};
  mesh.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.push_back(mesh);
  scene.instances.emplace_back();
  return scene;
}

Pigment matt(double grey, double translucency) {
  Pigment pigment;
  pigment.colour = {{0.0, {grey, grey, grey}}};
  pigment.mottle = 0.0;
  pigment.specular = 0.0;
  pigment.sheen = 0.0;
  pigment.translucency = translucency;
  return pigment;
}

Lighting darkness() {
  Lighting lighting;
  lighting.sky = {{0, 0, 1}, {}, {}, {}, {}};
  return lighting;
}

Camera above() {
  Camera camera;
  camera.position_mm = {3, 5, 50};
  return camera;
}

RenderOptions small(int samples = 16) {
  RenderOptions options;
  options.width = 24;
  options.height = 16;
  options.samples = samples;
  options.exposure = 1.0;
  options.denoise = false;
  return options;
}

double mean(const Picture& picture, int channel) {
  double sum = 0.0;
  for (std::size_t i = static_cast<std::size_t>(channel); i < picture.rgba.size(); i += 4) {
    sum += picture.rgba[i];
  }
  return 4.0 * sum / static_cast<double>(picture.rgba.size());
}

Picture traced(const Scene& scene, const RenderOptions& options, const Camera& camera = above()) {
  auto picture = trace(scene, camera, options);
  EXPECT_TRUE(picture.has_value()) << to_string(picture.error());
  return picture.value_or(Picture{});
}

TEST(Trace, AWhiteSheetInAnEvenSkyCannotBeSeen) {
  for (const double translucency : {0.0, 0.3, 1.0}) {
    const Picture picture = traced(sheet(matt(1.0, translucency)), small());
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
      EXPECT_NEAR(picture.rgba[i], 1.0, 1e-4);  // the density of the paths fits the light: no noise at all
    }
  }
}

TEST(Trace, AWhiteBallInAnEvenSkyCannotBeSeenEither) {
  // Closed, curved and lit as smooth: what facets and lifted rays get wrong shows here. Its paths all leave at once.
  Scene scene;
  scene.pigments = {matt(1.0, 0.0)};
  scene.meshes.push_back({unit_sphere(), {}});
  scene.instances.emplace_back();
  scene.instances[0].world_from_mesh.scale = 7.0;
  const Camera camera = frame(scene, View::front(), 1, 1);
  const Picture picture = traced(scene, small(64), camera);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    if (picture.rgba[i + 3] == 1.0F) {
      EXPECT_NEAR(picture.rgba[i], 1.0, 0.03);
    }
  }
}

TEST(Trace, AMattPlaneUnderASunHasTheRadianceOfLambertsLaw) {
  Scene scene = sheet(matt(0.5, 0.0));
  scene.lighting = darkness();
  const double tilt = math::radians(40.0);
  scene.lighting.lamps = {{{math::sin(tilt), 0.0, math::cos(tilt)}, 0.05, {3.0, 2.0, 1.0}}};
  const Picture picture = traced(scene, small(64));
  // The mean cosine over a round lamp is that of its centre times (1 + cos a) / 2 in solid angle, which the definition
  // of irradiance on a facing surface divides out again.
  const double expected = 0.5 / math::kPi * math::cos(tilt);
  EXPECT_NEAR(mean(picture, 0), 3.0 * expected, 0.003);
  EXPECT_NEAR(mean(picture, 1), 2.0 * expected, 0.003);
  EXPECT_NEAR(mean(picture, 2), 1.0 * expected, 0.003);
}

TEST(Trace, LightFromBehindShinesThroughInProportionToTranslucency) {
  for (const double translucency : {0.0, 0.2, 0.4, 0.8}) {
    Scene scene = sheet(matt(0.6, translucency));
    scene.lighting = darkness();
    scene.lighting.lamps = {{{0.0, 0.0, -1.0}, 0.05, {4.0, 4.0, 4.0}}};
    const double expected = translucency * 0.6 * 4.0 / math::kPi;
    EXPECT_NEAR(mean(traced(scene, small(32)), 1), expected, 0.002 + 0.002 * expected);
  }
}

TEST(Trace, LightThatPassedThroughIsDeeperInColour) {
  Pigment yellow = matt(0.5, 0.5);
  yellow.colour = {{0.0, {0.9, 0.6, 0.1}}};
  Scene scene = sheet(yellow);
  scene.lighting = darkness();
  scene.lighting.lamps = {{{0.0, 0.0, -1.0}, 0.05, {2.0, 2.0, 2.0}}};
  const Picture behind = traced(scene, small());
  scene.lighting.lamps[0].towards = {0.0, 0.0, 1.0};
  const Picture front = traced(scene, small());
  EXPECT_LT(mean(behind, 2) / mean(behind, 0), 0.6 * mean(front, 2) / mean(front, 0));
  EXPECT_NEAR(mean(behind, 0), mean(front, 0), 0.01);
}

TEST(Trace, ABallCastsShadowsOnASheet) {
  Scene scene = sheet(matt(0.5, 0.0));
  scene.lighting = darkness();
  scene.lighting.lamps = {{{0.0, 0.0, 1.0}, 0.02, {3.0, 3.0, 3.0}}};
  Camera camera = above();
  camera.position_mm = {0, 0, 20};
  camera.tan_half_width = camera.tan_half_height = 0.05;
  const double open = mean(traced(scene, small(), camera), 0);
  scene.meshes.push_back({unit_sphere(), {}});
  Instance lid;
  lid.mesh = 1;
  lid.world_from_mesh = {{0, 0, 60}, {}, 15.0};
  scene.instances.push_back(lid);
  EXPECT_GT(open, 0.4);
  EXPECT_LT(mean(traced(scene, small(), camera), 0), 0.05);
}

TEST(Trace, AnInstanceWearsItsOwnColour) {
  Scene scene = sheet(matt(0.5, 0.0));
  scene.instances[0].colour = Colour{0.1, 0.2, 0.3};
  const Picture picture = traced(scene, small());
  EXPECT_NEAR(mean(picture, 0), 0.1, 1e-4);
  EXPECT_NEAR(mean(picture, 2), 0.3, 1e-4);
}

TEST(Bsdf, NeverReturnsMoreThanItReceives) {
  for (const float roughness : {0.1F, 0.3F, 0.6F, 1.0F}) {
    for (const float specular : {0.0F, 0.3F, 1.0F}) {
      for (const float cosine : {0.05F, 0.3F, 0.7F, 1.0F}) {
        const Bsdf bsdf({Vec3f(1.0F), roughness, specular, 1.0F, 0.4F},
                        {std::sqrt(1.0F - cosine * cosine), 0.0F, cosine});
        double sum = 0.0;
        constexpr int kPaths = 4096;
        for (std::uint32_t s = 0; s < kPaths; ++s) {
          Sampler sampler(9, s);
          const auto choice = sampler.next();
          const auto at = sampler.next();
          if (const auto sample = bsdf.sample(choice.x, at.x, at.y)) {
            sum += sample->weight.y;
          }
        }
        EXPECT_LE(sum / kPaths, 1.015) << roughness << ' ' << specular << ' ' << cosine;
        EXPECT_GE(sum / kPaths, 0.5) << roughness << ' ' << specular << ' ' << cosine;
      }
    }
  }
}

TEST(Bsdf, SamplesAsDenseAsItsValueSays) {
  // The mean of the sampled weights is the integral of value * cos; here the integral is taken on an even grid instead.
  const float cosine = 0.6F;
  const Bsdf bsdf({{0.8F, 0.5F, 0.1F}, 0.4F, 0.9F, 0.3F, 0.3F}, {0.0F, 0.8F, cosine});
  double sampled = 0.0;
  double integral = 0.0;
  constexpr int kPaths = 16384;
  for (std::uint32_t s = 0; s < kPaths; ++s) {
    Sampler sampler(4, s);
    const auto choice = sampler.next();
    const auto at = sampler.next();
    if (const auto sample = bsdf.sample(choice.x, at.x, at.y)) {
      sampled += sample->weight.x;
    }
    Vec3f direction = cosine_direction(at.x, at.y);
    direction.z = choice.x < 0.5F ? direction.z : -direction.z;
    integral += 2.0 * math::kPi * bsdf.value(direction).x;
  }
  EXPECT_NEAR(sampled / integral, 1.0, 0.01);
}

/// A ring of translucent leaves over a ground: everything that a picture can have.
Scene ring() {
  Pigment pigment = matt(0.5, 0.4);
  pigment.colour = {{0.0, {0.8, 0.4, 0.05}}, {1.0, {0.9, 0.7, 0.1}}};
  pigment.specular = 0.4;
  pigment.sheen = 0.3;
  pigment.veins = 5;
  Scene scene;
  scene.pigments = {pigment};
  scene.meshes.push_back({unit_sphere(), {{0, 1280, 0}}});
  for (int i = 0; i < 9; ++i) {
    Instance instance;
    const double angle = math::kTurnRad * i / 9.0;
    instance.world_from_mesh = {{6.0 * math::cos(angle), 6.0 * math::sin(angle), 3.0}, {}, 2.0};
    instance.variations = {{0.05 * i, 1.0, static_cast<std::uint32_t>(i)}};
    scene.instances.push_back(instance);
  }
  scene.ground = Ground{};
  return scene;
}

TEST(Trace, GivesTheSameBytesForAnyNumberOfThreads) {
  Scene scene = ring();
  const Camera camera = frame(scene, View::three_quarter(), 80, 60);
  scene.lighting = studio_lighting(camera);
  RenderOptions options = RenderOptions::draft(80, 60);
  std::vector<float> first;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    const Picture picture = traced(scene, options, camera);
    if (first.empty()) {
      first = picture.rgba;
    }
    EXPECT_EQ(picture.rgba, first) << threads;
  }
}

TEST(Trace, DenoisingKeepsTheLightAndTakesMostOfTheNoise) {
  Scene scene = ring();
  const Camera camera = frame(scene, View::three_quarter(), 64, 64);
  scene.lighting = studio_lighting(camera);
  RenderOptions options;
  options.width = options.height = 64;
  options.samples = 256;
  options.denoise = false;
  const Picture truth = traced(scene, options, camera);
  options.samples = 8;
  const Picture raw = traced(scene, options, camera);
  options.denoise = true;
  const Picture clean = traced(scene, options, camera);
  double raw_error = 0.0;
  double clean_error = 0.0;
  for (std::size_t i = 0; i < truth.rgba.size(); ++i) {
    raw_error += (raw.rgba[i] - truth.rgba[i]) * (raw.rgba[i] - truth.rgba[i]);
    clean_error += (clean.rgba[i] - truth.rgba[i]) * (clean.rgba[i] - truth.rgba[i]);
  }
  EXPECT_LT(clean_error, 0.5 * raw_error);
  for (int channel = 0; channel < 4; ++channel) {
    EXPECT_NEAR(mean(clean, channel) / mean(raw, channel), 1.0, 0.02) << channel;
  }
}

TEST(Trace, GroundDarkensUnderThePlantAndNowhereElse) {
  Scene scene = ring();
  scene.lighting = {};  // an even white sky
  const Camera camera = frame(scene, View::top(), 96, 96);
  RenderOptions options = small(64);
  options.width = options.height = 96;
  options.denoise = true;
  Camera wide = camera;
  wide.tan_half_width *= 6.0;
  wide.tan_half_height *= 6.0;
  const Picture picture = traced(scene, options, wide);
  const auto alpha = [&](int x, int y) { return picture.rgba[4 * (y * 96 + x) + 3]; };
  EXPECT_GT(alpha(48, 48), 0.1F);  // the gap in the middle of the ring
  EXPECT_LT(alpha(2, 2), 0.02F);
}

TEST(Trace, AGroundDoesNotTakeTheLightOfAPlantSeenFromBelow) {
  Scene scene = ring();
  const Camera camera = frame(scene, View::bottom(), 40, 40);
  scene.lighting = studio_lighting(camera);
  RenderOptions options = small();
  const Picture standing = traced(scene, options, camera);
  scene.ground.reset();
  EXPECT_EQ(standing.rgba, traced(scene, options, camera).rgba);
}

/// The scene's first mesh as a veil.
Instance veil_at(double height, Veil veil) {
  Instance instance;
  instance.world_from_mesh.position_mm = {0, 0, height};
  instance.veil = veil;
  return instance;
}

Veil even_veil(double share) {
  return {.facing = share, .edge = share, .doublings = 0};
}

TEST(Haze, FadesByTheShareOfItsDepth) {
  for (const auto& [height, kept] : {std::pair{0.0, 1.0}, {-5.0, 0.7}, {-10.0, 0.4}, {-20.0, 0.4}}) {
    Scene scene = sheet(matt(0.5, 0.0));
    scene.instances[0].world_from_mesh.position_mm.z = height;
    scene.haze = Haze{.clear_mm = 0.0, .dense_mm = -10.0, .share = 0.6};
    for (const bool filtered : {false, true}) {
      RenderOptions options = small();
      options.denoise = filtered;
      const Picture picture = traced(scene, options);
      EXPECT_NEAR(mean(picture, 1), 0.5 * kept, 1e-3);
      EXPECT_NEAR(mean(picture, 3), kept, 1e-4);
    }
  }
}

TEST(Veil, LetsThroughWhatItDoesNotStop) {
  for (const double stopped : {0.0, 0.1, 0.5, 1.0}) {
    Scene scene = sheet(matt(0.8, 0.0));  // under an even sky: radiance 0.8 without the veil
    scene.pigments.push_back(matt(0.0, 0.0));
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes[1].spans = {{0, 2, 1}};
    scene.instances.push_back(veil_at(10.0, even_veil(stopped)));
    scene.instances[1].mesh = 1;
    // The camera is far above: light crosses the black veil on its way to the sheet and once more on its way back.
    const double passed = 1.0 - stopped;
    EXPECT_NEAR(mean(traced(scene, small(256)), 0), 0.8 * passed * passed, 0.002 + 0.004 * passed) << stopped;
  }
}

TEST(Veil, DimsALampByWhatItStops) {
  for (const double stopped : {0.2, 0.7}) {
    Scene scene = sheet(matt(0.5, 0.0));
    scene.pigments.push_back(matt(0.0, 0.0));
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes[1].spans = {{0, 2, 1}};
    scene.lighting = darkness();
    scene.lighting.lamps = {{{0.0, 0.0, 1.0}, 0.02, {math::kPi, math::kPi, math::kPi}}};
    scene.instances.push_back(veil_at(60.0, even_veil(stopped)));  // beyond the camera
    scene.instances[1].mesh = 1;
    const Picture picture = traced(scene, small());
    EXPECT_NEAR(mean(picture, 0), 0.5 * (1.0 - stopped), 1e-3);
    EXPECT_EQ(mean(picture, 3), 1.0);
  }
}

TEST(Veil, OfAlmostNothingLeavesThePictureAsItIs) {
  Scene scene = ring();
  const Camera camera = frame(scene, View::three_quarter(), 24, 16);
  scene.lighting = studio_lighting(camera);
  RenderOptions options = small();
  options.denoise = true;
  const Picture without = traced(scene, options, camera);
  scene.instances.push_back(veil_at(3.0, {.facing = 0.0, .edge = 0.0}));
  scene.instances.back().world_from_mesh.scale = 2.0;
  EXPECT_EQ(traced(scene, options, camera).rgba, without.rgba);
  scene.instances.back().veil = even_veil(1e-6);
  const Picture faint = traced(scene, options, camera);
  for (std::size_t i = 0; i < faint.rgba.size(); ++i) {
    EXPECT_NEAR(faint.rgba[i], without.rgba[i], 1e-3);
  }
}

TEST(Veil, ThatStopsAllIsAsGoodAsSolid) {
  Scene scene = ring();
  const Camera camera = frame(scene, View::three_quarter(), 24, 16);
  scene.lighting = studio_lighting(camera);
  const Picture solid = traced(scene, small(64), camera);
  for (Instance& instance : scene.instances) {
    instance.veil = even_veil(1.0);
  }
  const Picture veiled = traced(scene, small(64), camera);
  for (int channel = 0; channel < 4; ++channel) {
    EXPECT_NEAR(mean(veiled, channel) / mean(solid, channel), 1.0, 0.01) << channel;
  }
}

TEST(Veil, AWhiteOneInAnEvenSkyCannotBeSeen) {
  // Whatever it stops comes back as bright: no light is lost or made, on straight ways or scattered ones.
  for (const double facing : {0.01, 0.3}) {
    Scene scene;
    scene.pigments = {matt(1.0, 0.5)};
    scene.meshes.push_back({unit_sphere(), {}});
    for (const double size : {1.0, 1.5, 2.0}) {
      scene.instances.emplace_back();
      scene.instances.back().world_from_mesh.scale = size;
      scene.instances.back().veil = Veil{.facing = facing, .edge = 3.0 * facing, .doublings = 2};
    }
    RenderOptions options = small(256);
    options.max_bounces = 64;
    const Picture picture = traced(scene, options, frame(scene, View::front(), 24, 16));
    double light = 0.0;
    double coverage = 0.0;
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
      light += picture.rgba[i];
      coverage += picture.rgba[i + 3];
    }
    EXPECT_GT(coverage, 200.0 * facing);
    EXPECT_NEAR(light / coverage, 1.0, 0.01) << facing;
  }
}

TEST(Veil, IsDenseWhereItIsSeenEdgeOn) {
  Scene scene;
  scene.pigments = {matt(1.0, 0.5)};
  scene.meshes.push_back({unit_sphere(), {}});
  scene.instances.emplace_back();
  scene.instances[0].veil = Veil{.facing = 0.02, .edge = 0.9, .doublings = 3};
  RenderOptions options = small();
  options.width = options.height = 101;
  const Camera camera = frame(scene, View::front(), 1, 1);
  const Picture picture = traced(scene, options, camera);
  const auto coverage = [&](int x) { return static_cast<double>(picture.rgba[4 * (50 * 101 + x) + 3]); };
  EXPECT_NEAR(coverage(50), 1.0 - 0.98 * 0.98, 1e-4);  // the near side and the far one
  double densest = 0.0;
  for (int x = 0; x < 50; ++x) {
    densest = std::max(densest, coverage(x));
  }
  EXPECT_GT(densest, 0.4);  // over a pixel's width
  EXPECT_EQ(coverage(1), 0.0);
}

TEST(Veil, DoesNotShadeWhatPassesThroughMoreSurfacesThanAPathMayMeet) {
  // Twenty films of 1 %, one bounce: what is below shows through them all.
  Scene scene = sheet(matt(1.0, 0.0));
  for (int i = 0; i < 20; ++i) {
    scene.instances.push_back(veil_at(1.0 + i, even_veil(0.01)));
  }
  RenderOptions options = small(64);
  options.max_bounces = 1;
  EXPECT_GT(mean(traced(scene, options), 0), 0.8);
}

TEST(Veil, GivesTheSameBytesForAnyNumberOfThreads) {
  Scene scene = ring();
  scene.instances.push_back(veil_at(3.0, {}));
  scene.instances.back().world_from_mesh.scale = 9.0;
  const Camera camera = frame(scene, View::three_quarter(), 80, 60);
  scene.lighting = studio_lighting(camera);
  std::vector<float> first;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    const Picture picture = traced(scene, RenderOptions::draft(80, 60), camera);
    if (first.empty()) {
      first = picture.rgba;
    }
    EXPECT_EQ(picture.rgba, first) << threads;
  }
}

TEST(Veil, LetsTheFilterOfNoiseSeeTheRimsBehindIt) {
  // A dark ball before a light sheet: the film over them makes the filtered picture no worse.
  const auto error = [](double stopped) {
    Scene scene = sheet(matt(0.8, 0.0));
    scene.meshes.push_back({unit_sphere(), {}});
    Instance ball;
    ball.mesh = 1;
    ball.world_from_mesh = {{3, 5, 1}, {}, 4.0};
    ball.colour = Colour{0.05, 0.05, 0.05};
    scene.instances.push_back(ball);
    scene.instances.push_back(veil_at(20.0, even_veil(stopped)));
    RenderOptions options = small(16);
    options.width = options.height = 64;
    options.denoise = true;
    const Picture clean = traced(scene, options);
    options.denoise = false;
    options.samples = 256;
    const Picture truth = traced(scene, options);
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.rgba.size(); i += 4) {
      sum += (clean.rgba[i] - truth.rgba[i]) * (clean.rgba[i] - truth.rgba[i]);
    }
    return sum;
  };
  EXPECT_LT(error(0.1), 1.2 * error(0.0));
}

TEST(Trace, CanBeCancelledInEveryStage) {
  Scene scene = ring();
  const Camera camera = frame(scene, View::top(), 64, 64);
  for (const std::string_view stage : {"geometry", "light", "noise"}) {
    bool reached = false;
    const auto picture = trace(scene, camera, RenderOptions::draft(64, 64), [&](std::string_view now, double) {
      reached = reached || now == stage;
      return now != stage;
    });
    EXPECT_TRUE(reached) << stage;
    ASSERT_FALSE(picture.has_value()) << stage;
    EXPECT_EQ(picture.error().code, ErrorCode::kCancelled);
  }
}

TEST(Trace, AnEmptySceneIsItsBackdrop) {
  const Picture picture = traced(Scene{}, small());
  EXPECT_EQ(mean(picture, 3), 0.0);
}

TEST(CheckRenderOptions, NamesTheFieldAndTheValue) {
  EXPECT_FALSE(check(RenderOptions{}).has_value());
  const auto where = [](auto spoil) {
    RenderOptions options;
    spoil(options);
    const auto error = check(options);
    return error ? error->where : std::string("nothing");
  };
  EXPECT_EQ(where([](RenderOptions& o) { o.width = 0; }), "width");
  EXPECT_EQ(where([](RenderOptions& o) { o.height = 16385; }), "height");
  EXPECT_EQ(where([](RenderOptions& o) { o.samples = 65537; }), "samples");
  EXPECT_EQ(where([](RenderOptions& o) { o.samples = 1; }), "samples");
  EXPECT_EQ(where([](RenderOptions& o) { o.max_bounces = 0; }), "max_bounces");
  EXPECT_EQ(where([](RenderOptions& o) { o.exposure = std::numeric_limits<double>::quiet_NaN(); }), "exposure");
  EXPECT_EQ(where([](RenderOptions& o) { o.exposure = 0.0; }), "exposure");
  RenderOptions options;
  options.width = -3;
  EXPECT_EQ(check(options)->message, "must be from 1 to 16384, got -3");
}

}  // namespace
}  // namespace anthesis
