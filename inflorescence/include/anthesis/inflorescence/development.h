#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "anthesis/base/error.h"
#include "anthesis/base/progress.h"
#include "anthesis/corolla/organ_template.h"
#include "anthesis/geometry/surface_of_revolution.h"
#include "anthesis/inflorescence/species.h"
#include "anthesis/phyllotaxis/collision_model.h"
#include "anthesis/phyllotaxis/parastichies.h"

namespace anthesis {

/// 1-based, in order of birth; 0 is none. Ids are those of the pattern: the same organ in every output.
struct OrganId {
  std::uint32_t value = 0;
  friend constexpr auto operator<=>(OrganId, OrganId) = default;
};

/// What an organ is, whatever the time.
struct Organ {
  OrganId id;
  OrganId parent;                    ///< 0: it stands on the head itself
  std::uint32_t kind = 0;            ///< index into Species::organs
  std::uint32_t template_index = 0;  ///< index into Development::templates()
  double birth = 0.0;                ///< developmental time
  double divergence_rad = 0.0;       ///< angle from the organ born before it, as it was used
  double azimuth_rad = 0.0;          ///< about the head's axis, in [0, 2 pi)
  double mature_area_mm2 = 0.0;      ///< of the receptacle
};

/// An organ at a time.
struct OrganState {
  OrganId id;
  Placement world_from_organ;  ///< scale carries the size; millimetres, +z along the head's axis
  Vec3 normal;                 ///< of the receptacle
  double stage = 0.0;          ///< for OrganTemplate::pose
  double s = 0.0;              ///< position on the receptacle, 0 apex to 1 base
  double radius_mm = 0.0;      ///< distance from the head's axis
  double area_mm2 = 0.0;       ///< of the receptacle

  /// Where touching bent the organ: all its vertices in the world, exact in single precision. Empty: the template's
  /// pose at `stage`, placed by `world_from_organ`.
  std::vector<std::array<float, 3>> deformed_mm;
};

/// Surfaces of the plant that are not instances: their triangles and uvs are equal at all times.
struct Body {
  std::string name;  ///< "receptacle", "peduncle"
  std::string pigment;
  Mesh mesh;
};

/// The whole plant at a time.
struct Canopy {
  double time = 0.0;
  std::vector<OrganState> organs;  ///< those born by `time`, by id
  std::vector<Body> bodies;
};

/// A stretch of a head of rule kCollision where its pattern is no phyllotactic one (F92 section 4).
struct HeadWarning {
  std::string head;  ///< "head", "organs.areole.head"
  PatternWarning warning;
};

struct GrowthOptions {
  std::uint64_t seed = 1;
  double detail = 1.0;  ///< scales every polygonization, (0, 8]
};

/// A species grown into an individual: its whole development, as a function of time in [0, 1] (O16 fig. 3).
class Development {
 public:
  /// Errors: check(species), too many organs (100,000), cancelled.
  static Expected<Development> grow(const Species& species, const GrowthOptions& options,
                                    const Progress& progress = {});
  Development(Development&&) noexcept;
  Development& operator=(Development&&) noexcept;
  ~Development();

  const Species& species() const;
  const GrowthOptions& options() const;
  std::span<const Organ> organs() const;  ///< by id: organs()[id.value - 1]
  std::span<const OrganTemplate> templates() const;

  std::span<const HeadWarning> warnings() const;

  /// Any time gives the same plant whatever other times are asked for. O(organs), safe to call from many threads.
  Canopy at(double time) const;

  /// The receptacle of the plant's own head. 0.1 ms.
  SurfaceOfRevolution receptacle(double time) const;

 private:
  struct State;
  explicit Development(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The organs of the plant's own head at a time, in order of birth, for analyse_parastichies(). Organs that organs
/// carry are left out.
std::vector<PatternOrgan> pattern_of(const Development& development, double time);

/// "ray_floret.12": the name of an organ in every file and message.
std::string organ_name(const Development& development, OrganId id);

}  // namespace anthesis
