#pragma once
#include <Eigen/SparseCholesky>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
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

/// The edges of triangles.
struct MeshEdges {
  std::vector<MeshEdge> edges;
  std::vector<std::array<std::uint32_t, 3>> of_triangle;  ///< [t][i]: the edge opposite corner i

  /// Ascending by their points.
  void assign(std::span<const Triangle> triangles);

  /// Turns edge e, which has two triangles, to the other diagonal of the quadrilateral that they are.
  void flip(std::uint32_t e, std::vector<Triangle>& triangles);

 private:
  struct Side {
    std::uint64_t key;
    std::uint32_t triangle;
    std::uint32_t corner;
  };
  std::vector<Side> sides_;
};

/// The cotangent Laplacian of the points of a mesh that are not given, factorised: L D L^T. Copies share the factor;
/// whoever factorises next makes their own.
class LaplaceFactor {
 public:
  /// A new mesh, and a new order of elimination. Points below `first_free` are given.
  void assign(const MeshEdges& edges, std::size_t points, std::size_t first_free);

  /// Takes the edges after flips, in the order of elimination that there is.
  void arrange(const MeshEdges& edges);

  /// Finds a new order if the factor has become a quarter larger than it was when the order was found.
  void factorise(const MeshEdges& edges, std::span<const double> weights);

  Eigen::Index entries() const { return factor_->matrixL().nestedExpression().nonZeros(); }  ///< of L, below its ones

  /// values[i * kWidth + k] for each point of the mesh: those given are read, those free written. A column's bits do
  /// not depend on kWidth.
  template <std::size_t kWidth>
  void extend(const MeshEdges& edges, std::span<const double> weights, std::span<double> values) const;

 private:
  /// The upper triangle is what the factorisation reads: the lower one it would copy each time. The matrix is already
  /// in order, so that it has none to find.
  using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Upper, Eigen::NaturalOrdering<int>>;

  void order(const MeshEdges& edges);
  void fill(const MeshEdges& edges, std::span<const double> weights);

  std::size_t first_free_ = 0;
  std::size_t size_ = 0;
  std::vector<std::uint32_t> inner_;   ///< edges between two free points
  std::vector<std::uint32_t> beside_;  ///< edges between a given point and a free one
  std::vector<int> place_;             ///< in the order of elimination, of each free point
  std::vector<int> slots_;             ///< of each inner edge, among the numbers of the matrix
  Eigen::SparseMatrix<double> matrix_;
  std::shared_ptr<Factor> factor_;
  bool is_analysed_ = false;
  Eigen::Index ordered_entries_ = 0;  ///< of L when the order was found, 0 before
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
  double cotangents(const SectionMesh& mesh, std::uint32_t e) const;
  bool flip_to_delaunay(SectionMesh& mesh);
  void weigh(const SectionMesh& mesh);

  MeshEdges edges_;
  std::vector<double> weights_;
  std::vector<std::uint32_t> suspects_;  ///< edges that may have to be flipped
  LaplaceFactor natural_;
  LaplaceFactor zero_;
  bool has_natural_ = false;
  bool has_zero_ = false;
  bool axis_is_sound_ = true;
};

/// Fields are solved so many at once: the factor is read once for all of them.
inline constexpr std::size_t kFieldBlock = 8;

/// The harmonic coordinates of control points from block * kFieldBlock on, as many as a block has: written to their
/// place in weights[c * points + v], which must be 0. In [0, 1].
void harmonic_weight_block(const SectionMesh& mesh, const SectionLaplacian& laplacian, std::size_t controls,
                           std::size_t block, std::span<double> weights);

/// All harmonic coordinates: weights[c * points + v], in [0, 1]. Parallel over blocks of control points.
void harmonic_weights(const SectionMesh& mesh, const SectionLaplacian& laplacian, std::size_t controls,
                      std::vector<double>& weights);

}  // namespace anthesis
