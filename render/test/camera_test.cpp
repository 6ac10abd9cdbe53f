#include "anthesis/render/camera.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "anthesis/base/math.h"

namespace anthesis {
namespace {

/// A lopsided heap of balls with a long stem that is not framed.
Scene heap() {
  Scene scene;
  scene.pigments.emplace_back();
  scene.meshes.push_back({unit_sphere(), {}});
  for (int i = 0; i < 12; ++i) {
    Instance instance;
    instance.world_from_mesh = {
        {3.0 * i, 1.0 * (i % 5), 40.0 + 2.0 * (i % 3)}, rotation_about({1, 0, 0}, 0.3 * i), 1.0 + 0.2 * i};
    scene.instances.push_back(instance);
  }
  Instance stem;
  stem.world_from_mesh = {{0, 0, -500}, {}, 100.0};
  stem.framed = false;
  scene.instances.push_back(stem);
  return scene;
}

struct Bounds {
  double left = 1e9;
  double right = -1e9;
  double top = 1e9;
  double bottom = -1e9;
  double nearest = 1e9;
};

Bounds seen(const Scene& scene, const Camera& camera) {
  Bounds bounds;
  for (const Instance& instance : scene.instances) {
    if (!instance.framed) {
      continue;
    }
    for (const Vec3& p : scene.meshes[instance.mesh].mesh.positions_mm) {
      const Vec3 at = camera.project(apply(instance.world_from_mesh, p));
      bounds.left = std::min(bounds.left, at.x);
      bounds.right = std::max(bounds.right, at.x);
      bounds.top = std::min(bounds.top, at.y);
      bounds.bottom = std::max(bounds.bottom, at.y);
      bounds.nearest = std::min(bounds.nearest, at.z);
    }
  }
  return bounds;
}

TEST(Frame, HoldsEveryVertexInsideTheMarginsAndTouchesTwoOfThem) {
  const Scene scene = heap();
  View low = View::three_quarter();
  low.elevation_rad = math::radians(-70.0);
  low.focal_length_mm = 28.0;
  for (View view : {View::top(), View::side(), View::front(), View::three_quarter(), View::bottom(), low}) {
    view.margin = 0.08;
    for (const auto& [width, height] : {std::pair{600.0, 600.0}, {1600.0, 900.0}, {400.0, 1200.0}}) {
      const Bounds bounds = seen(scene, frame(scene, view, width, height));
      EXPECT_GT(bounds.nearest, 0.0);
      EXPECT_GE(bounds.left, 0.08 - 1e-9);
      EXPECT_LE(bounds.right, 0.92 + 1e-9);
      EXPECT_GE(bounds.top, 0.08 - 1e-9);
      EXPECT_LE(bounds.bottom, 0.92 + 1e-9);
      const bool across = bounds.left < 0.08 + 1e-6 && bounds.right > 0.92 - 1e-6;
      const bool down = bounds.top < 0.08 + 1e-6 && bounds.bottom > 0.92 - 1e-6;
      EXPECT_TRUE(across || down);
    }
  }
}

TEST(Frame, TopLooksDownWithYUpAndSideKeepsTheStemUpright) {
  const Scene scene = heap();
  const Camera top = frame(scene, View::top(), 1, 1);
  EXPECT_NEAR(top.back.z, 1.0, 1e-12);
  EXPECT_NEAR(top.up.y, 1.0, 1e-12);
  EXPECT_NEAR(top.right.x, 1.0, 1e-12);
  const Camera side = frame(scene, View::side(), 1, 1);
  EXPECT_NEAR(side.up.z, 1.0, 1e-12);
}

TEST(Frame, BottomLooksUpAsIfTheTopHadBeenTiltedOver) {
  const Camera bottom = frame(heap(), View::bottom(), 1, 1);
  EXPECT_NEAR(bottom.back.z, -1.0, 1e-12);
  EXPECT_NEAR(bottom.up.y, -1.0, 1e-12);
  EXPECT_NEAR(bottom.right.x, 1.0, 1e-12);
}

TEST(Frame, OfNothingIsStillACamera) {
  const Camera camera = frame(Scene{}, View::front(), 4, 3);
  EXPECT_GT(camera.project({0, 0, 0}).z, 1.0);
}

TEST(ParseView, KnowsItsNamesAndGuessesSlips) {
  for (const char* name : {"top", "side", "front", "three-quarter", "bottom"}) {
    EXPECT_TRUE(parse_view(name).has_value()) << name;
  }
  const auto slip = parse_view("three_quarter");
  ASSERT_FALSE(slip.has_value());
  EXPECT_EQ(slip.error().code, ErrorCode::kUnknownParameter);
  EXPECT_NE(slip.error().message.find("did you mean three-quarter?"), std::string::npos);
  EXPECT_NE(parse_view("botom").error().message.find("did you mean bottom?"), std::string::npos);
}

TEST(CheckView, NamesTheField) {
  EXPECT_FALSE(check(View{}).has_value());
  EXPECT_EQ(check(View{.margin = 0.5})->where, "margin");
  EXPECT_EQ(check(View{.elevation_rad = 2.0})->where, "elevation_rad");
  EXPECT_EQ(check(View{.focal_length_mm = 0.0})->where, "focal_length_mm");
  EXPECT_EQ(check(View{.f_number = -1.0})->where, "f_number");
}

}  // namespace
}  // namespace anthesis
