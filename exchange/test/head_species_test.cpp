// The heads that come with the program, against Table SMD1 of O24's supplement.
#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/exchange/species_file.h"
#include "anthesis/inflorescence/development.h"
#include "anthesis/inflorescence/head_interior.h"
#include "anthesis/phyllotaxis/parastichies.h"
#include "anthesis/vasculature/vein_measures.h"

namespace anthesis {
namespace {

struct PublishedHead {
  const char* name;
  double height_mm;
  double width_mm;
  std::array<double, 3> primordia;  ///< bracts, trans florets, florets
  double vertices;
  double spare;  ///< share of the vertices that ours may differ by
  std::array<std::size_t, 2> bundles;
};

void PrintTo(const PublishedHead& head, std::ostream* out) {
  *out << head.name;
}

class HeadSpecies : public testing::TestWithParam<PublishedHead> {};

TEST_P(HeadSpecies, HasThePublishedSize) {
  const Species species = *find_species(GetParam().name);
  const GrowingReceptacle head(digitised_head(*species.head.active_ring));
  double widest = 0.0;
  double highest = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const Vec2 point = head.point(1.0, i / 1000.0);
    widest = std::max(widest, 2.0 * point.x);
    highest = std::max(highest, point.y);
  }
  EXPECT_NEAR(highest, GetParam().height_mm, 0.01 * GetParam().height_mm);
  EXPECT_NEAR(widest, GetParam().width_mm, 0.01 * GetParam().width_mm);
}

/// From tiny to whole; and the ring only moves inwards through the tissue, for what has organs is naked no more.
TEST_P(HeadSpecies, GrowsAllTheTime) {
  const Species species = *find_species(GetParam().name);
  const GrowingReceptacle head(digitised_head(*species.head.active_ring));
  EXPECT_LT(head.length(0.0), 0.05 * head.length(1.0));
  for (int i = 1; i <= 100; ++i) {
    EXPECT_GT(head.length(0.01 * i), head.length(0.01 * (i - 1)));
    const auto tissue = [&](double time) { return head.material_from_s(time, head.ring(time)); };
    EXPECT_LE(tissue(0.01 * i), tissue(0.01 * (i - 1)) + 1e-9) << i;
  }
}

TEST_P(HeadSpecies, EveryPrimordiumHasItsVeinsAndTheyAreAsManyAsPublished) {
  const PublishedHead& published = GetParam();
  const Species species = *find_species(published.name);
  const auto ring = head_ring(species);
  ASSERT_TRUE(ring.has_value());
  const std::vector<VeinPrimordium> primordia = head_primordia(species, *ring);
  std::array<double, 3> kinds{};
  for (const VeinPrimordium& one : primordia) {
    kinds[static_cast<std::size_t>(one.kind)] += 1.0;
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(kinds[k], published.primordia[k], 0.02 * published.primordia[k] + 0.5) << k;
  }
  const auto contours = head_contours(species);
  ASSERT_TRUE(contours.has_value());
  for (const ContourPoint& point : contours->points) {
    ASSERT_GE(point.position.x, 0.0);
  }
  const auto veins = head_veins(species, *contours, primordia);
  ASSERT_TRUE(veins.has_value()) << to_string(veins.error());
  EXPECT_NEAR(static_cast<double>(veins->vertices.size()), published.vertices, published.spare * published.vertices);
  const VasculatureMeasures measures = measure(*veins);
  for (const StrandMeasures& strand : measures.strands) {
    EXPECT_TRUE(strand.connected);
  }
  EXPECT_GE(measures.bundles, published.bundles[0]);
  EXPECT_LE(measures.bundles, published.bundles[1]);
  // Bellis is a net: nearly each floret has a second way. The others are trees.
  const bool net = species.vasculature->params.reticulation.rule != ReticulationRule::kNone;
  EXPECT_EQ(measures.loops > 0, net);
  if (net) {
    EXPECT_GT(static_cast<double>(veins->second_connections.size()), 0.9 * kinds[2]);
  }
  // Strands of florets keep to their sectors where that has a weight: less than a twelfth of a turn on average.
  if (species.vasculature->params.sector_weight > 0.0) {
    double turned = 0.0;
    for (const StrandMeasures& strand : measures.strands) {
      turned += std::abs(strand.turned_rad);
    }
    EXPECT_LT(turned / static_cast<double>(measures.strands.size()), math::kTurnRad / 12.0);
  }
}

/// Adaxial strands of a sunflower run well below the surface, and most steeply so towards the rim.
TEST(SunflowerHead, HasFansThatGoDeep) {
  const Species species = *find_species("sunflower-head");
  const auto contours = head_contours(species);
  const auto veins = head_veins(species, *contours, head_primordia(species, *head_ring(species)));
  ASSERT_TRUE(veins.has_value());
  const std::span<const ContourPoint> outline = contours->frame(contours->frames() - 1);
  double height = 0.0;
  double radius = 0.0;
  for (const ContourPoint& point : outline) {
    height = std::max(height, point.position.y);
    radius = std::max(radius, point.position.x);
  }
  // From the apex outwards the outline is the upper surface as far as it is looked at here.
  const auto surface = [&](double r) {
    std::size_t i = 1;
    while (outline[i].position.x < r) {
      ++i;
    }
    const Vec2 a = outline[i - 1].position;
    const Vec2 b = outline[i].position;
    return a.y + (b.y - a.y) * (r - a.x) / (b.x - a.x);
  };
  std::array<double, 3> depth{};
  std::array<int, 3> count{};
  for (const VeinVertex& vertex : veins->vertices) {
    const double r = std::hypot(vertex.position.x, vertex.position.y);
    const int band = static_cast<int>(10.0 * r / radius) - 1;  // a tenth to four tenths of the radius
    if (vertex.kind == VeinKind::kAdaxial && band >= 0 && band < 3) {
      depth[band] += (surface(r) - vertex.position.z) / height;
      ++count[band];
    }
  }
  for (int band = 0; band < 3; ++band) {
    ASSERT_GT(count[band], 100) << band;
  }
  EXPECT_GT(depth[0] / count[0], 0.05);  // those of the published head: 0.08, 0.11, 0.14
  EXPECT_GT(depth[1] / count[1], 0.09);
  EXPECT_GT(depth[2] / count[2], 0.12);
}

TEST_P(HeadSpecies, MostOfItIsAGoldenSpiral) {
  const Expected<Development> development = Development::grow(*find_species(GetParam().name), {});
  ASSERT_TRUE(development.has_value());
  ParastichyOptions options;
  options.in_order_of_birth = false;  // several places of the ring bear organs by turns
  const Parastichies found = analyse_parastichies(pattern_of(*development, 1.0), options);
  std::size_t spiral = 0;
  std::size_t all = 0;
  for (const ParastichyRegion& region : found.regions) {
    all += region.organs;
    spiral += region.kind.series == ParastichySeries::kFibonacci ? region.organs : 0;
  }
  EXPECT_GT(4 * spiral, 3 * all);
}

INSTANTIATE_TEST_SUITE_P(
    Published, HeadSpecies,
    testing::Values(PublishedHead{"bellis-head", 8.37, 7.19, {28.0, 0.0, 392.0}, 14172.0, 0.02, {7, 9}},
                    PublishedHead{"sunflower-head", 5.35, 12.79, {81.0, 0.0, 416.0}, 38598.0, 0.02, {41, 48}},
                    PublishedHead{"gerbera-head", 7.65, 18.72, {84.0, 167.0, 466.0}, 47497.0, 0.02, {42, 50}},
                    // our own, against itself
                    PublishedHead{"coneflower-head", 15.0, 16.8, {32.0, 13.0, 342.0}, 37972.0, 0.01, {40, 46}}),
    [](const auto& test) {
      std::string name = test.param.name;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace anthesis
