#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/exchange/vlab_contour.h"
#include "anthesis/geometry/vec.h"

namespace anthesis {

// Files of the flower-head models of O24: primordia, the sequence of contours, its knots in time, cages. Limits and
// errors as in vlab_contour.h.

/// A primordium at one moment of the model of phyllotaxis.
struct VlabPrimordium {
  std::uint32_t id = 0;      ///< from 0 in the order of insertion
  std::uint32_t step = 0;    ///< of the model, from 1
  double s = 0.0;            ///< on the profile of that step: 0 apex, 1 base
  double azimuth_rad = 0.0;  ///< in [0, 2 pi]; x = r cos, z = r sin, y up
  double radius = 0.0;       ///< from the centre to the outline; 0 if the file has no such column
  int type = 0;              ///< Bellis, sunflower: 0 floret, 1 bract; gerbera: 0 bract, 1 trans floret, 2 disc floret
};

/// A `.prims` file: at insertion, when they became stable, or all at the last step.
struct VlabPrimordia {
  bool with_radius = false;               ///< whether the file has the column (those of Bellis do)
  std::vector<VlabPrimordium> primordia;  ///< in the order of the file, which need not be that of ids
};

/// The first line states the number of rows, or 0 where the program was stopped early; rows count. Ids are unique.
Expected<VlabPrimordia> read_vlab_primordia(std::string_view text, std::string_view file_name);

/// Six digits, byte for byte what VLab's models write. Precondition: at most 99,999 finite primordia.
std::string write_vlab_primordia(const VlabPrimordia& primordia);

struct VlabSequencePoint {
  double radius = 0.0;
  double height = 0.0;
  double s = 0.0;  ///< share of the arc length, 0 apex, 1 rim
};

/// A `.cntrs` file: the half section of a growing head, sampled frame by frame. Frames do not lie equally in time: the
/// model's progress grows by 0.0032 output_dalpha(progress) from one to the next.
struct VlabContourSequence {
  std::vector<bool> landmarks;            ///< one for each point of a frame: a landmark of the tissue, or a filler
  std::vector<VlabSequencePoint> points;  ///< frame after frame, apex to rim; early frames repeat points at the rim
  std::vector<Vec2> ring;                 ///< (radius, height) of the generative front, one for each frame

  std::size_t points_per_frame() const { return landmarks.size(); }
  std::size_t frames() const { return ring.size(); }
  std::span<const VlabSequencePoint> frame(std::size_t i) const {
    return std::span(points).subspan(i * points_per_frame(), points_per_frame());
  }
};

/// At most 1,000,000 frames and 100,000 points a frame. 5 MB take about 0.1 s.
Expected<VlabContourSequence> read_vlab_contour_sequence(std::string_view text, std::string_view file_name);

/// Six digits, byte for byte what VLab's models write. Precondition: points are frames times points_per_frame.
std::string write_vlab_contour_sequence(const VlabContourSequence& sequence);

/// `knotPositions.dat`: knots, ascending within [0, 1], of the quadratic B-spline in time that blends the stages of a
/// head: three more than stages.
Expected<std::vector<double>> read_vlab_knots(std::string_view text, std::string_view file_name);

/// One frame of a `.raw` file: a triangulated half section within its cage.
struct VlabCage {
  std::vector<std::array<float, 2>> vertices;           ///< (radius, height)
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of vertices
  std::vector<std::array<float, 2>> controls;  ///< of the cage: the contour, apex to rim, then 20 points of the base
  std::vector<float> weights;                  ///< of control c at vertex v: weights[c * vertices.size() + v]
};

inline constexpr std::size_t kVlabRawLimit = std::size_t{1} << 30;  ///< bytes

/// Errors name frame and byte: "bellis.raw:byte 1204: frame 3: triangles must ...". Numbers must be finite.
Expected<std::vector<VlabCage>> read_vlab_cages(std::string_view bytes, std::string_view file_name);

/// Precondition: sizes and indices as read_vlab_cages gives them.
std::string write_vlab_cages(std::span<const VlabCage> cages);

/// What a growing head is made of, in the form that models of its growth need.
struct VlabStages {
  std::vector<VlabContour> contours;           ///< stages of the profile, youngest first, apex to base
  std::vector<std::vector<double>> landmarks;  ///< for each stage, s of the landmarks of the tissue, base inwards
  std::vector<double> ring;                    ///< for each stage, s of the active ring
  std::vector<double> knots;                   ///< in time, three more than stages

  /// Weights of the stages at a time in [0, 1]: quadratic B-spline, sum 1. Profile, landmarks and ring blend by them.
  std::vector<double> weights(double time) const;
};

/// Puts together the stages of `contours_markers.cset`. Contours without markers that stand after the last stage are
/// decoration and left out. Without knots (empty) the stages lie equally in time.
/// Errors (`where` begins with the contour's name): a stage without markers, landmarks that do not descend, fewer than
/// three stages, knots that are not three more than stages.
Expected<VlabStages> vlab_stages(std::vector<VlabContour> contours, std::vector<double> knots);

}  // namespace anthesis
