#include "anthesis/exchange/vlab_contour.h"

#include <gmock/gmock.h>

#include <cmath>

#include "anthesis/geometry/arc_length.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "vlab_reference.h"

namespace anthesis {
namespace {

using testing::HasSubstr;

constexpr const char* kHook =
    "cver 1 3\n"
    "name: hook\n"
    "points: 5 7\n"
    "type: or\n"
    "samples: 50\n"
    "background: scan 1.png\n"
    "backgroundXY: -0.5 0.25\n"
    "markers: 2\n"
    "0 0.75 1.0 2.0\n"
    "1 0.25 0.5 1.0\n"
    "0 3 0 3\n"
    "1 3 0 1\n"
    "2 2.5 0 1\n"
    "3 1 0 1\n"
    "2.5 0 0 1\n";

VlabContour hook() {
  return read_vlab_contours(kHook, "hook.con")->front();
}

std::string error_of(std::string text) {
  const auto contours = read_vlab_contours(text, "a.con");
  return contours ? "no error" : to_string(contours.error());
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ReadVlabContours, KeepsEverythingTheFileSays) {
  const auto read = read_vlab_contours(kHook, "hook.con");
  ASSERT_TRUE(read.has_value()) << to_string(read.error());
  ASSERT_EQ(read->size(), 1u);
  const VlabContour& contour = read->front();
  EXPECT_EQ(contour.name, "hook");
  EXPECT_FALSE(contour.closed);
  EXPECT_FALSE(contour.through_ends);
  EXPECT_EQ(contour.samples, 50);
  EXPECT_EQ(contour.background, "scan 1.png");
  EXPECT_EQ(contour.background_offset, (Vec2{-0.5, 0.25}));
  ASSERT_EQ(contour.markers.size(), 2u);
  EXPECT_EQ(contour.markers[1].s, 0.25);
  EXPECT_EQ(contour.markers[1].position, (Vec2{0.5, 1.0}));
  ASSERT_EQ(contour.points.size(), 5u);
  EXPECT_EQ(contour.points[0].multiplicity, 3);
  EXPECT_EQ(contour.points[4].position, (Vec3{2.5, 0.0, 0.0}));
}

TEST(ReadVlabContours, KnowsAllVersions) {
  const std::string points = "0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n";
  const auto v2 = read_vlab_contours("cver 1 2\nname: a\npoints: 4 4\ntype: ce\n" + points, "a.con");
  ASSERT_TRUE(v2.has_value()) << to_string(v2.error());
  EXPECT_TRUE(v2->front().closed && v2->front().through_ends);
  const auto v1 = read_vlab_contours("cver 1 1\nname: a\npoints: 4 4\ntype: closed\n" + points, "a.con");
  ASSERT_TRUE(v1.has_value()) << to_string(v1.error());
  EXPECT_TRUE(v1->front().closed && !v1->front().through_ends);
  const auto v14 = read_vlab_contours(
      "version: 1.4\ncontact: 0 0 0\nend: 0 0 0\nheading: 0 1 0\nup: 0 0 -1\nsize: 1\npoints: 4\nrange: 0.0 1.0\n"
      "dimension: 4\ntype: bspline\n" +
          points,
      "a.con");
  ASSERT_TRUE(v14.has_value()) << to_string(v14.error());
  EXPECT_EQ(v14->front().points.size(), 4u);
  const auto oldest = read_vlab_contours("4 2 open\r\n0 0\r\n1 0\r\n1 1\r\n0 1\r\n", "a.con");
  ASSERT_TRUE(oldest.has_value()) << to_string(oldest.error());
  EXPECT_EQ(oldest->front().points.back().position, (Vec3{0.0, 1.0, 0.0}));
}

TEST(ReadVlabContours, SaysWhereWhatAndWhy) {
  EXPECT_EQ(error_of(replaced(kHook, "3 1 0 1", "3 1 0 x")),
            "a.con:14:7: multiplicity must be a whole number from 1 to 10000, got \"x\"");
  EXPECT_EQ(error_of(replaced(kHook, "3 1 0 1", "3 1 nan 1")), "a.con:14:5: z must be a number, got \"nan\"");
  EXPECT_EQ(error_of(replaced(kHook, "3 1 0 1", "3 1e31 0 1")),
            "a.con:14:3: y must be between -1e+30 and 1e+30, got \"1e31\"");
  EXPECT_EQ(error_of(replaced(kHook, "3 1 0 1", "3 1 0 1 7")), "a.con:14:9: line must end here, got \"7\"");
  EXPECT_EQ(error_of(replaced(kHook, "points: 5 7", "points: 5 8")),
            "a.con:3:1: points must state the sum of the multiplicities, 7, got 8");
  EXPECT_EQ(error_of(replaced(kHook, "points: 5 7", "points: 6 7")),
            "a.con:16:1: x must be a number, got the end of the file");
  EXPECT_EQ(error_of(replaced(kHook, "type: or", "type: os")),
            "a.con:4:7: type must be one of or, cr, oe, ce, got \"os\"");
  EXPECT_EQ(error_of(replaced(kHook, "1 0.25", "2 0.25")),
            "a.con:10:1: marker must be a whole number from 1 to 1, got \"2\"");
  EXPECT_EQ(error_of(replaced(kHook, "0 0.75", "0 1.75")), "a.con:9:3: s must be between 0 and 1, got \"1.75\"");
  EXPECT_EQ(error_of("cver 1 3\nname: a\npoints: 1 3\ntype: or\nsamples: 8\n0 0 0 3\n"),
            "a.con:3:1: points must be 4 to 10000 with their multiplicities, got 3");
  EXPECT_EQ(error_of(""), "a.con:1:1: points must be a whole number from 1 to 10000, got the end of the file");
  EXPECT_THAT(error_of("contourgalleryver 1 1\nitems: 2\n" + std::string(kHook)),
              HasSubstr("a.con:18:1: line must have \"cver\" here, got the end of the file"));
  const auto large = read_vlab_contours(std::string(kVlabTextLimit + 1, ' '), "a.con");
  ASSERT_FALSE(large.has_value());
  EXPECT_EQ(large.error().code, ErrorCode::kTooLarge);
}

TEST(WriteVlabContours, ReadBackAsTheSame) {
  VlabContour second = hook();
  second.name = "second";
  second.closed = true;
  second.background.clear();
  second.markers.clear();
  const Expected<std::string> text = write_vlab_contours({hook(), second});
  ASSERT_TRUE(text.has_value()) << to_string(text.error());
  const auto read = read_vlab_contours(*text, "a.cset");
  ASSERT_TRUE(read.has_value()) << to_string(read.error());
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ((*read)[0].background, "scan 1.png");
  EXPECT_EQ((*read)[0].markers.size(), 2u);
  EXPECT_TRUE((*read)[1].closed);
  EXPECT_EQ(*write_vlab_contours(*read), *text);
  EXPECT_EQ(*write_vlab_contour((*read)[0]), *write_vlab_contour(hook()));
}

TEST(WriteVlabContours, RefuseWhatVlabCouldNotReadBack) {
  VlabContour contour = hook();
  contour.name = "two words";
  EXPECT_EQ(write_vlab_contour(contour).error().message,
            "must have 1 to 30 characters and no blanks, got \"two words\"");
  contour = hook();
  contour.background = std::string(80, 'x');
  EXPECT_FALSE(write_vlab_contour(contour).has_value());
  contour = hook();
  contour.points.resize(1);
  EXPECT_FALSE(write_vlab_contour(contour).has_value());
  contour = hook();
  contour.points[1].position.y = std::nan("");
  EXPECT_FALSE(write_vlab_contour(contour).has_value());
}

/// Uniform cubic B-spline of the written-out control points by its definition: cubes of differences (truncated powers).
Vec3 by_definition(const std::vector<Vec3>& controls, double u) {
  Vec3 sum{};
  for (std::size_t i = 0; i < controls.size(); ++i) {
    const double x = u + 3.0 - static_cast<double>(i);  // the basis function is not zero for x in (0, 4)
    double weight = 0.0;
    constexpr double kChoose[5] = {1.0, -4.0, 6.0, -4.0, 1.0};
    for (int k = 0; k <= 4; ++k) {
      const double reach = std::max(0.0, x - k);
      weight += kChoose[k] * reach * reach * reach / 6.0;
    }
    sum += weight * controls[i];
  }
  return sum;
}

TEST(VlabSpline, IsTheUniformBSplineExactly) {
  std::vector<Vec3> controls;
  VlabContour contour;
  for (int count = 4; count <= 9; ++count) {  // from one piece, where both ends share their controls, to six
    contour.points.clear();
    controls.clear();
    for (int i = 0; i < count; ++i) {
      controls.push_back({std::sin(1.0 * i), std::cos(2.5 * i), 0.3 * i * i});
      contour.points.push_back({controls.back(), 1});
    }
    const BSplineCurve<Vec3> spline = vlab_spline(contour);
    ASSERT_EQ(spline.controls.size(), controls.size());
    for (double t = 0.0; t <= 1.0; t += 1.0 / 64.0) {
      EXPECT_LT(length(spline.at(t) - by_definition(controls, t * (count - 3))), 1e-12) << count << " at " << t;
    }
  }
}

TEST(VlabSpline, AClosedCurveMeetsItselfSmoothly) {
  VlabContour contour = hook();
  contour.closed = true;
  const BSplineCurve<Vec3> spline = vlab_spline(contour);
  EXPECT_LT(length(spline.at(0.0) - spline.at(1.0)), 1e-14);
  EXPECT_LT(length(spline.derivative(0.0) - spline.derivative(1.0)), 1e-12);
}

TEST(VlabSpline, TripledEndPointsKeepTheirPolygon) {
  VlabContour contour = hook();
  contour.points.back().multiplicity = 3;
  const BSplineCurve<Vec3> spline = vlab_spline(contour);
  ASSERT_EQ(spline.controls.size(), 9u);
  EXPECT_LT(length(spline.controls[1] - Vec3{0.0, 3.0, 0.0}), 1e-15);
  EXPECT_LT(length(spline.controls[3] - Vec3{1.0, 3.0, 0.0}), 1e-15);
  EXPECT_LT(length(spline.at(1.0) - Vec3{2.5, 0.0, 0.0}), 1e-15);
}

TEST(VlabCurve, IsTheSplineByArcLength) {
  for (const bool closed : {false, true}) {
    VlabContour contour = hook();
    contour.closed = closed;
    contour.points.back().multiplicity = 3;
    contour.samples = 4000;
    const VlabCurve curve(contour);
    const BSplineCurve<Vec3> spline = vlab_spline(contour);
    const ArcLength arc(spline);
    EXPECT_NEAR(curve.length(), arc.total_mm(), 1e-5);
    for (double s = 0.0; s <= 1.0; s += 1.0 / 128.0) {
      EXPECT_LT(length(curve.at(s) - spline.at(arc.t_from_s(s))), 1e-5) << s;
    }
  }
}

TEST(VlabProfile, RunsFromTheApexAndKeepsToTheAxis) {
  VlabContour contour = hook();
  contour.points.back().multiplicity = 3;
  contour.points.front().position.x = -0.01;  // drawn across the axis by hand
  const auto profile = vlab_profile(contour);
  ASSERT_TRUE(profile.has_value()) << to_string(profile.error());
  EXPECT_EQ(profile->front(), (Vec2{0.0, 3.0}));
  EXPECT_EQ(profile->back(), (Vec2{2.5, 0.0}));
  std::reverse(contour.points.begin(), contour.points.end());
  EXPECT_EQ(*vlab_profile(contour), *profile);
  const SurfaceOfRevolution surface(*profile, 3);
  EXPECT_GT(surface.area_mm2(), 0.0);
}

TEST(VlabProfile, RefusesWhatCannotBeTurned) {
  VlabContour contour = hook();
  contour.closed = true;
  EXPECT_THAT(to_string(vlab_profile(contour).error()), HasSubstr("hook must be an open curve"));
  contour = hook();
  contour.points[1].position.z = 0.5;
  EXPECT_THAT(to_string(vlab_profile(contour).error()), HasSubstr("hook must lie in the plane z = 0"));
  contour = hook();
  contour.points[0].position.x = -1.0;
  EXPECT_THAT(to_string(vlab_profile(contour).error()), HasSubstr("hook must have radii >= 0"));
}

// ---- against VLab's own values --------------------------------------------------------------------------------------

double extent(const VlabContour& contour) {
  Vec3 low = contour.points[0].position;
  Vec3 high = low;
  for (const VlabContourPoint& point : contour.points) {
    const Vec3 p = point.position;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return length(high - low);
}

struct Folder {
  const char* file;
  const char* values;
};
constexpr Folder kFolders[] = {{"heads/bellis/contours.cset", "heads/bellis/evaluated"},
                               {"heads/sunflower/contours.cset", "heads/sunflower/evaluated"},
                               {"vlab/lychnis/contours.cset", "vlab/lychnis/evaluated"},
                               {"vlab/synthetic/synthetic.cset", "vlab/synthetic/evaluated"}};

TEST(VlabReference, CurvesAreWhatVlabEvaluates) {
  ANTHESIS_NEEDS_REFERENCE();
  for (const Folder& folder : kFolders) {
    const auto contours = read_vlab_contours(test::reference_file(folder.file), folder.file);
    ASSERT_TRUE(contours.has_value()) << to_string(contours.error());
    std::vector<VlabCurve> curves;
    for (const VlabContour& contour : *contours) {
      curves.emplace_back(contour);
    }
    std::size_t compared = 0;
    for (const std::vector<double>& row : test::reference_table(folder.values + std::string("/curves.csv"))) {
      const auto i = static_cast<std::size_t>(row[0]) - 1;
      ASSERT_LT(i, curves.size());
      const double error = length(curves[i].at(row[1]) - Vec3{row[2], row[3], row[4]}) / extent((*contours)[i]);
      const double normal_error = length(curves[i].normal(row[1]) - Vec3{row[5], row[6], row[7]});
      ASSERT_LE(error, 3e-5) << folder.file << " curve " << i + 1 << " at " << row[1];
      ASSERT_LE(normal_error, 1e-4) << folder.file << " curve " << i + 1 << " at " << row[1];
      ++compared;
    }
    EXPECT_EQ(compared, 501 * curves.size());
  }
}

TEST(VlabReference, LengthsAreWhatVlabMeasures) {
  ANTHESIS_NEEDS_REFERENCE();
  for (const Folder& folder : kFolders) {
    const auto contours = read_vlab_contours(test::reference_file(folder.file), folder.file);
    ASSERT_TRUE(contours.has_value());
    for (const std::vector<double>& row : test::reference_table(folder.values + std::string("/lengths.csv"))) {
      const VlabContour& contour = contours->at(static_cast<std::size_t>(row[0]) - 1);
      if (!contour.through_ends) {  // VLab has no length of those: it answers the curve's before
        EXPECT_NEAR(VlabCurve(contour).length(), row[1], 3e-5 * row[1]) << folder.file << ' ' << contour.name;
      }
    }
  }
}

}  // namespace
}  // namespace anthesis
