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

constexpr double kStrandRadius = 0.05;

TEST(SceneOfVeins, AHalfHeadHasNothingFartherBeforeThePlaneThanAStrandIsThick) {
  for (const double azimuth_rad : {-1.57, 0.3, 2.9}) {
    VeinSceneOptions options;
    options.view.azimuth_rad = azimuth_rad;
    options.cut = HeadCut::kHalf;
    options.primordia = true;
    const Scene scene = scene_of(options);
    double farthest = 0.0;
    for (const Vec3& p : drawn(scene)) {
      const double before = dot(p, towards_viewer(options.view));
      EXPECT_LE(before, kStrandRadius + 1e-9);
      farthest = std::min(farthest, before);
    }
    EXPECT_LT(farthest, -2.0);
    // The film itself ends at the plane.
    for (const Instance& instance : scene.instances) {
      for (const Vec3& p : scene.meshes[instance.mesh].mesh.positions_mm) {
        EXPECT_TRUE(!instance.veil || dot(p, towards_viewer(options.view)) <= 1e-9);
      }
    }
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
  EXPECT_NEAR(nearest, 0.6, kStrandRadius);  // strands are cut on both sides
  EXPECT_NEAR(farthest, -0.6, kStrandRadius);
  EXPECT_NEAR(widest, 2.0, 0.1);
}

TEST(SceneOfVeins, NoStrandIsShavedLengthwise) {
  VeinSceneOptions options;
  options.view.azimuth_rad = 0.01;  // two of the strands lie nearly in the plane
  for (const HeadCut cut : {HeadCut::kHalf, HeadCut::kSlice}) {
    options.cut = cut;
    options.slice = 0.01;
    const Scene scene = scene_of(options);
    const Scene uncut = scene_of({});
    const Mesh& whole = uncut.meshes[0].mesh;
    const Mesh& strands = scene.meshes[0].mesh;
    ASSERT_FALSE(strands.triangles.empty());
    const auto thinnest = [](const Mesh& mesh) {
      double least = 1e9;
      for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 pa = mesh.positions_mm[a];
        const Vec3 pb = mesh.positions_mm[b];
        const Vec3 pc = mesh.positions_mm[c];
        const double longest = std::max({length(pb - pa), length(pc - pb), length(pa - pc)});
        least = std::min(least, length(cross(pb - pa, pc - pa)) / longest);
      }
      return least;
    };
    EXPECT_GT(thinnest(strands), 0.9 * thinnest(whole));
  }
}

TEST(SceneOfVeins, StrandsThatComeUpAslantEndAtTheBase) {
  HeadOfSpokes head = spokes();
  for (std::uint32_t i = 0; i < 12; ++i) {
    VeinVertex& middle = head.veins.vertices[12 + i];
    middle.position = Vec3{1.5 * middle.position.x, 1.5 * middle.position.y, 0.2};
  }
  double lowest = 1.0;
  for (const Vec3& p : drawn(scene_of({}, head))) {
    lowest = std::min(lowest, p.z);
  }
  EXPECT_NEAR(lowest, 0.0, 1e-3);
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

/// Where points show: least and greatest x and y.
struct Box {
  double left = 1e9;
  double right = -1e9;
  double upper = 1e9;
  double lower = -1e9;
};

Box box_of(const Camera& camera, const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& p : points) {
    const Vec3 at = camera.project(p);
    box.left = std::min(box.left, at.x);
    box.right = std::max(box.right, at.x);
    box.upper = std::min(box.upper, at.y);
    box.lower = std::max(box.lower, at.y);
  }
  return box;
}

TEST(SceneOfVeins, AHeadFillsThePictureAndStandsInItsMiddle) {
  std::vector<Vec2> top;  // wide at the top, with a narrow base
  for (const Vec2 p : dome()) {
    top.push_back({p.x, 0.3 * p.y});
  }
  top.push_back({1.2, -0.5});
  top.push_back({0.6, -1.0});
  std::vector<Vec2> cone;
  for (int i = 0; i <= 20; ++i) {
    cone.push_back({0.05 * i, 4.0 - 0.2 * i});
  }
  View aside;
  aside.azimuth_rad = 2.0;
  aside.elevation_rad = -0.7;
  for (const std::vector<Vec2>& outline : {top, cone}) {
    for (const View& view : {View::side(), View::front(), View::three_quarter(), View::top(), View::bottom(), aside}) {
      VeinSceneOptions options;
      options.view = view;
      for (const double width : {0.5, 1.0, 2.0}) {
        options.scale_bar = false;
        const auto plain = make_scene(Vasculature{}, outline, {}, options);
        ASSERT_TRUE(plain.has_value());
        const Box head = box_of(frame(*plain, view, width, 1.0), drawn(*plain));
        // Centred across, as well as along what is tight; nearly so along the other, in perspective.
        const double across = head.right - head.left;
        const double down = head.lower - head.upper;
        EXPECT_NEAR(std::max(across, down), 0.88, 0.015);
        EXPECT_NEAR(0.5 * (head.left + head.right), 0.5, 1e-3);
        EXPECT_NEAR(0.5 * (head.upper + head.lower), 0.5, down > across ? 0.01 : 0.04);
        options.scale_bar = true;
        const auto scene = make_scene(Vasculature{}, outline, {}, options);
        const Box all = box_of(frame(*scene, view, width, 1.0), drawn(*scene));
        EXPECT_NEAR(std::max(all.right - all.left, all.lower - all.upper), 0.88, 0.02);
        EXPECT_GT(std::min({all.left, 1.0 - all.right, all.upper, 1.0 - all.lower}), 0.05);
      }
    }
  }
}

TEST(SceneOfVeins, FramesOfAnAnimationShareOneScale) {
  const std::vector<Vec2> young_outline = {{0.0, 0.2}, {0.1, 0.1}, {0.1, 0.0}};
  VeinSceneOptions options;
  options.view = View::side();
  options.scale_bar = true;
  options.extent = together(extent_of(young_outline), extent_of(dome()));
  const Camera grown = frame(scene_of(options), options.view, 1, 1);
  const auto young = make_scene(Vasculature{}, young_outline, {}, options);
  ASSERT_TRUE(young.has_value());
  EXPECT_EQ(frame(*young, options.view, 1, 1).position_mm, grown.position_mm);
}

TEST(SceneOfVeins, TheExtentHoldsEveryCircleOfItsHeads) {
  const std::vector<Vec2> vase = {{0, 3}, {1, 3}, {0.5, 2}, {2, 1}, {1.2, 0.9}, {1.5, 0}, {0.5, 0}, {0.7, 0.1}};
  EXPECT_EQ(extent_of(vase).circles_mm, (std::vector<Vec2>{{1.5, 0}, {2, 1}, {1, 3}}));
  EXPECT_DOUBLE_EQ(extent_of(vase).radius_mm(), 2.0);
  const std::vector<Vec2> stalk = {{0.1, 3.5}, {0.1, -5}};
  EXPECT_EQ(together(extent_of(vase), extent_of(stalk)).circles_mm,
            (std::vector<Vec2>{{0.1, -5}, {2, 1}, {1, 3}, {0.1, 3.5}}));
  EXPECT_EQ(together({}, extent_of(vase)).circles_mm, extent_of(vase).circles_mm);
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
    ASSERT_EQ(scene.instances.size(), plain.instances.size() + 2);  // and its length
    const Camera camera = frame(scene, view, 1, 1);
    double lowest = 0.0;
    for (const Vec3& p : drawn(plain)) {
      lowest = std::max(lowest, camera.project(p).y);
    }
    const Mesh& bar = scene.meshes[scene.instances[scene.instances.size() - 3].mesh].mesh;
    const Mesh& label = scene.meshes[scene.instances[scene.instances.size() - 2].mesh].mesh;
    double left = 1e9;
    double right = -1e9;
    for (const Vec3& p : bar.positions_mm) {
      left = std::min(left, dot(p, camera.right));
      right = std::max(right, dot(p, camera.right));
      EXPECT_GT(camera.project(p).y, lowest);
      EXPECT_LT(camera.project(p).y, 1.0);
    }
    EXPECT_NEAR(right - left, scale_bar_mm(2.0), 1e-9);
    ASSERT_FALSE(label.triangles.empty());
    const Box bar_box = box_of(camera, bar.positions_mm);
    const Box letters = box_of(camera, label.positions_mm);
    EXPECT_GT(letters.left, bar_box.right);
    EXPECT_GT(letters.upper, lowest);
    EXPECT_NEAR(letters.upper + letters.lower, bar_box.upper + bar_box.lower, 0.01);
    EXPECT_NEAR(0.5 * (bar_box.left + letters.right), 0.5, 0.01);
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
    options.extent.circles_mm = {{1.0, 0.0}, {1.0, 1.0}};
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
  const auto where_circle = [&](Vec2 circle) {
    return where([&](Options& o, HeadOfSpokes&, Outline&) { o.extent.circles_mm[1] = circle; });
  };
  EXPECT_EQ(where_circle({0.0, 2.0}), "nothing");
  EXPECT_EQ(where_circle({-1.0, 0.0}), "extent.circles_mm[1]");
  EXPECT_EQ(where_circle({1.0, nan}), "extent.circles_mm[1]");
  EXPECT_EQ(where([](Options& o, HeadOfSpokes&, Outline&) {
              o.extent.circles_mm = {{0.0, 1.0}};
            }),
            "extent.circles_mm");
  EXPECT_EQ(where([](Options&, HeadOfSpokes&, Outline& p) { p.resize(1); }), "outline_mm");
  EXPECT_EQ(where([](Options&, HeadOfSpokes&, Outline& p) { p.assign(5, Vec2{1, 1}); }), "outline_mm");
  EXPECT_EQ(where([](Options&, HeadOfSpokes&, Outline& p) { p = {{0, 0}, {0, 1}}; }), "outline_mm");
  EXPECT_EQ(where([&](Options&, HeadOfSpokes&, Outline& p) { p[3].y = nan; }), "outline_mm[3]");
  EXPECT_EQ(where([](Options&, HeadOfSpokes&, Outline& p) { p[4].x = -1.0; }), "outline_mm[4]");
  EXPECT_EQ(where([](Options&, HeadOfSpokes& h, Outline&) { h.primordia.pop_back(); }), "primordia");
  EXPECT_EQ(where([](Options&, HeadOfSpokes& h, Outline&) { h.veins.primordia[2] = 999; }), "veins.primordia[2]");
}

}  // namespace
}  // namespace anthesis
