#include "anthesis/inflorescence/development.h"

#include <algorithm>
#include <cmath>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/random.h"
#include "anthesis/fate/cone.h"
#include "anthesis/phyllotaxis/fractionation.h"

namespace anthesis {
namespace {

// No species file may ask for all the memory there is.
constexpr std::size_t kMaxOrgans = 100'000;
constexpr std::size_t kMaxTemplateVertices = 2'000'000;
constexpr int kReceptacleRings = 40;
constexpr int kReceptacleSides = 48;
constexpr int kPeduncleRings = 24;

/// The functions of an organ kind, ready to evaluate.
struct KindFunctions {
  FunctionGraph growth;
  FunctionGraph opening;
  FunctionGraph size;
  FunctionGraph pitch_deg;
};

/// What one organ adds to its kind, whatever the time.
struct Deviation {
  double size = 1.0;
  double pitch_rad = 0.0;  ///< layering included
  double yaw_rad = 0.0;
  double roll_rad = 0.0;
  double stage = 0.0;
};

double draw(std::uint64_t seed, OrganId organ, RandomPurpose purpose, const Range& range) {
  return range[0] == range[1] ? range[0] : Rng(seed, organ.value, purpose).uniform(range[0], range[1]);
}

/// Triangles of a band of rings between rings `a` and `b`, each of `sides` + 1 vertices, facing away from the axis when
/// `a` is nearer the apex.
void add_band(Mesh& mesh, std::uint32_t a, std::uint32_t b, int sides) {
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
    mesh.triangles.push_back({a + i, b + i, b + i + 1});
    mesh.triangles.push_back({a + i, b + i + 1, a + i + 1});
  }
}

int receptacle_sides(double detail) {
  return std::max(8, static_cast<int>(std::lround(kReceptacleSides * detail)));
}

Mesh receptacle_mesh(const SurfaceOfRevolution& surface, double detail) {
  Mesh mesh;
  const int rings = std::max(4, static_cast<int>(std::lround(kReceptacleRings * detail)));
  const int sides = receptacle_sides(detail);
  std::vector<std::uint32_t> first;
  for (int j = 0; j <= rings; ++j) {
    const double t = static_cast<double>(j) / rings;
    first.push_back(static_cast<std::uint32_t>(mesh.positions_mm.size()));
    const bool pole = j == 0 && surface.radius_mm(0.0) == 0.0;
    for (int i = 0; i <= (pole ? 0 : sides); ++i) {
      const SurfaceFrame frame = surface.frame(t, math::kTurnRad * (i % sides) / sides);
      mesh.positions_mm.push_back(frame.position_mm);
      mesh.normals.push_back(frame.normal);
      mesh.uvs.push_back({pole ? 0.5 : static_cast<double>(i) / sides, 1.0 - t});
    }
  }
  for (int j = 0; j < rings; ++j) {
    if (first[j + 1] - first[j] == 1) {
      for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
        mesh.triangles.push_back({first[j], first[j + 1] + i, first[j + 1] + i + 1});
      }
    } else {
      add_band(mesh, first[j], first[j + 1], sides);
    }
  }
  return mesh;
}

/// The stem: an arc that leaves the base of the receptacle straight down and bends towards -x. `base` is the rim of the
/// receptacle now, (radius, height), `mature_base` when it is mature. Its first ring is the receptacle's last, vertex
/// by vertex: the two are one surface.
Mesh peduncle_mesh(const Peduncle& peduncle, double length_mm, const SurfaceOfRevolution& receptacle, Vec2 mature_base,
                   double detail) {
  Mesh mesh;
  const Vec2 base = receptacle.profile_mm().at(1.0);
  const int rings = std::max(4, static_cast<int>(std::lround(kPeduncleRings * detail)));
  const int sides = receptacle_sides(detail);
  const double bend = math::radians(peduncle.bend_deg);
  // A young head is carried by a thin stem; a stem's cross-section is in proportion to the width of what it carries.
  const double foot_mm = peduncle.radius_mm * std::sqrt(base.x / mature_base.x);
  for (int j = 0; j <= rings; ++j) {
    const double share = static_cast<double>(j) / rings;
    const double along = share * share;  // rings stand closer where the stem widens under the head
    const auto [sine, cosine] = math::sin_cos(along * bend);
    const double path = along * length_mm;
    // Integral of the direction (-sin, -cos) along the arc.
    const Vec3 centre = std::abs(bend) < 1e-9
                            ? Vec3{0.0, 0.0, base.y - path}
                            : Vec3{-(1.0 - cosine) * length_mm / bend, 0.0, base.y - sine * length_mm / bend};
    // The head tapers into the stem over one of its radii: a smooth step from the rim's width to the stem's.
    const double taper = std::clamp(1.0 - path / base.x, 0.0, 1.0);
    const double radius = lerp(foot_mm, base.x, taper * taper * (3.0 - 2.0 * taper));
    const Vec3 side{cosine, 0.0, -sine};
    for (int i = 0; i <= sides; ++i) {
      const auto [s, c] = math::sin_cos(math::kTurnRad * (i % sides) / sides);
      const Vec3 out = c * side + Vec3{0.0, s, 0.0};
      mesh.positions_mm.push_back(j == 0 ? receptacle.frame(1.0, math::kTurnRad * (i % sides) / sides).position_mm
                                         : centre + radius * out);
      mesh.normals.push_back(out);
      mesh.uvs.push_back({static_cast<double>(i) / sides, 1.0 - along});
    }
    if (j > 0) {
      add_band(mesh, static_cast<std::uint32_t>((j - 1) * (sides + 1)), static_cast<std::uint32_t>(j * (sides + 1)),
               sides);
    }
  }
  return mesh;
}

}  // namespace

struct Development::State {
  Species species;
  GrowthOptions options;
  std::optional<Fractionation> pattern;
  std::vector<Organ> organs;
  std::vector<OrganTemplate> templates;
  std::vector<KindFunctions> functions;  ///< by kind
  std::vector<Deviation> deviations;     ///< by organ
  std::vector<double> mature_size;       ///< by organ: factor by position, times the organ's own
  FunctionGraph peduncle_growth;
  Vec2 mature_base_mm;  ///< rim of the receptacle: (radius, height)

  std::uint32_t kind_named(const std::string& name) const {
    const auto& kinds = species.organs;
    const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const OrganKind& k) { return k.name == name; });
    return static_cast<std::uint32_t>(found - kinds.begin());
  }
  void decide_kinds(const SurfaceOfRevolution& mature, std::span<const PrimordiumPlace> places);
  std::optional<Error> build_templates(const Progress& progress);
  void draw_deviations(const SurfaceOfRevolution& mature, std::span<const PrimordiumPlace> places);
};

Development::Development(std::unique_ptr<State> state) : state_(std::move(state)) {}
Development::Development(Development&&) noexcept = default;
Development& Development::operator=(Development&&) noexcept = default;
Development::~Development() = default;

const Species& Development::species() const {
  return state_->species;
}
const GrowthOptions& Development::options() const {
  return state_->options;
}
std::span<const Organ> Development::organs() const {
  return state_->organs;
}
std::span<const OrganTemplate> Development::templates() const {
  return state_->templates;
}

Expected<Development> Development::grow(const Species& species, const GrowthOptions& options,
                                        const Progress& progress) {
  if (auto error = check(species)) {
    return unexpected(*error);
  }
  if (!(options.detail > 0.0 && options.detail <= 8.0)) {
    return unexpected(invalid_parameter("detail", "must be in (0, 8]", options.detail));
  }
  auto state = std::make_unique<State>();
  state->species = species;
  state->options = options;
  state->peduncle_growth = FunctionGraph(species.peduncle.growth);

  const Head& head = species.head;
  FractionationParams params;
  for (const ReceptacleProfile& profile : head.receptacle) {
    params.profiles.push_back({profile.time, profile.points});
  }
  params.divergence_rad = math::radians(head.divergence_deg);
  params.interval = head.interval;
  params.meristem_area_mm2 = head.meristem_area_mm2;
  params.meristem_growth = FunctionGraph(head.meristem_growth);
  params.area_mm2 = FunctionGraph(head.area_mm2);
  params.area_growth = FunctionGraph(head.area_growth);
  auto pattern = Fractionation::run(std::move(params), kMaxOrgans, progress);
  if (!pattern) {
    Error error = pattern.error();
    error.where = error.where.empty() ? "" : "head." + error.where;
    return unexpected(error);
  }
  state->pattern = std::move(*pattern);

  const SurfaceOfRevolution mature = state->pattern->surface(1.0);
  const std::vector<PrimordiumPlace> places = state->pattern->places(1.0, mature);
  state->mature_base_mm = mature.profile_mm().at(1.0);
  state->decide_kinds(mature, places);
  if (auto error = state->build_templates(progress)) {
    return unexpected(*error);
  }
  state->draw_deviations(mature, places);
  return Development(std::move(state));
}

void Development::State::decide_kinds(const SurfaceOfRevolution& mature, std::span<const PrimordiumPlace> places) {
  const auto primordia = pattern->primordia();
  for (std::size_t i = 0; i < primordia.size(); ++i) {
    Organ organ;
    organ.id = {static_cast<std::uint32_t>(i + 1)};
    organ.birth = primordia[i].birth;
    organ.divergence_rad = i == 0 ? 0.0 : math::radians(species.head.divergence_deg);
    organ.azimuth_rad = primordia[i].azimuth_rad;
    organ.mature_area_mm2 = primordia[i].mature_area_mm2;
    for (const Zone& zone : species.head.zones) {
      if (primordia[i].s_at_birth >= zone.from && (primordia[i].s_at_birth < zone.to || zone.to == 1.0)) {
        organ.kind = kind_named(zone.organ);
      }
    }
    organs.push_back(organ);
  }
  if (!species.head.fate) {
    return;
  }
  const FateRule& rule = *species.head.fate;
  std::vector<std::size_t> candidates;
  std::vector<Vec2> plan_mm;  // seen along the axis of the head, whose centre is the origin
  for (std::size_t i = 0; i < organs.size(); ++i) {
    if (organs[i].kind == kind_named(rule.of)) {
      const auto [sine, cosine] = math::sin_cos(organs[i].azimuth_rad);
      candidates.push_back(i);
      plan_mm.push_back(mature.radius_mm(places[i].t) * Vec2{cosine, sine});
    }
  }
  const std::vector<double> room = nearest_in_cone_mm(plan_mm, {}, math::radians(rule.cone_deg));
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (std::isinf(room[k])) {
      organs[candidates[k]].kind = kind_named(rule.with_room);
    }
  }
}

std::optional<Error> Development::State::build_templates(const Progress& progress) {
  // Templates are independent of one another: each kind and variant has its own place in the list.
  struct Job {
    std::uint32_t kind;
    std::uint32_t variant;
  };
  std::vector<Job> jobs;
  std::vector<std::uint32_t> first_job(species.organs.size());
  for (std::uint32_t kind = 0; kind < species.organs.size(); ++kind) {
    first_job[kind] = static_cast<std::uint32_t>(jobs.size());
    const int variants = species.organs[kind].variants;
    for (int variant = 0; variant < variants; ++variant) {
      jobs.push_back({kind, static_cast<std::uint32_t>(variants == 1 ? 0 : variant + 1)});
    }
  }
  std::size_t vertices = 0;
  for (const OrganKind& kind : species.organs) {
    vertices += static_cast<std::size_t>(kind.variants) * OrganTemplate::count_vertices(kind.shape, options.detail);
    if (vertices > kMaxTemplateVertices) {
      return Error{ErrorCode::kTooLarge, "organs." + kind.name,
                   "must leave all kinds and variants together at most " + std::to_string(kMaxTemplateVertices) +
                       " vertices, got more: lower the detail, the variants or the numbers of vertices"};
    }
  }
  std::vector<std::optional<Expected<OrganTemplate>>> built(jobs.size());
  const bool finished = parallel_for(
      jobs.size(),
      [&](std::size_t i) {
        // Kinds must not share their individuals' numbers; any odd constant keeps the seeds apart.
        const std::uint64_t seed = options.seed + 0x9E3779B97F4A7C15u * (jobs[i].kind + 1u);
        built[i] = OrganTemplate::build(species.organs[jobs[i].kind].shape, options.detail, seed, jobs[i].variant);
      },
      progress, "templates");
  if (!finished) {
    return Error{ErrorCode::kCancelled, "", "cancelled"};
  }
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (!*built[i]) {
      Error error = built[i]->error();
      error.where = "organs." + species.organs[jobs[i].kind].name;
      return error;
    }
    templates.push_back(std::move(**built[i]));
  }
  for (Organ& organ : organs) {
    const auto variants = static_cast<std::uint32_t>(species.organs[organ.kind].variants);
    const std::uint32_t pick = Rng(options.seed, organ.id.value, RandomPurpose::kVariant).bits() % variants;
    organ.template_index = first_job[organ.kind] + pick;
  }
  return std::nullopt;
}

void Development::State::draw_deviations(const SurfaceOfRevolution& mature, std::span<const PrimordiumPlace> places) {
  for (const OrganKind& kind : species.organs) {
    functions.push_back({FunctionGraph(kind.growth), FunctionGraph(kind.opening), FunctionGraph(kind.size),
                         FunctionGraph(kind.pitch_deg)});
  }
  std::vector<std::size_t> of_kind(species.organs.size());
  for (const Organ& organ : organs) {
    ++of_kind[organ.kind];
  }
  std::vector<std::size_t> seen(species.organs.size());
  for (std::size_t i = 0; i < organs.size(); ++i) {
    const Organ& organ = organs[i];
    const OrganKind& kind = species.organs[organ.kind];
    const OrganVariation& v = kind.variation;
    const std::uint64_t seed = options.seed;
    const double rank = of_kind[organ.kind] > 1
                            ? static_cast<double>(seen[organ.kind]) / static_cast<double>(of_kind[organ.kind] - 1)
                            : 0.0;
    ++seen[organ.kind];
    Deviation d;
    d.size = draw(seed, organ.id, RandomPurpose::kSize, v.size);
    d.pitch_rad =
        math::radians(draw(seed, organ.id, RandomPurpose::kPitch, v.pitch_deg) + kind.layering_deg * (1.0 - rank));
    d.yaw_rad = math::radians(draw(seed, organ.id, RandomPurpose::kYaw, v.yaw_deg));
    d.roll_rad = math::radians(draw(seed, organ.id, RandomPurpose::kRoll, v.roll_deg));
    d.stage = draw(seed, organ.id, RandomPurpose::kStage, v.stage);
    deviations.push_back(d);
    mature_size.push_back(d.size * functions[organ.kind].size(mature.s_from_t(places[i].t)));
  }
}

Canopy Development::at(double time) const {
  const State& state = *state_;
  const SurfaceOfRevolution surface = state.pattern->surface(time);
  const std::vector<PrimordiumPlace> places = state.pattern->places(time, surface);
  Canopy canopy;
  canopy.time = time;
  canopy.organs.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Organ& organ = state.organs[i];
    const OrganKind& kind = state.species.organs[organ.kind];
    const KindFunctions& functions = state.functions[organ.kind];
    const Deviation& deviation = state.deviations[i];
    const double age = time - organ.birth;
    const SurfaceFrame frame = surface.frame(places[i].t, organ.azimuth_rad);
    OrganState organ_state;
    organ_state.id = organ.id;
    organ_state.normal = frame.normal;
    organ_state.stage = std::clamp(functions.opening(age) + deviation.stage, 0.0, 1.0);
    organ_state.s = surface.s_from_t(places[i].t);
    organ_state.radius_mm = surface.radius_mm(places[i].t);
    organ_state.area_mm2 = places[i].area_mm2;
    Placement& placement = organ_state.world_from_organ;
    placement.scale = state.mature_size[i] * functions.growth(age);
    placement.position_mm = frame.position_mm - placement.scale * kind.sink_mm * frame.normal;
    const double pitch = math::radians(functions.pitch_deg(age)) + deviation.pitch_rad;
    placement.rotation = normalized(
        rotation_from_axes(frame.meridian, frame.parallel, frame.normal) * rotation_about({0.0, 1.0, 0.0}, pitch) *
        rotation_about({1.0, 0.0, 0.0}, deviation.yaw_rad) * rotation_about({0.0, 0.0, 1.0}, deviation.roll_rad));
    canopy.organs.push_back(organ_state);
  }
  const Head& head = state.species.head;
  if (!head.receptacle_pigment.empty()) {
    canopy.bodies.push_back({"receptacle", head.receptacle_pigment, receptacle_mesh(surface, state.options.detail)});
  }
  const Peduncle& peduncle = state.species.peduncle;
  if (peduncle.length_mm > 0.0) {
    const double length = peduncle.length_mm * state.peduncle_growth(time);
    canopy.bodies.push_back({"peduncle", peduncle.pigment,
                             peduncle_mesh(peduncle, length, surface, state.mature_base_mm, state.options.detail)});
  }
  return canopy;
}

std::string organ_name(const Development& development, OrganId id) {
  const Organ& organ = development.organs()[id.value - 1];
  return development.species().organs[organ.kind].name + "." + std::to_string(id.value);
}

}  // namespace anthesis
