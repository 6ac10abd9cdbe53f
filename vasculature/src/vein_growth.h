#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "anthesis/base/random.h"
#include "anthesis/vasculature/vasculature.h"
#include "vein_network.h"
#include "vertex_grid.h"

namespace anthesis::veins {

/// One run of the vein model.
class VeinGrowth {
 public:
  VeinGrowth(const VeinParams& params, const HeadGrowth& growth, std::span<const VeinPrimordium> primordia,
             const VeinOptions& options);

  Expected<Vasculature> run();

 private:
  struct Strand {  // what becomes of one primordium
    std::uint32_t surface = kNoVertex;
    std::uint32_t innermost = kNoVertex;
    std::uint32_t start_frame = 0;
  };
  struct Motion {  // straight from a place at a frame to another at the end of the stride
    Vec3 from;
    Vec3 goal;
    std::uint32_t frame = 0;
  };
  struct AttractionPoint {
    Vec3 position;
    Motion motion;
  };
  struct Path {
    std::vector<Vec3> points;
    std::uint32_t found = kNoVertex;
  };
  struct Place {
    Vec2 position;
    Vec2 inward;
  };

  void make_ring();
  Place place_on_outline(std::size_t frame, double s) const;
  void bear(std::size_t p);
  void start_due();
  void grow_initial(std::size_t p);
  NewVertex strand_vertex(std::size_t p, Vec3 position) const;
  void connect(std::size_t p);
  void reticulate_by_resistance(std::size_t p);
  std::uint32_t vertex_at_depth(std::uint32_t surface, double depth) const;
  std::uint32_t oldest_neighbour(std::uint32_t point) const;
  void reticulate_by_neighbour(std::size_t p);
  void reticulate();
  void add_attraction_points();
  void colonise();

  void prepare_joinable();
  double ground() const;
  double score(Vec3 p, std::uint32_t v, double ground, double oldest) const;
  std::uint32_t choose(Vec3 p, const std::vector<char>* excluded);
  std::uint32_t merge_partner(Vec3 p, const std::vector<char>* excluded) const;
  Path find_path(Vec3 p, Vec3 momentum, const VeinJitter& jitter, Rng& rng, const std::vector<char>* excluded);
  Vec3 deviated(Vec3 step, const VeinJitter& jitter, Rng& rng) const;

  bool needs_resistance() const;
  std::uint32_t next_event() const;
  void plan_motion(bool all);
  Vec3 moved(const Motion& motion, std::uint32_t frame) const;
  void advance(VeinNetwork& network, std::uint32_t frame) const;
  void go_to(std::uint32_t frame);
  void settle(VeinNetwork& network, std::uint32_t frame) const;
  Vasculature at(std::uint32_t frame) const;
  double time_of(std::uint32_t frame) const { return static_cast<double>(frame) / last_; }
  const VeinInitial& initial_of(std::size_t p) const {
    return params_.initials[static_cast<std::size_t>(primordia_[p].kind)];
  }

  const VeinParams& params_;
  const HeadGrowth& growth_;
  std::span<const VeinPrimordium> primordia_;
  const VeinOptions& options_;

  std::uint32_t last_;
  std::uint32_t frame_ = 0;
  std::uint32_t first_start_ = 0;         // first frame in which strands start
  std::uint32_t first_colonisation_ = 0;  // first frame with attraction points
  std::vector<std::uint32_t> births_;     // primordia by frame of birth, in their given order within a frame
  std::size_t born_ = 0;
  std::vector<std::size_t> waiting_;                // born, not started, in order of birth
  std::vector<std::size_t> unreticulated_;          // started, in order of start
  std::vector<std::uint32_t> reticulation_points_;  // where second strands of later primordia may end
  std::vector<Strand> strands_;

  VeinNetwork network_;
  std::uint32_t ring_ = 0;
  std::vector<AttractionPoint> attraction_points_;
  std::size_t most_attraction_points_ = 0;
  std::size_t planned_points_ = 0;  // the first so many have a motion

  std::uint32_t stride_end_ = 0;
  std::vector<Motion> motions_;  // of vertices; those made since the last plan have none

  bool joinable_known_ = false;
  std::vector<std::uint32_t> joinable_;  // vertices with a way to the ring, at least one frame old
  VertexGrid joinable_grid_;
};

}  // namespace anthesis::veins
