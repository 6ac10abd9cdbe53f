#include "anthesis/render/scene_of_veins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "anthesis/base/math.h"
#include "anthesis/render/path_tracer.h"

namespace anthesis {
namespace {

/// A head like half a ball of radius 2.
std::vector<Vec2> dome() {
  std::vector<Vec2> outline;
  for (int i = 0; i <= 20; ++i) {
    const auto [sine, cosine] = math::sin_cos(0.5 * math::kPi * i / 20.0);
    outline.push_back({2.0 * sine, 2.0 * cosine});
  }
  outline.front().x = 0.0;
  return outline;
}

/// Twelve strands that go straight up from the base and then out to the surface, the kinds in turn.
struct HeadOfSpokes {
  Vasculature veins;
  std::vector<VeinPrimordium> primordia;
};

HeadOfSpokes spokes() {
  HeadOfSpokes head;
  constexpr std::uint32_t kStrands = 12;
  constexpr double kHeights[] = {0.0, 0.5, 1.0};
  head.veins.ring_vertices = kStrands;
  for (std::uint32_t level = 0; level < 3; ++level) {
    for (std::uint32_t i = 0; i < kStrands; ++i) {
      const auto [sine, cosine] = math::sin_cos(math::kTurnRad * i / kStrands);
      const double radius = level < 2 ? 0.8 : 1.7;
      VeinVertex vertex;
      vertex.position = {radius * cosine, radius * sine, kHeights[level]};
      vertex.parent = level > 0 ? (level - 1) * kStrands + i : kNoVertex;
      vertex.kind = static_cast<VeinKind>(i % 3);
      vertex.diameter = 0.1;
      head.veins.vertices.push_back(vertex);
      if (level == 2) {
        head.veins.primordia.push_back(level * kStrands + i);
        VeinPrimordium primordium;
        primordium.id = i;
        primordium.kind = i % 2 == 0 ? PrimordiumKind::kBract : PrimordiumKind::kFloret;
        head.primordia.push_back(primordium);
      }
    }
  }
  return head;
}

Scene scene_of(const VeinSceneOptions& options, const HeadOfSpokes& head = spokes()) {
  auto scene = make_scene(head.veins, dome(), head.primordia, options);
  EXPECT_TRUE(scene.has_value()) << to_string(scene.error());
  EXPECT_FALSE(check(*scene).has_value()) << to_string(*check(*scene));
  return std::move(*scene);
}

/// All vertices of triangles.
std::vector<Vec3> drawn(const Scene& scene) {
  std::vector<Vec3> points;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh].mesh;
    for (const Triangle& triangle : mesh.triangles) {
      for (const std::uint32_t i : triangle) {
        points.push_back(apply(instance.world_from_mesh, mesh.positions_mm[i]));
      }
    }
  }
  return points;
}

Vec3 towards_viewer(const View& view) {
  const auto [sine, cosine] = math::sin_cos(view.azimuth_rad);
  return {cosine, sine, 0.0};
}

TEST(SceneOfVeins, EachKindOfStrandHasAPigmentOfItsOwn) {
  const Scene scene = scene_of({});
  const SceneMesh& strands = scene.meshes[0];
  ASSERT_EQ(strands.spans.size(), 3U);
  std::size_t triangles = 0;
  for (const PigmentSpan& span : strands.spans) {
    EXPECT_GT(span.triangle_count, 0U);
    triangles += span.triangle_count;
  }
  EXPECT_EQ(triangles, strands.mesh.triangles.size());
  EXPECT_NE(strands.spans[0].pigment, strands.spans[1].pigment);
  EXPECT_NE(strands.spans[1].pigment, strands.spans[2].pigment);
}

TEST(SceneOfVeins, TheReceptacleHoldsAllStrandsAndCanBeSeenThrough) {
  const Scene scene = scene_of({});
  const auto film = std::find_if(scene.instances.begin(), scene.instances.end(),
                                 [](const Instance& instance) { return instance.veil.has_value(); });
  ASSERT_NE(film, scene.instances.end());
  // A body of revolution: each of its points is as far from the middle of the ball, to the skin's thickness.
  for (const Vec3& p : scene.meshes[film->mesh].mesh.positions_mm) {
    EXPECT_GT(length(p), 2.0);
    EXPECT_LT(length(p), 2.1);
  }
  VeinSceneOptions bare;
  bare.receptacle = false;
  for (const Instance& instance : scene_of(bare).instances) {
    EXPECT_FALSE(instance.veil.has_value());
  }
}

TEST(SceneOfVeins, AHalfHeadHasNothingBeforeThePlaneThatFacesTheViewer) {
  for (const double azimuth_rad : {-1.57, 0.3, 2.9}) {
    VeinSceneOptions options;
    options.view.azimuth_rad = azimuth_rad;
    options.cut = HeadCut::kHalf;
    options.primordia = true;
    double farthest = 0.0;
    for (const Vec3& p : drawn(scene_of(options))) {
      const double before = dot(p, towards_viewer(options.view));
      EXPECT_LE(before, 1e-9);
      farthest = std::min(farthest, before);
    }
    EXPECT_LT(farthest, -2.0);
  }
}

TEST(SceneOfVeins, ASliceIsAsThickAsAskedAndAsWideAsTheHead) {
  VeinSceneOptions options;
  options.view.azimuth_rad = 0.2;
  options.cut = HeadCut::kSlice;
  options.slice = 0.3;
  options.primordia = true;
  double nearest = 0.0;
  double farthest = 0.0;
  double widest = 0.0;
  const Vec3 towards = towards_viewer(options.view);
  for (const Vec3& p : drawn(scene_of(options))) {
    nearest = std::max(nearest, dot(p, towards));
    farthest = std::min(farthest, dot(p, towards));
    widest = std::max(widest, length(p - dot(p, towards) * towards));
  }
  EXPECT_NEAR(nearest, 0.6, 1e-9);  // strands are cut on both sides
  EXPECT_NEAR(farthest, -0.6, 1e-9);
  EXPECT_NEAR(widest, 2.0, 0.1);
}

TEST(SceneOfVeins, TheCameraFramesTheHeadWhateverIsCutAway) {
  VeinSceneOptions options;
  const Camera whole = frame(scene_of(options), options.view, 3, 2);
  for (const HeadCut cut : {HeadCut::kHalf, HeadCut::kSlice}) {
    options.cut = cut;
    const Camera camera = frame(scene_of(options), options.view, 3, 2);
    EXPECT_EQ(camera.position_mm, whole.position_mm);
  }
}

TEST(SceneOfVeins, FramesOfAnAnimationShareOneScale) {
  VeinSceneOptions options;
  options.view = View::side();
  options.scale_bar = true;
  options.extent = HeadExtent{3.0, -1.0, 4.0};
  const HeadOfSpokes head = spokes();
  const Camera grown = frame(scene_of(options, head), options.view, 1, 1);
  const std::vector<Vec2> young_outline = {{0.0, 0.2}, {0.1, 0.1}, {0.1, 0.0}};
  const auto young = make_scene(Vasculature{}, young_outline, {}, options);
  ASSERT_TRUE(young.has_value());
  EXPECT_EQ(frame(*young, options.view, 1, 1).position_mm, grown.position_mm);
  // The whole cylinder is in the picture.
  for (const Vec3 p : {Vec3{3, 0, -1}, Vec3{-3, 0, 4}, Vec3{0, -3, 4}}) {
    const Vec3 at = grown.project(p);
    EXPECT_GT(std::min(at.x, at.y), 0.0);
    EXPECT_LT(std::max(at.x, at.y), 1.0);
  }
}

TEST(SceneOfVeins, TheExtentOfAnOutlineIsItsBox) {
  const HeadExtent extent = extent_of(dome());
  EXPECT_DOUBLE_EQ(extent.radius_mm, 2.0);
  EXPECT_NEAR(extent.lowest_mm, 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(extent.highest_mm, 2.0);
}

TEST(SceneOfVeins, TheScaleBarIsARoundNumberAtMostHalfTheRadius) {
  EXPECT_DOUBLE_EQ(scale_bar_mm(2.0), 1.0);
  EXPECT_DOUBLE_EQ(scale_bar_mm(3.9), 1.0);
  EXPECT_DOUBLE_EQ(scale_bar_mm(4.0), 2.0);
  EXPECT_DOUBLE_EQ(scale_bar_mm(10.0), 5.0);
  EXPECT_DOUBLE_EQ(scale_bar_mm(0.3), 0.1);
  EXPECT_DOUBLE_EQ(scale_bar_mm(0.0041), 0.002);
}

TEST(SceneOfVeins, TheScaleBarLiesBelowTheHeadAndIsTrueToScale) {
  for (const View& view : {View::side(), View::front(), View::top(), View::bottom(), View::three_quarter()}) {
    VeinSceneOptions options;
    options.view = view;
    const Scene plain = scene_of(options);
    options.scale_bar = true;
    const Scene scene = scene_of(options);
    ASSERT_EQ(scene.instances.size(), plain.instances.size() + 1);
    const Camera camera = frame(scene, view, 1, 1);
    double lowest = 0.0;
    for (const Vec3& p : drawn(plain)) {
      lowest = std::max(lowest, camera.project(p).y);
    }
    const Mesh& bar = scene.meshes[scene.instances[scene.instances.size() - 2].mesh].mesh;
    double left = 1e9;
    double right = -1e9;
    for (const Vec3& p : bar.positions_mm) {
      left = std::min(left, dot(p, camera.right));
      right = std::max(right, dot(p, camera.right));
      EXPECT_GT(camera.project(p).y, lowest);
      EXPECT_LT(camera.project(p).y, 1.0);
    }
    EXPECT_NEAR(right - left, scale_bar_mm(2.0), 1e-9);
  }
}

TEST(SceneOfVeins, ABeadStandsWhereEachPrimordiumIs) {
  VeinSceneOptions options;
  options.primordia = true;
  HeadOfSpokes head = spokes();
  head.veins.primordia[3] = kNoVertex;  // not yet born
  const Scene scene = scene_of(options, head);
  std::size_t beads = 0;
  for (const Instance& instance : scene.instances) {
    const Vec3 at = instance.world_from_mesh.position_mm;
    const bool bead = std::ranges::any_of(
        head.veins.primordia, [&](std::uint32_t v) { return v != kNoVertex && head.veins.vertices[v].position == at; });
    beads += bead ? 1 : 0;
  }
  EXPECT_EQ(beads, 11U);
}

TEST(SceneOfVeins, AYoungHeadWithoutVeinsIsARenderedReceptacle) {
  VeinSceneOptions options;
  options.cut = HeadCut::kSlice;
  const auto scene = make_scene(Vasculature{}, dome(), {}, options);
  ASSERT_TRUE(scene.has_value());
  EXPECT_FALSE(check(*scene).has_value());
  EXPECT_FALSE(drawn(*scene).empty());
}

TEST(SceneOfVeins, StrandsShowThroughTheReceptacle) {
  VeinSceneOptions options;
  options.view = View::side();
  RenderOptions render = RenderOptions::draft(60, 60);
  const auto picture_of = [&](bool receptacle) {
    options.receptacle = receptacle;
    Scene scene = scene_of(options);
    const Camera camera = frame(scene, options.view, 60, 60);
    scene.lighting = studio_lighting(camera);
    return trace(scene, camera, render).value();
  };
  const Picture naked = picture_of(false);
  const Picture veiled = picture_of(true);
  double difference = 0.0;
  double light = 0.0;
  for (std::size_t i = 0; i < naked.rgba.size(); i += 4) {
    if (naked.rgba[i + 3] == 1.0F) {
      difference += std::abs(veiled.rgba[i] - naked.rgba[i]);
      light += naked.rgba[i];
    }
  }
  EXPECT_GT(light, 1.0);
  EXPECT_LT(difference, 0.15 * light);
}

TEST(SceneOfVeins, NamesWhatIsWrong) {
  const HeadOfSpokes head = spokes();
  const auto where = [&](auto spoil) {
    VeinSceneOptions options;
    options.extent = HeadExtent{};
    options.primordia = true;
    HeadOfSpokes spoilt = head;
    std::vector<Vec2> outline = dome();
    spoil(options, spoilt, outline);
    const auto scene = make_scene(spoilt.veins, outline, spoilt.primordia, options);
    return scene ? std::string("nothing") : scene.error().where;
  };
  using Options = VeinSceneOptions;
  using Outline = std::vector<Vec2>;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(where([](Options&, HeadOfSpokes&, Outline&) {}), "nothing");
  EXPECT_EQ(where([](Options& o, HeadOfSpokes&, Outline&) { o.slice = 0.0; }), "slice");
  EXPECT_EQ(where([](Options& o, HeadOfSpokes&, Outline&) { o.haze = 1.5; }), "haze");
  EXPECT_EQ(where([](Options& o, HeadOfSpokes&, Outline&) { o.view.margin = 1.0; }), "view.margin");
  EXPECT_EQ(where([](Options& o, HeadOfSpokes&, Outline&) { o.tubes.sides = 2; }), "tubes.sides");
  EXPECT_EQ(where([](Options& o, HeadOfSpokes&, Outline&) { o.extent->radius_mm = 0.0; }), "extent.radius_mm");
  EXPECT_EQ(where([&](Options& o, HeadOfSpokes&, Outline&) { o.extent->lowest_mm = nan; }), "extent.lowest_mm");
  EXPECT_EQ(where([](Options& o, HeadOfSpokes&, Outline&) { o.extent->highest_mm = -1.0; }), "extent.highest_mm");
  EXPECT_EQ(where([](Options&, HeadOfSpokes&, Outline& p) { p.resize(1); }), "outline_mm");
  EXPECT_EQ(where([](Options&, HeadOfSpokes&, Outline& p) { p.assign(5, Vec2{1, 1}); }), "outline_mm");
  EXPECT_EQ(where([&](Options&, HeadOfSpokes&, Outline& p) { p[3].y = nan; }), "outline_mm[3]");
  EXPECT_EQ(where([](Options&, HeadOfSpokes&, Outline& p) { p[4].x = -1.0; }), "outline_mm[4]");
  EXPECT_EQ(where([](Options&, HeadOfSpokes& h, Outline&) { h.primordia.pop_back(); }), "primordia");
  EXPECT_EQ(where([](Options&, HeadOfSpokes& h, Outline&) { h.veins.primordia[2] = 999; }), "veins.primordia[2]");
}

}  // namespace
}  // namespace anthesis
