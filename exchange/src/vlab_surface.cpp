#include "anthesis/exchange/vlab_surface.h"

#include "anthesis/exchange/vlab_contour.h"
#include "anthesis/geometry/bspline.h"
#include "vlab_text.h"

namespace anthesis {
namespace {

using detail::TextPlace;
using detail::VlabText;

constexpr std::size_t kMostPatches = 100'000;

bool read_vector(VlabText& text, Vec3& vector) {
  return text.expect("X:") && text.number("x", vector.x) && text.expect("Y:") && text.number("y", vector.y) &&
         text.expect("Z:") && text.number("z", vector.z) && text.end_line();
}

bool read_direction(VlabText& text, std::string_view what, Vec3& direction) {
  const TextPlace place = text.place();
  if (!read_vector(text, direction)) {
    return false;
  }
  direction = normalized(direction);
  return length(direction) > 0.0 || text.fail_at(place, what, "must not be zero");
}

/// "AL: name A: name AR: name"; names may be missing.
bool read_neighbours(VlabText& text, std::string_view first) {
  if (!text.expect(first)) {
    return false;
  }
  text.rest_of_line();
  return true;
}

bool read_patch(VlabText& text, VlabPatch& patch) {
  patch.name = text.rest_of_line();
  if (!text.expect("TOP") || !text.expect("COLOR:")) {
    return false;
  }
  text.rest_of_line();
  if (!read_neighbours(text, "AL:") || !read_neighbours(text, "L:") || !read_neighbours(text, "BL:")) {
    return false;
  }
  for (Vec3& control : patch.controls) {
    for (double* coordinate : {&control.x, &control.y, &control.z}) {
      text.skip_line_ends();
      if (!text.number("control point", *coordinate)) {
        return false;
      }
    }
  }
  return text.end_line();
}

bool read_surface(VlabText& text, VlabSurface& surface) {
  double ignored = 0.0;
  for (int i = 0; i < 6; ++i) {
    if (!text.number("box", ignored)) {
      return false;
    }
  }
  if (!text.end_line()) {
    return false;
  }
  if (text.next_is("PRECISION")) {
    text.rest_of_line();
  }
  Vec3 end;
  if (!text.expect("CONTACT") || !text.expect("POINT") || !read_vector(text, surface.contact) || !text.expect("END") ||
      !text.expect("POINT") || !read_vector(text, end) || !text.expect("HEADING") ||
      !read_direction(text, "HEADING", surface.heading) || !text.expect("UP") ||
      !read_direction(text, "UP", surface.up) || !text.expect("SIZE:") || !text.number("SIZE", surface.size, 1e-30) ||
      !text.end_line()) {
    return false;
  }
  while (!text.at_end()) {
    const TextPlace place = text.place();
    if (surface.patches.size() == kMostPatches) {
      return text.fail_at(place, "patches", "must be at most " + std::to_string(kMostPatches), ErrorCode::kTooLarge);
    }
    text.skip_line_ends();
    if (!read_patch(text, surface.patches.emplace_back())) {
      return false;
    }
  }
  return !surface.patches.empty() || text.fail("patches", "must be at least 1");
}

}  // namespace

Expected<VlabSurface> read_vlab_surface(std::string_view text, std::string_view file_name) {
  VlabText reader(text, file_name);
  VlabSurface surface;
  if (!reader.fits(kVlabTextLimit) || !read_surface(reader, surface)) {
    return unexpected(reader.error);
  }
  return surface;
}

std::array<Vec3, 16> vlab_placed_controls(const VlabSurface& surface, const VlabPatch& patch) {
  // Contact point to the origin, heading to +y, up to +z, and what lies to the right of both to +x. The two need not be
  // perpendicular: like VLab, we write the point in terms of the three axes as they are.
  const Vec3 left = cross(surface.up, surface.heading);
  std::array<Vec3, 16> placed;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Vec3 p = (patch.controls[i] - surface.contact) / surface.size;
    placed[i] = -p.x * left + p.y * surface.heading + p.z * surface.up;
  }
  return placed;
}

Vec3 vlab_patch_point(const std::array<Vec3, 16>& controls, double u, double v) {
  return surface_at(std::span<const Vec3>(controls), clamped_basis(4, 3, v), clamped_basis(4, 3, u), 4);
}

}  // namespace anthesis
