#pragma once
// The one description of species files. Each function below lists the keys of one table: name, member, range, sentence.
// Visitors turn the list into a reader (species_file.cpp), a schema (species_schema.cpp) and a writer
// (species_writer.cpp). A member is a pointer to member, or a function from the object to a part of it.
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <type_traits>

#include "anthesis/inflorescence/species.h"

namespace anthesis::species_table {

/// The range of a number.
struct Limits {
  double min = 0.0;
  double max = 0.0;
  bool open_min = false;  ///< min itself is refused
  bool open_max = false;  ///< max itself is refused

  constexpr bool allow(double value) const {  // false for NaN
    return (open_min ? value > min : value >= min) && (open_max ? value < max : value <= max);
  }
};

constexpr Limits within(double min, double max) {
  return {min, max, false, false};
}
constexpr Limits above(double min, double max) {
  return {min, max, true, false};
}
constexpr Limits between(double min, double max) {
  return {min, max, true, true};
}

/// "must be > 0 and at most 1"
inline std::string rule_text(const Limits& limits) {
  if (!limits.open_min && !limits.open_max) {
    return "must be in [" + to_text(limits.min) + ", " + to_text(limits.max) + "]";
  }
  return std::string("must be ") + (limits.open_min ? "> " : "at least ") + to_text(limits.min) + " and " +
         (limits.open_max ? "< " : "at most ") + to_text(limits.max);
}

/// How many elements a list may have. Nothing in a plant needs more, and a file cannot ask for gigabytes.
struct Count {
  std::size_t min = 0;
  std::size_t max = 0;
};
inline constexpr Count kPoints = {2, 256};
inline constexpr Count kPoses = {1, 32};
inline constexpr Count kSectionPoints = {2, 64};
inline constexpr std::size_t kLongestText = 1000;  // bytes
inline constexpr std::size_t kLongestName = 64;

/// Pairs of numbers: control points of a function (first numbers ascending) or of a curve (any order).
struct PointsRule {
  Limits x;
  Limits y;
  bool ascending = false;
  Count count = kPoints;
  bool one_is_enough = false;  ///< else an ascending list must span a range
};
constexpr PointsRule function_of(Limits x, Limits y) {
  return {x, y, true};
}
constexpr PointsRule curve(Limits x, Limits y) {
  return {x, y, false};
}
constexpr PointsRule course_of(Limits y) {
  return {{0.0, 1.0}, y, true, {1, 256}, true};
}

/// The values of an enumeration, in its order, as a file names them.
using Choices = std::span<const char* const>;
inline constexpr std::array kPlacementRules = {"centripetal", "divergent", "segregation",
                                               "ridley",      "collision", "active_ring"};
inline constexpr std::array kVeinClocks = {"consistent", "published"};
inline constexpr std::array kHeadInsides = {"harmonic", "mean_value"};
inline constexpr std::array kAxisConditions = {"natural", "zero"};
inline constexpr std::array kVeinKinds = {"floret", "abaxial", "adaxial"};
inline constexpr std::array kSectorRules = {"squared_distance", "fourth_power"};
inline constexpr std::array kJoinRules = {"there", "below", "forward"};
inline constexpr std::array kDeviationRules = {"uniform", "projected"};
inline constexpr std::array kReticulationRules = {"none", "least_resistance", "oldest_neighbour"};
inline constexpr std::array kDiameterRules = {"murray", "murray_by_kind"};

enum class Need { kOptional, kRequired };
enum class Layout { kOwnTable, kInline };  ///< [head.fate] or variation = { ... }

/// What a name must be the name of.
enum class NameOf { kNothing, kOrgan, kPigment };

inline constexpr Limits kUnit = within(0.0, 1.0);
inline constexpr Limits kHalfTurn = within(-180.0, 180.0);
inline constexpr Limits kTurn = within(-360.0, 360.0);
inline constexpr Limits kLength = within(0.0, 10000.0);
inline constexpr Limits kOffset = within(-10000.0, 10000.0);
inline constexpr Limits kArea = above(0.0, 1e6);
inline constexpr Limits kFactor = within(0.0, 100.0);

template <class T>
using Table = std::type_identity<T>;

template <class V>
void describe(V& v, Table<ReceptacleProfile>) {
  using T = ReceptacleProfile;
  v.number("time", &T::time, kUnit, "Developmental time of this outline; ascending over the list.", Need::kRequired);
  v.points("points", &T::points, curve(kLength, kOffset),
           "Half outline from apex to base: control points [radius, height] of a B-spline. On a growing meristem "
           "only the shape counts, the size follows from the organs; else in mm.",
           Need::kRequired);
}

template <class V>
void describe(V& v, Table<Zone>) {
  using T = Zone;
  v.name("organ", &T::organ, NameOf::kOrgan, "Kind of the organs that arise in the zone.", Need::kRequired);
  v.number("from", &T::from, kUnit, "Position of the zone's end nearest the apex: 0 apex, 1 base.", Need::kRequired);
  v.number("to", &T::to, kUnit, "Position of the zone's end nearest the base: 0 apex, 1 base.", Need::kRequired);
}

template <class V>
void describe(V& v, Table<FateRule>) {
  using T = FateRule;
  v.name("of", &T::of, NameOf::kOrgan, "Kind of organ that the rule is asked for.", Need::kRequired);
  v.name("with_room", &T::with_room, NameOf::kOrgan, "Kind it becomes when no other of its kind lies in its cone.",
         Need::kRequired);
  v.number("cone_deg", &T::cone_deg, between(0.0, 180.0), "Half opening angle of the cone, in degrees.");
}

template <class V>
void describe(V& v, Table<HeadSection>) {
  using T = HeadSection;
  v.points("points", &T::points, curve(kLength, kOffset),
           "Half section from apex to base: control points [radius, height] of a B-spline, in mm.", Need::kRequired);
  v.numbers("landmarks", &T::landmarks, kUnit, Count{0, 256},
            "Positions of the same places of the tissue on all sections, from the base inwards: 0 apex, 1 base.");
  v.number("ring", &T::ring, kUnit, "Position of the active ring: 0 apex, 1 base.", Need::kRequired);
}

template <class V>
void describe(V& v, Table<ActiveRing>) {
  using T = ActiveRing;
  v.name("floret", &T::floret, NameOf::kOrgan, "Kind of the organs inside the landmarks.", Need::kRequired);
  v.name("bract", &T::bract, NameOf::kOrgan, "Kind of the organs outside the bract landmark.");
  v.integer("bract_landmark", &T::bract_landmark, 0, 256, "Number of the landmark, 1 outermost; 0: no bracts.");
  v.name("trans_floret", &T::trans_floret, NameOf::kOrgan, "Kind of the organs between the two landmarks.");
  v.integer("trans_landmark", &T::trans_landmark, 0, 256, "Number of the landmark, 1 outermost; 0: no trans florets.");
  v.points("threshold_mm", &T::threshold_mm, function_of(kUnit, above(0.0, 10000.0)),
           "Least distance of a new primordium to all others against time: control points [time, mm].",
           Need::kRequired);
  v.integer("threshold_frozen_above", &T::threshold_frozen_above, 0, 100000,
            "The least distance stays what it is with more primordia than this; 0: never.");
  v.number("relaxation", &T::relaxation, within(0.0, 10000.0),
           "Rate at which the youngest primordia move sideways to that distance.");
  v.number("mobile_zone", &T::mobile_zone, above(0.0, 100.0),
           "They may move as long as their position is below so many times the ring's.");
  v.number("last_ring", &T::last_ring, kUnit, "No more primordia once the ring's position is at or below this.");
  v.number("lag", &T::lag, within(0.0, 0.1),
           "How much nearer to the apex a primordium stands than where it arose, in shares of all tissue.");
  v.number("first_azimuth_deg", &T::first_azimuth_deg, within(0.0, 360.0), "Of the first primordium, in degrees.");
  v.numbers("knots", &T::knots, kUnit, Count{0, 103},
            "When the sections are: knots of the quadratic B-spline in time that blends them, three more than "
            "sections, the first three 0, the last three 1; left out, equally spaced.");
  v.list("sections", &T::sections, Count{3, 100}, "The head at stages of its growth, youngest first.", Need::kRequired);
}

template <class V>
void describe(V& v, Table<Head>) {
  using T = Head;
  v.choice(
      "rule", &T::rule, kPlacementRules,
      "How organs find their places. A growing meristem is covered: centripetal, from its rim inwards; divergent, "
      "from a line between its middle and its rim both ways; segregation, it gives off an organ whenever it is large "
      "enough. On a receptacle of given size: ridley, bands of given areas; collision, spheres of given radii that "
      "roll up from the base until they touch; active_ring, wherever there is room on the active ring of a growing "
      "head.");
  v.number("divergence_deg", &T::divergence_deg, between(-360.0, 360.0),
           "Angle from one organ to the next, in degrees, counter-clockwise seen from above. The golden angle is "
           "137.50776405003785.");
  v.number("interval", &T::interval, above(0.0, 1.0),
           "Developmental time between two organs; not for segregation and active_ring.");
  v.number("height_mm", &T::height_mm, kOffset,
           "Of a head that an organ carries: where it stands on the organ's axis, in mm.");
  v.number("meristem_area_mm2", &T::meristem_area_mm2, kArea,
           "Growing meristems: area of the middle that is still naked at time 0, in square mm.");
  v.points("meristem_growth", &T::meristem_growth, function_of(kUnit, kFactor),
           "Growing meristems: factor of the naked area against time: control points [time, factor].");
  v.points(
      "meristem_rate", &T::meristem_rate, function_of(kUnit, within(-1000.0, 1000.0)),
      "Growing meristems: relative rate at which the naked area grows, in place of its factor: control points [time, "
      "rate]; a constant rate is exponential growth.");
  v.points("area_growth", &T::area_growth, function_of(kUnit, kFactor),
           "Growing meristems: share of its mature area that an organ has reached, against age: control points [age, "
           "share].");
  v.number("outer_area_mm2", &T::outer_area_mm2, kArea, "Divergent: area of the rim that is naked at time 0.");
  v.points("outer_growth", &T::outer_growth, function_of(kUnit, kFactor),
           "Divergent: factor of the naked rim's area against time: control points [time, factor].");
  v.number("threshold_area_mm2", &T::threshold_area_mm2, kArea,
           "Segregation: area of the naked middle at which it gives off an organ, in square mm.");
  v.points("area_mm2", &T::area_mm2, function_of(kUnit, kArea),
           "All rules but collision and active_ring: mature area of an organ against its position at birth: control "
           "points [position, "
           "square mm]; 0 apex, 1 base.");
  v.points("growth", &T::growth, function_of(kUnit, kFactor),
           "Given size: factor of the receptacle's size against time: control points [time, factor].");
  v.integer("count", &T::count, 0, 100000, "Given size: at most so many organs; 0 is as many as there is room for.");
  v.points(
      "radius_mm", &T::radius_mm, function_of(kUnit, above(0.0, 10000.0)),
      "Collision: radius of an organ's sphere against its position: control points [position, mm]; 0 apex, 1 base.");
  v.number("contact_factor", &T::contact_factor, within(0.05, 1.0),
           "Collision: distance of two touching organs over the sum of their radii; below 1 they run into each other.");
  v.flag("bezier", &T::bezier,
         "Given size: outlines are cubic Bezier curves, end to end, of 3 n + 1 points; otherwise one B-spline.");
  v.name("receptacle_pigment", &T::receptacle_pigment, NameOf::kPigment, "Pigment of the naked receptacle.");
  v.list("receptacle", &T::receptacle, Count{0, 32},
         "Outline of the receptacle at key times, at least one; none for active_ring.");
  v.list("zones", &T::zones, Count{0, 64},
         "What grows where: zones that cover positions 0 to 1 without gap or overlap; none for active_ring.");
  v.option("active_ring", &T::active_ring, "Rule active_ring: the growing head and how primordia keep apart on it.");
  v.option("fate", &T::fate, "Florets with room become another kind (rays at the rim): the cone rule.");
}

template <class V>
void describe(V& v, Table<Hairs>) {
  using T = Hairs;
  v.name("on", &T::on, NameOf::kNothing,
         "Name of the petals or column of the same organ that they stand on; left out for the hairs of the stem.");
  v.name("pigment", &T::pigment, NameOf::kPigment, "Their pigment, from root to tip.", Need::kRequired);
  v.flag("upper", &T::upper, "They stand on the upper side of petals, on the outside of columns and the stem.");
  v.flag("lower", &T::lower, "They stand on the lower side of petals.");
  v.number("density_per_mm2", &T::density_per_mm2, within(1e-6, 1000.0),
           "Hairs on a square mm of each side, when it is full grown.");
  v.range("along", &T::along, kUnit, "The part that they stand on, from base 0 to tip 1.");
  v.range("length_mm", &T::length_mm, within(0.001, 1000.0), "Length when full grown, in mm.");
  v.number("radius_mm", &T::radius_mm, within(0.0001, 100.0), "Radius at the root, in mm; they end in a point.");
  v.range("lean_deg", &T::lean_deg, within(-90.0, 90.0), "Lean from the surface's normal towards its tip, in degrees.");
  v.range("swirl_deg", &T::swirl_deg, kHalfTurn,
          "Turn of the lean's direction about the normal, in degrees; [-180, 180] is any direction.");
  v.range("bend_deg", &T::bend_deg, kTurn, "Further lean over the length, in degrees.");
}

template <class V>
void describe(V& v, Table<Peduncle>) {
  using T = Peduncle;
  v.name("pigment", &T::pigment, NameOf::kPigment, "Pigment of the stem.");
  v.number("length_mm", &T::length_mm, kLength, "Length in mm; 0 is no stem.");
  v.number("radius_mm", &T::radius_mm, above(0.0, 1000.0), "Radius at the foot of the mature stem, in mm.");
  v.number("bend_deg", &T::bend_deg, kHalfTurn, "Bend of the whole stem, in degrees.");
  v.points("growth", &T::growth, function_of(kUnit, kFactor),
           "Factor of the length against time: control points [time, factor].");
  v.list("hairs", &T::hairs, Count{0, 32}, "Hairs that are drawn on it.");
}

template <class V>
void describe(V& v, Table<PetalPose>) {
  using T = PetalPose;
  v.number("stage", &T::stage, kUnit, "Stage of development of this pose: 0 bud, 1 open; ascending over the list.",
           Need::kRequired);
  v.points("midrib_mm", &T::midrib_mm, curve(kOffset, kOffset),
           "Midrib from base to tip: control points [outward, up], in mm.", Need::kRequired);
  v.numbers("half_width_mm", &T::half_width_mm, kLength, kPoints,
            "Half width of the petal at each point of the midrib, in mm.", Need::kRequired);
  v.numbers("side_mm", &T::side_mm, kOffset, Count{0, kPoints.max},
            "Sideways shift of each row, in mm; left out for symmetric petals.");
  v.sections(
      "section", "sections", &T::sections,
      "Half cross-section as points [across, up] or [across, up, forward], in units of the half width there: "
      "across 0 is the midrib, 1 the half width. A margin may come back: a section that rolls inwards is a tube.");
}

template <class V>
void describe(V& v, Table<Petals>) {
  using T = Petals;
  v.name("name", &T::name, NameOf::kNothing, "What these petals are called.", Need::kRequired);
  v.name("pigment", &T::pigment, NameOf::kPigment, "Their pigment.", Need::kRequired);
  v.integer("count", &T::count, 1, 64, "Copies by rotation about the organ's axis.");
  v.flag("mirrored", &T::mirrored, "Add a second copy, reflected in the organ's plane of symmetry.");
  v.number("azimuth_deg", &T::azimuth_deg, kTurn, "Direction of the first petal, in degrees; 0 is outward.");
  v.integer("fused", &T::fused, 0, 256,
            "Control points of the margin, from the base up, that neighbouring petals share.");
  v.name("fused_with", &T::fused_with, NameOf::kNothing,
         "Name of an earlier set of petals whose margin these share; left out, they share each other's.");
  v.integer("degree_across", &T::degree_across, 1, 5, "Degree of the B-spline surface across the petal.");
  v.integer("degree_along", &T::degree_along, 1, 5, "Degree of the B-spline surface along the petal.");
  v.points("spacing", &T::spacing, function_of(kUnit, within(0.002, 1.0)),
           "Distance between rows of vertices against position, base 0 to tip 1: control points [position, share of "
           "the length].");
  v.points("vertices", &T::vertices, function_of(kUnit, within(1.0, 200.0)),
           "Vertices across against position, base 0 to tip 1: control points [position, number].");
  v.list("poses", &T::poses, kPoses, "The petal at key stages of its development, at least one.", Need::kRequired);
}

template <class V>
void describe(V& v, Table<ColumnPose>) {
  using T = ColumnPose;
  v.number("stage", &T::stage, kUnit, "Stage of development of this pose: 0 bud, 1 open; ascending over the list.",
           Need::kRequired);
  v.points("profile_mm", &T::profile_mm, curve(kLength, kOffset),
           "Outline from base to top: control points [radius, height], in mm.", Need::kRequired);
  v.number("lean_deg", &T::lean_deg, kHalfTurn, "Lean away from the organ's axis, in degrees.");
}

template <class V>
void describe(V& v, Table<Column>) {
  using T = Column;
  v.name("name", &T::name, NameOf::kNothing, "What this part is called: stamens, style, ovary.", Need::kRequired);
  v.name("pigment", &T::pigment, NameOf::kPigment, "Its pigment.", Need::kRequired);
  v.integer("count", &T::count, 1, 256, "Copies by rotation about the organ's axis.");
  v.number("azimuth_deg", &T::azimuth_deg, kTurn, "Direction of the first copy, in degrees; 0 is outward.");
  v.number("ring_radius_mm", &T::ring_radius_mm, kLength, "Distance of the copies' bases from the axis, in mm.");
  v.number("base_mm", &T::base_mm, kOffset, "Height of the copies' bases, in mm.");
  v.integer("sides", &T::sides, 3, 64, "Vertices around.");
  v.integer("rings", &T::rings, 2, 64, "Vertices along.");
  v.integer("degree", &T::degree, 1, 5, "Degree of the outline's curve.");
  v.list("poses", &T::poses, kPoses, "The part at key stages of its development, at least one.", Need::kRequired);
}

template <class V>
void describe(V& v, Table<OrganVariation>) {
  using T = OrganVariation;
  v.range("size", &T::size, within(0.01, 100.0), "Factor of the size, from lowest to highest.");
  v.range("pitch_deg", &T::pitch_deg, kHalfTurn, "Added tilt outward, in degrees.");
  v.range("yaw_deg", &T::yaw_deg, kHalfTurn, "Turn about the head's radius, in degrees.");
  v.range("roll_deg", &T::roll_deg, kHalfTurn, "Turn about the organ's own axis, in degrees.");
  v.range("stage", &T::stage, within(-1.0, 1.0), "Added to the stage of development.");
}

template <class V>
void describe(V& v, Table<ShapeVariation>) {
  using T = ShapeVariation;
  v.range("curl_deg", &T::curl_deg, kTurn, "Extra bend over the length, in degrees; backwards when positive.");
  v.range("twist_deg", &T::twist_deg, kTurn, "Turn of the tip about the midrib, in degrees.");
  v.range("sway_deg", &T::sway_deg, kTurn, "Extra bend sideways over the length, in degrees.");
  v.range("width", &T::width, within(0.01, 100.0), "Factor of the width.");
}

template <class V>
void describe(V& v, Table<Tissue>) {
  using T = Tissue;
  const auto stiffness = within(1e-6, 1.0);
  v.number("thickness_mm", &T::thickness_mm, within(0.01, 10.0),
           "Thickness of a grown organ, in mm: organs keep the mean of theirs between them.");
  v.number("stretch", &T::stretch, stiffness,
           "Stiffness against change of lengths: share of an error removed at once.");
  v.number("bend", &T::bend, stiffness, "Stiffness against bending of the midrib: folds that run across.");
  v.number("roll", &T::roll, stiffness, "Stiffness against rolling or flattening: folds that run along.");
  v.number("hold", &T::hold, stiffness, "Stiffness of the attachment at the base.");
}

// The file shows the form of an organ beside its timing: one table, two structs.
inline constexpr auto kShapePetals = [](auto& kind) -> auto& {
  return kind.shape.petals;
};
inline constexpr auto kShapeColumns = [](auto& kind) -> auto& {
  return kind.shape.columns;
};
inline constexpr auto kShapeHairs = [](auto& kind) -> auto& {
  return kind.shape.hairs;
};
inline constexpr auto kShapeVariation = [](auto& kind) -> auto& {
  return kind.shape.variation;
};

template <class V>
void describe(V& v, Table<OrganKind>) {
  using T = OrganKind;
  v.integer("variants", &T::variants, 1, 64, "Number of different shapes to choose from at random.");
  v.points("growth", &T::growth, function_of(kUnit, kFactor),
           "Factor of the size against age: control points [age, factor].");
  v.points("opening", &T::opening, function_of(kUnit, kUnit),
           "Stage of development against age: control points [age, stage].");
  v.points("size", &T::size, function_of(kUnit, kFactor),
           "Factor of the size against position on the mature head, apex 0 to base 1: control points [position, "
           "factor].");
  v.points("pitch_deg", &T::pitch_deg, function_of(kUnit, kHalfTurn),
           "Tilt outward from the receptacle's normal against age: control points [age, degrees].");
  v.number("layering_deg", &T::layering_deg, kHalfTurn,
           "Extra tilt of the first organ of the kind over the last, in degrees: neighbours lie in layers.");
  v.number("sink_mm", &T::sink_mm, within(-1000.0, 1000.0), "How deep the base is set into the receptacle, in mm.");
  v.number(
      "fits_radius_mm", &T::fits_radius_mm, kLength,
      "Radius of the organ's place that the form is drawn for, in mm: it is scaled to the place it has. 0 keeps the "
      "size that is drawn.");
  v.vector("contact_point_mm", &T::contact_point_mm, kOffset,
           "Point of the form that comes to lie on the receptacle: [outward, sideways, up], in mm.");
  v.vector("axis", &T::axis, kOffset, "Direction of the form that comes to lie along the receptacle's normal.");
  v.vector("outward", &T::outward, kOffset, "Direction of the form that comes to point away from the apex.");
  v.table("variation", &T::variation, Layout::kInline, "How organs of the kind differ in how they stand.");
  v.table("tissue", &T::tissue, Layout::kInline, "How organs of the kind give way when they touch.");
  v.table("shape_variation", kShapeVariation, Layout::kInline, "How organs of the kind differ in form.");
  v.list("petals", kShapePetals, Count{0, 32},
         "Sets of petals, or of anything flat: ligules, corolla lobes, bracts, leaves.");
  v.list("columns", kShapeColumns, Count{0, 32}, "Parts that are round: stamens, styles, ovaries, pappus.");
  v.list("hairs", kShapeHairs, Count{0, 32}, "Hairs that are drawn on petals and columns.");
  v.option("head", &T::head, "Organs that the organ carries itself: the same table as the plant's own head.");
}

template <class V>
void describe(V& v, Table<Pigment>) {
  using T = Pigment;
  v.stops("colour", &T::colour, Count{1, 16},
          "Colour from base (0) to tip (1): one \"#rrggbb\", or a list of [position, \"#rrggbb\"].", Need::kRequired);
  v.colour("underside", &T::underside, "Colour mixed half and half into the lower side.");
  v.colour("margin", &T::margin, "Colour towards the edges.");
  v.number("margin_width", &T::margin_width, within(0.001, 1.0), "Share of the half width that the margin fades over.");
  v.integer("veins", &T::veins, 0, 64, "Veins across the whole width.");
  v.number("vein_depth", &T::vein_depth, kUnit, "How much darker a vein is.");
  v.number("mottle", &T::mottle, kUnit, "Strength of fine random patches.");
  v.range("hue_deg", &T::hue_deg, kHalfTurn, "Turn of hue of an organ, in degrees.");
  v.range("value", &T::value, within(0.0, 2.0), "Factor of brightness of an organ.");
  v.number("roughness", &T::roughness, kUnit, "0 mirror, 1 matt.");
  v.number("specular", &T::specular, kUnit, "Strength of the clear reflection.");
  v.number("sheen", &T::sheen, kUnit, "Velvet at grazing angles.");
  v.number("translucency", &T::translucency, kUnit, "Share of the diffuse light that passes through.");
}

template <class V>
void describe(V& v, Table<VeinJitter>) {
  using T = VeinJitter;
  v.number("probability", &T::probability, kUnit, "That a step deviates (eta).");
  v.number("strength", &T::strength, kFactor, "Of a deviation, in steps (gamma).");
}

inline constexpr Limits kAnyPositive = within(0.0, 1e6);
inline constexpr Limits kVeinLength = above(0.0, 1e6);

template <class V>
void describe(V& v, Table<VeinInitial>) {
  using T = VeinInitial;
  v.number("depth_mm", &T::depth_mm, kVeinLength, "Depth to which the strand begins straight into the head.");
  v.flag("depth_follows_course", &T::depth_follows_course, "Times depth_course at birth.");
  v.range("depth_range", &T::depth_range, above(0.0, 100.0), "Times a random number, once for each primordium.");
  v.number("sinking_mm", &T::sinking_mm, kAnyPositive, "It points this much further down.");
  v.whole_range("delay_frames", &T::delay_frames, 0, 1000000, "From birth to the start of the strand, in frames.");
  v.choice("kind", &T::kind, kVeinKinds, "Kind of the beginning.");
  v.choice("strand", &T::strand, kVeinKinds, "Kind of its inner end and of the strand that goes on from there.");
  v.table("jitter", &T::jitter, Layout::kInline, "Deviation of the beginning.");
  v.table("strand_jitter", &T::strand_jitter, Layout::kInline, "Deviation of the strand.");
  v.number("resistivity_factor", &T::resistivity_factor, kAnyPositive, "Of the strand.");
  v.number("initial_resistivity_factor", &T::initial_resistivity_factor, kAnyPositive, "Of the beginning.");
}

template <class V>
void describe(V& v, Table<VeinReticulation>) {
  using T = VeinReticulation;
  v.choice("rule", &T::rule, kReticulationRules,
           "Second ways: none; by least resistance, up to a ratio; from the oldest neighbour, up to a difference.");
  v.integer("delay_frames", &T::delay_frames, 0, 1000000, "From the start of a strand to its second way.");
  v.number("ratio_limit", &T::ratio_limit, kAnyPositive,
           "Resistance of the second way over that of the first (kappa).");
  v.number("difference_limit", &T::difference_limit, within(-1e6, 1e6),
           "Resistance of the second way less the first's.");
  v.number("reach_mm", &T::reach_mm, kAnyPositive, "Longest second connection, in mm.");
  v.number("neighbourhood_mm", &T::neighbourhood_mm, kAnyPositive, "No point farther than this is considered, in mm.");
}

inline constexpr auto kSourcePlaces = [](auto& colonisation) -> auto& {
  return colonisation.s.points;
};

template <class V>
void describe(V& v, Table<VeinColonisation>) {
  using T = VeinColonisation;
  v.flag("enabled", &T::enabled, "Whether strands grow towards attraction points below the surface.");
  v.range("window", &T::window, kUnit, "Times between which attraction points appear.");
  v.points("s", kSourcePlaces, course_of(kUnit), "Where on the outline, against time: 0 apex, 1 rim.");
  v.range("depth_mm", &T::depth_mm, kAnyPositive, "Depth of attraction points below the surface, in mm.");
  v.integer("points_per_frame", &T::points_per_frame, 0, 10000, "At most so many in a frame.");
  v.number("spacing_mm", &T::spacing_mm, kVeinLength, "Between a new point and those of earlier frames.");
  v.number("kill_distance_mm", &T::kill_distance_mm, kVeinLength, "A point this near a strand is used up.");
  v.number("step_mm", &T::step_mm, kVeinLength, "Of a strand at the end; twice that at time 0.");
  v.number("resistivity_factor", &T::resistivity_factor, kAnyPositive, "Of these strands.");
  v.table("jitter", &T::jitter, Layout::kInline, "Deviation of these strands.");
}

/// A part of the parameters of veins as a part of the table they stand in.
template <class Member>
constexpr auto of_veins(Member member) {
  return [member](auto& veins) -> auto& {
    return std::invoke(member, veins.params);
  };
}
template <std::size_t kind>
inline constexpr auto kInitial = [](auto& veins) -> auto& {
  return veins.params.initials[kind];
};
template <std::size_t kind>
inline constexpr auto kTip = [](auto& veins) -> auto& {
  return veins.params.tip_diameter_mm[kind];
};
template <auto member>
inline constexpr auto kCourse = [](auto& veins) -> auto& {
  return std::invoke(member, veins.params).points;
};

template <class V>
void describe(V& v, Table<HeadVeins>) {
  using T = HeadVeins;
  using P = VeinParams;
  v.preset("like", "source",
           "Whose parameters all others begin with; and whether by the text of O24 or as its programs have them.");
  v.integer("frames", &T::frames, 2, 100000, "Steps of the development.");
  v.choice("inside", &T::inside, kHeadInsides, "What carries tissue inside the head from frame to frame.");
  v.choice("axis", &T::axis, kAxisConditions,
           "Harmonic: whether what lies beside the axis moves away from it freely, as in O24, or not at all.");
  v.number("max_edge", &T::max_edge, within(0.01, 1.0),
           "Harmonic: longest edge of the triangulated section, as a share of its size.");
  v.choice("clock", &T::clock, kVeinClocks,
           "Which outline a frame sees: that of its own time, or one that follows a pace, as in O24's programs.");
  v.points("pace", &T::pace, function_of(kUnit, above(0.0, 1000.0)), "Published clock: pace of the outlines.");
  v.integer("ring_vertices", of_veins(&P::ring_vertices), 1, 100000, "Vertices of the ring that all strands lead to.");
  v.number("ring_radius", of_veins(&P::ring_radius), above(0.0, 1.0), "Radius of the ring over that of the base.");
  v.number("ring_inset_mm", of_veins(&P::ring_inset_mm), kAnyPositive, "Less this.");
  v.number("first_start", of_veins(&P::first_start), kUnit, "Strands start at times later than this.");
  v.table("bract", kInitial<0>, Layout::kInline, "How strands of bracts begin.");
  v.table("trans_floret", kInitial<1>, Layout::kInline, "How strands of trans florets begin.");
  v.table("floret", kInitial<2>, Layout::kInline, "How strands of florets begin.");
  v.points("depth_course", kCourse<&P::depth_course>, course_of(kFactor), "Factor of their depth against time.");
  v.flag("deviated_initial_is_unit", of_veins(&P::deviated_initial_is_unit),
         "Steps of a beginning keep their length when they deviate.");
  v.points("ground_resistivity", kCourse<&P::ground_resistivity>, course_of(kAnyPositive),
           "Resistivity of the ground over that of mature strands, against time (r_G).");
  v.points("maturation_frames", kCourse<&P::maturation_frames>, course_of(kAnyPositive),
           "Frames that a strand takes to mature, against time (tau_m).");
  v.number("mature_resistivity", of_veins(&P::mature_resistivity), kAnyPositive, "Of mature strands (r_V).");
  v.number("vein_weight", of_veins(&P::vein_weight), kAnyPositive, "Weight of the way through strands.");
  v.number("age_weight", of_veins(&P::age_weight), kAnyPositive, "Weight of the age of strands (mu_age).");
  v.number("age_offset", of_veins(&P::age_offset), kUnit, "What is taken off the ratio of ages.");
  v.flag("visible_only", of_veins(&P::visible_only), "Only vertices that are not shielded may be joined.");
  v.number("shielding_angle_deg", of_veins(&P::shielding_angle_deg), above(0.0, 180.0),
           "Width of the nearest vertex as a shield, in degrees.");
  v.number("sector_weight", of_veins(&P::sector_weight), kAnyPositive,
           "Cost of ways across the radial plane (mu_sec).");
  v.choice("sector_rule", of_veins(&P::sector_rule), kSectorRules, "By which rule.");
  v.number("inward_limit", of_veins(&P::inward_limit), within(-1.0, 1.0),
           "Ways whose direction has a radial part below this are avoided; -1: none.");
  v.number("step_mm", of_veins(&P::step_mm), kVeinLength, "Step of a strand (delta).");
  v.number("merge_distance_mm", of_veins(&P::merge_distance_mm), kVeinLength, "A strand this near another joins it.");
  v.number("momentum", of_veins(&P::momentum), kAnyPositive, "Of the beginning's direction, kept by the strand.");
  v.flag("retarget", of_veins(&P::retarget), "Choose the way again at each step.");
  v.choice("deviation", of_veins(&P::deviation), kDeviationRules, "How steps deviate.");
  v.number("drift", of_veins(&P::drift), kUnit, "Each step down by a random share of this many steps.");
  v.choice("join", of_veins(&P::join), kJoinRules, "Where a strand is attached that has come near another.");
  v.number("split_length_mm", of_veins(&P::split_length_mm), kVeinLength, "Longer edges are halved.");
  v.table("reticulation", of_veins(&P::reticulation), Layout::kInline, "Second ways to the ring.");
  v.table("colonisation", of_veins(&P::colonisation), Layout::kInline,
          "Strands towards attraction points below the surface.");
  v.choice("diameter_rule", of_veins(&P::diameter_rule), kDiameterRules, "How diameters add up.");
  v.number("murray_exponent", of_veins(&P::murray_exponent), within(1.0, 100.0), "Exponent of Murray's law (n).");
  v.number("floret_tip_mm", kTip<0>, kVeinLength, "Diameter of tips of florets.");
  v.number("abaxial_tip_mm", kTip<1>, kVeinLength, "Diameter of abaxial tips.");
  v.number("adaxial_tip_mm", kTip<2>, kVeinLength, "Diameter of adaxial tips.");
  v.points("diameter_course", kCourse<&P::diameter_course>, course_of(above(0.0, 1e6)),
           "Factor of all diameters against time.");
  v.integer("fade_in_frames", of_veins(&P::fade_in_frames), 0, 1000000,
            "Age at which a piece of a strand has its whole diameter; 0: at once.");
  v.number("second_share", of_veins(&P::second_share), within(0.0, 0.5), "Share that a second way gets.");
}

template <class V>
void describe(V& v, Table<Species>) {
  using T = Species;
  v.name("name", &T::name, NameOf::kNothing, "The species' name on the command line.", Need::kRequired);
  v.text("latin", &T::latin, "Its scientific name.");
  v.text("summary", &T::summary, "A sentence for lists.");
  v.flag("collisions", &T::collisions, "Whether organs push one another unless asked otherwise.");
  v.table("head", &T::head, Layout::kOwnTable, "The flower head: organs in a spiral on a receptacle.", Need::kRequired);
  v.table("peduncle", &T::peduncle, Layout::kOwnTable, "The stem under the head.");
  v.option("vasculature", &T::vasculature, "Veins inside the head, which must have an active ring.");
  v.named("organs", &T::organs, Count{1, 64}, "Kinds of organs, by name.", Need::kRequired);
  v.named("pigments", &T::pigments, Count{1, 64}, "Pigments, by name.", Need::kRequired);
}

}  // namespace anthesis::species_table
