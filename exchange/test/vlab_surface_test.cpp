#include "anthesis/exchange/vlab_surface.h"

#include <gtest/gtest.h>

#include "anthesis/geometry/bspline.h"
#include "vlab_reference.h"

namespace anthesis {
namespace {

const std::string kHead =
    "-1 1   -1 1   -1 1\n"
    "PRECISION S: 5 T: 5\n"
    "CONTACT POINT  X: 1.0 Y: 2.0 Z: 3.0\n"
    "END POINT  X: 0 Y: 0 Z: 0\n"
    "HEADING  X: 2.0 Y: 0.0 Z: 0.0\n"
    "UP  X: 0.0 Y: 0.0 Z: 0.5\n"
    "SIZE: 4.0\n";

/// A patch whose control point (row, column) is (row, column, row * column).
std::string patch(const std::string& name) {
  std::string text = name +
                     "\nTOP COLOR: 1 DIFFUSE: 0.5 BOTTOM COLOR: 2 DIFFUSE: 0.5\nAL: ~ A: ~ AR: ~\nL: ~ R: other\n"
                     "BL: ~ B: ~ BR: ~\n";
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      text += std::to_string(row) + ' ' + std::to_string(column) + ' ' + std::to_string(row * column) + "  ";
    }
    text += '\n';
  }
  return text;
}

TEST(ReadVlabSurface, KeepsPatchesInRowsAndColumns) {
  const auto surface = read_vlab_surface(kHead + patch("left part") + patch("right"), "a.s");
  ASSERT_TRUE(surface.has_value()) << to_string(surface.error());
  ASSERT_EQ(surface->patches.size(), 2u);
  EXPECT_EQ(surface->patches[0].name, "left part");
  EXPECT_EQ(surface->patches[1].controls[4 * 2 + 3], (Vec3{2.0, 3.0, 6.0}));
  EXPECT_EQ(surface->contact, (Vec3{1.0, 2.0, 3.0}));
  EXPECT_EQ(surface->heading, (Vec3{1.0, 0.0, 0.0}));
}

TEST(ReadVlabSurface, PlacesTheContactPointAtTheOriginAndTheHeadingAlongY) {
  const auto surface = read_vlab_surface(kHead + patch("p"), "a.s");
  ASSERT_TRUE(surface.has_value());
  VlabPatch here;
  here.controls.fill({1.0, 2.0, 3.0});
  here.controls[1] = {1.0, 6.0, 3.0};  // one size beyond the contact point
  const auto placed = vlab_placed_controls(*surface, here);
  EXPECT_EQ(placed[0], Vec3{});
  EXPECT_EQ(placed[1], surface->heading);
}

TEST(ReadVlabSurface, AnUprightSurfaceIsOnlyMovedAndScaled) {
  VlabSurface surface;
  surface.contact = {1.0, 0.0, -1.0};
  surface.size = 2.0;
  VlabPatch here;
  here.controls.fill({4.0, 6.0, 7.0});
  EXPECT_EQ(vlab_placed_controls(surface, here)[0], (Vec3{1.5, 3.0, 4.0}));
}

TEST(ReadVlabSurface, APatchIsItsBezierSurface) {
  const auto surface = read_vlab_surface(kHead + patch("p"), "a.s");
  ASSERT_TRUE(surface.has_value());
  const std::array<Vec3, 16>& controls = surface->patches[0].controls;
  // Equally spaced controls make the surface linear in u and v: (3u, 3v, 9uv).
  for (const double u : {0.0, 0.3, 1.0}) {
    for (const double v : {0.0, 0.6, 1.0}) {
      EXPECT_LT(length(vlab_patch_point(controls, u, v) - Vec3{3.0 * u, 3.0 * v, 9.0 * u * v}), 1e-14);
    }
  }
}

TEST(ReadVlabSurface, SaysWhereWhatAndWhy) {
  const auto error_of = [](const std::string& text) {
    const auto surface = read_vlab_surface(text, "a.s");
    return surface ? "no error" : to_string(surface.error());
  };
  EXPECT_EQ(error_of(kHead), "a.s:8:1: patches must be at least 1, got the end of the file");
  EXPECT_EQ(error_of(kHead + patch("p") + "more\n"), "a.s:18:1: line must have \"TOP\" here, got the end of the file");
  std::string flat = kHead;
  flat.replace(flat.find("X: 2.0"), 6, "X: 0.0");
  EXPECT_EQ(error_of(flat + patch("p")), "a.s:5:10: HEADING must not be zero");
  EXPECT_EQ(error_of("VERSION stedit\n" + kHead), "a.s:1:1: box must be a number, got \"VERSION\"");
}

TEST(VlabReference, SurfacesOfLychnisAreOnePatchEach) {
  ANTHESIS_NEEDS_REFERENCE();
  const auto leaf = read_vlab_surface(test::reference_file("vlab/lychnis/leaf.s"), "leaf.s");
  ASSERT_TRUE(leaf.has_value()) << to_string(leaf.error());
  ASSERT_EQ(leaf->patches.size(), 1u);
  // Its base, the last row, lies about the contact point; its tip, the first, 2.7 further along the heading.
  const auto controls = vlab_placed_controls(*leaf, leaf->patches[0]);
  EXPECT_LT(length(vlab_patch_point(controls, 1.0, 0.5)), 0.05);
  EXPECT_NEAR(vlab_patch_point(controls, 0.0, 0.5).y, 2.65, 0.01);
  const auto petal = read_vlab_surface(test::reference_file("vlab/lychnis/petal.s"), "petal.s");
  ASSERT_TRUE(petal.has_value()) << to_string(petal.error());
  EXPECT_NEAR(length(petal->up), 1.0, 1e-15);
}

}  // namespace
}  // namespace anthesis
