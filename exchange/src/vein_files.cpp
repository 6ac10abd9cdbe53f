#include "anthesis/exchange/vein_files.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "provenance.h"
#include "text.h"

namespace anthesis {
namespace {

using detail::append;

std::string head_of(const MadeFrom& made_from) {
  std::string text;
  append(text, "# generator: ", detail::generator(), "\n");
  for (const auto& [key, value] : made_from) {
    append(text, "# ", detail::one_line(key), ": ", detail::one_line(value), "\n");
  }
  return text;
}

/// The number, or nothing for `none`.
void append_unless(std::string& text, std::uint32_t value, std::uint32_t none) {
  if (value != none) {
    detail::append_number(text, value);
  }
}

/// For each vertex where its second connections lead, in the order of the list.
std::vector<std::vector<std::uint32_t>> second_parents(const Vasculature& veins) {
  std::vector<std::vector<std::uint32_t>> parents(veins.vertices.size());
  for (const SecondConnection& second : veins.second_connections) {
    parents[second.from].push_back(second.to);
  }
  return parents;
}

/// Vertices with each parent before its children, and strands one after the other: depth first from the roots, the
/// thickest child right after its parent. Without ring vertices that nothing grows from.
std::vector<std::uint32_t> in_order_of_growth(const Vasculature& veins) {
  const auto count = static_cast<std::uint32_t>(veins.vertices.size());
  std::vector<std::vector<std::uint32_t>> children(count);
  std::vector<bool> used(count, false);
  for (const SecondConnection& second : veins.second_connections) {
    used[second.to] = true;
  }
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t v = count; v-- > 0;) {  // children come after the ring
    const std::uint32_t parent = veins.vertices[v].parent;
    if (parent != kNoVertex) {
      children[parent].push_back(v);
    } else if (v >= veins.ring_vertices || used[v] || !children[v].empty()) {
      waiting.push_back(v);
    }
  }
  std::vector<std::uint32_t> order;
  order.reserve(count);
  while (!waiting.empty()) {
    const std::uint32_t v = waiting.back();
    waiting.pop_back();
    order.push_back(v);
    std::stable_sort(children[v].begin(), children[v].end(), [&](std::uint32_t a, std::uint32_t b) {
      return veins.vertices[a].diameter < veins.vertices[b].diameter;
    });
    waiting.insert(waiting.end(), children[v].begin(), children[v].end());
  }
  return order;
}

int swc_type(const Vasculature& veins, std::uint32_t v) {
  if (v < veins.ring_vertices) {
    return 1;
  }
  switch (veins.vertices[v].kind) {
    case VeinKind::kAbaxial:
      return 2;
    case VeinKind::kFloret:
      return 3;
    case VeinKind::kAdaxial:
      break;
  }
  return 4;
}

}  // namespace

std::string_view vein_kind_name(VeinKind kind) {
  switch (kind) {
    case VeinKind::kFloret:
      return "floret";
    case VeinKind::kAbaxial:
      return "abaxial";
    case VeinKind::kAdaxial:
      break;
  }
  return "adaxial";
}

std::string_view primordium_kind_name(PrimordiumKind kind) {
  switch (kind) {
    case PrimordiumKind::kBract:
      return "bract";
    case PrimordiumKind::kTransFloret:
      return "trans_floret";
    case PrimordiumKind::kFloret:
      break;
  }
  return "floret";
}

std::string veins_csv(const Vasculature& veins, const MadeFrom& made_from) {
  std::string text = head_of(made_from);
  append(text, "vertex,parent,second_parents,kind,primordium,age_frames,diameter,resistance,x,y,z\n");
  text.reserve(text.size() + 160 * veins.vertices.size());
  const std::vector<std::vector<std::uint32_t>> seconds = second_parents(veins);
  for (std::uint32_t v = 0; v < veins.vertices.size(); ++v) {
    const VeinVertex& vertex = veins.vertices[v];
    append(text, v, ",");
    append_unless(text, vertex.parent, kNoVertex);
    text += ',';
    for (std::size_t i = 0; i < seconds[v].size(); ++i) {
      append(text, i == 0 ? "" : " ", seconds[v][i]);
    }
    append(text, ",", v < veins.ring_vertices ? "ring" : vein_kind_name(vertex.kind), ",");
    append_unless(text, vertex.primordium, kNoPrimordium);
    append(text, ",", vertex.age_frames, ",", vertex.diameter, ",");
    if (std::isfinite(vertex.resistance)) {
      append(text, vertex.resistance);
    }
    append(text, ",", vertex.position.x, ",", vertex.position.y, ",", vertex.position.z, "\n");
  }
  return text;
}

std::string vein_primordia_csv(const Vasculature& veins, std::span<const VeinPrimordium> primordia,
                               const MadeFrom& made_from) {
  ANTHESIS_ASSERT(veins.primordia.size() == primordia.size());
  std::string text = head_of(made_from);
  append(text, "primordium,kind,birth_frame,s,azimuth_deg,vertex,x,y,z\n");
  for (std::size_t i = 0; i < primordia.size(); ++i) {
    const VeinPrimordium& one = primordia[i];
    append(text, one.id, ",", primordium_kind_name(one.kind), ",", one.birth_frame, ",", one.s, ",",
           math::degrees(one.azimuth_rad), ",");
    if (veins.primordia[i] == kNoVertex) {
      append(text, ",,,\n");
      continue;
    }
    const Vec3 p = veins.vertices[veins.primordia[i]].position;
    append(text, veins.primordia[i], ",", p.x, ",", p.y, ",", p.z, "\n");
  }
  return text;
}

std::string vein_measures_csv(const VasculatureMeasures& measures, std::span<const VeinPrimordium> primordia,
                              const MadeFrom& made_from) {
  ANTHESIS_ASSERT(measures.strands.size() == primordia.size());
  std::string text = head_of(made_from);
  append(text, "# bundles: ", measures.bundles, "\n# joints: ", measures.joints, "\n# tips: ", measures.tips,
         "\n# loops: ", measures.loops, "\n# loops_through_ring: ", measures.loops_through_ring,
         "\n# highest_order: ", measures.highest_order, "\n# total_length: ", measures.total_length, "\n");
  append(text, "primordium,kind,connected,own_length,length_to_ring,order,bundle,turned_deg,sectors_crossed\n");
  for (std::size_t i = 0; i < primordia.size(); ++i) {
    const StrandMeasures& strand = measures.strands[i];
    append(text, primordia[i].id, ",", primordium_kind_name(primordia[i].kind), ",", strand.connected ? 1 : 0, ",");
    if (strand.connected) {
      append(text, strand.own_length, ",", strand.length_to_ring, ",", strand.order, ",", strand.bundle, ",",
             math::degrees(strand.turned_rad), ",", strand.sectors_crossed, "\n");
    } else {
      append(text, ",,,,,\n");
    }
  }
  return text;
}

std::string veins_swc(const Vasculature& veins, const MadeFrom& made_from) {
  std::string text = head_of(made_from);
  append(text, "# types: 1 ring, 2 abaxial, 3 floret, 4 adaxial\n");
  const std::vector<std::uint32_t> order = in_order_of_growth(veins);
  std::vector<std::uint32_t> id(veins.vertices.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    id[order[i]] = i + 1;
  }
  for (const SecondConnection& second : veins.second_connections) {
    append(text, "# second connection: ", id[second.from], " ", id[second.to], "\n");
  }
  text.reserve(text.size() + 120 * order.size());
  for (const std::uint32_t v : order) {
    const VeinVertex& vertex = veins.vertices[v];
    const Vec3 p = vertex.position;
    append(text, id[v], " ", swc_type(veins, v), " ", p.x, " ", p.y, " ", p.z, " ", 0.5 * vertex.diameter, " ");
    if (vertex.parent == kNoVertex) {
      append(text, "-1\n");
    } else {
      append(text, id[vertex.parent], "\n");
    }
  }
  return text;
}

}  // namespace anthesis
