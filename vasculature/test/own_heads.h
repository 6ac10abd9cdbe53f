#pragma once
// Small heads of our own making.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "anthesis/base/math.h"
#include "anthesis/vasculature/mean_value_growth.h"
#include "anthesis/vasculature/vasculature.h"

namespace anthesis::test {

/// A cylinder of radius 1 and height 1 that does not grow. s = 0.5 is its edge.
inline HeadGrowth still_cylinder(std::size_t frames) {
  static const std::array<Vec2, 3> outline = {Vec2{0.0, 1.0}, Vec2{1.0, 1.0}, Vec2{1.0, 0.0}};
  return {frames, [](std::size_t) { return std::span<const Vec2>(outline); },
          [](std::size_t, std::size_t, std::span<Vec2>) {}};
}

/// Straight strands that start at once, everything of resistivity 1.
inline VeinParams plain_veins() {
  VeinParams params;
  params.ring_vertices = 1;
  params.ring_radius = 0.5;
  params.ring_inset_mm = 0.0;
  params.first_start = 0.0;
  for (VeinInitial& initial : params.initials) {
    initial.depth_mm = 0.1;
  }
  params.maturation_frames = {{{0.0, 0.0}}};
  params.step_mm = 0.005;
  params.merge_distance_mm = 0.005;
  params.split_length_mm = 0.1;
  return params;
}

/// A primordium on the top of the cylinder.
inline VeinPrimordium on_top(std::uint32_t id, std::uint32_t frame, double radius, double azimuth_rad) {
  return {id, frame, 0.5 * radius, azimuth_rad, PrimordiumKind::kBract};
}

/// A head the shape of a saucer on a stalk, of `scale` times the size that O24's gerbera has, with as many primordia or
/// every n-th of them, born at the golden angle along a ring that closes.
struct SaucerHead {
  OutlineSequence outlines;
  std::vector<VeinPrimordium> primordia;
};

inline SaucerHead saucer_head(std::size_t frames = 2214, double scale = 1.0, std::uint32_t every = 1) {
  SaucerHead head;
  constexpr std::size_t kTop = 50;
  constexpr std::size_t kSide = 40;
  head.outlines.points_per_frame = kTop + kSide;
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = static_cast<double>(f) / static_cast<double>(frames - 1);
    const double grown = t * t * (3.0 - 2.0 * t);
    const double radius = scale * 0.3 * math::pow(9.36 / 0.3, grown);
    const double height = scale * 0.2 * math::pow(7.65 / 0.2, grown);
    const double base = scale * 0.234 * math::pow(3.6 / 0.234, grown);
    for (std::size_t i = 0; i < kTop; ++i) {
      const double u = static_cast<double>(i) / kTop;
      head.outlines.points.push_back({radius * u, height * (1.0 - 0.1 * u * u)});
    }
    for (std::size_t i = 0; i < kSide; ++i) {
      const double u = static_cast<double>(i) / (kSide - 1);
      head.outlines.points.push_back({radius + (base - radius) * u, 0.9 * height * (1.0 - u)});
    }
  }
  constexpr std::array<Vec2, 9> kBirths = {Vec2{0, 0},  {5, 400},    {34, 800},   {141, 1000}, {321, 1200},
                                           {492, 1400}, {643, 1600}, {706, 1800}, {717, 1985}};
  constexpr std::array<Vec2, 7> kRing = {Vec2{0, 0.58}, {500, 0.55},   {1000, 0.382}, {1500, 0.119},
                                         {1800, 0.03},  {1985, 0.003}, {2214, 0.003}};
  const auto along = [](const auto& points, double x) {
    std::size_t i = 1;
    while (i + 1 < points.size() && points[i].x < x) {
      ++i;
    }
    return points[i - 1].y + (points[i].y - points[i - 1].y) * (x - points[i - 1].x) / (points[i].x - points[i - 1].x);
  };
  const double pace = static_cast<double>(frames) / 2214.0;
  for (std::uint32_t id = 0; id < 717; id += every) {
    const double frame = along(kBirths, id);
    head.primordia.push_back({id, static_cast<std::uint32_t>(frame * pace), along(kRing, frame),
                              std::fmod(id * 2.399963229728653, math::kTurnRad),
                              id < 84    ? PrimordiumKind::kBract
                              : id < 251 ? PrimordiumKind::kTransFloret
                                         : PrimordiumKind::kFloret});
  }
  return head;
}

}  // namespace anthesis::test
