#include "anthesis/corolla/pose.h"

#include <algorithm>

#include "anthesis/base/assert.h"
#include "anthesis/geometry/frames.h"

namespace anthesis {

IntrinsicPolyline to_intrinsic(std::span<const Vec3> points_mm) {
  ANTHESIS_ASSERT(points_mm.size() >= 2);
  const std::vector<Quaternion> frames = rotation_minimising_frames(points_mm, {0.0, 1.0, 0.0});
  IntrinsicPolyline polyline;
  polyline.base_mm = points_mm[0];
  polyline.heading = frames[0];
  for (std::size_t i = 0; i < frames.size(); ++i) {
    polyline.lengths_mm.push_back(length(points_mm[i + 1] - points_mm[i]));
    if (i > 0) {
      polyline.turns.push_back(conjugate(frames[i - 1]) * frames[i]);
    }
  }
  return polyline;
}

void from_intrinsic(const IntrinsicPolyline& polyline, std::span<Vec3> points_mm) {
  Quaternion frame = polyline.heading;
  points_mm[0] = polyline.base_mm;
  for (std::size_t i = 0; i < polyline.lengths_mm.size(); ++i) {
    if (i > 0) {
      frame = normalized(frame * polyline.turns[i - 1]);
    }
    points_mm[i + 1] = points_mm[i] + polyline.lengths_mm[i] * rotate(frame, {1.0, 0.0, 0.0});
  }
}

IntrinsicPolyline blend(const IntrinsicPolyline& a, const IntrinsicPolyline& b, double share) {
  ANTHESIS_ASSERT(a.lengths_mm.size() == b.lengths_mm.size());
  IntrinsicPolyline result;
  result.base_mm = lerp(a.base_mm, b.base_mm, share);
  result.heading = slerp(a.heading, b.heading, share);
  for (std::size_t i = 0; i < a.lengths_mm.size(); ++i) {
    result.lengths_mm.push_back(lerp(a.lengths_mm[i], b.lengths_mm[i], share));
  }
  for (std::size_t i = 0; i < a.turns.size(); ++i) {
    result.turns.push_back(slerp(a.turns[i], b.turns[i], share));
  }
  return result;
}

PoseBlend::PoseBlend(std::vector<double> stages, std::vector<ControlMesh> meshes)
    : stages_(std::move(stages)), meshes_(std::move(meshes)) {
  ANTHESIS_ASSERT(!meshes_.empty() && stages_.size() == meshes_.size());
  std::vector<Vec3> line(along());
  for (const ControlMesh& mesh : meshes_) {
    std::vector<IntrinsicPolyline>& columns = columns_.emplace_back();
    for (int i = 0; i < across(); ++i) {
      for (int j = 0; j < along(); ++j) {
        line[j] = mesh.at(j, i);
      }
      columns.push_back(to_intrinsic(line));
      pointed_ = pointed_ && mesh.at(along() - 1, i) == mesh.at(along() - 1, 0);
    }
  }
}

ControlMesh PoseBlend::at(double stage) const {
  const auto later = std::upper_bound(stages_.begin(), stages_.end(), stage);
  const std::size_t after = static_cast<std::size_t>(later - stages_.begin());
  if (after == 0) {
    return meshes_.front();
  }
  if (after == stages_.size() || stages_[after - 1] == stage) {
    return meshes_[after - 1];
  }
  const double share = (stage - stages_[after - 1]) / (stages_[after] - stages_[after - 1]);
  ControlMesh mesh = meshes_[after];
  std::vector<Vec3> line(along());
  for (int i = 0; i < across(); ++i) {
    from_intrinsic(blend(columns_[after - 1][i], columns_[after][i], share), line);
    for (int j = 0; j < along(); ++j) {
      mesh.at(j, i) = line[j];
    }
  }
  if (pointed_) {
    const Vec3 tip = mesh.at(along() - 1, across() / 2);
    for (int i = 0; i < across(); ++i) {
      const Vec3 miss = tip - mesh.at(along() - 1, i);
      for (int j = 1; j < along(); ++j) {
        mesh.at(j, i) += (static_cast<double>(j) / (along() - 1)) * miss;
      }
      mesh.at(along() - 1, i) = tip;
    }
  }
  return mesh;
}

}  // namespace anthesis
