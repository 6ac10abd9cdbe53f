#pragma once
#include <Eigen/SparseCholesky>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "anthesis/receptacle/harmonic_section.h"

namespace anthesis {

inline constexpr std::uint32_t kNoTriangle = std::numeric_limits<std::uint32_t>::max();

struct MeshEdge {
  std::uint32_t a = 0;  ///< < b
  std::uint32_t b = 0;
  std::uint32_t triangle = kNoTriangle;
  std::uint32_t other = kNoTriangle;  ///< none at the boundary
};

/// The edges of triangles, ascending by their points.
struct MeshEdges {
  std::vector<MeshEdge> edges;
  std::vector<std::array<std::uint32_t, 3>> of_triangle;  ///< [t][i]: the edge opposite corner i

  void assign(std::span<const Triangle> triangles);

 private:
  struct Side {
    std::uint64_t key;
    std::uint32_t triangle;
    std::uint32_t corner;
  };
  std::vector<Side> sides_;
};

/// The cotangent Laplacian of the points of a mesh that are not given, factorised.
class LaplaceFactor {
 public:
  /// Points below `first_free` are given.
  void analyse(const MeshEdges& edges, std::size_t points, std::size_t first_free);
  void factorise(const MeshEdges& edges, std::span<const double> weights);

  std::size_t size() const { return static_cast<std::size_t>(matrix_.rows()); }

  /// Solves for kWidth right-hand sides at once, side by side: block[i * kWidth + k]. `scratch` is as long.
  /// Instantiated for 1, 2 and 8. All sums run in one order, whatever kWidth: a column's bits do not depend on it.
  template <std::size_t kWidth>
  void solve(std::span<double> block, std::span<double> scratch) const;

 private:
  std::size_t first_free_ = 0;
  Eigen::SparseMatrix<double> matrix_;  ///< lower half
  std::vector<std::size_t> diagonal_;   ///< where it stands among the values
  std::vector<std::size_t> slot_;       ///< of each edge among the values; the largest number if it has none
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
};

/// A mesh with its Laplacian. Moving the points and calling `refresh` is much cheaper than a new one.
class SectionLaplacian {
 public:
  /// Takes a new mesh.
  void reset(const SectionMesh& mesh);

  /// Takes the mesh's points where they are now. Flips edges of the mesh until it is Delaunay again, then factorises;
  /// for the odd condition on the axis too if asked.
  void refresh(SectionMesh& mesh, bool with_zero_axis);

  /// Least angle condition of the axis: false if an edge on it is seen under more than a right angle, where values
  /// could go beyond those of the boundary.
  bool axis_is_sound() const { return axis_is_sound_; }

  /// Extends kWidth functions given at the points of contour and base: values[i * kWidth + k], one row for each point
  /// of the mesh, the rest is written. With kZero given values on the axis count as they are.
  template <std::size_t kWidth>
  void extend(const SectionMesh& mesh, AxisCondition axis, std::span<double> values) const;

 private:
  bool flip(SectionMesh& mesh);
  void weigh(const SectionMesh& mesh);

  MeshEdges edges_;
  std::vector<double> weights_;
  LaplaceFactor natural_;
  LaplaceFactor zero_;
  bool analysed_natural_ = false;
  bool analysed_zero_ = false;
  bool axis_is_sound_ = true;
};

/// All harmonic coordinates: weights[c * points + v], in [0, 1]. Parallel over blocks of control points.
void harmonic_weights(const SectionMesh& mesh, const SectionLaplacian& laplacian, std::size_t controls,
                      std::vector<double>& weights);

}  // namespace anthesis
