#include "anthesis/render/scene_of_veins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anthesis/base/assert.h"
#include "anthesis/base/check.h"
#include "anthesis/base/math.h"
#include "cut_veins.h"
#include "glyphs.h"
#include "polygon.h"
#include "view_axes.h"

namespace anthesis {
namespace {

constexpr double kFarthest_mm = 1e6;
constexpr std::size_t kSectionPoints = 128;  // along the half section
constexpr int kAround = 128;                 // about the axis
constexpr int kRoundSides = 12;              // of the section's line and the scale bar

// Shares of the framed radius.
constexpr double kSkin = 0.012;         // from the outline, where the florets' strands end, to the drawn film
constexpr double kLine = 0.0065;        // radius of the section's line
constexpr double kBar = 0.011;          // radius of the scale bar
constexpr double kBarGap = 0.13;        // from the head down to it
constexpr double kLetter = 0.09;        // height of the letters beside it
constexpr double kLargestBead = 0.035;  // radius

constexpr Veil kFilm = {.facing = 0.012, .edge = 0.75, .doublings = 3};
constexpr Veil kSectionFilm = {.facing = 0.035, .edge = 0.035, .doublings = 0};

enum PigmentIndex : std::uint32_t {
  kFloretPigment,
  kAbaxialPigment,
  kAdaxialPigment,
  kFilmPigment,
  kLinePigment,
  kBractBead,
  kFloretBead,
  kBarPigment
};

Colour srgb(int red, int green, int blue) {
  return {linear_from_srgb(red / 255.0), linear_from_srgb(green / 255.0), linear_from_srgb(blue / 255.0)};
}

Pigment matt(const char* name, Colour colour, double specular, double translucency) {
  Pigment pigment;
  pigment.name = name;
  pigment.colour = {{0.0, colour}};
  pigment.mottle = 0.0;
  pigment.roughness = 0.45;
  pigment.specular = specular;
  pigment.sheen = 0.0;
  pigment.translucency = translucency;
  return pigment;
}

/// In the order of PigmentIndex. Strands are lighter than vein_colour, as these are lit; receptacle and section stand
/// out from the backdrop.
std::vector<Pigment> pigments_of_veins(const Backdrop& backdrop) {
  const bool light = backdrop.transparent || backdrop.centre.g > 0.2;
  const Colour film = light ? srgb(92, 140, 70) : srgb(200, 234, 154);
  const Colour line = light ? srgb(70, 112, 44) : srgb(214, 246, 140);
  return {matt("floret", srgb(196, 112, 240), 0.35, 0.0),
          matt("abaxial", srgb(220, 232, 130), 0.35, 0.0),
          matt("adaxial", srgb(248, 54, 60), 0.35, 0.0),
          matt("receptacle", film, 0.0, 0.5),
          matt("section", line, 0.0, 0.3),
          matt("bract", srgb(206, 224, 150), 0.2, 0.0),
          matt("floret bead", srgb(250, 240, 214), 0.2, 0.0),
          matt("scale bar", light ? srgb(40, 44, 40) : srgb(250, 250, 250), 0.0, 0.3)};
}

std::optional<Error> check_outline(std::span<const Vec2> outline_mm) {
  if (outline_mm.size() < 2) {
    return Error{ErrorCode::kInvalidParameter, "outline_mm", "must have at least two points"};
  }
  double length_mm = 0.0;
  double radius_mm = 0.0;
  for (std::size_t i = 0; i < outline_mm.size(); ++i) {
    const Vec2 p = outline_mm[i];
    if (!(p.x >= 0.0 && p.x <= kFarthest_mm && std::abs(p.y) <= kFarthest_mm)) {
      return Error{ErrorCode::kInvalidParameter, "outline_mm[" + std::to_string(i) + "]",
                   "must be finite with a radius >= 0"};
    }
    length_mm += i > 0 ? length(p - outline_mm[i - 1]) : 0.0;
    radius_mm = std::max(radius_mm, p.x);
  }
  if (!(length_mm > 0.0 && radius_mm > 0.0)) {
    return Error{ErrorCode::kInvalidParameter, "outline_mm", "must have some length and a radius > 0"};
  }
  return std::nullopt;
}

/// A half section with directions across, apex first.
struct Section {
  std::vector<Vec2> points;
  std::vector<Vec2> normals;  ///< unit, outwards
};

/// A smooth curve through the outline, evenly sampled and moved outwards. At the apex it runs on into its mirror image.
Section smooth_section(std::span<const Vec2> outline_mm, double outwards_mm) {
  std::vector<Vec2> knots;
  for (const Vec2 p : outline_mm) {
    if (knots.empty() || p != knots.back()) {
      knots.push_back(p);
    }
  }
  const std::size_t last = knots.size() - 1;
  std::vector<double> at = {0.0};  // arc length of the polygon
  for (std::size_t i = 1; i <= last; ++i) {
    at.push_back(at.back() + length(knots[i] - knots[i - 1]));
  }
  // Tangents of the parabola through three points; the apex' neighbour on the other side is its mirror image.
  std::vector<Vec2> tangents(knots.size());
  const auto bent = [](Vec2 a, Vec2 b, Vec2 c) {
    const double before = length(b - a);
    const double after = length(c - b);
    return (after / before) * (b - a) + (before / after) * (c - b);
  };
  for (std::size_t i = 0; i <= last; ++i) {
    if (i == 0 && knots[0].x == 0.0 && knots[1].x > 0.0) {
      tangents[i] = {1.0, 0.0};
    } else if (i == 0) {
      tangents[i] = normalized(knots[1] - knots[0]);
    } else if (i == last) {
      tangents[i] = normalized(knots[last] - knots[last - 1]);
    } else {
      tangents[i] = normalized(bent(knots[i - 1], knots[i], knots[i + 1]));
    }
  }
  Section section;
  std::size_t span = 0;
  for (std::size_t k = 0; k < kSectionPoints; ++k) {
    const double s = at[last] * static_cast<double>(k) / static_cast<double>(kSectionPoints - 1);
    while (span + 2 <= last && s > at[span + 1]) {
      ++span;
    }
    const double size = at[span + 1] - at[span];
    const double t = std::min(1.0, (s - at[span]) / size);
    const Vec2 p0 = knots[span];
    const Vec2 p1 = knots[span + 1];
    const Vec2 m0 = size * tangents[span];
    const Vec2 m1 = size * tangents[span + 1];
    const double u = 1.0 - t;
    const Vec2 point = u * u * (1.0 + 2.0 * t) * p0 + t * t * (3.0 - 2.0 * t) * p1 + t * u * u * m0 - t * t * u * m1;
    const Vec2 along = 6.0 * t * u * (p1 - p0) + u * (1.0 - 3.0 * t) * m0 - t * (2.0 - 3.0 * t) * m1;
    const Vec2 way = normalized(length(along) > 0.0 ? along : p1 - p0);
    const Vec2 normal = {-way.y, way.x};
    const Vec2 moved = point + outwards_mm * normal;
    section.points.push_back({std::max(0.0, moved.x), moved.y});
    section.normals.push_back(normal);
  }
  return section;
}

/// The section turned about the axis, from one azimuth over an angle.
Mesh revolved(const Section& section, double first_rad, double angle_rad, int columns) {
  Mesh mesh;
  const auto rows = static_cast<std::uint32_t>(section.points.size());
  for (int j = 0; j <= columns; ++j) {
    const auto [sine, cosine] = math::sin_cos(first_rad + angle_rad * j / columns);
    for (std::uint32_t i = 0; i < rows; ++i) {
      const Vec2 p = section.points[i];
      const Vec2 n = section.normals[i];
      mesh.positions_mm.push_back({p.x * cosine, p.x * sine, p.y});
      mesh.normals.push_back({n.x * cosine, n.x * sine, n.y});
    }
  }
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(columns); ++j) {
    for (std::uint32_t i = 0; i + 1 < rows; ++i) {
      const std::uint32_t a = j * rows + i;
      const std::uint32_t b = a + rows;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

/// A closed round line along points of a plane of unit normal `across`.
Mesh round_line(std::span<const Vec3> points, Vec3 across, double radius) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(points.size());
  const auto add = [&](Vec3 position, Vec3 normal) {
    mesh.positions_mm.push_back(position);
    mesh.normals.push_back(normal);
  };
  const auto tangent = [&](std::uint32_t i) {
    return normalized(points[std::min(i + 1, n - 1)] - points[i > 0 ? i - 1 : 0]);
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3 side = cross(across, tangent(i));
    for (int j = 0; j < kRoundSides; ++j) {
      const auto [sine, cosine] = math::sin_cos(math::kTurnRad * j / kRoundSides);
      const Vec3 normal = cosine * across + sine * side;
      add(points[i] + radius * normal, normal);
    }
  }
  constexpr std::uint32_t kSides = kRoundSides;
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    for (std::uint32_t j = 0; j < kSides; ++j) {
      const std::uint32_t a = i * kSides + j;
      const std::uint32_t b = i * kSides + (j + 1) % kSides;
      mesh.triangles.push_back({a, b, b + kSides});
      mesh.triangles.push_back({a, b + kSides, a + kSides});
    }
  }
  for (const std::uint32_t end : {0U, n - 1}) {
    const Vec3 outwards = end == 0 ? -tangent(end) : tangent(end);
    const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
    for (std::uint32_t j = 0; j < kSides; ++j) {
      add(mesh.positions_mm[end * kSides + j], outwards);
    }
    for (std::uint32_t j = 1; j + 1 < kSides; ++j) {
      mesh.triangles.push_back(end == 0 ? Triangle{first, first + j + 1, first + j}
                                        : Triangle{first, first + j, first + j + 1});
    }
  }
  return mesh;
}

constexpr int kTextGap = 4;  // from a line to the text beside it, in points of a letter

/// From the end of a line to the end of the text beside it.
double text_width(std::string_view text, double height) {
  const double points = static_cast<double>(Glyph::kAdvance * text.size()) + kTextGap - 1;
  return points * height / Glyph::kRows;
}

/// Flat letters that face the viewer, to the right of a point.
Mesh text_beside(Vec3 point, const ViewAxes& axes, std::string_view text, double height) {
  const double dot_mm = height / Glyph::kRows;
  Mesh mesh;
  const auto corner = [&](std::size_t letter, int column, int row) {
    const double across = static_cast<double>(Glyph::kAdvance * letter) + column + kTextGap;
    mesh.positions_mm.push_back(point + dot_mm * across * axes.right + (0.5 * height - dot_mm * row) * axes.up);
    mesh.normals.push_back(axes.back);
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const Glyph& glyph = glyph_of(text[i]);
    for (int row = 0; row < Glyph::kRows && text[i] != ' '; ++row) {
      for (int column = 0; column < Glyph::kColumns; ++column) {
        if (glyph.lit(column, row)) {
          const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
          corner(i, column, row);
          corner(i, column, row + 1);
          corner(i, column + 1, row + 1);
          corner(i, column + 1, row);
          mesh.triangles.push_back({first, first + 1, first + 2});
          mesh.triangles.push_back({first, first + 2, first + 3});
        }
      }
    }
  }
  return mesh;
}

/// The plane through the axis that faces the viewer.
struct CuttingPlane {
  Vec3 towards;  ///< the viewer, unit, level
  Vec3 right;    ///< unit, level

  explicit CuttingPlane(const View& view) {
    const auto [sine, cosine] = math::sin_cos(view.azimuth_rad);
    towards = {cosine, sine, 0.0};
    right = {-sine, cosine, 0.0};
  }

  Vec3 at(Vec2 p, double before) const { return p.x * right + before * towards + Vec3{0.0, 0.0, p.y}; }
};

/// The whole section from its left rim over the apex to the right one.
std::vector<Vec2> both_sides(const Section& section) {
  std::vector<Vec2> points;
  for (std::size_t i = section.points.size(); i-- > 1;) {
    points.push_back({-section.points[i].x, section.points[i].y});
  }
  if (section.points[0].x > 0.0) {
    points.push_back({-section.points[0].x, section.points[0].y});
  }
  points.insert(points.end(), section.points.begin(), section.points.end());
  return points;
}

class VeinScene {
 public:
  VeinScene(std::span<const Vec2> outline_mm, const VeinSceneOptions& options)
      : options_(options), plane_(options.view) {
    const HeadExtent present = extent_of(outline_mm);
    extent_ = options.extent.circles_mm.empty() ? present : extent_of(options.extent.circles_mm);
    framed_mm_ = extent_.radius_mm();
    section_ = smooth_section(outline_mm, kSkin * present.radius_mm());
    scene_.backdrop = options.backdrop;
    scene_.pigments = pigments_of_veins(options.backdrop);
  }

  /// What of the strands is to be seen.
  Vasculature opened(const Vasculature& veins) const {
    VeinCutParams params;
    params.radius_factor = options_.tubes.radius_factor;
    if (options_.cut == HeadCut::kHalf) {
      return cut(veins, {plane_.towards, 0.0}, params);
    }
    params.most_reach_mm = slice_mm();
    return cut(cut(veins, {plane_.towards, slice_mm()}, params), {-plane_.towards, slice_mm()}, params);
  }

  void add_strands(VeinTubes tubes) {
    // The flat ends of strands that come up aslant would stick out below the base.
    const auto lower = [](Vec2 p, Vec2 q) { return p.y < q.y; };
    const double lowest_mm = std::min_element(section_.points.begin(), section_.points.end(), lower)->y;
    for (Vec3& p : tubes.mesh.positions_mm) {
      p.z = std::max(p.z, lowest_mm);
    }
    // A row of triangles between two kinds is all of one, so that their border runs straight around the tube.
    std::array<std::vector<Triangle>, 3> by_kind;
    for (const Triangle& t : tubes.mesh.triangles) {
      by_kind[static_cast<std::size_t>(std::min({tubes.kind[t[0]], tubes.kind[t[1]], tubes.kind[t[2]]}))].push_back(t);
    }
    SceneMesh mesh{std::move(tubes.mesh), {}};
    mesh.mesh.triangles.clear();
    for (std::uint32_t kind = 0; kind < by_kind.size(); ++kind) {
      const auto first = static_cast<std::uint32_t>(mesh.mesh.triangles.size());
      mesh.mesh.triangles.insert(mesh.mesh.triangles.end(), by_kind[kind].begin(), by_kind[kind].end());
      mesh.spans.push_back({first, static_cast<std::uint32_t>(by_kind[kind].size()), kind});
    }
    add(std::move(mesh));
  }

  void add_receptacle() {
    if (options_.cut != HeadCut::kSlice) {
      const bool half = options_.cut == HeadCut::kHalf;
      const double first_rad = half ? options_.view.azimuth_rad + 0.5 * math::kPi : 0.0;
      add_plain(revolved(section_, first_rad, half ? math::kPi : math::kTurnRad, half ? kAround / 2 : kAround),
                kFilmPigment, kFilm);
    }
    if (options_.cut == HeadCut::kWhole) {
      return;
    }
    const std::vector<Vec2> points = both_sides(section_);
    const double line_mm = kLine * framed_mm_;
    const double at_mm = options_.cut == HeadCut::kHalf ? -line_mm : 0.0;  // nothing stands out of a half head's cut
    std::vector<Vec3> line;
    SceneMesh film;
    for (const Vec2 p : points) {
      line.push_back(plane_.at(p, at_mm));
      film.mesh.positions_mm.push_back(plane_.at(p, at_mm));
    }
    add_plain(round_line(line, plane_.towards, line_mm), kLinePigment);
    std::vector<Vec2> counter_clockwise(points.rbegin(), points.rend());
    const auto last = static_cast<std::uint32_t>(points.size() - 1);
    for (const auto& [a, b, c] : triangulate_polygon(counter_clockwise)) {
      film.mesh.triangles.push_back({last - a, last - b, last - c});
    }
    add_plain(std::move(film.mesh), kFilmPigment, kSectionFilm);
  }

  void add_beads(const Vasculature& veins, std::span<const VeinPrimordium> primordia) {
    // As wide as half a primordium's place, were they all equal.
    double area_mm2 = 0.0;
    for (std::size_t i = 1; i < section_.points.size(); ++i) {
      const Vec2 a = section_.points[i - 1];
      const Vec2 b = section_.points[i];
      area_mm2 += math::kPi * (a.x + b.x) * length(b - a);
    }
    const double place_mm = std::sqrt(area_mm2 / static_cast<double>(std::max<std::size_t>(1, primordia.size())));
    const double radius_mm = std::min(0.2 * place_mm, kLargestBead * framed_mm_);
    std::array<std::optional<std::uint32_t>, 2> meshes;
    for (std::size_t i = 0; i < primordia.size(); ++i) {
      if (veins.primordia[i] == kNoVertex) {
        continue;
      }
      const Vec3 at = veins.vertices[veins.primordia[i]].position;
      const double before = dot(at, plane_.towards);
      const bool cut_away = (options_.cut == HeadCut::kHalf && before > -radius_mm) ||
                            (options_.cut == HeadCut::kSlice && std::abs(before) > slice_mm() - radius_mm);
      if (cut_away) {
        continue;
      }
      const bool bract = primordia[i].kind == PrimordiumKind::kBract;
      std::optional<std::uint32_t>& mesh = meshes[bract ? 1 : 0];
      if (!mesh) {
        mesh = static_cast<std::uint32_t>(scene_.meshes.size());
        const Mesh ball = unit_sphere();
        const auto all = static_cast<std::uint32_t>(ball.triangles.size());
        scene_.meshes.push_back({ball, {{0, all, bract ? kBractBead : kFloretBead}}});
      }
      Instance bead;
      bead.mesh = *mesh;
      bead.world_from_mesh = {at, {}, radius_mm};
      bead.framed = false;
      scene_.instances.push_back(bead);
    }
  }

  /// What the camera frames, as points without triangles; with the scale bar and its length below them.
  Scene finish() && {
    SceneMesh points;
    std::vector<Vec3>& framed = points.mesh.positions_mm;
    // The film and the section's line lie around the outlines.
    const double around_mm = (kSkin + kLine) * framed_mm_;
    for (int j = 0; j < kAround; ++j) {
      const math::SinCos azimuth = math::sin_cos(math::kTurnRad * j / kAround);
      for (const Vec2 circle : extent_.circles_mm) {
        for (int k = 0; k <= kRoundSides; ++k) {
          const math::SinCos angle = math::sin_cos(math::kPi * k / kRoundSides);
          const double radius = circle.x + around_mm * angle.sin;
          framed.push_back({radius * azimuth.cos, radius * azimuth.sin, circle.y + around_mm * angle.cos});
        }
      }
    }
    if (options_.scale_bar) {
      const ViewAxes axes = axes_of(options_.view);
      const std::string length = to_text(scale_bar_mm(framed_mm_)) + " mm";
      const double letter_mm = kLetter * framed_mm_;
      const std::array<Vec3, 2> ends = bar_ends(framed, text_width(length, letter_mm));
      const Mesh bar = round_line(ends, axes.back, kBar * framed_mm_);
      const Mesh label = text_beside(ends[1], axes, length, letter_mm);
      for (const Mesh& part : {bar, label}) {
        framed.insert(framed.end(), part.positions_mm.begin(), part.positions_mm.end());
        add_plain(part, kBarPigment);
      }
    }
    add_haze(framed);
    add(std::move(points), true);
    return std::move(scene_);
  }

 private:
  double slice_mm() const { return options_.slice * framed_mm_; }

  void add(SceneMesh mesh, bool framed = false, std::optional<Veil> veil = std::nullopt) {
    Instance instance;
    instance.mesh = static_cast<std::uint32_t>(scene_.meshes.size());
    instance.framed = framed;
    instance.veil = veil;
    scene_.meshes.push_back(std::move(mesh));
    scene_.instances.push_back(std::move(instance));
  }

  void add_plain(Mesh mesh, std::uint32_t pigment, std::optional<Veil> veil = std::nullopt) {
    const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
    add({std::move(mesh), {{0, triangles, pigment}}}, false, veil);
  }

  /// From the middle of the head backwards: what is before it is as clear as can be, the section and the scale bar too.
  void add_haze(std::span<const Vec3> points) {
    const Vec3 towards = axes_of(options_.view).back;
    double nearest = -std::numeric_limits<double>::infinity();
    double farthest = -nearest;
    for (const Vec3& p : points) {
      nearest = std::max(nearest, dot(p, towards));
      farthest = std::min(farthest, dot(p, towards));
    }
    if (nearest > farthest) {
      scene_.haze = Haze{towards, 0.5 * (nearest + farthest), farthest, options_.haze};
    }
  }

  /// Below `points` in the picture, as deep as their middle, so that the bar is true to scale there; with room for
  /// `label_width` to its right.
  std::array<Vec3, 2> bar_ends(std::span<const Vec3> points, double label_width) const {
    const ViewAxes axes = axes_of(options_.view);
    double lowest = std::numeric_limits<double>::infinity();
    double low_mm = lowest;
    double high_mm = -lowest;
    for (const Vec3& p : points) {
      low_mm = std::min(low_mm, p.z);
      high_mm = std::max(high_mm, p.z);
    }
    const Vec3 middle = {0.0, 0.0, 0.5 * (low_mm + high_mm)};
    // What is nearer than the middle shows larger. About as far away as the camera will be:
    const double distance = (framed_mm_ + 0.5 * (high_mm - low_mm)) * options_.view.focal_length_mm / 18.0;
    for (const Vec3& p : points) {
      const double nearer = std::min(0.5 * distance, dot(p - middle, axes.back));
      lowest = std::min(lowest, dot(p - middle, axes.up) * distance / (distance - nearer));
    }
    const Vec3 centre = middle + (lowest - kBarGap * framed_mm_) * axes.up;
    const double bar_mm = scale_bar_mm(framed_mm_);
    const Vec3 left = centre - 0.5 * (bar_mm + label_width) * axes.right;
    return {left, left + bar_mm * axes.right};
  }

  const VeinSceneOptions& options_;
  CuttingPlane plane_;
  HeadExtent extent_;
  double framed_mm_ = 1.0;
  Section section_;
  Scene scene_;
};

std::optional<Error> check_primordia(const Vasculature& veins, std::span<const VeinPrimordium> primordia) {
  if (veins.primordia.size() != primordia.size()) {
    return Error{ErrorCode::kInvalidParameter, "primordia", "must be those that the veins were grown with"};
  }
  for (std::size_t i = 0; i < veins.primordia.size(); ++i) {
    if (veins.primordia[i] != kNoVertex && veins.primordia[i] >= veins.vertices.size()) {
      return Error{ErrorCode::kInvalidParameter, "veins.primordia[" + std::to_string(i) + "]",
                   "must be a vertex of the veins"};
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> check(const VeinSceneOptions& options) {
  if (auto error = check(options.view)) {
    error->where = "view." + error->where;
    return error;
  }
  if (auto error = check(options.tubes)) {
    error->where = "tubes." + error->where;
    return error;
  }
  if (auto error = check_number("haze", options.haze, 0.0, 1.0)) {
    return error;
  }
  if (!(options.slice > 0.0 && options.slice <= 1.0)) {
    return invalid_parameter("slice", "must be > 0 and at most 1", options.slice);
  }
  for (std::size_t i = 0; i < options.extent.circles_mm.size(); ++i) {
    const Vec2 circle = options.extent.circles_mm[i];
    if (!(circle.x >= 0.0 && circle.x <= kFarthest_mm && std::abs(circle.y) <= kFarthest_mm)) {
      return Error{ErrorCode::kInvalidParameter, "extent.circles_mm[" + std::to_string(i) + "]",
                   "must be finite with a radius >= 0"};
    }
  }
  if (!options.extent.circles_mm.empty() && !(options.extent.radius_mm() > 0.0)) {
    return Error{ErrorCode::kInvalidParameter, "extent.circles_mm", "must have a radius > 0"};
  }
  return std::nullopt;
}

Lighting vein_lighting(const Camera& camera) {
  const auto direction = [&](double right, double up, double back) {
    return normalized(right * camera.right + up * camera.up + back * camera.back);
  };
  Lighting lighting = studio_lighting(camera);
  // A head of strands is all undersides: what the flower's portrait leaves in the dark is lit from below and in front.
  lighting.sky.nadir = {0.16, 0.17, 0.18};
  lighting.sky.glows.push_back({direction(0.25, -0.75, 0.6), 1, {0.42, 0.42, 0.44}});
  return lighting;
}

double HeadExtent::radius_mm() const {
  double radius_mm = 0.0;
  for (const Vec2 circle : circles_mm) {
    radius_mm = std::max(radius_mm, circle.x);
  }
  return radius_mm;
}

HeadExtent extent_of(std::span<const Vec2> outline_mm) {
  std::vector<Vec2> points(outline_mm.begin(), outline_mm.end());
  std::sort(points.begin(), points.end(), [](Vec2 p, Vec2 q) { return p.y != q.y ? p.y < q.y : p.x > q.x; });
  // The outer side of the convex hull; the other side is its mirror image.
  std::vector<Vec2> hull;
  for (const Vec2 p : points) {
    if (!hull.empty() && p.y == hull.back().y) {
      continue;  // within the last circle
    }
    while (hull.size() > 1 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(p);
  }
  return {std::move(hull)};
}

HeadExtent together(const HeadExtent& one, const HeadExtent& other) {
  std::vector<Vec2> circles_mm = one.circles_mm;
  circles_mm.insert(circles_mm.end(), other.circles_mm.begin(), other.circles_mm.end());
  return extent_of(circles_mm);
}

double scale_bar_mm(double framed_radius_mm) {
  ANTHESIS_ASSERT(framed_radius_mm > 0.0);
  return math::round_down_to_125(0.5 * framed_radius_mm);
}

Expected<Scene> make_scene(const Vasculature& veins, std::span<const Vec2> outline_mm,
                           std::span<const VeinPrimordium> primordia, const VeinSceneOptions& options) {
  if (auto error = check(options)) {
    return unexpected(*error);
  }
  if (auto error = check_outline(outline_mm)) {
    return unexpected(*error);
  }
  if (auto error = options.primordia ? check_primordia(veins, primordia) : std::nullopt) {
    return unexpected(*error);
  }
  VeinScene scene(outline_mm, options);
  Expected<VeinTubes> tubes = vein_tubes(options.cut == HeadCut::kWhole ? veins : scene.opened(veins), options.tubes);
  if (!tubes) {
    return unexpected(tubes.error());
  }
  scene.add_strands(std::move(*tubes));
  if (options.receptacle) {
    scene.add_receptacle();
  }
  if (options.primordia) {
    scene.add_beads(veins, primordia);
  }
  return std::move(scene).finish();
}

}  // namespace anthesis
