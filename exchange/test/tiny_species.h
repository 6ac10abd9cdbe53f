#pragma once
#include <gtest/gtest.h>

#include "anthesis/inflorescence/development.h"

namespace anthesis::test {

/// A small head of about thirty organs: outer petals of one pigment that open by 80 degrees, and inner florets of two.
inline Species tiny_species() {
  Species species;
  species.name = "tiny";
  species.latin = "Parva parva";
  species.sha256 = std::string(64, 'a');

  species.pigments.resize(2);
  Pigment& plain = species.pigments[0];
  plain.name = "plain";
  plain.colour = {{0.0, {0.2, 0.4, 0.1}}};
  plain.mottle = 0.0;
  plain.sheen = 0.0;
  Pigment& veined = species.pigments[1];
  veined.name = "veined";
  veined.colour = {{0.0, {0.5, 0.1, 0.3}}, {1.0, {0.9, 0.7, 0.8}}};
  veined.veins = 7;
  veined.translucency = 0.4;
  veined.hue_deg = {-10.0, 10.0};
  veined.roughness = 0.3;

  species.head.receptacle = {{0.0, {{0.0, 3.0}, {2.0, 3.0}, {4.0, 2.0}, {5.0, 0.0}, {5.0, -1.0}}},
                             {1.0, {{0.0, 1.0}, {3.0, 1.0}, {5.0, 0.7}, {6.0, 0.0}, {6.0, -1.0}}}};
  species.head.receptacle_pigment = "plain";
  species.head.interval = 0.02;
  species.head.meristem_area_mm2 = 30.0;
  species.head.zones = {{"floret", 0.0, 0.6}, {"petal", 0.6, 1.0}};
  species.peduncle.pigment = "plain";
  species.peduncle.length_mm = 20.0;
  species.peduncle.growth = {{0.0, 0.2}, {1.0, 1.0}};

  Petals blade;
  blade.name = "blade";
  blade.pigment = "veined";
  blade.poses = {{.stage = 0.0,
                  .midrib_mm = {{0.0, 0.0}, {0.0, 3.0}, {-1.0, 6.0}, {-3.0, 8.0}},
                  .half_width_mm = {0.3, 1.0, 1.0, 0.2},
                  .side_mm = {},
                  .sections = {}},
                 {.stage = 1.0,
                  .midrib_mm = {{0.0, 0.0}, {2.0, 1.0}, {6.0, 1.0}, {9.0, -1.0}},
                  .half_width_mm = {0.3, 1.5, 2.0, 0.3},
                  .side_mm = {},
                  .sections = {}}};
  OrganKind petal;
  petal.name = "petal";
  petal.shape.petals = {blade};
  petal.variants = 2;
  petal.shape.variation.curl_deg = {-10.0, 10.0};
  petal.growth = {{0.0, 0.1}, {0.5, 0.6}, {1.0, 1.0}};
  petal.pitch_deg = {{0.0, 0.0}, {1.0, 30.0}};

  Petals tube = blade;
  tube.name = "tube";
  tube.count = 5;
  Column style;
  style.name = "style";
  style.pigment = "plain";
  style.poses = {{.stage = 0.0, .profile_mm = {{0.2, 0.0}, {0.2, 0.5}, {0.2, 1.0}, {0.0, 1.2}}, .lean_deg = 0.0},
                 {.stage = 0.5, .profile_mm = {{0.2, 0.0}, {0.2, 2.0}, {0.3, 4.0}, {0.0, 5.0}}, .lean_deg = 0.0},
                 {.stage = 1.0, .profile_mm = {{0.2, 0.0}, {0.2, 2.0}, {0.3, 4.0}, {0.0, 5.0}}, .lean_deg = 20.0}};
  OrganKind floret;
  floret.name = "floret";
  floret.shape.petals = {tube};
  floret.shape.columns = {style};
  floret.growth = {{0.0, 0.1}, {1.0, 0.3}};
  species.organs = {petal, floret};
  return species;
}

inline Development grow_tiny(std::uint64_t seed = 7) {
  Expected<Development> development = Development::grow(tiny_species(), {.seed = seed, .detail = 1.0});
  if (!development) {
    ADD_FAILURE() << to_string(development.error());
    std::abort();
  }
  return std::move(*development);
}

}  // namespace anthesis::test
