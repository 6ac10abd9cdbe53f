#include "section_laplacian.h"

#include <algorithm>
#include <numeric>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"
#include "anthesis/geometry/predicates.h"

namespace anthesis {
namespace {

/// An edge is flipped when its weight is below this; above, up to 0, four points are taken to lie on a circle.
constexpr double kFlipBelow = -1e-9;

/// With each flip the mesh comes nearer to Delaunay, so that this many for an edge are never met.
constexpr std::size_t kMostFlips = 1000;

/// The order of elimination is given up when L has become so much larger than it was when the order was found.
constexpr double kMostGrowth = 1.25;

std::size_t corner_opposite(const MeshEdges& edges, std::uint32_t triangle, std::uint32_t e) {
  const auto& of = edges.of_triangle[triangle];
  return static_cast<std::size_t>(std::find(of.begin(), of.end(), e) - of.begin());
}

double cotangent(Vec2 top, Vec2 a, Vec2 b) {
  return dot(a - top, b - top) / cross(a - top, b - top);
}

}  // namespace

void MeshEdges::assign(std::span<const Triangle> triangles) {
  sides_.clear();
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      const std::uint64_t p = triangles[t][(corner + 1) % 3];
      const std::uint64_t q = triangles[t][(corner + 2) % 3];
      sides_.push_back({std::min(p, q) << 32 | std::max(p, q), t, corner});
    }
  }
  std::sort(sides_.begin(), sides_.end(),
            [](const Side& x, const Side& y) { return x.key != y.key ? x.key < y.key : x.triangle < y.triangle; });
  edges.clear();
  of_triangle.resize(triangles.size());
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Side& side = sides_[i];
    if (i == 0 || sides_[i - 1].key != side.key) {
      edges.push_back({static_cast<std::uint32_t>(side.key >> 32), static_cast<std::uint32_t>(side.key & 0xffffffffU),
                       side.triangle, kNoTriangle});
    } else {
      edges.back().other = side.triangle;
    }
    of_triangle[side.triangle][side.corner] = static_cast<std::uint32_t>(edges.size() - 1);
  }
}

void MeshEdges::flip(std::uint32_t e, std::vector<Triangle>& triangles) {
  MeshEdge& edge = edges[e];
  const std::uint32_t one = edge.triangle;
  const std::uint32_t two = edge.other;
  const std::size_t top = corner_opposite(*this, one, e);
  const std::size_t bottom = corner_opposite(*this, two, e);
  const std::uint32_t c = triangles[one][top];
  const std::uint32_t a = triangles[one][(top + 1) % 3];
  const std::uint32_t b = triangles[one][(top + 2) % 3];
  const std::uint32_t d = triangles[two][bottom];
  const std::uint32_t bc = of_triangle[one][(top + 1) % 3];
  const std::uint32_t ca = of_triangle[one][(top + 2) % 3];
  const std::uint32_t ad = of_triangle[two][(bottom + 1) % 3];  // two is (d, b, a)
  const std::uint32_t db = of_triangle[two][(bottom + 2) % 3];
  triangles[one] = {c, a, d};
  triangles[two] = {c, d, b};
  of_triangle[one] = {ad, e, ca};
  of_triangle[two] = {db, bc, e};
  const auto hand_over = [&](std::uint32_t side, std::uint32_t from, std::uint32_t to) {
    (edges[side].triangle == from ? edges[side].triangle : edges[side].other) = to;
  };
  hand_over(ad, two, one);
  hand_over(bc, one, two);
  edge.a = std::min(c, d);
  edge.b = std::max(c, d);
}

void LaplaceFactor::assign(const MeshEdges& edges, std::size_t points, std::size_t first_free) {
  first_free_ = first_free;
  size_ = points - first_free;
  order(edges);
}

/// Approximate minimum degree, of the points as they are numbered.
void LaplaceFactor::order(const MeshEdges& edges) {
  place_.resize(size_);
  std::iota(place_.begin(), place_.end(), 0);
  arrange(edges);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> sequence;
  Eigen::AMDOrdering<int>()(matrix_.selfadjointView<Eigen::Upper>(), sequence);
  for (std::size_t i = 0; i < size_; ++i) {
    place_[static_cast<std::size_t>(sequence.indices()[static_cast<Eigen::Index>(i)])] = static_cast<int>(i);
  }
  arrange(edges);
  ordered_entries_ = 0;
}

void LaplaceFactor::arrange(const MeshEdges& edges) {
  inner_.clear();
  beside_.clear();
  std::vector<Eigen::Triplet<double, int>> entries;
  for (std::size_t i = 0; i < size_; ++i) {
    entries.emplace_back(place_[i], place_[i], -1.0);
  }
  for (std::uint32_t e = 0; e < edges.edges.size(); ++e) {
    const MeshEdge& edge = edges.edges[e];  // a < b
    if (edge.a >= first_free_) {
      const auto [row, column] = std::minmax(place_[edge.a - first_free_], place_[edge.b - first_free_]);
      entries.emplace_back(row, column, static_cast<double>(inner_.size()));
      inner_.push_back(e);
    } else if (edge.b >= first_free_) {
      beside_.push_back(e);
    }
  }
  matrix_.resize(static_cast<Eigen::Index>(size_), static_cast<Eigen::Index>(size_));
  matrix_.setFromTriplets(entries.begin(), entries.end());
  // For now the numbers tell which edge stands where.
  slots_.resize(inner_.size());
  for (int slot = 0; slot < matrix_.nonZeros(); ++slot) {
    if (const double edge = matrix_.valuePtr()[slot]; edge >= 0.0) {
      slots_[static_cast<std::size_t>(edge)] = slot;
    }
  }
  is_analysed_ = false;
}

void LaplaceFactor::fill(const MeshEdges& edges, std::span<const double> weights) {
  std::vector<double> diagonal(size_, 0.0);
  double* values = matrix_.valuePtr();
  for (std::size_t k = 0; k < inner_.size(); ++k) {
    const MeshEdge& edge = edges.edges[inner_[k]];
    const double weight = weights[inner_[k]];
    values[slots_[k]] = -weight;
    diagonal[edge.a - first_free_] += weight;
    diagonal[edge.b - first_free_] += weight;
  }
  for (const std::uint32_t e : beside_) {
    diagonal[edges.edges[e].b - first_free_] += weights[e];
  }
  for (std::size_t i = 0; i < size_; ++i) {
    values[matrix_.outerIndexPtr()[place_[i] + 1] - 1] = diagonal[i];  // the last of its column
  }
}

void LaplaceFactor::factorise(const MeshEdges& edges, std::span<const double> weights) {
  if (size_ == 0) {
    return;
  }
  for (;;) {
    fill(edges, weights);
    if (factor_.use_count() != 1) {
      factor_ = std::make_shared<Factor>();
      is_analysed_ = false;
    }
    if (!is_analysed_) {
      factor_->analyzePattern(matrix_);
      is_analysed_ = true;
    }
    factor_->factorize(matrix_);
    ANTHESIS_ASSERT(factor_->info() == Eigen::Success);
    if (ordered_entries_ == 0) {
      ordered_entries_ = entries();
    }
    if (static_cast<double>(entries()) <= kMostGrowth * static_cast<double>(ordered_entries_)) {
      return;
    }
    order(edges);
  }
}

template <std::size_t kWidth>
void LaplaceFactor::extend(const MeshEdges& edges, std::span<const double> weights, std::span<double> values) const {
  if (size_ == 0) {
    return;
  }
  using Block = Eigen::Matrix<double, Eigen::Dynamic, static_cast<int>(kWidth)>;
  Block block = Block::Zero(static_cast<Eigen::Index>(size_), kWidth);
  for (const std::uint32_t e : beside_) {
    const MeshEdge& edge = edges.edges[e];
    for (std::size_t k = 0; k < kWidth; ++k) {
      block(place_[edge.b - first_free_], k) += weights[e] * values[edge.a * kWidth + k];
    }
  }
  const Block solution = factor_->solve(block);
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t k = 0; k < kWidth; ++k) {
      values[(first_free_ + i) * kWidth + k] = solution(place_[i], k);
    }
  }
}

template void LaplaceFactor::extend<1>(const MeshEdges&, std::span<const double>, std::span<double>) const;
template void LaplaceFactor::extend<2>(const MeshEdges&, std::span<const double>, std::span<double>) const;
template void LaplaceFactor::extend<kFieldBlock>(const MeshEdges&, std::span<const double>, std::span<double>) const;

void SectionLaplacian::reset(const SectionMesh& mesh) {
  edges_.assign(mesh.triangles);
  has_natural_ = false;
  has_zero_ = false;
}

void SectionLaplacian::weigh(const SectionMesh& mesh) {
  weights_.assign(edges_.edges.size(), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    const Vec2 a = mesh.points[triangle[0]];
    const Vec2 b = mesh.points[triangle[1]];
    const Vec2 c = mesh.points[triangle[2]];
    const double half = 0.5 / cross(b - a, c - a);
    const auto& edges = edges_.of_triangle[t];
    weights_[edges[0]] += half * dot(b - a, c - a);
    weights_[edges[1]] += half * dot(c - b, a - b);
    weights_[edges[2]] += half * dot(a - c, b - c);
  }
}

/// What `weigh` finds, for one edge.
double SectionLaplacian::cotangents(const SectionMesh& mesh, std::uint32_t e) const {
  double sum = 0.0;
  for (const std::uint32_t t : {edges_.edges[e].triangle, edges_.edges[e].other}) {
    if (t != kNoTriangle) {
      const std::size_t top = corner_opposite(edges_, t, e);
      const Triangle& triangle = mesh.triangles[t];
      sum += 0.5 * cotangent(mesh.points[triangle[top]], mesh.points[triangle[(top + 1) % 3]],
                             mesh.points[triangle[(top + 2) % 3]]);
    }
  }
  return sum;
}

/// True if anything was flipped.
bool SectionLaplacian::flip_to_delaunay(SectionMesh& mesh) {
  suspects_.clear();
  for (std::uint32_t e = 0; e < weights_.size(); ++e) {
    if (weights_[e] < kFlipBelow && edges_.edges[e].other != kNoTriangle) {
      suspects_.push_back(e);
    }
  }
  std::size_t flips = 0;
  while (!suspects_.empty() && flips < kMostFlips * weights_.size()) {
    const std::uint32_t e = suspects_.back();
    suspects_.pop_back();
    if (weights_[e] >= kFlipBelow || edges_.edges[e].other == kNoTriangle) {
      continue;  // mended by another flip, or at the boundary
    }
    const std::uint32_t one = edges_.edges[e].triangle;
    const std::uint32_t two = edges_.edges[e].other;
    const std::size_t top = corner_opposite(edges_, one, e);
    const Vec2 c = mesh.points[mesh.triangles[one][top]];
    const Vec2 a = mesh.points[mesh.triangles[one][(top + 1) % 3]];
    const Vec2 b = mesh.points[mesh.triangles[one][(top + 2) % 3]];
    const Vec2 d = mesh.points[mesh.triangles[two][corner_opposite(edges_, two, e)]];
    if (orient2d(c, a, d) <= 0 || orient2d(c, d, b) <= 0) {
      continue;
    }
    edges_.flip(e, mesh.triangles);
    ++flips;
    for (const std::uint32_t t : {one, two}) {
      for (const std::uint32_t side : edges_.of_triangle[t]) {
        weights_[side] = cotangents(mesh, side);
        if (side != e) {
          suspects_.push_back(side);
        }
      }
    }
  }
  return flips > 0;
}

void SectionLaplacian::refresh(SectionMesh& mesh, bool with_zero_axis) {
  weigh(mesh);
  const bool is_flipped = flip_to_delaunay(mesh);
  const std::size_t given = mesh.contour_points();
  axis_is_sound_ = true;
  for (std::size_t e = 0; e < weights_.size(); ++e) {
    if (weights_[e] < 0.0) {
      const MeshEdge& edge = edges_.edges[e];
      // An edge between two given points never enters. One beside the axis can only lie on it.
      axis_is_sound_ = axis_is_sound_ && (edge.other != kNoTriangle || (edge.a < given && edge.b < given));
      weights_[e] = 0.0;  // otherwise by rounding
    }
  }
  const auto renew = [&](LaplaceFactor& factor, bool& is_there, std::size_t first_free) {
    if (!is_there) {
      factor.assign(edges_, mesh.points.size(), first_free);
      is_there = true;
    } else if (is_flipped) {
      factor.arrange(edges_);
    }
    factor.factorise(edges_, weights_);
  };
  renew(natural_, has_natural_, given);
  if (with_zero_axis) {
    renew(zero_, has_zero_, given + mesh.axis_points);
  }
}

template <std::size_t kWidth>
void SectionLaplacian::extend([[maybe_unused]] const SectionMesh& mesh, AxisCondition axis,
                              std::span<double> values) const {
  ANTHESIS_ASSERT(values.size() == mesh.points.size() * kWidth);
  (axis == AxisCondition::kNatural ? natural_ : zero_).extend<kWidth>(edges_, weights_, values);
}

template void SectionLaplacian::extend<1>(const SectionMesh&, AxisCondition, std::span<double>) const;
template void SectionLaplacian::extend<2>(const SectionMesh&, AxisCondition, std::span<double>) const;
template void SectionLaplacian::extend<kFieldBlock>(const SectionMesh&, AxisCondition, std::span<double>) const;

void harmonic_weight_block(const SectionMesh& mesh, const SectionLaplacian& laplacian, std::size_t controls,
                           std::size_t block, std::span<double> weights) {
  const std::size_t points = mesh.points.size();
  const std::size_t first = block * kFieldBlock;
  std::vector<double> values(points * kFieldBlock, 0.0);
  for (std::size_t i = 0; i < mesh.contour_points(); ++i) {
    const SectionPlace& place = mesh.places[i];
    if (place.from - first < kFieldBlock) {
      values[i * kFieldBlock + place.from - first] += 1.0 - place.t;
    }
    if (place.t > 0.0 && place.to - first < kFieldBlock) {
      values[i * kFieldBlock + place.to - first] += place.t;
    }
  }
  laplacian.extend<kFieldBlock>(mesh, AxisCondition::kNatural, values);
  for (std::size_t k = 0; k < kFieldBlock && first + k < controls; ++k) {
    double* row = &weights[(first + k) * points];
    for (std::size_t v = 0; v < points; ++v) {
      row[v] = std::min(values[v * kFieldBlock + k], 1.0);  // by rounding only; below 0 nothing can come
    }
  }
}

void harmonic_weights(const SectionMesh& mesh, const SectionLaplacian& laplacian, std::size_t controls,
                      std::vector<double>& weights) {
  weights.assign(controls * mesh.points.size(), 0.0);
  parallel_for((controls + kFieldBlock - 1) / kFieldBlock,
               [&](std::size_t block) { harmonic_weight_block(mesh, laplacian, controls, block, weights); });
}

}  // namespace anthesis
