#include "point_cloud.h"

#include <fmt/format.h>

#include "anthesis/base/version.h"

namespace anthesis::cli {

std::string point_cloud_ply(const Development& development, double time) {
  const Canopy canopy = development.at(time);
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment Anthesis {}\ncomment species {} seed {} time {}\ncomment sha256 {}\n", kVersion,
      development.species().name, development.options().seed, to_text(time), development.species().sha256);
  const std::vector<OrganKind>& kinds = development.species().organs;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    text += fmt::format("comment kind {} {}\n", i, kinds[i].name);
  }
  text += fmt::format(
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty double nx\n"
      "property double ny\nproperty double nz\nproperty uint organ\nproperty int kind\nproperty double area_mm2\n"
      "end_header\n",
      canopy.organs.size());
  for (const OrganState& organ : canopy.organs) {
    for (const Vec3 v : {organ.world_from_organ.position_mm, organ.normal}) {
      text += to_text(v.x) + ' ' + to_text(v.y) + ' ' + to_text(v.z) + ' ';
    }
    text += fmt::format("{} {} {}\n", organ.id.value, development.organs()[organ.id.value - 1].kind,
                        to_text(organ.area_mm2));
  }
  return text;
}

}  // namespace anthesis::cli
