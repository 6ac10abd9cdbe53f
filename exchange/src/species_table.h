#pragma once
// The one description of species files. Each function below lists the keys of one table: name, member, range, sentence.
// Visitors turn the list into a reader (species_file.cpp), a schema (species_schema.cpp) and a writer
// (species_writer.cpp). A member is a pointer to member, or a function from the object to a part of it.
#include <array>
#include <cstddef>
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
};
constexpr PointsRule function_of(Limits x, Limits y) {
  return {x, y, true};
}
constexpr PointsRule curve(Limits x, Limits y) {
  return {x, y, false};
}

/// The values of an enumeration, in its order, as a file names them.
using Choices = std::span<const char* const>;
inline constexpr std::array kPlacementRules = {"centripetal", "divergent", "segregation", "ridley", "collision"};

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
void describe(V& v, Table<Head>) {
  using T = Head;
  v.choice(
      "rule", &T::rule, kPlacementRules,
      "How organs find their places. A growing meristem is covered: centripetal, from its rim inwards; divergent, "
      "from a line between its middle and its rim both ways; segregation, it gives off an organ whenever it is large "
      "enough. On a receptacle of given size: ridley, bands of given areas; collision, spheres of given radii that "
      "roll up from the base until they touch.");
  v.number("divergence_deg", &T::divergence_deg, between(-360.0, 360.0),
           "Angle from one organ to the next, in degrees, counter-clockwise seen from above. The golden angle is "
           "137.50776405003785.");
  v.number("interval", &T::interval, above(0.0, 1.0), "Developmental time between two organs; not for segregation.");
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
           "All rules but collision: mature area of an organ against its position at birth: control points [position, "
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
  v.list("receptacle", &T::receptacle, Count{1, 32}, "Outline of the receptacle at key times, at least one.",
         Need::kRequired);
  v.list("zones", &T::zones, Count{1, 64},
         "What grows where: zones that cover positions 0 to 1 without gap or overlap.", Need::kRequired);
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
void describe(V& v, Table<Species>) {
  using T = Species;
  v.name("name", &T::name, NameOf::kNothing, "The species' name on the command line.", Need::kRequired);
  v.text("latin", &T::latin, "Its scientific name.");
  v.text("summary", &T::summary, "A sentence for lists.");
  v.flag("collisions", &T::collisions, "Whether organs push one another unless asked otherwise.");
  v.table("head", &T::head, Layout::kOwnTable, "The flower head: organs in a spiral on a receptacle.", Need::kRequired);
  v.table("peduncle", &T::peduncle, Layout::kOwnTable, "The stem under the head.");
  v.named("organs", &T::organs, Count{1, 64}, "Kinds of organs, by name.", Need::kRequired);
  v.named("pigments", &T::pigments, Count{1, 64}, "Pigments, by name.", Need::kRequired);
}

}  // namespace anthesis::species_table
