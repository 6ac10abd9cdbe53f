#include "anthesis/receptacle/harmonic_section.h"

#include "anthesis/base/assert.h"
#include "section_laplacian.h"

namespace anthesis {

struct HarmonicSection::Parts {
  SectionMesh mesh;
  std::size_t controls = 0;
  SectionLaplacian laplacian;
};

HarmonicSection::HarmonicSection(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {}

Expected<HarmonicSection> HarmonicSection::make(std::span<const Vec2> controls, const SectionMeshParams& params) {
  Expected<SectionMesh> mesh = triangulate_section(controls, params);
  if (!mesh) {
    return unexpected(std::move(mesh.error()));
  }
  auto parts = std::make_shared<Parts>();
  parts->mesh = std::move(*mesh);
  parts->controls = controls.size();
  parts->laplacian.reset(parts->mesh);
  parts->laplacian.refresh(parts->mesh, true);
  return HarmonicSection(std::move(parts));
}

const SectionMesh& HarmonicSection::mesh() const {
  return parts_->mesh;
}

std::size_t HarmonicSection::controls() const {
  return parts_->controls;
}

std::vector<double> HarmonicSection::extend(std::span<const double> values, AxisCondition axis) const {
  const SectionMesh& mesh = parts_->mesh;
  ANTHESIS_ASSERT(values.size() == parts_->controls);
  const auto at = [&](std::uint32_t control) {
    const bool on_axis = control == 0 || control + 1 == parts_->controls;
    return on_axis && axis == AxisCondition::kZero ? 0.0 : values[control];
  };
  std::vector<double> result(mesh.points.size());
  for (std::size_t i = 0; i < mesh.contour_points(); ++i) {
    const SectionPlace& place = mesh.places[i];
    result[i] = place.t == 0.0 ? at(place.from) : (1.0 - place.t) * at(place.from) + place.t * at(place.to);
  }
  parts_->laplacian.extend<1>(mesh, axis, result);
  return result;
}

void HarmonicSection::weights(const std::function<void(std::size_t, std::span<const double>)>& row) const {
  std::vector<double> all;
  harmonic_weights(parts_->mesh, parts_->laplacian, parts_->controls, all);
  const std::size_t points = parts_->mesh.points.size();
  for (std::size_t i = 0; i < parts_->controls; ++i) {
    row(i, std::span(all).subspan(i * points, points));
  }
}

}  // namespace anthesis
