#include "anthesis/corolla/organ_shape.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "anthesis/base/check.h"
#include "anthesis/geometry/function_graph.h"

namespace anthesis {
namespace {

constexpr double kLongestMm = 1e5;  // 100 m: beyond any organ, and squares stay far from overflow

std::string at(std::string_view where, std::string_view list, std::size_t index) {
  return std::string(where) + "." + std::string(list) + "[" + std::to_string(index) + "]";
}

/// `before`: the stage of the pose before, less than 0 for the first.
std::optional<Error> check_stage(const std::string& where, double stage, double before) {
  if (!(stage >= 0.0 && stage <= 1.0 && stage > before)) {
    return invalid_parameter(where + ".stage", "must be in [0, 1] and later than the pose before", stage);
  }
  return std::nullopt;
}

/// Whether the way from `b` to `c` is that from `a` to `b` backwards, to some twenty degrees.
bool turns_back(const SectionPoint& a, const SectionPoint& b, const SectionPoint& c) {
  const Vec3 before{b.across - a.across, b.up - a.up, b.forward - a.forward};
  const Vec3 after{c.across - b.across, c.up - b.up, c.forward - b.forward};
  const double sizes = length(before) * length(after);
  return sizes > 0.0 && dot(before, after) < -0.94 * sizes;
}

std::optional<Error> check_pose(const PetalPose& pose, const Petals& petals, const std::string& where) {
  const std::size_t rows = pose.midrib_mm.size();
  if (rows < static_cast<std::size_t>(petals.degree_along) + 1) {
    return invalid_parameter(where + ".midrib_mm", "must have more points than degree_along",
                             static_cast<double>(rows));
  }
  double longest = 0.0;
  for (std::size_t j = 0; j < rows; ++j) {
    for (const double value : {pose.midrib_mm[j].x, pose.midrib_mm[j].y}) {
      if (auto error = check_number(where + ".midrib_mm", value, -kLongestMm, kLongestMm)) {
        return error;
      }
    }
    longest = std::max(longest, length(pose.midrib_mm[j] - pose.midrib_mm[0]));
  }
  if (!(longest > 0.0)) {
    return invalid_parameter(where + ".midrib_mm", "must have some length", longest);
  }
  if (pose.half_width_mm.size() != rows) {
    return invalid_parameter(where + ".half_width_mm", "must have one number for each midrib point",
                             static_cast<double>(pose.half_width_mm.size()));
  }
  for (const double value : pose.half_width_mm) {
    if (auto error = check_number(where + ".half_width_mm", value, 0.0, kLongestMm)) {
      return error;
    }
  }
  if (!pose.side_mm.empty() && pose.side_mm.size() != rows) {
    return invalid_parameter(where + ".side_mm", "must have one number for each midrib point",
                             static_cast<double>(pose.side_mm.size()));
  }
  for (const double value : pose.side_mm) {
    if (auto error = check_number(where + ".side_mm", value, -kLongestMm, kLongestMm)) {
      return error;
    }
  }
  if (pose.sections.size() > 1 && pose.sections.size() != rows) {
    return invalid_parameter(where + ".sections", "must be one for each midrib point",
                             static_cast<double>(pose.sections.size()));
  }
  for (const auto& section : pose.sections) {
    if (2 * section.size() < static_cast<std::size_t>(petals.degree_across) + 2) {
      return invalid_parameter(where + ".sections", "must have more points across than degree_across",
                               static_cast<double>(section.size()));
    }
    if (section.size() != pose.sections[0].size()) {
      return invalid_parameter(where + ".sections", "must have equal numbers of points",
                               static_cast<double>(section.size()));
    }
    for (std::size_t i = 0; i < section.size(); ++i) {
      for (const double value : {section[i].across, section[i].up, section[i].forward}) {
        if (auto error = check_number(where + ".sections", value, -100.0, 100.0)) {
          return error;
        }
      }
      if (i == 0 ? section[i].across != 0.0 : section[i].across < 0.0) {
        return invalid_parameter(where + ".sections", "must start across 0 at the midrib and stay on its side of it",
                                 section[i].across);
      }
      // A margin may roll inwards until it meets the other one, but a kink of half a turn is a mistake.
      if (i > 1 && turns_back(section[i - 2], section[i - 1], section[i])) {
        return invalid_parameter(where + ".sections", "must not turn straight back: roll inwards through up",
                                 section[i].across);
      }
    }
  }
  return std::nullopt;
}

std::optional<Error> check_petals(const OrganShape& shape, std::size_t index, const std::string& where) {
  const Petals& petals = shape.petals[index];
  if (auto error = check_whole(where + ".count", petals.count, 1, 64))
    return error;
  if (auto error = check_number(where + ".azimuth_deg", petals.azimuth_deg, -360.0, 360.0))
    return error;
  if (auto error = check_whole(where + ".fused", petals.fused, 0, 256))
    return error;
  if (auto error = check_whole(where + ".degree_across", petals.degree_across, 1, 5))
    return error;
  if (auto error = check_whole(where + ".degree_along", petals.degree_along, 1, 5))
    return error;
  if (auto error = check_function_values(where + ".spacing", petals.spacing, 0.002, 1.0))
    return error;
  if (auto error = check_function_values(where + ".vertices", petals.vertices, 1.0, 200.0))
    return error;
  if (petals.poses.empty()) {
    return invalid_parameter(where + ".poses", "must have at least 1 pose", 0.0);
  }
  for (std::size_t i = 0; i < petals.poses.size(); ++i) {
    const std::string pose_where = at(where, "poses", i);
    const PetalPose& pose = petals.poses[i];
    const PetalPose& first = petals.poses[0];
    const double before = i > 0 ? petals.poses[i - 1].stage : -1.0;
    if (auto error = check_stage(pose_where, pose.stage, before))
      return error;
    if (auto error = check_pose(pose, petals, pose_where))
      return error;
    const auto points_across = [](const PetalPose& p) { return p.sections.empty() ? 0 : p.sections[0].size(); };
    if (pose.midrib_mm.size() != first.midrib_mm.size() || points_across(pose) != points_across(first)) {
      return invalid_parameter(pose_where, "must have as many points along and across as the first pose",
                               static_cast<double>(pose.midrib_mm.size()));
    }
  }
  if (!petals.fused_with.empty()) {
    const auto end = shape.petals.begin() + static_cast<std::ptrdiff_t>(index);
    const auto other =
        std::find_if(shape.petals.begin(), end, [&](const Petals& p) { return p.name == petals.fused_with; });
    if (other == end) {
      return invalid_parameter(where + ".fused_with", "must name a set of petals that stands before",
                               petals.fused_with);
    }
    if (petals.count != 1 || other->count != 1 || other->mirrored || petals.azimuth_deg != 0.0 ||
        other->azimuth_deg != 0.0) {
      return invalid_parameter(where + ".fused_with", "must join petals of count 1 and azimuth_deg 0",
                               petals.fused_with);
    }
    if (petals.poses[0].midrib_mm.size() != other->poses[0].midrib_mm.size() ||
        petals.degree_along != other->degree_along) {
      return invalid_parameter(where + ".fused_with", "must have as many midrib points and the same degree_along",
                               petals.fused_with);
    }
  } else if (petals.mirrored && petals.fused > 0) {
    return invalid_parameter(where + ".fused", "must be 0 for a mirrored set, unless it is fused_with another",
                             petals.fused);
  }
  return std::nullopt;
}

std::optional<Error> check_column(const Column& column, const std::string& where) {
  if (auto error = check_whole(where + ".count", column.count, 1, 256))
    return error;
  if (auto error = check_number(where + ".azimuth_deg", column.azimuth_deg, -360.0, 360.0))
    return error;
  if (auto error = check_number(where + ".ring_radius_mm", column.ring_radius_mm, 0.0, kLongestMm))
    return error;
  if (auto error = check_number(where + ".base_mm", column.base_mm, -kLongestMm, kLongestMm))
    return error;
  if (auto error = check_whole(where + ".sides", column.sides, 3, 64))
    return error;
  if (auto error = check_whole(where + ".rings", column.rings, 2, 64))
    return error;
  if (auto error = check_whole(where + ".degree", column.degree, 1, 5))
    return error;
  if (column.poses.empty()) {
    return invalid_parameter(where + ".poses", "must have at least 1 pose", 0.0);
  }
  for (std::size_t i = 0; i < column.poses.size(); ++i) {
    const std::string pose_where = at(where, "poses", i);
    const ColumnPose& pose = column.poses[i];
    const double before = i > 0 ? column.poses[i - 1].stage : -1.0;
    if (auto error = check_stage(pose_where, pose.stage, before))
      return error;
    if (auto error = check_number(pose_where + ".lean_deg", pose.lean_deg, -180.0, 180.0))
      return error;
    if (pose.profile_mm.size() < static_cast<std::size_t>(column.degree) + 1 ||
        pose.profile_mm.size() != column.poses[0].profile_mm.size()) {
      return invalid_parameter(pose_where + ".profile_mm",
                               "must have more points than degree, as many as the first pose",
                               static_cast<double>(pose.profile_mm.size()));
    }
    for (const Vec2 point : pose.profile_mm) {
      if (auto error = check_number(pose_where + ".profile_mm", point.x, 0.0, kLongestMm))
        return error;
      if (auto error = check_number(pose_where + ".profile_mm", point.y, -kLongestMm, kLongestMm))
        return error;
    }
  }
  return std::nullopt;
}

std::optional<Error> check_hairs(const OrganShape& shape, const Hairs& hairs, const std::string& where) {
  const auto named = [&](const auto& part) { return part.name == hairs.on; };
  const bool flat = std::any_of(shape.petals.begin(), shape.petals.end(), named);
  if (!flat && std::none_of(shape.columns.begin(), shape.columns.end(), named)) {
    std::vector<std::string_view> names;
    for (const Petals& petals : shape.petals) {
      names.emplace_back(petals.name);
    }
    for (const Column& column : shape.columns) {
      names.emplace_back(column.name);
    }
    const std::string_view near = nearest_name(hairs.on, names.data(), names.size());
    return Error{ErrorCode::kUnknownParameter, where + ".on",
                 "must name petals or a column of the same organ, got \"" + hairs.on + '"' +
                     (near.empty() ? "" : "; did you mean \"" + std::string(near) + "\"?")};
  }
  if (!flat && hairs.lower) {
    return invalid_parameter(where + ".lower", "must be false on a column, which has only an outside", "true");
  }
  return check(hairs, where);
}

}  // namespace

std::optional<Error> check(const Hairs& hairs, std::string_view where) {
  const std::string prefix(where);
  if (!hairs.upper && !hairs.lower) {
    return invalid_parameter(prefix + ".upper", "must be true unless lower is", "false");
  }
  if (auto error = check_number(prefix + ".density_per_mm2", hairs.density_per_mm2, 1e-6, 1000.0))
    return error;
  if (auto error = check_range(prefix + ".along", hairs.along, 0.0, 1.0))
    return error;
  if (hairs.along[0] == hairs.along[1]) {
    return invalid_parameter(prefix + ".along", "must be of some length", hairs.along[0]);
  }
  if (auto error = check_range(prefix + ".length_mm", hairs.length_mm, 1e-3, 1000.0))
    return error;
  if (auto error = check_number(prefix + ".radius_mm", hairs.radius_mm, 1e-4, 100.0))
    return error;
  if (auto error = check_range(prefix + ".lean_deg", hairs.lean_deg, -90.0, 90.0))
    return error;
  if (auto error = check_range(prefix + ".swirl_deg", hairs.swirl_deg, -180.0, 180.0))
    return error;
  return check_range(prefix + ".bend_deg", hairs.bend_deg, -360.0, 360.0);
}

std::optional<Error> check(const OrganShape& shape, std::string_view where) {
  if (shape.petals.empty() && shape.columns.empty()) {
    return invalid_parameter(where, "must have petals or columns", "none");
  }
  for (std::size_t i = 0; i < shape.petals.size(); ++i) {
    if (auto error = check_petals(shape, i, at(where, "petals", i)))
      return error;
  }
  for (std::size_t i = 0; i < shape.columns.size(); ++i) {
    if (auto error = check_column(shape.columns[i], at(where, "columns", i)))
      return error;
  }
  for (std::size_t i = 0; i < shape.hairs.size(); ++i) {
    if (auto error = check_hairs(shape, shape.hairs[i], at(where, "hairs", i)))
      return error;
  }
  const std::string variation = std::string(where) + ".shape_variation";
  if (auto error = check_range(variation + ".curl_deg", shape.variation.curl_deg, -360.0, 360.0))
    return error;
  if (auto error = check_range(variation + ".twist_deg", shape.variation.twist_deg, -360.0, 360.0))
    return error;
  if (auto error = check_range(variation + ".sway_deg", shape.variation.sway_deg, -360.0, 360.0))
    return error;
  return check_range(variation + ".width", shape.variation.width, 0.01, 100.0);
}

}  // namespace anthesis
