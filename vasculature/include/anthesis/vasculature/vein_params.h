#pragma once
#include <array>
#include <optional>

#include "anthesis/base/error.h"
#include "anthesis/phyllotaxis/primordium_kind.h"
#include "anthesis/vasculature/time_course.h"

namespace anthesis {

/// What a strand serves: the inside of a floret, a bract (the strands near the underside of the head), or tissue near
/// the upper side. Strands of florets are adaxial where the authors of O24 colour them so.
enum class VeinKind { kFloret, kAbaxial, kAdaxial };

/// Deviation of a strand from its way, step by step.
struct VeinJitter {
  double probability = 0.0;  ///< that a step deviates, in [0, 1]
  double strength = 0.0;     ///< of a deviation, in steps, >= 0
};

/// How the strand of one kind of primordium begins: straight into the head, along the inward normal.
struct VeinInitial {
  double depth_mm = 0.1;                           ///< > 0
  bool depth_follows_course = false;               ///< times VeinParams::depth_course at birth
  std::array<double, 2> depth_range = {1.0, 1.0};  ///< times a random number, once for each primordium
  double sinking_mm = 0.0;                         ///< the initial points this much further down, >= 0
  std::array<int, 2> delay_frames = {0, 0};        ///< from birth to start, a random whole number, ends included
  VeinKind kind = VeinKind::kAbaxial;
  VeinKind strand = VeinKind::kAbaxial;  ///< of the innermost vertex, and of the strand that goes on from there
  VeinJitter jitter = {};                ///< of the initial
  VeinJitter strand_jitter = {};
  double resistivity_factor = 1.0;          ///< of the strand, >= 0
  double initial_resistivity_factor = 1.0;  ///< of the initial but its innermost vertex, >= 0
};

/// How much a way across the radial plane costs (O24 eq. 13).
enum class SectorRule {
  kSquaredDistance,  ///< 1 + weight * (distance from the plane)^2, as in the text
  kFourthPower,      ///< (1 + weight * (cosine to the plane's normal)^2)^4, as in the released models
};

/// Where a strand is attached that has come near a vertex.
enum class JoinRule {
  kThere,    ///< to that vertex
  kBelow,    ///< to the next one towards the base
  kForward,  ///< to the first towards the base, of at most ten, that lies ahead
};

enum class DeviationRule {
  kUniform,    ///< uniform in [0, strength], in a random direction across (O24 eq. 14)
  kProjected,  ///< strength times the part of a random unit vector that lies across, as in the released models
};

enum class ReticulationRule {
  kNone,
  kLeastResistance,  ///< minimum resistance again, avoiding the first way; a limit to the ratio (O24, section 5.6)
  kOldestNeighbour,  ///< the oldest of the three nearest points but the one already joined; a limit to the difference
};

enum class DiameterRule {
  kMurray,        ///< d^n adds up, from the diameters of the tips; a split shares it out (O24 eq. 15)
  kMurrayByKind,  ///< number of tips^(1/n) times the tip diameter of the vertex' own kind; half of it once more along
                  ///< second connections
};

struct VeinReticulation {
  ReticulationRule rule = ReticulationRule::kNone;
  int delay_frames = 285;         ///< from the start of a strand, >= 0
  double ratio_limit = 1.3;       ///< kLeastResistance: resistance of the new way over that of the old one, >= 0
  double difference_limit = 3.3;  ///< kOldestNeighbour: resistance of the new way less that of the old one
  double reach_mm = 0.5;          ///< kOldestNeighbour: longest second connection, >= 0
  double neighbourhood_mm = 0.7;  ///< kOldestNeighbour: no point farther than this is considered, >= 0
};

/// Strands that grow towards attraction points below the surface, by space colonisation (Runions et al. 2007).
struct VeinColonisation {
  bool enabled = false;
  std::array<double, 2> window = {0.463,
                                  0.95};  ///< times in [0, 1] between which attraction points appear; growth goes on
  TimeCourse s;                           ///< where on the outline, in [0, 1]: 0 apex, 1 rim
  std::array<double, 2> depth_mm = {0.65, 0.66};  ///< below the surface, >= 0
  int points_per_frame = 20;                      ///< at most, >= 0
  double spacing_mm = 0.015;                      ///< between a new point and those of earlier frames, > 0
  double kill_distance_mm = 0.13;                 ///< a point this near a strand is used up, > 0
  double step_mm = 0.0065;                        ///< > 0; at the end, twice that at time 0
  double resistivity_factor = 0.05;               ///< >= 0
  VeinJitter jitter;
};

/// The vein model of O24 (V-model), as data. Lengths are millimetres (O24 states no unit: that of its tables), ages
/// frames, times in [0, 1] = frame / last frame. Resistivities are ratios: that of a mature strand is
/// `mature_resistivity`.
struct VeinParams {
  VeinParams();  // with the values below; where it is inlined GCC 12 takes them for uninitialised

  // ring
  int ring_vertices = 52;        ///< at least 1
  double ring_radius = 0.75;     ///< share of the base's radius in frame 0, in (0, 1]
  double ring_inset_mm = 0.025;  ///< less this, >= 0

  // when
  double first_start = 0.1;  ///< strands start at times later than this, in [0, 1]

  // initials: bract, trans floret, floret
  std::array<VeinInitial, 3> initials;
  TimeCourse depth_course = {{{0.0, 1.0}}};  ///< factor, in [0, 100]
  bool deviated_initial_is_unit = false;     ///< steps of an initial keep their length when they deviate

  // minimum resistance
  TimeCourse ground_resistivity = {{{0.0, 1.0}}};  ///< of tissue without strands, >= 0
  TimeCourse maturation_frames = {{{0.0, 1.0}}};   ///< >= 0, rounded down; 0: mature at once
  double mature_resistivity = 1.0;                 ///< >= 0
  double vein_weight = 1.0;                        ///< of the resistance of the way through strands, >= 0
  double age_weight = 0.0;                         ///< mu_age of O24 eq. 10, >= 0
  double age_offset = 1.0;                         ///< what eq. 10 takes off the ratio of ages, in [0, 1]
  bool visible_only = false;                       ///< only vertices that are not shielded may be joined
  double shielding_angle_deg = 30.0;               ///< width of the nearest vertex as a shield; in (0, 180]
  double sector_weight = 0.0;                      ///< mu_sec of O24 eq. 13, >= 0; with kSquaredDistance per mm^2
  SectorRule sector_rule = SectorRule::kSquaredDistance;
  double inward_limit = -1.0;  ///< a way whose direction has a radial part below this is avoided, in [-1, 1]; -1: none

  // strands
  double step_mm = 0.02;            ///< > 0
  double merge_distance_mm = 0.03;  ///< a tip this near a vertex joins; at least half a step
  double momentum = 0.0;            ///< of the initial's depth vector, kept by the strand's tip, >= 0; 0: straight
  bool retarget = false;            ///< choose again at each step
  DeviationRule deviation = DeviationRule::kUniform;
  double drift = 0.0;  ///< each step down by a random share of this many steps, in [0, 1]
  JoinRule join = JoinRule::kThere;
  double split_length_mm = 0.1;  ///< edges this long are halved, once a stride; at least a step

  VeinReticulation reticulation;
  VeinColonisation colonisation;

  // diameters
  DiameterRule diameter_rule = DiameterRule::kMurray;
  double murray_exponent = 5.0;                             ///< >= 1
  std::array<double, 3> tip_diameter_mm = {0.1, 0.1, 0.1};  ///< > 0; floret, abaxial, adaxial
  TimeCourse diameter_course = {{{0.0, 1.0}}};              ///< > 0, factor of all diameters
  int fade_in_frames = 0;                                   ///< age at which an edge has its whole diameter; 0: at once
  double second_share = 1.0 / 3.0;                          ///< kMurray: of d^n, what a later way out gets, in [0, 0.5]
};

/// What is wrong with parameters, if anything; `where` is like "initials[0].depth_mm".
std::optional<Error> check(const VeinParams& params);

/// The heads that O24 models.
enum class HeadModel { kBellis, kSunflower, kGerbera };
inline constexpr std::array kHeadModelNames = {"bellis", "sunflower", "gerbera"};  ///< in files and flags, by HeadModel

/// Where the constants of a head come from.
enum class VeinSource {
  kPaper,        ///< equations and Table SMD1 of the supplement of O24; what it leaves open as published
  kAsPublished,  ///< what the models released with O24 do
};
inline constexpr std::array kVeinSourceNames = {"paper", "as_published"};  ///< in files and flags, by VeinSource

/// The parameters of a head of O24. See docs/vasculature.md for what differs. The unit is that of O24: heads of Bellis
/// 8.4, sunflower 5.4 and gerbera 7.7 high at the end.
VeinParams vein_params(HeadModel model, VeinSource source);
VeinParams bellis_veins(VeinSource source);
VeinParams sunflower_veins(VeinSource source);
VeinParams gerbera_veins(VeinSource source);

}  // namespace anthesis
