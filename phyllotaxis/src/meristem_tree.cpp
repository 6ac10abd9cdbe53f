#include "anthesis/phyllotaxis/meristem_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"

namespace anthesis {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// The first time t with t - start >= age as doubles go: a meristem's own count of births by its age and the tree's by
/// time are then the same at every time that can be asked for.
double first_time(double start, double age) {
  double time = start + age;
  while (time - start < age) {
    time = std::nextafter(time, kNever);
  }
  for (double before = std::nextafter(time, -kNever); before - start >= age; before = std::nextafter(time, -kNever)) {
    time = before;
  }
  return time;
}

/// Age at which a primordium of this mature area becomes a meristem.
double onset_age(const MeristemLevel& level, const MeristemDynamicsParams& parent, double mature_area_mm2) {
  if (!(level.onset_area_mm2 > 0.0)) {
    return level.onset_age;
  }
  const double newborn = mature_area_mm2 * parent.area_growth(0.0);
  return std::max(level.onset_age, parent.area_growth.when(0.0, level.onset_area_mm2 / newborn));
}

Vec2 rim(const SurfaceOfRevolution& surface) {
  return surface.profile_mm().controls.back();
}

}  // namespace

std::optional<Error> check(const MeristemTreeParams& params) {
  if (params.levels.empty()) {
    return invalid_parameter("levels", "must have at least 1 entry", 0.0);
  }
  for (std::size_t i = 0; i < params.levels.size(); ++i) {
    const MeristemLevel& level = params.levels[i];
    const std::string where = "levels[" + std::to_string(i) + "].";
    if (auto error = check(level.dynamics)) {
      error->where = where + error->where;
      return error;
    }
    for (std::size_t k = 0; k < level.dynamics.profiles.size(); ++k) {
      const double radius = level.dynamics.profiles[k].controls.back().x;
      if (!(radius > 0.0)) {
        return invalid_parameter(where + "receptacle[" + std::to_string(k) + "].points",
                                 "must end at a rim of radius > 0", radius);
      }
    }
    if (!(level.onset_age >= 0.0) || !std::isfinite(level.onset_age)) {
      return invalid_parameter(where + "onset_age", "must be finite and >= 0", level.onset_age);
    }
    if (!(level.onset_area_mm2 >= 0.0) || !std::isfinite(level.onset_area_mm2)) {
      return invalid_parameter(where + "onset_area_mm2", "must be finite and >= 0", level.onset_area_mm2);
    }
  }
  if (params.depth < 1) {
    return invalid_parameter("depth", "must be >= 1", params.depth);
  }
  if (!(params.fill > 0.0 && params.fill <= 1.0)) {
    return invalid_parameter("fill", "must be in (0, 1]", params.fill);
  }
  return std::nullopt;
}

Expected<MeristemTree> MeristemTree::run(MeristemTreeParams params, std::size_t limit, const Progress& progress) {
  if (auto error = check(params)) {
    return unexpected(*error);
  }
  MeristemTree tree(std::move(params));
  for (std::size_t i = 0; i < tree.params_.levels.size(); ++i) {
    auto dynamics = MeristemDynamics::run(tree.params_.levels[i].dynamics, limit, progress);
    if (!dynamics) {
      Error error = dynamics.error();
      error.where = error.where.empty() ? "" : "levels[" + std::to_string(i) + "]." + error.where;
      return unexpected(error);
    }
    tree.dynamics_.push_back(std::move(*dynamics));
  }
  if (auto error = tree.bear(limit, progress)) {
    return unexpected(*error);
  }
  return tree;
}

std::optional<Error> MeristemTree::bear(std::size_t limit, const Progress& progress) {
  std::vector<std::vector<double>> onset_ages(dynamics_.size());  // of the elements of a level's meristems
  for (std::size_t i = 0; i < dynamics_.size(); ++i) {
    for (const Primordium& primordium : dynamics_[i].primordia()) {
      onset_ages[i].push_back(
          onset_age(params_.levels[entry(i + 1)], dynamics_[i].params(), primordium.mature_area_mm2));
    }
  }
  std::vector<MeristemElement> unsorted(1);
  for (std::size_t i = 0; i < unsorted.size(); ++i) {
    const MeristemElement parent = unsorted[i];
    if (!(parent.onset <= 1.0)) {
      continue;
    }
    const std::uint32_t level = parent.level + 1;
    const bool last = level == static_cast<std::uint32_t>(params_.depth);
    const MeristemDynamics& pattern = dynamics(parent.level);
    const std::span<const Primordium> primordia = pattern.primordia();
    for (std::size_t k = 0; k < primordia.size(); ++k) {
      MeristemElement element;
      element.parent = static_cast<std::uint32_t>(i);
      element.level = level;
      element.order = static_cast<std::uint32_t>(k);
      element.birth = first_time(parent.onset, primordia[k].birth);
      element.azimuth_rad = primordia[k].azimuth_rad;
      if (element.birth > 1.0) {
        break;
      }
      if (unsorted.size() >= limit) {
        return Error{ErrorCode::kTooLarge, "depth",
                     "must give at most " + std::to_string(limit) + " elements, got more"};
      }
      const double age = last ? kNever : onset_ages[entry(parent.level)][k];
      element.onset = element.birth + age <= 1.0 ? element.birth + age : kNever;
      unsorted.push_back(element);
    }
    if (i % 256 == 0 && !report(progress, "elements", static_cast<double>(i) / static_cast<double>(unsorted.size()))) {
      return Error{ErrorCode::kCancelled, "", "cancelled"};
    }
  }

  // The list runs level by level, so a stable order by birth keeps every element behind its parent.
  std::vector<std::uint32_t> by_birth(unsorted.size());
  std::iota(by_birth.begin(), by_birth.end(), 0u);
  std::stable_sort(by_birth.begin(), by_birth.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return unsorted[a].birth < unsorted[b].birth; });
  std::vector<std::uint32_t> rank(unsorted.size());
  first_child_.assign(unsorted.size() + 1, 0);
  for (std::uint32_t i = 0; i < by_birth.size(); ++i) {
    rank[by_birth[i]] = i;
    elements_.push_back(unsorted[by_birth[i]]);
    if (i > 0) {
      elements_[i].parent = rank[elements_[i].parent];
      ++first_child_[elements_[i].parent + 1];
    }
  }
  std::partial_sum(first_child_.begin(), first_child_.end(), first_child_.begin());
  children_.resize(elements_.size() - 1);
  for (std::uint32_t i = 1; i < elements_.size(); ++i) {
    children_[first_child_[elements_[i].parent] + elements_[i].order] = i;
  }
  return std::nullopt;
}

std::size_t MeristemTree::entry(std::size_t level) const {
  return std::min(level, params_.levels.size() - 1);
}

const MeristemDynamics& MeristemTree::dynamics(std::size_t level) const {
  return dynamics_[entry(level)];
}

std::size_t MeristemTree::born(double time) const {
  const auto end = std::upper_bound(elements_.begin(), elements_.end(), time,
                                    [](double t, const MeristemElement& element) { return t < element.birth; });
  return static_cast<std::size_t>(end - elements_.begin());
}

std::vector<Placement> MeristemTree::places(double time) const {
  const std::size_t count = born(time);
  std::vector<std::uint32_t> meristems;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (elements_[i].onset <= time) {
      meristems.push_back(i);
    }
  }
  // First each element in its parent's frame, which needs no other meristem's, then one out of the other.
  std::vector<Placement> places(count);
  parallel_for(meristems.size(), [&](std::size_t m) {
    const std::uint32_t parent = meristems[m];
    const MeristemElement& element = elements_[parent];
    const MeristemDynamics& pattern = dynamics(element.level);
    const double age = time - element.onset;
    const SurfaceOfRevolution surface = pattern.surface(age);
    const Vec2 base = rim(surface);
    const std::vector<PrimordiumPlace> on_surface = pattern.places(age, surface);
    // As many as are born, save beyond time 1, for which the tree has no elements.
    const std::size_t children = first_child_[parent + 1] - first_child_[parent];
    for (std::size_t k = 0; k < std::min(children, on_surface.size()); ++k) {
      const std::uint32_t child = children_[first_child_[parent] + k];
      const SurfaceFrame frame = surface.frame(on_surface[k].t, elements_[child].azimuth_rad);
      Placement& place = places[child];
      place.position_mm = (frame.position_mm - Vec3{0.0, 0.0, base.y}) / base.x;
      place.rotation = rotation_from_axes(frame.meridian, frame.parallel, frame.normal);
      place.scale = std::sqrt(params_.fill * on_surface[k].area_mm2 / math::kPi) / base.x;
    }
    if (parent == 0) {
      places[0] = {{0.0, 0.0, base.y}, {}, base.x};
    }
  });
  for (std::size_t i = 1; i < count; ++i) {
    places[i] = places[elements_[i].parent] * places[i];
    places[i].rotation = normalized(places[i].rotation);
  }
  return places;
}

SurfaceOfRevolution MeristemTree::surface(std::size_t element, double time) const {
  const MeristemElement& e = elements_[element];
  const SurfaceOfRevolution grown = dynamics(e.level).surface(std::max(0.0, time - e.onset));
  const Vec2 base = rim(grown);
  std::vector<Vec2> controls = grown.profile_mm().controls;
  for (Vec2& control : controls) {
    control = (control - Vec2{0.0, base.y}) / base.x;
  }
  return SurfaceOfRevolution(std::move(controls), grown.profile_mm().degree);
}

}  // namespace anthesis
