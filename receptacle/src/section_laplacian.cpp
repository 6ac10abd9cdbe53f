#include "section_laplacian.h"

#include <algorithm>

#include "anthesis/base/assert.h"
#include "anthesis/base/parallel.h"
#include "anthesis/geometry/predicates.h"

namespace anthesis {
namespace {

constexpr std::size_t kNoSlot = std::numeric_limits<std::size_t>::max();

/// An edge is flipped when its weight is below this; above, up to 0, four points are taken to lie on a circle.
constexpr double kFlipBelow = -1e-9;

/// In each of these the mesh comes nearer to Delaunay, so that the bound is never met.
constexpr int kMostPasses = 1000;

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

void LaplaceFactor::analyse(const MeshEdges& edges, std::size_t points, std::size_t first_free) {
  first_free_ = first_free;
  const std::size_t size = points - first_free;
  slot_.assign(edges.edges.size(), kNoSlot);
  diagonal_.resize(size);
  std::vector<int> rows;
  std::vector<int> columns{0};
  std::size_t e = 0;
  for (std::size_t column = 0; column < size; ++column) {
    diagonal_[column] = rows.size();
    rows.push_back(static_cast<int>(column));
    // Edges ascend by their points: those of a column come together, their rows ascending, as the matrix wants them.
    for (; e < edges.edges.size() && edges.edges[e].a <= column + first_free; ++e) {
      if (edges.edges[e].a == column + first_free) {
        slot_[e] = rows.size();
        rows.push_back(static_cast<int>(edges.edges[e].b - first_free));
      }
    }
    columns.push_back(static_cast<int>(rows.size()));
  }
  const std::vector<double> values(rows.size(), 1.0);
  matrix_ = Eigen::Map<const Eigen::SparseMatrix<double>>(static_cast<int>(size), static_cast<int>(size),
                                                          static_cast<int>(rows.size()), columns.data(), rows.data(),
                                                          values.data());
  if (size > 0) {
    factor_.analyzePattern(matrix_);
  }
}

void LaplaceFactor::factorise(const MeshEdges& edges, std::span<const double> weights) {
  if (size() == 0) {
    return;
  }
  double* values = matrix_.valuePtr();
  for (const std::size_t slot : diagonal_) {
    values[slot] = 0.0;
  }
  for (std::size_t e = 0; e < edges.edges.size(); ++e) {
    const MeshEdge& edge = edges.edges[e];
    if (slot_[e] != kNoSlot) {
      values[slot_[e]] = -weights[e];
    }
    if (edge.a >= first_free_) {
      values[diagonal_[edge.a - first_free_]] += weights[e];
    }
    if (edge.b >= first_free_) {
      values[diagonal_[edge.b - first_free_]] += weights[e];
    }
  }
  factor_.factorize(matrix_);
  ANTHESIS_ASSERT(factor_.info() == Eigen::Success);
}

template <std::size_t kWidth>
void LaplaceFactor::solve(std::span<double> block, std::span<double> scratch) const {
  const std::size_t n = size();
  if (n == 0) {
    return;
  }
  // Eigen's own solution takes one right-hand side after the other and reads the factor for each anew.
  const int* order = factor_.permutationP().indices().data();
  const auto& lower = factor_.matrixL().nestedExpression();
  const int* columns = lower.outerIndexPtr();
  const int* rows = lower.innerIndexPtr();
  const double* values = lower.valuePtr();
  const Eigen::VectorXd diagonal = factor_.vectorD();  // a copy
  double* y = scratch.data();
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(&block[i * kWidth], kWidth, y + static_cast<std::size_t>(order[i]) * kWidth);
  }
  for (std::size_t j = 0; j < n; ++j) {
    double known[kWidth];
    std::copy_n(y + j * kWidth, kWidth, known);
    for (int e = columns[j]; e < columns[j + 1]; ++e) {
      double* row = y + static_cast<std::size_t>(rows[e]) * kWidth;
      for (std::size_t k = 0; k < kWidth; ++k) {
        row[k] -= values[e] * known[k];
      }
    }
  }
  for (std::size_t j = n; j-- > 0;) {
    double sum[kWidth];
    for (std::size_t k = 0; k < kWidth; ++k) {
      sum[k] = y[j * kWidth + k] / diagonal[static_cast<Eigen::Index>(j)];
    }
    for (int e = columns[j]; e < columns[j + 1]; ++e) {
      const double* row = y + static_cast<std::size_t>(rows[e]) * kWidth;
      for (std::size_t k = 0; k < kWidth; ++k) {
        sum[k] -= values[e] * row[k];
      }
    }
    std::copy_n(sum, kWidth, y + j * kWidth);
  }
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(y + static_cast<std::size_t>(order[i]) * kWidth, kWidth, &block[i * kWidth]);
  }
}

void SectionLaplacian::reset(const SectionMesh& mesh) {
  edges_.assign(mesh.triangles);
  analysed_natural_ = false;
  analysed_zero_ = false;
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

bool SectionLaplacian::flip(SectionMesh& mesh) {
  bool any = false;
  std::vector<bool> touched;
  for (std::size_t e = 0; e < edges_.edges.size(); ++e) {
    const MeshEdge& edge = edges_.edges[e];
    if (edge.other == kNoTriangle || weights_[e] >= kFlipBelow) {
      continue;
    }
    touched.resize(mesh.triangles.size(), false);
    if (touched[edge.triangle] || touched[edge.other]) {
      continue;  // in the next pass, if still needed
    }
    const auto corner = [&](std::uint32_t t) {
      const auto& edges = edges_.of_triangle[t];
      return static_cast<std::size_t>(std::find(edges.begin(), edges.end(), e) - edges.begin());
    };
    const Triangle one = mesh.triangles[edge.triangle];
    const std::size_t top = corner(edge.triangle);
    const std::uint32_t c = one[top];
    const std::uint32_t a = one[(top + 1) % 3];
    const std::uint32_t b = one[(top + 2) % 3];
    const std::uint32_t d = mesh.triangles[edge.other][corner(edge.other)];
    const auto& p = mesh.points;
    if (orient2d(p[c], p[a], p[d]) <= 0 || orient2d(p[c], p[d], p[b]) <= 0) {
      continue;
    }
    touched[edge.triangle] = true;
    touched[edge.other] = true;
    mesh.triangles[edge.triangle] = {c, a, d};
    mesh.triangles[edge.other] = {c, d, b};
    any = true;
  }
  return any;
}

void SectionLaplacian::refresh(SectionMesh& mesh, bool with_zero_axis) {
  weigh(mesh);
  for (int pass = 0; pass < kMostPasses && flip(mesh); ++pass) {
    reset(mesh);
    weigh(mesh);
  }
  const std::size_t given = mesh.contour_points();
  const std::size_t axis_end = given + mesh.axis_points;
  axis_is_sound_ = true;
  for (std::size_t e = 0; e < weights_.size(); ++e) {
    if (weights_[e] < 0.0) {
      const MeshEdge& edge = edges_.edges[e];
      // An edge between two given points never enters. One beside the axis can only lie on it.
      axis_is_sound_ = axis_is_sound_ && (edge.other != kNoTriangle || (edge.a < given && edge.b < given));
      weights_[e] = 0.0;  // otherwise by rounding
    }
  }
  if (!analysed_natural_) {
    natural_.analyse(edges_, mesh.points.size(), given);
    analysed_natural_ = true;
  }
  natural_.factorise(edges_, weights_);
  if (with_zero_axis) {
    if (!analysed_zero_) {
      zero_.analyse(edges_, mesh.points.size(), axis_end);
      analysed_zero_ = true;
    }
    zero_.factorise(edges_, weights_);
  }
}

template <std::size_t kWidth>
void SectionLaplacian::extend(const SectionMesh& mesh, AxisCondition axis, std::span<double> values) const {
  const std::size_t points = mesh.points.size();
  const std::size_t given = mesh.contour_points();
  const bool natural = axis == AxisCondition::kNatural;
  const std::size_t first_free = natural ? given : given + mesh.axis_points;
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(given * kWidth), values.end(), 0.0);
  for (std::size_t e = 0; e < edges_.edges.size() && edges_.edges[e].a < first_free; ++e) {
    const MeshEdge& edge = edges_.edges[e];  // a < b: only b can be free
    if (edge.b >= first_free) {
      for (std::size_t k = 0; k < kWidth; ++k) {
        values[edge.b * kWidth + k] += weights_[e] * values[edge.a * kWidth + k];
      }
    }
  }
  std::vector<double> scratch((points - first_free) * kWidth);
  (natural ? natural_ : zero_).solve<kWidth>(values.subspan(first_free * kWidth), scratch);
}

template void SectionLaplacian::extend<1>(const SectionMesh&, AxisCondition, std::span<double>) const;
template void SectionLaplacian::extend<2>(const SectionMesh&, AxisCondition, std::span<double>) const;
template void SectionLaplacian::extend<8>(const SectionMesh&, AxisCondition, std::span<double>) const;

void harmonic_weights(const SectionMesh& mesh, const SectionLaplacian& laplacian, std::size_t controls,
                      std::vector<double>& weights) {
  constexpr std::size_t kWidth = 8;  // the factor is read once for so many fields
  const std::size_t points = mesh.points.size();
  weights.assign(controls * points, 0.0);
  parallel_for((controls + kWidth - 1) / kWidth, [&](std::size_t block) {
    const std::size_t first = block * kWidth;
    std::vector<double> values(points * kWidth, 0.0);
    for (std::size_t i = 0; i < mesh.contour_points(); ++i) {
      const SectionPlace& place = mesh.places[i];
      if (place.from - first < kWidth) {
        values[i * kWidth + place.from - first] += 1.0 - place.t;
      }
      if (place.t > 0.0 && place.to - first < kWidth) {
        values[i * kWidth + place.to - first] += place.t;
      }
    }
    laplacian.extend<kWidth>(mesh, AxisCondition::kNatural, values);
    for (std::size_t k = 0; k < kWidth && first + k < controls; ++k) {
      double* row = &weights[(first + k) * points];
      for (std::size_t v = 0; v < points; ++v) {
        row[v] = std::min(values[v * kWidth + k], 1.0);  // by rounding only; below 0 nothing can come
      }
    }
  });
}

}  // namespace anthesis
