#include "anthesis/inflorescence/species.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "anthesis/base/check.h"
#include "anthesis/geometry/function_graph.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "anthesis/inflorescence/head_interior.h"

namespace anthesis {
namespace {

constexpr int kMostOrgans = 100'000;

/// kUnknownParameter for a name that is used but nowhere defined.
std::optional<Error> check_name(const std::string& where, const std::string& name,
                                const std::vector<std::string>& known, std::string_view what) {
  if (std::find(known.begin(), known.end(), name) != known.end()) {
    return std::nullopt;
  }
  std::vector<std::string_view> views(known.begin(), known.end());
  const std::string_view near = nearest_name(name, views.data(), views.size());
  return Error{ErrorCode::kUnknownParameter, where,
               "must name " + std::string(what) + ", got " + name +
                   (near.empty() ? "" : "; did you mean " + std::string(near) + "?")};
}

std::optional<Error> check_unique(const std::string& where, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty() || !seen.insert(name).second) {
      return invalid_parameter(where, "must have different names", name);
    }
  }
  return std::nullopt;
}

std::optional<Error> check_outlines(const std::string& path, const Head& head) {
  if (head.receptacle.empty()) {
    return invalid_parameter(path + ".receptacle", "must have at least 1 profile", 0.0);
  }
  for (std::size_t i = 0; i < head.receptacle.size(); ++i) {
    const ReceptacleProfile& profile = head.receptacle[i];
    const std::string where = path + ".receptacle[" + std::to_string(i) + "]";
    if (auto error = check_profile(where + ".points", profile.points))
      return error;
    for (const Vec2 point : profile.points) {
      for (const double value : {point.x, point.y}) {
        if (auto error = check_number(where + ".points", value, -1e6, 1e6))
          return error;
      }
    }
    if (auto error = check_number(where + ".time", profile.time, 0.0, 1.0))
      return error;
    if (i > 0 && profile.time <= head.receptacle[i - 1].time) {
      return invalid_parameter(where + ".time", "must be later than the profile before", profile.time);
    }
    if (profile.points.size() != head.receptacle[0].points.size()) {
      return invalid_parameter(where + ".points", "must be as many as in the first profile",
                               static_cast<double>(profile.points.size()));
    }
  }
  return std::nullopt;
}

/// Organs of a ring and what GrowingReceptacle asks of its sections.
std::optional<Error> check_ring(const std::string& path, const Head& head, const std::vector<std::string>& organs) {
  const ActiveRing& ring = *head.active_ring;
  const std::string where = path + ".active_ring";
  for (std::size_t i = 0; i < ring.sections.size(); ++i) {
    const std::string points = where + ".sections[" + std::to_string(i) + "].points";
    if (ring.sections[i].points.size() < 4) {
      return invalid_parameter(points, "must be at least 4", static_cast<double>(ring.sections[i].points.size()));
    }
    for (const Vec2 point : ring.sections[i].points) {
      for (const double value : {point.x, point.y}) {
        if (auto error = check_number(points, value, -1e6, 1e6))
          return error;
      }
    }
    const Vec2 apex = ring.sections[i].points.front();
    if (apex.x != 0.0) {
      return invalid_parameter(points + "[0][0]", "must be 0: a section begins on the axis", apex.x);
    }
    if (!(apex.y > ring.sections[i].points.back().y)) {
      return invalid_parameter(points + "[0][1]",
                               "must be above the base, at " + to_text(ring.sections[i].points.back().y), apex.y);
    }
  }
  if (auto error = check_function_values(where + ".threshold_mm", ring.threshold_mm, 1e-6, 1e4))
    return error;
  if (auto error = check_whole(where + ".threshold_frozen_above", ring.threshold_frozen_above, 0, kMostOrgans))
    return error;
  const std::pair<const char*, int> landmarks[] = {{"bract_landmark", ring.bract_landmark},
                                                   {"trans_landmark", ring.trans_landmark}};
  for (const auto& [name, landmark] : landmarks) {
    if (auto error = check_whole(where + "." + name, landmark, 0, 1000))
      return error;
  }
  if (auto error = check_number(where + ".first_azimuth_deg", ring.first_azimuth_deg, 0.0, 360.0))
    return error;
  if (auto error = check(digitised_head(ring))) {
    const bool profile = error->where.ends_with(".profile");  // named after its control points here
    error->where = where + "." + (profile ? error->where.substr(0, error->where.size() - 7) + "points" : error->where);
    return error;
  }
  if (auto error = check(active_ring_params(ring), GrowingReceptacle(digitised_head(ring)))) {
    const std::size_t unit = error->where.rfind("_rad");
    error->where = where + "." + (unit == std::string::npos ? error->where : error->where.substr(0, unit) + "_deg");
    return error;
  }
  const std::tuple<const char*, const std::string&, bool> kinds[] = {
      {".floret", ring.floret, true},
      {".bract", ring.bract, ring.bract_landmark > 0},
      {".trans_floret", ring.trans_floret, ring.trans_landmark > 0}};
  for (const auto& [name, kind, needed] : kinds) {
    if (needed || !kind.empty()) {
      if (auto error = check_name(where + name, kind, organs, "an organ"))
        return error;
    }
  }
  if (head.bezier || !head.receptacle.empty() || !head.zones.empty()) {
    return invalid_parameter(path + (head.bezier               ? ".bezier"
                                     : head.receptacle.empty() ? ".zones"
                                                               : ".receptacle"),
                             "must be left out with rule active_ring", "some");
  }
  return std::nullopt;
}

std::optional<Error> check_head(const std::string& path, const Head& head, const std::vector<std::string>& organs,
                                const std::vector<std::string>& pigments) {
  if ((head.rule == PlacementRule::kActiveRing) != head.active_ring.has_value()) {
    return head.active_ring
               ? invalid_parameter(path + ".active_ring", "must come with rule = \"active_ring\"", "another")
               : invalid_parameter(path + ".active_ring", "must be given with rule = \"active_ring\"", "none");
  }
  if (auto error = head.active_ring ? check_ring(path, head, organs) : check_outlines(path, head))
    return error;
  if (head.bezier && grows_meristem(head.rule)) {
    return invalid_parameter(path + ".bezier", "must be false for rules that grow the meristem", "true");
  }
  if (head.bezier && !head.receptacle.empty() && head.receptacle[0].points.size() % 3 != 1) {
    return invalid_parameter(path + ".receptacle[0].points", "must be 3 n + 1 for n cubic Bezier curves",
                             static_cast<double>(head.receptacle[0].points.size()));
  }
  if (auto error = check_number(path + ".divergence_deg", head.divergence_deg, -360.0, 360.0))
    return error;
  if (auto error = check_number(path + ".interval", head.interval, 1e-6, 1.0))
    return error;
  if (auto error = check_whole(path + ".count", head.count, 0, kMostOrgans))
    return error;
  if (auto error = check_number(path + ".height_mm", head.height_mm, -1e4, 1e4))
    return error;
  if (auto error = check_function_values(path + ".growth", head.growth, 1e-6, 1e3))
    return error;
  if (auto error = check_function_values(path + ".radius_mm", head.radius_mm, 1e-4, 1e4))
    return error;
  if (auto error = check_number(path + ".contact_factor", head.contact_factor, 0.05, 1.0))
    return error;
  if (auto error = check_number(path + ".outer_area_mm2", head.outer_area_mm2, 1e-6, 1e9))
    return error;
  if (auto error = check_function_values(path + ".outer_growth", head.outer_growth, 1e-6, 1e6))
    return error;
  if (auto error = check_number(path + ".threshold_area_mm2", head.threshold_area_mm2, 1e-6, 1e9))
    return error;
  if (auto error = check_number(path + ".meristem_area_mm2", head.meristem_area_mm2, 1e-6, 1e9))
    return error;
  if (auto error = check_function_values(path + ".meristem_growth", head.meristem_growth, 1e-6, 1e6))
    return error;
  if (!head.meristem_rate.empty()) {
    if (auto error = check_function_values(path + ".meristem_rate", head.meristem_rate, -1e3, 1e3))
      return error;
  }
  if (auto error = check_function_values(path + ".area_mm2", head.area_mm2, 1e-6, 1e9))
    return error;
  if (auto error = check_function_values(path + ".area_growth", head.area_growth, 1e-6, 1e3))
    return error;
  if (!head.receptacle_pigment.empty()) {
    if (auto error = check_name(path + ".receptacle_pigment", head.receptacle_pigment, pigments, "a pigment"))
      return error;
  }
  if (head.zones.empty() && !head.active_ring) {
    return invalid_parameter(path + ".zones", "must have at least 1 zone", 0.0);
  }
  std::vector<Zone> zones = head.zones;
  std::sort(zones.begin(), zones.end(), [](const Zone& a, const Zone& b) { return a.from < b.from; });
  double covered = 0.0;
  for (const Zone& zone : zones) {
    if (auto error = check_name(path + ".zones.organ", zone.organ, organs, "an organ"))
      return error;
    if (zone.from != covered || !(zone.to > zone.from)) {
      return invalid_parameter(path + ".zones", "must cover [0, 1] without gap or overlap",
                               to_text(zone.from) + " to " + to_text(zone.to));
    }
    covered = zone.to;
  }
  if (covered != 1.0 && !head.active_ring) {
    return invalid_parameter(path + ".zones", "must cover [0, 1] up to 1", covered);
  }
  if (head.fate) {
    if (auto error = check_name(path + ".fate.of", head.fate->of, organs, "an organ"))
      return error;
    if (auto error = check_name(path + ".fate.with_room", head.fate->with_room, organs, "an organ"))
      return error;
    if (!(head.fate->cone_deg > 0.0 && head.fate->cone_deg < 180.0)) {
      return invalid_parameter(path + ".fate.cone_deg", "must be in (0, 180)", head.fate->cone_deg);
    }
  }
  return std::nullopt;
}

std::optional<Error> check_organ(const OrganKind& organ, const std::vector<std::string>& pigments) {
  const std::string where = "organs." + organ.name;
  const bool bare = organ.shape.petals.empty() && organ.shape.columns.empty();
  if (!(bare && organ.head)) {  // what only carries other organs needs no form of its own
    if (auto error = check(organ.shape, where))
      return error;
  }
  for (const Petals& petals : organ.shape.petals) {
    if (auto error = check_name(where + ".petals.pigment", petals.pigment, pigments, "a pigment"))
      return error;
  }
  for (const Column& column : organ.shape.columns) {
    if (auto error = check_name(where + ".columns.pigment", column.pigment, pigments, "a pigment"))
      return error;
  }
  for (const Hairs& hairs : organ.shape.hairs) {
    if (auto error = check_name(where + ".hairs.pigment", hairs.pigment, pigments, "a pigment"))
      return error;
  }
  if (auto error = check_number(where + ".variants", organ.variants, 1, 64))
    return error;
  if (auto error = check_function_values(where + ".growth", organ.growth, 0.0, 1e3))
    return error;
  if (auto error = check_function_values(where + ".opening", organ.opening, 0.0, 1.0))
    return error;
  if (auto error = check_function_values(where + ".size", organ.size, 0.0, 1e3))
    return error;
  if (auto error = check_function_values(where + ".pitch_deg", organ.pitch_deg, -180.0, 180.0))
    return error;
  if (auto error = check_number(where + ".layering_deg", organ.layering_deg, -180.0, 180.0))
    return error;
  if (auto error = check_number(where + ".sink_mm", organ.sink_mm, -1e4, 1e4))
    return error;
  if (auto error = check_number(where + ".fits_radius_mm", organ.fits_radius_mm, 0.0, 1e4))
    return error;
  for (const double value : {organ.contact_point_mm.x, organ.contact_point_mm.y, organ.contact_point_mm.z}) {
    if (auto error = check_number(where + ".contact_point_mm", value, -1e4, 1e4))
      return error;
  }
  if (!(length(organ.axis) > 1e-6) || !std::isfinite(length(organ.axis))) {
    return invalid_parameter(where + ".axis", "must have a direction, its length", length(organ.axis));
  }
  const double apart = length(cross(normalized(organ.axis), normalized(organ.outward)));
  if (!(apart > 1e-3)) {
    return invalid_parameter(where + ".outward", "must not lie along the axis, the sine between them", apart);
  }
  const OrganVariation& v = organ.variation;
  if (auto error = check_range(where + ".variation.size", v.size, 0.01, 100.0))
    return error;
  if (auto error = check_range(where + ".variation.pitch_deg", v.pitch_deg, -180.0, 180.0))
    return error;
  if (auto error = check_range(where + ".variation.yaw_deg", v.yaw_deg, -180.0, 180.0))
    return error;
  if (auto error = check_range(where + ".variation.roll_deg", v.roll_deg, -180.0, 180.0))
    return error;
  if (auto error = check_range(where + ".variation.stage", v.stage, -1.0, 1.0))
    return error;
  const Tissue& tissue = organ.tissue;
  if (auto error = check_number(where + ".tissue.thickness_mm", tissue.thickness_mm, 0.01, 10.0))
    return error;
  const std::pair<const char*, double> stiffnesses[] = {
      {"stretch", tissue.stretch}, {"bend", tissue.bend}, {"roll", tissue.roll}, {"hold", tissue.hold}};
  for (const auto& [name, stiffness] : stiffnesses) {
    if (auto error = check_number(where + ".tissue." + name, stiffness, 1e-6, 1.0))
      return error;
  }
  return std::nullopt;
}

/// A head that an organ carries: what it needs beyond any other.
std::optional<Error> check_carried(const std::string& path, const Head& head) {
  const bool grows =
      grows_meristem(head.rule) || head.active_ring || head.receptacle.size() > 1 || head.growth != Head{}.growth;
  if (!head.receptacle_pigment.empty() && grows) {
    return invalid_parameter(path + ".receptacle_pigment",
                             "must be left out where the receptacle grows apart from the organ that carries it: one "
                             "outline, no growth, and rule ridley or collision",
                             head.receptacle_pigment);
  }
  return std::nullopt;
}

/// kInvalidParameter when organs of some kind would, level by level, carry themselves.
std::optional<Error> check_levels(const Species& species) {
  const std::size_t count = species.organs.size();
  std::vector<std::vector<bool>> carries(count, std::vector<bool>(count));
  for (std::size_t i = 0; i < count; ++i) {
    if (const auto& head = species.organs[i].head) {
      for (std::size_t j = 0; j < count; ++j) {
        const std::string& name = species.organs[j].name;
        carries[i][j] =
            (head->fate && head->fate->with_room == name) ||
            (head->active_ring && (head->active_ring->floret == name || head->active_ring->bract == name ||
                                   head->active_ring->trans_floret == name)) ||
            std::any_of(head->zones.begin(), head->zones.end(), [&](const Zone& zone) { return zone.organ == name; });
      }
    }
  }
  for (std::size_t via = 0; via < count; ++via) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        carries[i][j] = carries[i][j] || (carries[i][via] && carries[via][j]);
      }
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (carries[i][i]) {
      return invalid_parameter("organs." + species.organs[i].name + ".head.zones",
                               "must not lead back to the organ itself", species.organs[i].name);
    }
  }
  return std::nullopt;
}

/// As check(VeinParams), by the names that a species file has for the initials and tips.
std::optional<Error> check_veins(const Species& species) {
  const HeadVeins& veins = *species.vasculature;
  if (!species.head.active_ring) {
    return invalid_parameter("vasculature", "must come with head.rule = \"active_ring\"", "another rule");
  }
  if (auto error = check_whole("vasculature.frames", veins.frames, 2, 100'000))
    return error;
  if (auto error = check_number("vasculature.max_edge", veins.max_edge, 0.01, 1.0))
    return error;
  if (auto error = check_function_values("vasculature.pace", veins.pace, 1e-6, 1e3))
    return error;
  if (veins.clock == VeinClock::kPublished && veins.pace == HeadVeins{}.pace) {
    return invalid_parameter("vasculature.pace", "must be given with clock = \"published\"", "none");
  }
  std::optional<Error> error = check(veins.params);
  if (error) {
    constexpr std::pair<const char*, const char*> kNames[] = {{"initials[0]", "bract"},
                                                              {"initials[1]", "trans_floret"},
                                                              {"initials[2]", "floret"},
                                                              {"tip_diameter_mm[0]", "floret_tip_mm"},
                                                              {"tip_diameter_mm[1]", "abaxial_tip_mm"},
                                                              {"tip_diameter_mm[2]", "adaxial_tip_mm"}};
    for (const auto& [cpp, key] : kNames) {
      if (error->where.starts_with(cpp)) {
        error->where.replace(0, std::string_view(cpp).size(), key);
      }
    }
    error->where.insert(0, "vasculature.");
  }
  return error;
}

std::optional<Error> check_pigment(const Pigment& pigment) {
  const std::string where = "pigments." + pigment.name;
  if (pigment.colour.empty()) {
    return invalid_parameter(where + ".colour", "must have at least 1 stop", 0.0);
  }
  for (std::size_t i = 0; i < pigment.colour.size(); ++i) {
    if (auto error =
            check_number(where + ".colour", pigment.colour[i].at, i > 0 ? pigment.colour[i - 1].at : 0.0, 1.0)) {
      return error;
    }
  }
  if (auto error = check_number(where + ".margin_width", pigment.margin_width, 1e-3, 1.0))
    return error;
  if (auto error = check_number(where + ".veins", pigment.veins, 0, 64))
    return error;
  if (auto error = check_range(where + ".hue_deg", pigment.hue_deg, -180.0, 180.0))
    return error;
  if (auto error = check_range(where + ".value", pigment.value, 0.0, 2.0))
    return error;
  const std::pair<const char*, double> shares[] = {
      {"vein_depth", pigment.vein_depth}, {"mottle", pigment.mottle}, {"roughness", pigment.roughness},
      {"specular", pigment.specular},     {"sheen", pigment.sheen},   {"translucency", pigment.translucency}};
  for (const auto& [name, value] : shares) {
    if (auto error = check_number(where + "." + name, value, 0.0, 1.0))
      return error;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> check(const Species& species) {
  std::vector<std::string> organs;
  std::vector<std::string> pigments;
  for (const OrganKind& organ : species.organs) {
    organs.push_back(organ.name);
  }
  for (const Pigment& pigment : species.pigments) {
    pigments.push_back(pigment.name);
  }
  if (auto error = check_unique("organs", organs))
    return error;
  if (auto error = check_unique("pigments", pigments))
    return error;
  for (const Pigment& pigment : species.pigments) {
    if (auto error = check_pigment(pigment))
      return error;
  }
  for (const OrganKind& organ : species.organs) {
    if (auto error = check_organ(organ, pigments))
      return error;
  }
  if (auto error = check_head("head", species.head, organs, pigments))
    return error;
  for (const OrganKind& organ : species.organs) {
    if (organ.head) {
      const std::string path = "organs." + organ.name + ".head";
      if (auto error = check_head(path, *organ.head, organs, pigments))
        return error;
      if (auto error = check_carried(path, *organ.head))
        return error;
    }
  }
  if (auto error = check_levels(species))
    return error;
  if (species.vasculature) {
    if (auto error = check_veins(species))
      return error;
  }
  const Peduncle& peduncle = species.peduncle;
  if (auto error = check_number("peduncle.length_mm", peduncle.length_mm, 0.0, 1e5))
    return error;
  if (auto error = check_number("peduncle.radius_mm", peduncle.radius_mm, 1e-3, 1e4))
    return error;
  if (auto error = check_number("peduncle.bend_deg", peduncle.bend_deg, -180.0, 180.0))
    return error;
  if (auto error = check_function_values("peduncle.growth", peduncle.growth, 1e-3, 1e3))
    return error;
  for (std::size_t i = 0; i < peduncle.hairs.size(); ++i) {
    const Hairs& hairs = peduncle.hairs[i];
    const std::string where = "peduncle.hairs[" + std::to_string(i) + "]";
    if (!hairs.on.empty()) {
      return invalid_parameter(where + ".on", "must be left out: they stand on the stem", hairs.on);
    }
    if (hairs.lower) {
      return invalid_parameter(where + ".lower", "must be false on the stem, which has only an outside", "true");
    }
    if (auto error = check(hairs, where))
      return error;
    if (auto error = check_name(where + ".pigment", hairs.pigment, pigments, "a pigment"))
      return error;
  }
  if (peduncle.length_mm > 0.0) {
    return check_name("peduncle.pigment", peduncle.pigment, pigments, "a pigment");
  }
  return std::nullopt;
}

}  // namespace anthesis
