#pragma once
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "anthesis/inflorescence/species.h"
#include "anthesis/phyllotaxis/active_ring.h"
#include "anthesis/phyllotaxis/collision_model.h"
#include "anthesis/phyllotaxis/meristem_dynamics.h"
#include "anthesis/receptacle/growing_receptacle.h"

namespace anthesis {

/// Organs placed once on the mature receptacle; they keep their places on it while its outline grows.
struct FixedPattern {
  std::vector<KeyProfile> profiles;
  bool bezier = false;  ///< profiles are chains of cubic Bezier curves
  FunctionGraph growth;
  std::vector<Primordium> primordia;
  std::vector<double> t;  ///< place along the profile
  std::vector<PatternWarning> warnings;
};

/// Organs that keep their places in the tissue of a head that grows through digitised sections.
struct RingPattern {
  GrowingReceptacle head;
  std::vector<RingPrimordium> ring;
  std::vector<Primordium> primordia;
  std::vector<PrimordiumKind> kinds;
};

/// The pattern of one head as a function of its own time, whatever the rule that places its organs.
class HeadPattern {
 public:
  static Expected<HeadPattern> make(const Head& head, std::size_t limit, const Progress& progress);

  std::span<const Primordium> primordia() const;
  std::span<const PatternWarning> warnings() const;
  SurfaceOfRevolution surface(double time) const;

  /// By primordium, where landmarks of the tissue decide it; empty where zones do.
  std::span<const PrimordiumKind> kinds() const;

  /// Of the primordia born by `time`, which are the first so many.
  std::vector<PrimordiumPlace> places(double time, const SurfaceOfRevolution& surface) const;

 private:
  explicit HeadPattern(std::variant<MeristemDynamics, FixedPattern, RingPattern> pattern)
      : pattern_(std::move(pattern)) {}
  std::variant<MeristemDynamics, FixedPattern, RingPattern> pattern_;
};

/// An error of grow_active_ring in the words of species files: `where` begins with the table's name.
Error error_of_ring(Error error, std::string_view table);

}  // namespace anthesis
