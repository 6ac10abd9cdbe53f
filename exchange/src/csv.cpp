#include "anthesis/exchange/csv.h"

#include "anthesis/base/math.h"
#include "check_time.h"
#include "provenance.h"
#include "text.h"

namespace anthesis {
namespace {

// RFC 4180: quotes around a field that holds a comma or a quote, which is doubled.
std::string field(std::string_view text) {
  if (text.find_first_of(",\"#\r\n") == std::string_view::npos) {
    return std::string(text);
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c;
    if (c == '"') {
      quoted += c;
    }
  }
  return quoted + '"';
}

}  // namespace

Expected<std::string> organs_csv(const Development& development, double time) {
  if (std::optional<Error> error = detail::check_time(time)) {
    return unexpected(*error);
  }
  using detail::append;
  std::string text;
  for (const auto& [key, value] : detail::provenance(development)) {
    append(text, "# ", key, ": ", value, "\n");
  }
  append(text, "# time: ", time, "\n");
  append(text,
         "id,parent,kind,birth,age,x_mm,y_mm,z_mm,nx,ny,nz,divergence_deg,azimuth_deg,s,radius_mm,area_mm2,size,"
         "stage\n");
  const Canopy canopy = development.at(time);
  text.reserve(text.size() + 256 * canopy.organs.size());
  for (const OrganState& state : canopy.organs) {
    const Organ& organ = development.organs()[state.id.value - 1];
    const Vec3 p = state.world_from_organ.position_mm;
    append(text, organ.id.value, ",", organ.parent.value, ",", field(development.species().organs[organ.kind].name),
           ",", organ.birth, ",", time - organ.birth, ",", p.x, ",", p.y, ",", p.z, ",", state.normal.x, ",",
           state.normal.y, ",", state.normal.z, ",", math::degrees(organ.divergence_rad), ",",
           math::degrees(organ.azimuth_rad), ",", state.s, ",", state.radius_mm, ",", state.area_mm2, ",",
           state.world_from_organ.scale, ",", state.stage, "\n");
  }
  return text;
}

}  // namespace anthesis
