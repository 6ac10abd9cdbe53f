#include "anthesis/exchange/vlab_species.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "anthesis/base/check.h"
#include "anthesis/base/math.h"
#include "anthesis/phyllotaxis/ridley.h"

namespace anthesis {
namespace {

constexpr int kDegree = 3;
constexpr int kFunctionPoints = 33;
constexpr int kOutlinePoints = 24;
constexpr int kStages = 9;            // outlines of a growing head
constexpr double kStepTime = 0.0005;  // of the models of O24: progress by step

/// Where each control point of a clamped uniform cubic B-spline acts most: the means of its knots (Greville). With
/// these as the abscissae of a function's control points, x(u) = u.
std::vector<double> greville(int count) {
  std::vector<double> places;
  const auto knot = [count](int i) { return std::clamp(i - kDegree, 0, count - kDegree); };
  for (int i = 0; i < count; ++i) {
    const int sum = knot(i + 1) + knot(i + 2) + knot(i + 3);
    places.push_back(static_cast<double>(sum) / (kDegree * (count - kDegree)));
  }
  return places;
}

/// Control points of the spline that takes the given values at its Greville abscissae. Gauss without pivoting: the
/// matrix is totally positive.
std::vector<Vec2> interpolating(std::vector<Vec2> values) {
  const int count = static_cast<int>(values.size());
  const std::vector<double> places = greville(count);
  std::vector<std::vector<double>> rows(values.size(), std::vector<double>(values.size(), 0.0));
  for (int i = 0; i < count; ++i) {
    const BasisFunctions basis = clamped_basis(count, kDegree, places[i]);
    std::copy_n(basis.weight.begin(), basis.count, rows[i].begin() + basis.first);
  }
  for (int column = 0; column < count; ++column) {
    for (int row = column + 1; row < count; ++row) {
      const double factor = rows[row][column] / rows[column][column];
      if (factor != 0.0) {
        for (int k = column; k < count; ++k) {
          rows[row][k] -= factor * rows[column][k];
        }
        values[row] = values[row] - factor * values[column];
      }
    }
  }
  for (int row = count - 1; row >= 0; --row) {
    for (int k = row + 1; k < count; ++k) {
      values[row] = values[row] - rows[row][k] * values[k];
    }
    values[row] = values[row] / rows[row][row];
  }
  return values;
}

/// Control points of a function over [0, 1] that is f at 33 places.
template <class Function>
FunctionPoints fitted(const Function& f) {
  std::vector<Vec2> values;
  for (const double x : greville(kFunctionPoints)) {
    values.push_back({x, f(x)});
  }
  return interpolating(std::move(values));
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

/// The drawn ends of an open uniform curve: its first and last point.
bool drawn_from_base(const VlabContour& contour) {
  const BSplineCurve<Vec3> spline = vlab_spline(contour);
  return spline.controls.back().x < spline.controls.front().x;
}

// ---- the parts of a species that VLab's files say nothing about
// -------------------------------------------------------

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

/// Outline of a head at a time, up to `reach` of its length, in the drawing's units.
class Outlines {
 public:
  explicit Outlines(const VlabStages& stages) : stages_(stages) {
    for (const VlabContour& contour : stages.contours) {
      curves_.emplace_back(contour);
    }
  }

  Vec2 at(const std::vector<double>& weights, double s) const {
    Vec3 sum{};
    for (std::size_t i = 0; i < weights.size(); ++i) {
      sum += weights[i] * curves_[i].at(s);
    }
    return {std::max(sum.x, 0.0), sum.y};
  }

  /// Control points for SurfaceOfRevolution.
  std::vector<Vec2> controls(double time, double reach) const {
    const std::vector<double> weights = stages_.weights(time);
    std::vector<Vec2> points;
    for (const double t : greville(kOutlinePoints)) {
      points.push_back(at(weights, t * reach));
    }
    points = interpolating(std::move(points));
    for (Vec2& point : points) {
      point.x = std::max(point.x, 0.0);
    }
    points.front().x = 0.0;
    points[1].y = points[0].y;  // smooth over the apex
    return points;
  }

 private:
  const VlabStages& stages_;
  std::vector<VlabCurve> curves_;
};

/// Mature area of an organ against s, from where organs stand: such that each stretch of the profile holds as many
/// bands as there are organs on it, and all of it half a band more than all organs.
FunctionPoints areas_of(const SurfaceOfRevolution& surface, const std::vector<double>& s_of_rank) {
  const std::size_t count = s_of_rank.size();
  const auto area_at = [&](double s) { return surface.area_from_apex_mm2(surface.t_from_s(s)); };
  // Organ k stands in the middle of its band: borders lie half way between neighbours.
  const auto border = [&](std::size_t k) {
    return k == 0 ? 1.0 : k == count ? 0.0 : 0.5 * (s_of_rank[k - 1] + s_of_rank[k]);
  };
  constexpr double kSpare = 0.1;  // of a band
  struct Stretch {
    double from = 0.0;
    double to = 0.0;
    double organs = 0.0;
  };
  std::vector<Stretch> parts;  // ascending s
  FunctionPoints points;
  const double least = 1e-3 * surface.area_mm2() / static_cast<double>(count);
  // Organs differ most at the rim: stretches grow from 2 organs there to a twelfth of them all.
  std::vector<std::size_t> cuts = {0};
  const std::size_t longest = std::max<std::size_t>(count / 12, 2);
  for (std::size_t length = 2; cuts.back() + length + longest / 2 < count; length = std::min(length + 1, longest)) {
    cuts.push_back(cuts.back() + length);
  }
  cuts.push_back(count);
  for (std::size_t i = cuts.size() - 1; i-- > 0;) {
    const double spare = cuts[i + 1] == count ? kSpare : 0.0;
    const Stretch part{border(cuts[i + 1]), border(cuts[i]), static_cast<double>(cuts[i + 1] - cuts[i]) + spare};
    const double area = area_at(part.to) - area_at(part.from);
    parts.push_back(part);
    points.push_back({0.5 * (part.from + part.to), std::max(area / part.organs, least)});
  }
  points.insert(points.begin(), Vec2{0.0, points.front().y});
  points.push_back({1.0, points.back().y});
  // The curve leans towards its control points without reaching them: correct each by what its stretch then holds.
  constexpr int kRounds = 3;  // more would follow the scatter of single organs
  constexpr int kSteps = 50;
  for (int round = 0; round <= kRounds; ++round) {
    const FunctionGraph graph(points);
    double organs = 0.0;
    double all_bands = 0.0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      double bands = 0.0;
      double before = area_at(parts[i].from);
      const double step = (parts[i].to - parts[i].from) / kSteps;
      for (int k = 0; k < kSteps; ++k) {
        const double after = area_at(parts[i].from + (k + 1) * step);
        bands += (after - before) / graph(parts[i].from + (k + 0.5) * step);
        before = after;
      }
      organs += parts[i].organs;
      all_bands += bands;
      if (round < kRounds) {  // the square root damps what neighbours do to each other
        points[i + 1].y = std::max(std::sqrt(bands / parts[i].organs) * points[i + 1].y, least);
      }
    }
    points.front().y = points[1].y;
    points.back().y = points[points.size() - 2].y;
    if (round == kRounds) {  // what single stretches miss, the whole does not
      for (Vec2& point : points) {
        point.y *= all_bands / organs;
      }
    }
  }
  return points;
}

/// Types of primordia, outermost first, with how many there are of each.
std::vector<std::pair<int, std::size_t>> types_from_rim(const std::vector<VlabPrimordium>& primordia) {
  std::map<int, std::pair<double, std::size_t>> sums;
  for (const VlabPrimordium& one : primordia) {
    sums[one.type].first += one.s;
    ++sums[one.type].second;
  }
  std::vector<std::pair<int, std::size_t>> types;
  for (const auto& [type, sum] : sums) {
    types.emplace_back(type, sum.second);
  }
  std::stable_sort(types.begin(), types.end(), [&](const auto& a, const auto& b) {
    const auto mean = [&](int type) { return sums[type].first / static_cast<double>(sums[type].second); };
    return mean(a.first) > mean(b.first);
  });
  return types;
}

void add_kinds(Species& species, const std::vector<VlabPrimordium>& primordia, const std::vector<double>& s_of_rank) {
  const std::vector<std::pair<int, std::size_t>> types = types_from_rim(primordia);
  const Colour green{0.1, 0.35, 0.06};
  const Colour white{0.9, 0.9, 0.85};
  const Colour yellow{0.9, 0.6, 0.03};
  double to = 1.0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < types.size(); ++i) {
    const bool last = i + 1 == types.size();
    const std::string name = types.size() == 1 ? "organ"
                             : last            ? "floret"
                             : i == 0          ? "bract"
                             : i == 1          ? "ray_floret"
                                               : "floret_" + std::to_string(types[i].first);
    used += types[i].second;
    const double from = last ? 0.0 : 0.5 * (s_of_rank[used - 1] + s_of_rank[used]);
    if (from < to) {
      add_kind(species, name, last ? yellow : i == 0 ? green : white);
      species.head.zones.push_back({name, from, to});
      to = from;
    }
  }
}

Expected<Species> growing_head(std::string_view name, const VlabObject& object, const VlabScale& scale) {
  const Expected<VlabStages> stages = vlab_stages(object.contours, object.knots);
  if (!stages) {
    return unexpected(stages.error());
  }
  for (const VlabContour& contour : stages->contours) {
    if (auto profile = vlab_profile(contour); !profile) {
      return unexpected(profile.error());
    }
    if (drawn_from_base(contour)) {
      return unexpected(invalid_parameter(contour.name, "must run from the apex to the base", "the other way"));
    }
  }
  std::vector<double> s_of_rank;
  for (const VlabPrimordium& one : object.mature) {
    s_of_rank.push_back(one.s);
  }
  std::sort(s_of_rank.begin(), s_of_rank.end(), std::greater<>());
  const auto outermost = [](const std::vector<VlabPrimordium>& primordia) {
    double s = 0.0;
    for (const VlabPrimordium& one : primordia) {
      s = std::max(s, one.s);
    }
    return s;
  };
  // The underside of the head carries no organs and is left off: the outline ends half an organ below the outermost.
  const std::size_t count = s_of_rank.size();
  const double half_organ = count > 8 ? (s_of_rank[0] - s_of_rank[8]) / 16.0 : 0.0;
  const double last_reach = std::min(1.0, s_of_rank[0] + half_organ);
  const double first_reach = object.born.empty() ? last_reach : std::min(1.0, outermost(object.born) + half_organ);

  Species species = bare_species(name);
  const Outlines outlines(*stages);
  std::vector<std::vector<Vec2>> controls;
  std::vector<double> size;
  for (int i = 0; i < kStages; ++i) {
    const double time = static_cast<double>(i) / (kStages - 1);
    controls.push_back(outlines.controls(time, first_reach + time * (last_reach - first_reach)));
    if (auto error = check_profile("contours", controls.back())) {
      return unexpected(*error);
    }
    size.push_back(SurfaceOfRevolution(controls.back(), kDegree).length_mm());
  }
  // Size and shape apart: outlines of the mature length, and a factor that the organs shrink and grow by as well.
  const double unit_mm = 0.5 * scale.width_mm / widest(controls.back(), kDegree);
  for (int i = 0; i < kStages; ++i) {
    const double time = static_cast<double>(i) / (kStages - 1);
    for (Vec2& point : controls[i]) {
      point = (unit_mm * size.back() / size[i]) * point;
    }
    species.head.receptacle.push_back({time, controls[i]});
  }
  species.head.growth.clear();
  for (int i = 0; i < kStages; ++i) {
    species.head.growth.push_back({static_cast<double>(i) / (kStages - 1), size[i] / size.back()});
  }
  for (double& s : s_of_rank) {
    s /= last_reach;
  }
  const SurfaceOfRevolution surface(controls.back(), kDegree);
  species.head.area_mm2 = areas_of(surface, s_of_rank);
  species.head.count = static_cast<int>(count);
  std::uint32_t last_step = 0;
  for (const VlabPrimordium& one : object.born) {
    last_step = std::max(last_step, one.step);
  }
  const double births = object.born.empty() ? 0.8 : std::min(kStepTime * last_step, 0.95);
  species.head.interval = std::clamp(births / static_cast<double>(count), 1e-6, 1.0);
  add_kinds(species, object.mature, s_of_rank);
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
  for (const std::string_view end :
       {".con", ".cset", ".func", ".fset", "knotPositions.dat", "_initial.prims", "_final.prims"}) {
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
    } else if (file->name.ends_with("_initial.prims") || file->name.ends_with("_final.prims")) {
      auto primordia = read_vlab_primordia(file->bytes, file->name);
      if (!primordia) {
        return unexpected(primordia.error());
      }
      (file->name.ends_with("_final.prims") ? object.mature : object.born) = std::move(primordia->primordia);
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
  if (grows && object.mature.empty()) {
    return unexpected(invalid_parameter("primordia", "must come with a file *_final.prims", "none"));
  }
  if (!grows && rho == nullptr) {
    return unexpected(invalid_parameter(
        "files", "must hold contours with markers and *_final.prims, or one contour and a function named rho",
        "neither"));
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
