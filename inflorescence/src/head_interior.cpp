#include "anthesis/inflorescence/head_interior.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "anthesis/base/assert.h"
#include "anthesis/base/math.h"
#include "anthesis/geometry/function_graph.h"
#include "anthesis/vasculature/mean_value_growth.h"
#include "head_pattern.h"

namespace anthesis {
namespace {

constexpr double kStepTime = 0.0005;  // of the programs of O24
constexpr std::uint32_t kStride = 8;  // of mean value growth
constexpr std::size_t kBasePoints = 20;

const ActiveRing& ring_of(const Species& species) {
  ANTHESIS_ASSERT(species.head.active_ring.has_value());
  return *species.head.active_ring;
}

const HeadVeins& veins_of(const Species& species) {
  ANTHESIS_ASSERT(species.vasculature.has_value());
  return *species.vasculature;
}

SectionLookup lookup_of(HeadRules rules) {
  return rules == HeadRules::kAsPublished ? SectionLookup::kAsPublished : SectionLookup::kExact;
}

Expected<Vasculature> within_harmonic(const Species& species, const ContourSequence& contours,
                                      std::span<const VeinPrimordium> primordia, VeinOptions options) {
  Expected<InteriorGrowth> interior = head_inside(species, contours);
  if (!interior) {
    return unexpected(interior.error());
  }
  std::optional<Error> failed;
  std::size_t brought_back = 0;
  const std::size_t outline = contours.points_per_frame();
  const HeadGrowth growth{interior->frames(),
                          [&](std::size_t frame) { return interior->section(frame).first(outline); },
                          [&](std::size_t frame, std::size_t, std::span<Vec2> points) {
                            if (!failed) {
                              failed = interior->advance(frame);
                            }
                            if (!failed) {
                              brought_back += interior->carry(points);
                            }
                          }};
  options.stride = 1;
  Expected<Vasculature> veins = grow_veins(veins_of(species).params, growth, primordia, options);
  if (failed) {
    return unexpected(*failed);
  }
  if (veins) {
    veins->brought_back = brought_back;
  }
  return veins;
}

Expected<Vasculature> within_mean_value(const Species& species, const ContourSequence& contours,
                                        std::span<const VeinPrimordium> primordia, VeinOptions options) {
  OutlineSequence outlines;
  outlines.points_per_frame = contours.points_per_frame();
  for (const ContourPoint& point : contours.points) {
    outlines.points.push_back(point.position);
  }
  options.stride = kStride;
  return grow_veins(veins_of(species).params, mean_value_growth(std::move(outlines)), primordia, options);
}

}  // namespace

DigitisedHead digitised_head(const ActiveRing& ring) {
  DigitisedHead head;
  for (const HeadSection& section : ring.sections) {
    head.sections.push_back({{3, section.points}, section.landmarks, section.ring});
  }
  head.knots = ring.knots;
  return head;
}

ActiveRingParams active_ring_params(const ActiveRing& ring) {
  ActiveRingParams params;
  params.threshold = [graph = FunctionGraph(ring.threshold_mm)](double time) { return graph(time); };
  if (ring.threshold_frozen_above > 0) {
    params.threshold_frozen_above = static_cast<std::size_t>(ring.threshold_frozen_above);
  }
  params.relaxation = ring.relaxation;
  params.mobile_zone = ring.mobile_zone;
  params.last_ring = ring.last_ring;
  params.lag = ring.lag;
  params.first_azimuth_rad = math::radians(ring.first_azimuth_deg);
  params.bract_landmark = static_cast<std::size_t>(ring.bract_landmark);
  params.trans_landmark = static_cast<std::size_t>(ring.trans_landmark);
  return params;
}

Expected<std::vector<RingPrimordium>> head_ring(const Species& species, HeadRules rules, const Progress& progress) {
  const GrowingReceptacle head(digitised_head(ring_of(species)), lookup_of(rules));
  const ActiveRingParams params = active_ring_params(ring_of(species));
  auto grown = rules == HeadRules::kAsPublished ? grow_active_ring_as_published(head, params, progress)
                                                : grow_active_ring(head, params, progress);
  if (!grown) {
    return unexpected(error_of_ring(grown.error(), "head.active_ring"));
  }
  return grown;
}

std::vector<VeinPrimordium> head_primordia(const Species& species, std::span<const RingPrimordium> ring,
                                           HeadRules rules) {
  const HeadVeins& veins = veins_of(species);
  std::vector<double> clock;
  if (veins.clock == VeinClock::kPublished && rules == HeadRules::kExact) {
    clock = published_clock(GrowingReceptacle(digitised_head(ring_of(species))), kStepTime);
  }
  const auto frame_of = [&](const RingMoment& moment) {
    if (veins.clock == VeinClock::kConsistent) {
      return static_cast<std::uint32_t>(std::lround(moment.time * (veins.frames - 1)));
    }
    return rules == HeadRules::kAsPublished
               ? moment.step
               : static_cast<std::uint32_t>(std::lower_bound(clock.begin(), clock.end(), moment.time) - clock.begin());
  };
  std::vector<VeinPrimordium> primordia;
  for (std::uint32_t id = 0; id < ring.size(); ++id) {
    const RingMoment& stable = ring[id].stable;
    primordia.push_back({id, frame_of(stable), stable.s, stable.azimuth_rad, stable.kind});
  }
  std::stable_sort(primordia.begin(), primordia.end(),
                   [](const auto& a, const auto& b) { return a.birth_frame < b.birth_frame; });
  return primordia;
}

Expected<ContourSequence> head_contours(const Species& species, HeadRules rules) {
  const HeadVeins& veins = veins_of(species);
  DigitisedHead sections = digitised_head(ring_of(species));
  std::vector<double> times;
  if (veins.clock == VeinClock::kPublished) {
    sections.knots.clear();  // O24 blends the outlines of its frames as if the sections lay equally in time
    auto paced = contour_times([graph = FunctionGraph(veins.pace)](double time) { return graph(time); });
    if (!paced) {
      return unexpected(paced.error());
    }
    times = std::move(*paced);
  } else {
    for (int f = 0; f < veins.frames; ++f) {
      times.push_back(static_cast<double>(f) / (veins.frames - 1));
    }
  }
  ContourSequence contours = sample_contours(GrowingReceptacle(sections, lookup_of(rules)), times);
  constexpr std::size_t kChecked = 64;  // between sections that are simple an outline crosses itself for long or hardly
  for (std::size_t i = 0; i <= kChecked; ++i) {
    const std::size_t frame = i * (contours.frames() - 1) / kChecked;
    std::vector<Vec2> outline;
    for (const ContourPoint& point : contours.frame(frame)) {
      outline.push_back(point.position);
    }
    if (place_of_crossing(outline)) {
      return unexpected(invalid_parameter("head.active_ring.sections",
                                          "must blend into outlines that do not cross themselves",
                                          "one that does at time " + to_text(contours.times[frame])));
    }
  }
  return contours;
}

Expected<InteriorGrowth> head_inside(const Species& species, const ContourSequence& contours) {
  InteriorGrowthParams params;
  params.mesh.max_edge = veins_of(species).max_edge;
  params.axis = veins_of(species).axis;
  return InteriorGrowth::make(head_sections(contours), params);
}

SectionSequence head_sections(const ContourSequence& contours) {
  return with_base(contours, kBasePoints);
}

Expected<Vasculature> head_veins(const Species& species, const ContourSequence& contours,
                                 std::span<const VeinPrimordium> primordia, VeinOptions options) {
  auto veins = veins_of(species).inside == HeadInside::kHarmonic
                   ? within_harmonic(species, contours, primordia, std::move(options))
                   : within_mean_value(species, contours, primordia, std::move(options));
  if (!veins && veins.error().where == "ring_inset_mm") {
    veins.error().where.insert(0, "vasculature.");
  }
  return veins;
}

}  // namespace anthesis
