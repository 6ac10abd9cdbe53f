#include "anthesis/exchange/vlab_digitised_head.h"

#include <gmock/gmock.h>

namespace anthesis {
namespace {

/// Three stages of a cap of growing size, apex first, with one landmark and the ring.
std::vector<VlabContour> cap() {
  std::vector<VlabContour> contours;
  for (const double size : {1.0, 2.0, 4.0}) {
    VlabContour contour;
    contour.name = "stage";
    contour.through_ends = true;
    for (const Vec3 p : {Vec3{0.0, 1.0, 0.0}, Vec3{0.6, 1.0, 0.0}, Vec3{1.0, 0.6, 0.0}, Vec3{1.0, 0.0, 0.0}}) {
      contour.points.push_back({size * p, 1});
    }
    contour.markers = {{0.9, {}}, {0.8 / size, {}}};
    contours.push_back(contour);
  }
  return contours;
}

TEST(VlabDigitisedHead, HasTheStagesWithTheirMarkers) {
  const Expected<DigitisedHead> head = vlab_digitised_head(cap(), {}, 3.0);
  ASSERT_TRUE(head.has_value()) << to_string(head.error());
  ASSERT_EQ(head->sections.size(), 3u);
  EXPECT_EQ(head->sections[1].landmarks, std::vector<double>{0.9});
  EXPECT_EQ(head->sections[1].ring, 0.4);
  const GrowingReceptacle grown(*head);
  EXPECT_NEAR(grown.point(0.0, 0.0).y, 3.0, 1e-9);
  EXPECT_NEAR(grown.point(1.0, 1.0).x, 12.0, 1e-9);
  EXPECT_NEAR(grown.point(1.0, 1.0).y, 0.0, 1e-9);
}

TEST(VlabDigitisedHead, PutsWhatOvershootsTheAxisOnIt) {
  std::vector<VlabContour> contours = cap();
  contours[0].points[0].position.x = -0.005;
  const Expected<DigitisedHead> head = vlab_digitised_head(contours, {});
  ASSERT_TRUE(head.has_value()) << to_string(head.error());
  EXPECT_EQ(head->sections[0].profile.controls[0].x, 0.0);
  contours[0].points[0].position.x = 0.005;
  EXPECT_EQ(vlab_digitised_head(contours, {})->sections[0].profile.controls[0].x, 0.0);
  contours[0].points[0].position.x = -0.05;
  EXPECT_FALSE(vlab_digitised_head(contours, {}).has_value());
}

TEST(VlabDigitisedHead, NamesWhatIsWrong) {
  std::vector<VlabContour> contours = cap();
  contours[2].markers.back().s = -0.25;
  const Expected<DigitisedHead> head = vlab_digitised_head(contours, {});
  ASSERT_FALSE(head.has_value());
  EXPECT_THAT(to_string(head.error()), testing::StartsWith("contours.sections[2].ring "));
  contours.pop_back();
  EXPECT_FALSE(vlab_digitised_head(contours, {}).has_value());
}

}  // namespace
}  // namespace anthesis
