#include "anthesis/exchange/vlab_species.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anthesis/base/check.h"
#include "anthesis/base/math.h"
#include "anthesis/exchange/vlab_digitised_head.h"
#include "anthesis/phyllotaxis/ridley.h"

namespace anthesis {
namespace {

constexpr int kDegree = 3;
constexpr int kFunctionPoints = 33;

/// Control points of a function over [0, 1] that is f at 33 places.
template <class Function>
FunctionPoints fitted(const Function& f) {
  std::vector<Vec2> values;
  for (const double x : greville_places(kFunctionPoints, kDegree)) {
    values.push_back({x, f(x)});
  }
  return interpolating_controls(std::move(values), kDegree);
}

std::optional<Error> check(const VlabScale& scale) {
  if (auto error = check_number("width_mm", scale.width_mm, 0.01, 1e4)) {
    return error;
  }
  if (!(scale.radius_factor > 0.0 && scale.radius_factor <= 1000.0)) {
    return invalid_parameter("radius_factor", "must be > 0 and at most 1000", scale.radius_factor);
  }
  return std::nullopt;
}

double widest(std::span<const Vec2> controls, int degree) {
  const BSplineCurve<Vec2> curve{degree, {controls.begin(), controls.end()}};
  double radius = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    radius = std::max(radius, curve.at(i / 1000.0).x);
  }
  return radius;
}

/// By its drawn ends.
bool drawn_from_base(const VlabContour& contour) {
  const BSplineCurve<Vec3> spline = vlab_spline(contour);
  return spline.controls.back().x < spline.controls.front().x;
}

// ---- the parts of a species that VLab's files say nothing about
// ------------------------------------------------------

/// A bead of radius 1 mm that stands on the receptacle, scaled to the disc of its organ's area.
OrganKind bead(const std::string& name, const std::string& pigment) {
  Column column;
  column.name = "bead";
  column.pigment = pigment;
  column.sides = 10;
  column.rings = 7;
  // A cubic that keeps within 3 % of the half circle.
  const std::vector<Vec2> half_circle = {{0.0, 0.0}, {0.55, 0.0}, {1.05, 0.45}, {1.05, 1.55}, {0.55, 2.0}, {0.0, 2.0}};
  column.poses = {{.stage = 0.0, .profile_mm = half_circle, .lean_deg = 0.0}};
  OrganKind kind;
  kind.name = name;
  kind.shape.columns = {column};
  kind.growth = {{0.0, 0.2}, {0.1, 1.0}, {1.0, 1.0}};
  kind.fits_radius_mm = 1.0;
  return kind;
}

Pigment plain(const std::string& name, Colour colour) {
  Pigment pigment;
  pigment.name = name;
  pigment.colour = {{0.0, colour}};
  return pigment;
}

Species bare_species(std::string_view name) {
  Species species;
  for (const char c : name) {  // a folder's name may be anything, a species' may not
    const bool fits = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-';
    species.name += fits ? c : '_';
  }
  if (species.name.empty()) {
    species.name = "head";
  }
  species.summary = "a flower head imported from the Virtual Laboratory";
  species.pigments = {plain("receptacle", {0.18, 0.3, 0.08})};
  species.head.rule = PlacementRule::kRidley;
  species.head.receptacle_pigment = "receptacle";
  return species;
}

void add_kind(Species& species, const std::string& name, Colour colour) {
  species.pigments.push_back(plain(name, colour));
  species.organs.push_back(bead(name, name));
}

// ---- heads that grow ------------------------------------------------------------------------------------------------

constexpr double kRounding = 0.0005;  // mean of what O24's programs take off a primordium's place in the tissue
constexpr double kFirstThreshold = 3.5 * math::kPi / 100.0;  // in units of the files

/// What the programs of O24 state of each of its heads, and their files do not; as it stands here for other heads.
struct HeadConstants {
  double threshold = kFirstThreshold;  ///< factor of the function thresholdDistanceFunc
  double threshold_pace = 1.0;         ///< factor of its time
  int bract_landmark = 0;
  int trans_landmark = 0;
  double last_ring = 0.0025;
  double scale_mm = 0.0;  ///< a unit of the files, where heads have the sizes of O24's tables
};

HeadConstants constants_of(HeadModel model) {
  switch (model) {
    case HeadModel::kBellis:
      return {.bract_landmark = 3, .last_ring = 0.01, .scale_mm = 15.0};
    case HeadModel::kSunflower:
      return {.threshold = 0.45 * kFirstThreshold, .threshold_pace = 2.0, .bract_landmark = 8, .scale_mm = 10.0};
    case HeadModel::kGerbera:
      break;
  }
  return {.bract_landmark = 6, .trans_landmark = 11, .scale_mm = 15.0};
}

/// Files of VLab state six digits after the point; more than nine here would be noise.
double rounded(double value) {
  return std::round(value * 1e9) / 1e9;
}

/// The drawn function as control points, value and argument scaled.
Expected<FunctionPoints> scaled(const VlabFunction& function, double x_factor, double y_factor) {
  if (auto graph = vlab_graph(function); !graph) {
    return unexpected(graph.error());
  }
  FunctionPoints points;
  for (const Vec2 control : vlab_controls(function)) {
    points.push_back({rounded(x_factor * control.x), rounded(y_factor * control.y)});
  }
  return points;
}

Expected<Species> growing_head(std::string_view name, const VlabObject& object, const VlabScale& scale) {
  Expected<DigitisedHead> head = vlab_digitised_head(object.contours, object.knots, 1.0);
  if (!head) {
    return unexpected(head.error());
  }
  const HeadConstants constants = scale.like ? constants_of(*scale.like) : HeadConstants{};
  const double unit_mm =
      scale.like ? constants.scale_mm : 0.5 * scale.width_mm / widest(head->sections.back().profile.controls, kDegree);
  Species species = bare_species(name);
  species.head.rule = PlacementRule::kActiveRing;
  species.collisions = false;  // beads of the size of their places
  ActiveRing& ring = species.head.active_ring.emplace();
  for (DigitisedSection& section : head->sections) {
    for (Vec2& point : section.profile.controls) {
      point = {rounded(unit_mm * point.x), rounded(unit_mm * point.y)};
    }
    ring.sections.push_back({std::move(section.profile.controls), std::move(section.landmarks), section.ring});
  }
  ring.knots = std::move(head->knots);
  const VlabFunction* threshold = object.find_function("thresholdDistanceFunc");
  if (threshold == nullptr) {
    return unexpected(invalid_parameter("functions", "must hold one named thresholdDistanceFunc", "none"));
  }
  auto threshold_mm = scaled(*threshold, 1.0 / constants.threshold_pace, unit_mm * constants.threshold);
  if (!threshold_mm) {
    return unexpected(threshold_mm.error());
  }
  ring.threshold_mm = std::move(*threshold_mm);
  ring.last_ring = constants.last_ring;
  ring.lag = scale.like ? kRounding : 0.0;
  const int landmarks = static_cast<int>(ring.sections.back().landmarks.size());
  const auto had = [&](int landmark) { return landmark <= landmarks ? landmark : 0; };  // heads of other people
  ring.bract_landmark = had(constants.bract_landmark);
  ring.trans_landmark = had(constants.trans_landmark);
  ring.floret = "floret";
  add_kind(species, ring.floret, {0.75, 0.5, 0.03});
  ring.trans_floret = "trans_floret";
  add_kind(species, ring.trans_floret, {0.8, 0.75, 0.6});
  ring.bract = "bract";
  add_kind(species, ring.bract, {0.2, 0.4, 0.08});
  if (scale.like) {
    HeadVeins& veins = species.vasculature.emplace();
    veins.params = vein_params(*scale.like, scale.source);
    if (const VlabFunction* pace = object.find_function("output_dalpha")) {
      auto points = scaled(*pace, 1.0, 1.0);
      if (!points) {
        return unexpected(points.error());
      }
      veins.pace = std::move(*points);
      veins.clock = VeinClock::kPublished;
    }
  }
  return species;
}

Expected<Species> ridley_head(std::string_view name, const VlabObject& object, const VlabFunction& rho,
                              const VlabScale& scale) {
  const Expected<VlabRidley> model = vlab_ridley(object.contours.front(), rho, scale);
  if (!model) {
    return unexpected(model.error());
  }
  Species species = bare_species(name);
  species.head.receptacle = {{0.0, model->surface.profile_mm().controls}};
  species.head.area_mm2 = fitted([&](double s) { return model->area_mm2(s); });
  const std::vector<double> places = place_organs(model->surface, model->area_mm2, SpiralDirection::kFromBase, 100'000);
  species.head.interval = std::clamp(0.8 / static_cast<double>(std::max<std::size_t>(places.size(), 1)), 1e-6, 1.0);
  add_kind(species, "organ", {0.5, 0.6, 0.1});
  species.head.zones = {{"organ", 0.0, 1.0}};
  return species;
}

bool has_markers(const std::vector<VlabContour>& contours) {
  return std::any_of(contours.begin(), contours.end(), [](const VlabContour& c) { return !c.markers.empty(); });
}

}  // namespace

bool is_vlab_head_file(std::string_view file_name) {
  for (const std::string_view end : {".con", ".cset", ".func", ".fset", "knotPositions.dat"}) {
    if (file_name.ends_with(end)) {
      return true;
    }
  }
  return false;
}

const VlabFunction* VlabObject::find_function(std::string_view name) const {
  const auto found = std::find_if(functions.begin(), functions.end(), [&](const auto& f) { return f.name == name; });
  return found == functions.end() ? nullptr : &*found;
}

Expected<VlabObject> read_vlab_object(std::span<const VlabFile> files) {
  std::vector<const VlabFile*> sorted;
  for (const VlabFile& file : files) {
    sorted.push_back(&file);
  }
  std::sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
  VlabObject object;
  for (const VlabFile* file : sorted) {
    if (file->name.ends_with(".con") || file->name.ends_with(".cset")) {
      auto contours = read_vlab_contours(file->bytes, file->name);
      if (!contours) {
        return unexpected(contours.error());
      }
      if (has_markers(*contours) && !has_markers(object.contours)) {
        object.contours = std::move(*contours);
      } else if (!has_markers(object.contours)) {
        object.contours.insert(object.contours.end(), contours->begin(), contours->end());
      }
    } else if (file->name.ends_with(".func") || file->name.ends_with(".fset")) {
      auto functions = read_vlab_functions(file->bytes, file->name);
      if (!functions) {
        return unexpected(functions.error());
      }
      object.functions.insert(object.functions.end(), functions->begin(), functions->end());
    } else if (file->name.ends_with("knotPositions.dat")) {
      auto knots = read_vlab_knots(file->bytes, file->name);
      if (!knots) {
        return unexpected(knots.error());
      }
      object.knots = std::move(*knots);
    }
  }
  return object;
}

Expected<VlabRidley> vlab_ridley(const VlabContour& profile, const VlabFunction& rho, const VlabScale& scale) {
  if (auto error = check(scale)) {
    return unexpected(*error);
  }
  Expected<std::vector<Vec2>> controls = vlab_profile(profile);
  if (!controls) {
    return unexpected(controls.error());
  }
  const Expected<FunctionGraph> drawn = vlab_graph(rho);
  if (!drawn) {
    return unexpected(drawn.error());
  }
  const double unit_mm = 0.5 * scale.width_mm / widest(*controls, kDegree);
  for (Vec2& point : *controls) {
    point = unit_mm * point;
  }
  const bool from_base = drawn_from_base(profile);
  const auto radius_mm = [&](double s) { return unit_mm * scale.radius_factor * (*drawn)(from_base ? 1.0 - s : s); };
  FunctionPoints radii = fitted(radius_mm);
  FunctionPoints areas = fitted([&](double s) { return math::kPi * radius_mm(s) * radius_mm(s); });
  for (const FunctionPoints* points : {&radii, &areas}) {
    for (const Vec2 point : *points) {
      if (!(point.y > 0.0)) {
        return unexpected(invalid_parameter(rho.name, "must be > 0 over the whole profile", point.y));
      }
    }
  }
  return VlabRidley{SurfaceOfRevolution(std::move(*controls), kDegree), FunctionGraph(std::move(radii)),
                    FunctionGraph(std::move(areas))};
}

Expected<Species> species_from_vlab(std::string_view name, const VlabObject& object, const VlabScale& scale) {
  if (auto error = check(scale)) {
    return unexpected(*error);
  }
  const VlabFunction* rho = object.find_function("rho");
  if (object.contours.empty()) {
    return unexpected(invalid_parameter("contours", "must come with a .con or .cset file", "none"));
  }
  const bool grows = has_markers(object.contours);
  if (!grows && rho == nullptr) {
    return unexpected(invalid_parameter(
        "files", "must hold contours with markers, or one contour and a function named rho", "neither"));
  }
  Expected<Species> species = grows ? growing_head(name, object, scale) : ridley_head(name, object, *rho, scale);
  if (species) {
    if (auto error = anthesis::check(*species)) {
      return unexpected(*error);
    }
  }
  return species;
}

}  // namespace anthesis
