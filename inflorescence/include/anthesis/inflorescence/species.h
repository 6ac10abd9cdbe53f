#pragma once
#include <optional>
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/corolla/organ_shape.h"
#include "anthesis/corolla/pigment.h"
#include "anthesis/geometry/vec.h"
#include "anthesis/receptacle/harmonic_section.h"
#include "anthesis/vasculature/vein_params.h"

namespace anthesis {

/// A function given by control points (x, y), x ascending: a clamped B-spline of degree at most 3 through the first and
/// the last point. See geometry/function_graph.h.
using FunctionPoints = std::vector<Vec2>;

/// How organs find their places on a receptacle.
enum class PlacementRule {
  kCentripetal,  ///< a naked meristem is covered from its rim inwards (O16 fig. 11a)
  kDivergent,    ///< a naked meristem is covered from a line between its middle and its rim, both ways (O16 fig. 11b)
  kSegregation,  ///< a small meristem grows and gives off an organ whenever it is large enough (O16 fig. 11c)
  kRidley,       ///< bands of given areas on a receptacle of given size (O16 eq. 3)
  kCollision,    ///< spheres of given radii that roll up from the base until they touch (F92 section 2)
  kActiveRing,   ///< wherever there is room on the active ring of a growing head (O24 section 3)
};

/// Whether the rule makes the receptacle as large as the organs on it, or places them on one of given size.
constexpr bool grows_meristem(PlacementRule rule) {
  return rule == PlacementRule::kCentripetal || rule == PlacementRule::kDivergent ||
         rule == PlacementRule::kSegregation;
}

/// The half section of the receptacle at one time, apex to base, as control points (radius, height) of a clamped cubic
/// B-spline. For rules that grow the meristem only its shape counts: its size follows from the organs it carries (O16
/// section 4). For kRidley and kCollision it is the receptacle itself, in millimetres.
struct ReceptacleProfile {
  double time = 0.0;
  std::vector<Vec2> points;
};

/// The half section of a head at one stage of its growth, as it was drawn or traced on a scan. Places on it are shares
/// s of its length: 0 apex, 1 base.
struct HeadSection {
  std::vector<Vec2> points;  ///< from apex to base, control points (radius, height) of a clamped cubic B-spline, mm
  std::vector<double> landmarks;  ///< s of the same places of the tissue on all sections, from the base inwards
  double ring = 0.0;              ///< s of the active ring
};

/// Primordia on the active ring of a head that grows through given sections (O24, C- and P-model). See
/// docs/active-ring.md and docs/receptacle.md.
struct ActiveRing {
  std::vector<HeadSection> sections;  ///< youngest first, at least 3; later ones have no fewer landmarks
  std::vector<double> knots;          ///< when: of the quadratic B-spline in time that blends the sections, three more
                                      ///< than sections; empty: equally spaced
  FunctionPoints threshold_mm = {{0.0, 1.0}, {1.0, 1.0}};  ///< least distance to all other primordia against time
  int threshold_frozen_above = 0;  ///< it stays what it is with more primordia than this; 0: never
  double relaxation = 45.32;       ///< rate at which the youngest move sideways to the distance of the threshold
  double mobile_zone = 1.5;        ///< they may as long as their s is below so many times the ring's
  double last_ring = 0.0025;       ///< no primordia once the ring's s is at or below this
  double lag = 0.0;  ///< how much nearer to the apex a primordium stands, in shares of all tissue, than where it arose
  double first_azimuth_deg = 180.0;  ///< of the first primordium

  std::string floret;        ///< kind of the organs inside all landmarks below
  std::string bract;         ///< kind outside the bract landmark
  int bract_landmark = 0;    ///< number of the landmark, 1 outermost; 0: there are no bracts
  std::string trans_floret;  ///< kind between the two landmarks
  int trans_landmark = 0;    ///< 0: there are none
};

/// What grows on a stretch of the receptacle between two positions s (0 apex, 1 base).
struct Zone {
  std::string organ;  ///< kind of the organs that arise in the zone
  double from = 0.0;  ///< position nearest the apex
  double to = 1.0;    ///< position nearest the base
};

/// Florets with room become another kind: the cone rule of O16 section 5.
struct FateRule {
  std::string of;          ///< kind that the rule is asked for
  std::string with_room;   ///< kind it becomes when its cone is empty of others of its kind
  double cone_deg = 75.0;  ///< half opening angle, (0, 180)
};

/// A flower head: organs in a spiral on a surface of revolution, produced from the rim inwards. Any organ may carry one
/// too: florets of a floret cluster, spines of a cactus' areole, heads of plants in a pot.
struct Head {
  PlacementRule rule = PlacementRule::kCentripetal;
  std::vector<ReceptacleProfile> receptacle;  ///< at least one, times ascending, equal numbers of points; kActiveRing:
                                              ///< none, its sections take their place
  bool bezier = false;  ///< the points are those of cubic Bezier curves, end to end: 3 n + 1; given size only
  std::string receptacle_pigment;
  double divergence_deg = 137.50776405003785;  ///< from one organ to the next, counter-clockwise seen from above
  double interval = 0.001;                     ///< developmental time between two organs; not for kSegregation and
                                               ///< kActiveRing
  double height_mm = 0.0;                      ///< of a head that an organ carries: where it stands on the organ's axis

  // Rules that grow the meristem.
  double meristem_area_mm2 = 10.0;                            ///< naked at time 0
  FunctionPoints meristem_growth = {{0.0, 1.0}, {1.0, 1.0}};  ///< factor of the naked region's area against time
  FunctionPoints
      meristem_rate;  ///< if given, in place of the factor: its relative rate of growth; constant: exponential
  FunctionPoints area_growth = {{0.0, 1.0}, {1.0, 1.0}};   ///< share of the mature area against age
  double outer_area_mm2 = 10.0;                            ///< kDivergent: of the naked rim at time 0
  FunctionPoints outer_growth = {{0.0, 1.0}, {1.0, 1.0}};  ///< kDivergent: factor of the naked rim's area against time
  double threshold_area_mm2 = 20.0;  ///< kSegregation: area of the naked region at which it gives off an organ

  // All rules but kCollision.
  FunctionPoints area_mm2 = {{0.0, 1.0}, {1.0, 1.0}};  ///< mature area of an organ against its position s at birth

  // Rules with a receptacle of given size.
  FunctionPoints growth = {{0.0, 1.0}, {1.0, 1.0}};  ///< factor of the whole receptacle's size against time
  int count = 0;                                     ///< at most so many organs; 0: as many as there is room for

  // Rule kCollision.
  FunctionPoints radius_mm = {{0.0, 1.0}, {1.0, 1.0}};  ///< of an organ's sphere against its position s
  double contact_factor = 1.0;  ///< distance of two centres at contact over the sum of their radii, (0, 1]

  // Rule kActiveRing.
  std::optional<ActiveRing> active_ring;

  std::vector<Zone> zones;  ///< cover [0, 1] without gap or overlap; kActiveRing: none
  std::optional<FateRule> fate;
};

/// How organs of a kind stand and differ. Each range is drawn from once for each organ.
struct OrganVariation {
  Range size = {1.0, 1.0};       ///< factor
  Range pitch_deg = {0.0, 0.0};  ///< added tilt outward
  Range yaw_deg = {0.0, 0.0};    ///< turn about the head's radius at the organ
  Range roll_deg = {0.0, 0.0};   ///< turn about the organ's own axis
  Range stage = {0.0, 0.0};      ///< added to the stage, kept in [0, 1]
};

/// How organs of a kind give way when they touch. Stiffnesses are the share of an error that one projection removes,
/// (0, 1]: 1 gives way to nothing but contact.
struct Tissue {
  double thickness_mm = 0.04;  ///< of a grown organ; two organs keep the mean of theirs between them. [0.01, 10]
  double stretch = 1.0;        ///< stiffness against change of lengths
  double bend = 0.5;           ///< stiffness against bending of the midrib: folds that run across
  double roll = 0.2;           ///< stiffness against rolling up or flattening: folds that run along
  double hold = 0.5;           ///< stiffness of the attachment at the base
};

/// A kind of organ: its form, how it grows and opens, how it stands on the receptacle.
struct OrganKind {
  std::string name;
  OrganShape shape;
  int variants = 1;                                     ///< shapes to choose from at random, 1 to 64
  FunctionPoints growth = {{0.0, 1.0}, {1.0, 1.0}};     ///< size factor against age (time since birth)
  FunctionPoints opening = {{0.0, 0.0}, {1.0, 1.0}};    ///< stage in [0, 1] against age
  FunctionPoints size = {{0.0, 1.0}, {1.0, 1.0}};       ///< size factor against position s on the mature receptacle
  FunctionPoints pitch_deg = {{0.0, 0.0}, {1.0, 0.0}};  ///< tilt from the receptacle's normal outward, against age
  double layering_deg = 0.0;    ///< extra pitch of the first organ of the kind over the last: neighbours lie in layers
  double sink_mm = 0.0;         ///< how deep the base is set into the receptacle
  double fits_radius_mm = 0.0;  ///< radius that the organ is drawn for: it grows and shrinks in proportion to
                                ///< its sphere (F92 section 3.1), or the disc of its area; 0: its size is given
  Vec3 contact_point_mm;        ///< of the form, which comes to lie on the receptacle (F92 section 3.1)
  Vec3 axis = {0.0, 0.0, 1.0};  ///< of the form, which comes to lie along the receptacle's normal
  Vec3 outward = {1.0, 0.0, 0.0};  ///< of the form, which comes to point away from the apex
  std::optional<Head> head;        ///< organs that it carries itself
  OrganVariation variation;
  Tissue tissue;
};

/// The stem under the head.
struct Peduncle {
  std::string pigment;
  double length_mm = 0.0;  ///< 0: none
  double radius_mm = 1.0;  ///< at the foot of the mature stem; at the head it meets the receptacle
  double bend_deg = 0.0;   ///< of the whole stem, towards -x
  FunctionPoints growth = {{0.0, 1.0}, {1.0, 1.0}};  ///< factor of the length against time
  std::vector<Hairs> hairs;                          ///< drawn on it
};

/// Which outline of the head the veins of a frame see, and in which frame a primordium is born.
enum class VeinClock {
  kConsistent,  ///< both at the frame's share of all frames
  kPublished,   ///< as in the programs of O24: outlines follow a pace of their own, births a clock of 2000 frames
};

/// What carries tissue inside a head from frame to frame.
enum class HeadInside {
  kHarmonic,   ///< harmonic extension of the outline's displacement (O24, H- and G-model)
  kMeanValue,  ///< its mean value interpolation
};

/// The veins inside the plant's own head, which must have an active ring (O24, V-model).
struct HeadVeins {
  VeinParams params;
  int frames = 2214;  ///< of the whole development
  HeadInside inside = HeadInside::kHarmonic;
  AxisCondition axis = AxisCondition::kNatural;  ///< kHarmonic: of the displacement away from the axis
  double max_edge = 0.0625;  ///< kHarmonic: longest edge of the triangulated section, as a share of its size
  VeinClock clock = VeinClock::kConsistent;
  FunctionPoints pace = {{0.0, 1.0}, {1.0, 1.0}};  ///< kPublished: of the outlines, against their time
};

/// A plant, as its file states it; plain data, read once and checked once.
struct Species {
  std::string name;        ///< "sunflower"
  std::string latin;       ///< "Helianthus annuus"
  std::string summary;     ///< a sentence for lists
  bool collisions = true;  ///< whether organs push one another unless asked otherwise
  Head head;
  Peduncle peduncle;
  std::vector<OrganKind> organs;  ///< in the order of the file
  std::vector<Pigment> pigments;  ///< in the order of the file
  std::optional<HeadVeins> vasculature;
  std::string sha256;  ///< of the file's bytes; empty for species made in code
};

/// What is wrong with `species`, if anything: every name it uses exists, every number is within its range.
std::optional<Error> check(const Species& species);

}  // namespace anthesis
