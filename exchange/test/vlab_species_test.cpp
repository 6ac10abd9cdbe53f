#include "anthesis/exchange/vlab_species.h"

#include <gmock/gmock.h>

#include <cmath>

#include "anthesis/exchange/species_file.h"
#include "anthesis/inflorescence/development.h"
#include "anthesis/phyllotaxis/ridley.h"
#include "vlab_reference.h"

namespace anthesis {
namespace {

using testing::HasSubstr;

template <class T>
std::string message(const Expected<T>& result) {
  return result ? "no error" : to_string(result.error());
}

/// A dome drawn from the base up, and organs that are smaller towards its apex.
std::vector<VlabFile> dome() {
  return {{"profile.con",
           "cver 1 3\nname: dome\npoints: 4 8\ntype: or\nsamples: 100\n1 0 0 3\n1 0.5 0 1\n0.6 1 0 1\n0 1 0 3\n"},
          {"rho.func", "fver 1 1\nname: rho\nsamples: 100\nflip: off\npoints: 4\n0 0.6\n0.3 0.5\n0.6 0.4\n1 0.3\n"}};
}

VlabObject read(const std::vector<VlabFile>& files) {
  Expected<VlabObject> object = read_vlab_object(files);
  EXPECT_TRUE(object.has_value()) << message(object);
  return object ? *object : VlabObject();
}

TEST(VlabRidley, KeepsTheRadiiWhereTheyWereDrawn) {
  const VlabObject object = read(dome());
  const auto model = vlab_ridley(object.contours[0], object.functions[0], {.width_mm = 10.0, .radius_factor = 0.5});
  ASSERT_TRUE(model.has_value()) << message(model);
  // Drawn from the base: radius 0.6 units there, 0.3 at the apex; a unit is half of 10 mm.
  EXPECT_NEAR(model->radius_mm(1.0), 5.0 * 0.5 * 0.6, 1e-12);
  EXPECT_NEAR(model->radius_mm(0.0), 5.0 * 0.5 * 0.3, 1e-12);
  EXPECT_NEAR(model->area_mm2(0.0), 3.14159265358979 * std::pow(model->radius_mm(0.0), 2), 1e-12);
  EXPECT_NEAR(model->area_mm2(0.37), 3.14159265358979 * std::pow(model->radius_mm(0.37), 2), 2e-3);
  EXPECT_NEAR(model->surface.radius_mm(1.0), 5.0, 1e-12);
  EXPECT_NEAR(model->surface.radius_mm(0.0), 0.0, 1e-12);
}

TEST(SpeciesFromVlab, ARidleyObjectGrows) {
  const Expected<Species> species = species_from_vlab("dome", read(dome()), {.width_mm = 10.0, .radius_factor = 0.3});
  ASSERT_TRUE(species.has_value()) << message(species);
  const Expected<Species> again = read_species(write_species(*species), "dome.toml");
  ASSERT_TRUE(again.has_value()) << message(again);
  const Expected<Development> development = Development::grow(*again, {.seed = 1, .detail = 0.5});
  ASSERT_TRUE(development.has_value()) << message(development);
  EXPECT_GT(development->organs().size(), 20u);
}

/// Three stages of a growing cap and 60 primordia at the places of Vogel's spiral: equal areas.
std::vector<VlabFile> cap() {
  std::string contours = "contourgalleryver 1 1\nitems: 3\n";
  for (const double size : {0.2, 0.5, 1.0}) {
    const auto x = [size](double value) { return std::to_string(size * value); };
    contours += "cver 1 3\nname: stage\npoints: 4 8\ntype: or\nsamples: 200\nmarkers: 2\n0 1 0 0\n1 0.5 0 0\n0 " +
                x(0.1) + " 0 3\n" + x(0.3) + ' ' + x(0.1) + " 0 1\n" + x(0.6) + ' ' + x(0.05) + " 0 1\n" + x(1.0) +
                " 0 0 3\n";
  }
  std::string mature = "00060\n";
  std::string born = "00060\n";
  for (int i = 0; i < 60; ++i) {
    const double s = 0.9 * std::sqrt(1.0 - (i + 0.5) / 60.0);
    const std::string row = std::to_string(s) + " 1 " + (i < 20 ? "1" : "0") + "\n";
    mature += std::to_string(i) + " 2000 " + row;
    born += std::to_string(i) + ' ' + std::to_string(1 + 25 * i) + ' ' + row;
  }
  return {{"cap.cset", contours},
          {"cap_final.prims", mature},
          {"cap_initial.prims", born},
          {"knotPositions.dat", "0: 0 0 0\n1: 0 0 0\n2: 0 0 0\n3: 1 0 0\n4: 1 0 0\n5: 1 0 0\n"},
          {"notes.txt", "not ours"}};
}

TEST(SpeciesFromVlab, AGrowingHeadHasTheOrgansOfTheObject) {
  const Expected<Species> species = species_from_vlab("cap", read(cap()), {.width_mm = 30.0, .radius_factor = 1.0});
  ASSERT_TRUE(species.has_value()) << message(species);
  EXPECT_EQ(species->head.receptacle.size(), 9u);
  EXPECT_NEAR(species->head.growth.front().y, 0.2, 1e-3);
  EXPECT_EQ(species->head.growth.back().y, 1.0);
  const Expected<Species> again = read_species(write_species(*species), "cap.toml");
  ASSERT_TRUE(again.has_value()) << message(again);
  const Expected<Development> development = Development::grow(*again, {.seed = 1, .detail = 0.5});
  ASSERT_TRUE(development.has_value()) << message(development);
  ASSERT_EQ(development->organs().size(), 60u);
  std::size_t bracts = 0;
  for (const auto& organ : development->organs()) {
    bracts += again->organs[organ.kind].name == "bract" ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(bracts), 20.0, 1.0);
}

TEST(SpeciesFromVlab, SaysWhichFilesAreMissing) {
  std::vector<VlabFile> files = dome();
  files.pop_back();
  EXPECT_THAT(message(species_from_vlab("a", read(files))), HasSubstr("a function named rho, got neither"));
  EXPECT_THAT(message(species_from_vlab("a", read({}))), HasSubstr("contours must come with a .con or .cset file"));
  files = cap();
  files.erase(files.begin() + 1);
  EXPECT_THAT(message(species_from_vlab("a", read(files))), HasSubstr("primordia must come with a file *_final.prims"));
  EXPECT_THAT(message(species_from_vlab("a", read(dome()), {.width_mm = -1.0, .radius_factor = 1.0})),
              HasSubstr("width_mm must be"));
  files = dome();
  files[1].bytes[5] = 'x';
  const auto broken = read_vlab_object(files);
  ASSERT_FALSE(broken.has_value());
  EXPECT_THAT(to_string(broken.error()), testing::StartsWith("rho.func:1:6: "));
}

// ---- VLab's own models ----------------------------------------------------------------------------------------------

/// Algorithm 5 of Prusinkiewicz et al. 2001 as VLab's Ridley model runs it: steps of 0.001 units along the profile from
/// the base, an organ each time the running number of organs passes one. It begins at `start`, which is 0 in VLab.
std::vector<double> steps_of_algorithm_5(const VlabContour& profile, const VlabFunction& rho, double factor,
                                         double start) {
  VlabContour fine = profile;
  fine.samples = 10'000;
  const VlabCurve curve(fine);
  const VlabFunctionTable table(rho);
  constexpr double kStep = 0.001;
  std::vector<double> places;
  double organs = start;
  for (double along = 0.0; along < curve.length(); along += kStep) {
    const double s = along / curve.length();
    const double radius = factor * table(s);
    organs += 2.0 * curve.at(s).x / (radius * radius) * kStep;
    if (organs >= 1.0) {
      organs -= 1.0;
      places.push_back(1.0 - (along + kStep) / curve.length());  // from the apex
    }
  }
  return places;
}

TEST(VlabReference, RidleysModelIsOurPlacementOfBands) {
  ANTHESIS_NEEDS_REFERENCE();
  const auto contours = read_vlab_contours(test::reference_file("vlab/ridley/profile.con"), "profile.con");
  const auto functions = read_vlab_functions(test::reference_file("vlab/ridley/rho.func"), "rho.func");
  ASSERT_TRUE(contours.has_value() && functions.has_value()) << message(contours) << message(functions);
  const VlabScale scale{.width_mm = 20.0, .radius_factor = 0.2};
  const auto model = vlab_ridley(contours->front(), functions->front(), scale);
  ASSERT_TRUE(model.has_value()) << message(model);
  const std::vector<double> t = place_organs(model->surface, model->area_mm2, SpiralDirection::kFromBase, 100'000);

  // Begun half an organ later, the steps put organs where we do: in the middle of their bands.
  const double step = 0.001 / VlabCurve(contours->front()).length();
  const std::vector<double> middles =
      steps_of_algorithm_5(contours->front(), functions->front(), scale.radius_factor, 0.5);
  EXPECT_EQ(t.size(), 123u);
  ASSERT_NEAR(static_cast<double>(middles.size()), static_cast<double>(t.size()), 1.0);
  for (std::size_t i = 0; i < std::min(t.size(), middles.size()); ++i) {
    EXPECT_NEAR(model->surface.s_from_t(t[i]), middles[i], 3.0 * step) << i;
  }
  // As VLab begins them, they put organ i on the border between our organs i and i + 1.
  const std::vector<double> borders =
      steps_of_algorithm_5(contours->front(), functions->front(), scale.radius_factor, 0.0);
  ASSERT_EQ(borders.size(), t.size());
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    EXPECT_LT(borders[i], model->surface.s_from_t(t[i]) + step) << i;
    EXPECT_GT(borders[i], model->surface.s_from_t(t[i + 1]) - 2.0 * step) << i;
  }
}

TEST(VlabReference, PublishedHeadsBecomeSpeciesWithTheirOrgansInPlace) {
  ANTHESIS_NEEDS_REFERENCE();
  struct Head {
    const char* name;
    const char* folder;
    const char* primordia;
    std::size_t organs;
    std::size_t bracts;
  };
  for (const Head& head : {Head{"bellis", "heads/bellis", "heads/bellis", 367, 46},
                           Head{"bellis", "heads/bellis", "heads/bellis/vasculature", 420, 28},
                           Head{"sunflower", "heads/sunflower", "heads/sunflower", 497, 83}}) {
    std::vector<VlabFile> files;
    for (const char* file : {"contours_markers.cset", "contours.cset", "knotPositions.dat", "functions.fset"}) {
      files.push_back({file, test::reference_file(std::string(head.folder) + '/' + file)});
    }
    for (const char* end : {"_initial.prims", "_final.prims"}) {
      const std::string file = head.name + std::string(end);
      files.push_back({file, test::reference_file(std::string(head.primordia) + '/' + file)});
    }
    const VlabObject object = read(files);
    const Expected<Species> species = species_from_vlab(head.name, object, {.width_mm = 20.0, .radius_factor = 0.2});
    ASSERT_TRUE(species.has_value()) << message(species);
    const Expected<Species> again = read_species(write_species(*species), "head.toml");
    ASSERT_TRUE(again.has_value()) << message(again);
    const Expected<Development> development = Development::grow(*again, {.seed = 1, .detail = 0.3});
    ASSERT_TRUE(development.has_value()) << message(development);
    ASSERT_EQ(development->organs().size(), head.organs) << head.primordia;
    std::size_t bracts = 0;
    for (const auto& organ : development->organs()) {
      bracts += again->organs[organ.kind].name == "bract" ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(bracts), static_cast<double>(head.bracts), 3.0) << head.primordia;

    // Organ k from the rim stands where the k-th published one does, in shares of the outline that carries organs.
    std::vector<double> published;
    for (const VlabPrimordium& one : object.mature) {
      published.push_back(one.s);
    }
    std::sort(published.begin(), published.end(), std::greater<>());
    const double reach = published[0] + (published[0] - published[8]) / 16.0;
    const SurfaceOfRevolution surface(again->head.receptacle.back().points, 3);
    const std::vector<double> t =
        place_organs(surface, FunctionGraph(again->head.area_mm2), SpiralDirection::kFromBase, published.size());
    const FunctionGraph area_mm2(again->head.area_mm2);
    const auto area_at = [&](double s) { return surface.area_from_apex_mm2(surface.t_from_s(s)); };
    double worst = 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < t.size(); ++k) {
      const double s = published[k] / reach;
      const double off = std::abs(surface.area_from_apex_mm2(t[k]) - area_at(s)) / area_mm2(s);
      worst = std::max(worst, off);
      sum += off;
    }
    // In organs. The published ones arise several at a time at one s, where ours have a band each.
    EXPECT_LT(worst, 8.0) << head.primordia;
    EXPECT_LT(sum / static_cast<double>(t.size()), 2.0) << head.primordia;
  }
}

}  // namespace
}  // namespace anthesis
