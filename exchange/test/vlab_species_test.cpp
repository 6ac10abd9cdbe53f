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

/// Three stages of a growing cap; its ring runs from the rim to the apex.
std::vector<VlabFile> cap() {
  std::string contours = "contourgalleryver 1 1\nitems: 3\n";
  for (const double size : {0.2, 0.5, 1.0}) {
    const auto x = [size](double value) { return std::to_string(size * value); };
    contours += "cver 1 3\nname: stage\npoints: 4 8\ntype: or\nsamples: 200\nmarkers: 2\n0 0.9 0 0\n1 " +
                std::to_string(0.8 - 0.8 * size) + " 0 0\n0 " + x(0.1) + " 0 3\n" + x(0.3) + ' ' + x(0.1) + " 0 1\n" +
                x(0.6) + ' ' + x(0.05) + " 0 1\n" + x(1.0) + " 0 0 3\n";
  }
  return {
      {"cap.cset", contours},
      {"knotPositions.dat", "0: 0 0 0\n1: 0 0 0\n2: 0 0 0\n3: 1 0 0\n4: 1 0 0\n5: 1 0 0\n"},
      {"threshold.func",
       "fver 1 1\nname: thresholdDistanceFunc\nsamples: 100\nflip: off\npoints: 4\n0 1.5\n0.3 1.2\n0.6 1.2\n1 1.2\n"},
      {"notes.txt", "not ours"}};
}

TEST(SpeciesFromVlab, AGrowingHeadKeepsItsStagesAndGrowsPrimordia) {
  const Expected<Species> species = species_from_vlab("cap", read(cap()), {.width_mm = 30.0});
  ASSERT_TRUE(species.has_value()) << message(species);
  ASSERT_TRUE(species->head.active_ring.has_value());
  const ActiveRing& ring = *species->head.active_ring;
  ASSERT_EQ(ring.sections.size(), 3u);
  EXPECT_EQ(ring.knots, (std::vector{0.0, 0.0, 0.0, 1.0, 1.0, 1.0}));
  EXPECT_NEAR(ring.sections[0].ring, 0.64, 1e-6);
  EXPECT_EQ(ring.sections[2].landmarks, std::vector{0.9});
  EXPECT_NEAR(ring.sections[2].points.back().x, 15.0, 1e-6);  // half the width
  EXPECT_NEAR(ring.sections[0].points.back().x, 3.0, 1e-6);
  EXPECT_NEAR(ring.threshold_mm.front().y, 1.5 * 15.0 * 3.5 * 3.14159265358979 / 100.0, 1e-6);
  EXPECT_FALSE(species->vasculature.has_value());  // of whose? nobody says
  const Expected<Species> again = read_species(write_species(*species), "cap.toml");
  ASSERT_TRUE(again.has_value()) << message(again);
  EXPECT_EQ(write_species(*again), write_species(*species));
  const Expected<Development> development = Development::grow(*again, {.seed = 1, .detail = 0.5});
  ASSERT_TRUE(development.has_value()) << message(development);
  EXPECT_GT(development->organs().size(), 20u);
}

TEST(SpeciesFromVlab, AHeadLikeOneOfThePapersHasItsVeins) {
  for (const HeadModel model : {HeadModel::kBellis, HeadModel::kSunflower, HeadModel::kGerbera}) {
    const std::string name = kHeadModelNames[static_cast<std::size_t>(model)];
    const Expected<Species> species =
        species_from_vlab("cap", read(cap()), {.like = model, .source = VeinSource::kPaper});
    ASSERT_TRUE(species.has_value()) << message(species);
    ASSERT_TRUE(species->vasculature.has_value());
    const std::string text = write_species(*species);
    const Expected<Species> again = read_species(text, "cap.toml");
    ASSERT_TRUE(again.has_value()) << message(again) << text;
    EXPECT_EQ(write_species(*again), text) << name;
    // A file that names the model and its source has the same parameters.
    const std::string like = "\n[vasculature]\nlike = \"" + name + "\"\nsource = \"paper\"\n";
    std::string shorter = text.substr(0, text.find("\n[vasculature]\n")) + like;
    shorter += text.substr(text.find("\n[organs."));
    const Expected<Species> same = read_species(shorter, "cap.toml");
    ASSERT_TRUE(same.has_value()) << message(same);
    EXPECT_EQ(write_species(*same), text);
  }
}

TEST(SpeciesFromVlab, SaysWhichFilesAreMissing) {
  std::vector<VlabFile> files = dome();
  files.pop_back();
  EXPECT_THAT(message(species_from_vlab("a", read(files))), HasSubstr("a function named rho, got neither"));
  EXPECT_THAT(message(species_from_vlab("a", read({}))), HasSubstr("contours must come with a .con or .cset file"));
  files = cap();
  files.erase(files.begin() + 2);
  EXPECT_THAT(message(species_from_vlab("a", read(files))), HasSubstr("must hold one named thresholdDistanceFunc"));
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

TEST(VlabReference, PublishedHeadsBecomeSpeciesWithAsManyOrgans) {
  ANTHESIS_NEEDS_REFERENCE();
  struct Published {
    const char* name;
    HeadModel model;
    double organs;
    double height_mm;  // Table SMD1
    double width_mm;
  };
  for (const Published& published : {Published{"bellis", HeadModel::kBellis, 367, 8.37, 7.19},
                                     Published{"sunflower", HeadModel::kSunflower, 497, 5.35, 12.79}}) {
    std::vector<VlabFile> files;
    for (const char* file : {"contours_markers.cset", "contours.cset", "knotPositions.dat", "functions.fset"}) {
      files.push_back({file, test::reference_file("heads/" + std::string(published.name) + '/' + file)});
    }
    const Expected<Species> species = species_from_vlab(published.name, read(files), {.like = published.model});
    ASSERT_TRUE(species.has_value()) << message(species);
    const Expected<Species> again = read_species(write_species(*species), "head.toml");
    ASSERT_TRUE(again.has_value()) << message(again);
    const Expected<Development> development = Development::grow(*again, {.seed = 1, .detail = 0.3});
    ASSERT_TRUE(development.has_value()) << message(development);
    EXPECT_NEAR(static_cast<double>(development->organs().size()), published.organs, 0.03 * published.organs);
    const SurfaceOfRevolution mature = development->receptacle(1.0);
    double widest = 0.0;
    double highest = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      const Vec2 point = mature.profile_mm().at(i / 1000.0);
      widest = std::max(widest, 2.0 * point.x);
      highest = std::max(highest, point.y);
    }
    EXPECT_NEAR(widest, published.width_mm, 2e-3 * published.width_mm);
    EXPECT_NEAR(highest, published.height_mm, 2e-3 * published.height_mm);
  }
}

}  // namespace
}  // namespace anthesis
