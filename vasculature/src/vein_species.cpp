// The three heads of O24. Courses over time are our own broken lines through the values of the drawn curves; single
// numbers are those of Table SMD1 or of the released models, see docs/vasculature.md, with six digits at the most: they
// are what an imported species file shows.
#include "anthesis/vasculature/vein_params.h"

namespace anthesis {
namespace {

VeinInitial& initial_of(VeinParams& params, PrimordiumKind kind) {
  return params.initials[static_cast<std::size_t>(kind)];
}

void set_jitter(VeinParams& params, double probability, double strength) {
  for (VeinInitial& initial : params.initials) {
    initial.jitter = {probability, strength};
    initial.strand_jitter = {probability, strength};
  }
  params.colonisation.jitter = {probability, strength};
}

}  // namespace

VeinParams vein_params(HeadModel model, VeinSource source) {
  switch (model) {
    case HeadModel::kBellis:
      return bellis_veins(source);
    case HeadModel::kSunflower:
      return sunflower_veins(source);
    case HeadModel::kGerbera:
      break;
  }
  return gerbera_veins(source);
}

VeinParams bellis_veins(VeinSource source) {
  VeinParams params;
  params.ring_vertices = 52;
  params.ring_radius = 0.75;
  params.first_start = 0.1;
  initial_of(params, PrimordiumKind::kBract) = {.depth_mm = 0.3};
  initial_of(params, PrimordiumKind::kFloret) = {
      .depth_mm = 0.22, .depth_follows_course = true, .kind = VeinKind::kFloret, .strand = VeinKind::kAdaxial};
  initial_of(params, PrimordiumKind::kTransFloret) = initial_of(params, PrimordiumKind::kFloret);
  params.depth_course = {{{0.0, 0.995},
                          {0.1, 0.981},
                          {0.2, 0.960},
                          {0.3, 0.925},
                          {0.4, 0.865},
                          {0.457, 0.800},
                          {0.5, 0.722},
                          {0.6, 0.598},
                          {0.7, 0.551},
                          {0.8, 0.528},
                          {1.0, 0.512}}};
  params.shielding_angle_deg = 31.5127;  // 0.55 rad
  params.age_weight = 1.0;
  params.step_mm = 0.02;
  params.merge_distance_mm = 0.03;
  params.split_length_mm = 0.1;
  params.reticulation.delay_frames = 285;
  if (source == VeinSource::kPaper) {
    params.ground_resistivity = {{{0.0, 0.5}, {0.669, 6.5}}};
    params.maturation_frames = {{{0.0, 255.0}}};
    params.reticulation.rule = ReticulationRule::kLeastResistance;
    set_jitter(params, 0.30, 0.3);
    params.murray_exponent = 5.0;
    params.tip_diameter_mm = {0.04, 0.08, 0.04};  // strands of florets are labelled adaxial
    return params;
  }
  params.ground_resistivity = {{{0.0, 0.0134}, {0.669, 6.512}, {1.0, 6.504}}};
  params.maturation_frames = {{{0.0, 1.64}, {0.262, 4.2}, {0.318, 252.8}, {1.0, 254.2}}};
  params.age_offset = 0.0;
  params.visible_only = true;
  params.momentum = 1.0;
  params.deviation = DeviationRule::kProjected;
  params.join = JoinRule::kBelow;
  params.reticulation.rule = ReticulationRule::kOldestNeighbour;
  set_jitter(params, 0.35, 0.34);
  params.diameter_rule = DiameterRule::kMurrayByKind;
  params.fade_in_frames = 24;
  params.murray_exponent = 5.26316;  // 1 / 0.19
  params.tip_diameter_mm = {0.0479, 0.0878, 0.0878};
  return params;
}

VeinParams sunflower_veins(VeinSource source) {
  VeinParams params;
  params.ring_vertices = 125;
  params.ring_radius = 0.9;
  params.first_start = 0.05;
  initial_of(params, PrimordiumKind::kBract) = {.depth_mm = 0.11, .delay_frames = {5, 5}};
  initial_of(params, PrimordiumKind::kFloret) = {.depth_mm = 0.48,
                                                 .depth_follows_course = true,
                                                 .depth_range = {0.75, 2.0},
                                                 .delay_frames = {60, 149},
                                                 .kind = VeinKind::kFloret,
                                                 .strand = VeinKind::kAdaxial};
  initial_of(params, PrimordiumKind::kTransFloret) = initial_of(params, PrimordiumKind::kFloret);
  params.depth_course = {{{0.0, 0.118},
                          {0.25, 0.122},
                          {0.3, 0.125},
                          {0.35, 0.157},
                          {0.39, 0.219},
                          {0.41, 0.277},
                          {0.45, 0.365},
                          {0.5, 0.452},
                          {0.55, 0.524},
                          {0.6, 0.579},
                          {0.65, 0.612},
                          {0.7, 0.602},
                          {0.75, 0.490},
                          {0.8, 0.353},
                          {0.85, 0.280},
                          {0.9, 0.245},
                          {1.0, 0.221}}};
  params.shielding_angle_deg = 0.572958;  // 0.01 rad
  params.step_mm = 0.01;
  params.merge_distance_mm = 0.01;
  params.split_length_mm = 0.05;
  if (source == VeinSource::kPaper) {
    params.ground_resistivity = {{{0.0, 0.6}, {0.408, 0.6}, {0.408, 1.9}, {1.0, 2.1}}};
    params.maturation_frames = {{{0.0, 4.0}}};
    params.sector_weight = 0.65;
    set_jitter(params, 0.49, 0.8);
    params.murray_exponent = 5.0;
    params.tip_diameter_mm = {0.1, 0.14, 0.1};
    return params;
  }
  params.ground_resistivity = {{{0.0, 0.626},
                                {0.408, 0.631},
                                {0.408, 1.823},
                                {0.45, 1.901},
                                {0.6, 1.929},
                                {0.8, 1.995},
                                {0.9, 2.054},
                                {1.0, 2.151}}};
  params.maturation_frames = {{{0.0, 1.0}, {0.15, 1.0}, {0.15, 0.0}}};
  params.vein_weight = 0.75;
  params.visible_only = true;
  params.sector_weight = 0.63;
  params.sector_rule = SectorRule::kFourthPower;
  params.inward_limit = -0.8;
  params.momentum = 50.0;
  params.deviation = DeviationRule::kProjected;
  params.deviated_initial_is_unit = true;
  params.drift = 0.1;
  params.join = JoinRule::kForward;
  // Probability 0.49 and strength 0.82, times factors of the kind: 1 and 0.3, 1 and 0.4; 0.65 and 1.5, 1 and 2.
  initial_of(params, PrimordiumKind::kBract).jitter = {0.49, 0.246};
  initial_of(params, PrimordiumKind::kBract).strand_jitter = {0.49, 0.328};
  for (const PrimordiumKind kind : {PrimordiumKind::kTransFloret, PrimordiumKind::kFloret}) {
    initial_of(params, kind).jitter = {0.3185, 1.23};
    initial_of(params, kind).strand_jitter = {0.49, 1.64};
  }
  params.diameter_rule = DiameterRule::kMurrayByKind;
  params.fade_in_frames = 24;
  params.diameter_course = {{{0.0, 0.293},
                             {0.2, 0.302},
                             {0.4, 0.343},
                             {0.5, 0.392},
                             {0.6, 0.497},
                             {0.7, 0.719},
                             {0.8, 0.888},
                             {0.9, 0.968},
                             {1.0, 0.996}}};
  params.murray_exponent = 5.0;
  params.tip_diameter_mm = {0.1071, 0.1530, 0.0918};
  return params;
}

VeinParams gerbera_veins(VeinSource source) {
  VeinParams params;
  params.ring_vertices = 52;
  params.ring_radius = 0.8;
  params.first_start = 0.1;
  initial_of(params, PrimordiumKind::kBract) = {.depth_mm = 0.16, .delay_frames = {10, 10}};
  initial_of(params, PrimordiumKind::kTransFloret) = {.depth_mm = 0.0016, .delay_frames = {20, 20}};
  initial_of(params, PrimordiumKind::kFloret) = {.depth_mm = 0.38,
                                                 .depth_follows_course = true,
                                                 .sinking_mm = 0.25,
                                                 .delay_frames = {20, 20},
                                                 .kind = VeinKind::kFloret,
                                                 .strand = VeinKind::kFloret};
  params.depth_course = {{{0.0, 0.512},
                          {0.2, 0.496},
                          {0.3, 0.481},
                          {0.4, 0.450},
                          {0.45, 0.421},
                          {0.5, 0.376},
                          {0.6, 0.269},
                          {0.7, 0.186},
                          {0.8, 0.134},
                          {0.9, 0.106},
                          {1.0, 0.0975}}};
  params.step_mm = 0.02;
  params.merge_distance_mm = 0.03;
  params.split_length_mm = 0.1;
  params.colonisation.enabled = true;
  params.colonisation.s = {{{0.0, 0.484},
                            {0.45, 0.483},
                            {0.463, 0.417},
                            {0.5, 0.269},
                            {0.525, 0.207},
                            {0.6, 0.102},
                            {0.7, 0.047},
                            {0.8, 0.024},
                            {0.9, 0.0147},
                            {1.0, 0.0118}}};
  if (source == VeinSource::kPaper) {
    params.ground_resistivity = {{{0.0, 0.4}, {0.39, 1.1}, {0.39, 1.3}, {0.5225, 1.3}, {0.5225, 7.0}}};
    params.maturation_frames = {{{0.0, 13.0}}};
    params.sector_weight = 0.25;
    params.colonisation.resistivity_factor = 1.0;
    set_jitter(params, 0.30, 0.27);
    params.murray_exponent = 5.0;
    params.tip_diameter_mm = {0.09, 0.14, 0.11};
    return params;
  }
  params.ground_resistivity = {{{0.0, 0.3}, {0.39, 1.068}, {0.39, 1.26}, {0.5225, 1.26}, {0.5225, 6.98}}};
  params.maturation_frames = {{{0.0, 13.0}, {0.15, 13.0}, {0.15, 12.0}}};
  initial_of(params, PrimordiumKind::kTransFloret).resistivity_factor = 1.15;
  initial_of(params, PrimordiumKind::kTransFloret).initial_resistivity_factor = 1.15;
  initial_of(params, PrimordiumKind::kFloret).resistivity_factor = 100.0;
  initial_of(params, PrimordiumKind::kFloret).initial_resistivity_factor = 500.0;
  params.sector_weight = 0.5;
  params.sector_rule = SectorRule::kFourthPower;
  params.momentum = 50.0;
  params.retarget = true;
  params.deviation = DeviationRule::kProjected;
  set_jitter(params, 0.66, 0.27);
  params.diameter_rule = DiameterRule::kMurrayByKind;
  params.fade_in_frames = 24;
  params.murray_exponent = 5.0;
  params.tip_diameter_mm = {0.0919, 0.1470, 0.1259};
  return params;
}

}  // namespace anthesis
