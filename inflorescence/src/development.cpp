#include "anthesis/inflorescence/development.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/random.h"
#include "anthesis/fate/cone.h"
#include "head_pattern.h"

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

/// An organ's place on the receptacle that carries it, in the frame of that head.
struct LocalPlace {
  SurfaceFrame frame;
  double s = 0.0;
  double radius_mm = 0.0;
  double area_mm2 = 0.0;
};

std::vector<LocalPlace> local_places(const HeadPattern& pattern, double time, const SurfaceOfRevolution& surface) {
  const std::span<const Primordium> primordia = pattern.primordia();
  const std::vector<PrimordiumPlace> places = pattern.places(time, surface);
  std::vector<LocalPlace> local(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double t = places[i].t;
    local[i] = {surface.frame(t, primordia[i].azimuth_rad), surface.s_from_t(t), surface.radius_mm(t),
                places[i].area_mm2};
  }
  return local;
}

/// The receptacle of a head that an organ carries, as a part of that organ: all organs of the kind share it.
Column receptacle_column(const Head& head) {
  Column column;
  column.name = "receptacle";
  column.pigment = head.receptacle_pigment;
  column.base_mm = head.height_mm;
  column.sides = 16;
  column.rings = 12;
  const std::vector<Vec2>& outline = head.receptacle[0].points;
  column.degree = std::min(3, static_cast<int>(outline.size()) - 1);
  column.poses.push_back({0.0, {outline.rbegin(), outline.rend()}, 0.0});
  return column;
}

/// A head and what arises on it. All organs of a kind that carries organs share one.
struct PatternOfHead {
  HeadPattern pattern;
  std::vector<std::uint32_t> kinds;  ///< by primordium
  std::vector<double> mature_s;      ///< by primordium
};

/// The form of an organ, turned and moved to stand on the receptacle as its species file says.
Placement organ_from_form(const OrganKind& kind) {
  const Vec3 z = normalized(kind.axis);
  const Vec3 x = normalized(kind.outward - dot(kind.outward, z) * z);
  Placement placement;
  if (kind.axis != OrganKind{}.axis || kind.outward != OrganKind{}.outward) {
    placement.rotation = conjugate(rotation_from_axes(x, cross(z, x), z));
  }
  placement.position_mm = -rotate(placement.rotation, kind.contact_point_mm);
  return placement;
}

}  // namespace

struct Development::State {
  Species species;
  GrowthOptions options;
  std::vector<HeadWarning> warnings;
  std::vector<PatternOfHead> heads;         ///< the plant's own first
  std::vector<std::uint32_t> head_of_kind;  ///< index into `heads`; 0: organs of the kind carry none
  std::vector<Organ> organs;
  std::vector<std::uint32_t> rank;  ///< by organ: its number in the pattern of its head
  std::vector<OrganTemplate> templates;
  std::vector<KindFunctions> functions;    ///< by kind
  std::vector<Placement> organ_from_form;  ///< by kind
  std::vector<Deviation> deviations;       ///< by organ
  std::vector<double> mature_size;         ///< by organ: factor by position, times the organ's own
  FunctionGraph peduncle_growth;
  Vec2 mature_base_mm;  ///< rim of the receptacle: (radius, height)

  std::uint32_t kind_named(const std::string& name) const {
    const auto& kinds = species.organs;
    const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const OrganKind& k) { return k.name == name; });
    return static_cast<std::uint32_t>(found - kinds.begin());
  }
  const PatternOfHead& head_of(const Organ& organ) const {
    return heads[organ.parent.value == 0 ? 0 : head_of_kind[organs[organ.parent.value - 1].kind]];
  }
  std::optional<Error> make_heads(const Progress& progress);
  std::vector<std::uint32_t> decide_kinds(const Head& head, const HeadPattern& pattern,
                                          std::span<const LocalPlace> mature) const;
  std::optional<Error> bear_organs();
  std::optional<Error> build_templates(const Progress& progress);
  void draw_deviations();
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
std::span<const HeadWarning> Development::warnings() const {
  return state_->warnings;
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

  if (auto error = state->make_heads(progress)) {
    return unexpected(*error);
  }
  if (auto error = state->bear_organs()) {
    return unexpected(*error);
  }
  if (auto error = state->build_templates(progress)) {
    return unexpected(*error);
  }
  state->draw_deviations();
  return Development(std::move(state));
}

std::optional<Error> Development::State::make_heads(const Progress& progress) {
  const auto add = [&](const Head& head, const std::string& path) -> std::optional<Error> {
    auto pattern = HeadPattern::make(head, kMaxOrgans, progress);
    if (!pattern) {
      Error error = pattern.error();
      error.where = error.where.empty() ? "" : path + "." + error.where;
      return error;
    }
    for (const PatternWarning& warning : pattern->warnings()) {
      warnings.push_back({path, warning});
    }
    const SurfaceOfRevolution mature = pattern->surface(1.0);
    const std::vector<LocalPlace> places = local_places(*pattern, 1.0, mature);
    PatternOfHead made{std::move(*pattern), {}, {}};
    made.kinds = decide_kinds(head, made.pattern, places);
    for (const LocalPlace& place : places) {
      made.mature_s.push_back(place.s);
    }
    if (heads.empty()) {
      mature_base_mm = mature.profile_mm().at(1.0);
    }
    heads.push_back(std::move(made));
    return std::nullopt;
  };
  if (auto error = add(species.head, "head")) {
    return error;
  }
  for (const OrganKind& kind : species.organs) {
    head_of_kind.push_back(kind.head ? static_cast<std::uint32_t>(heads.size()) : 0);
    if (kind.head) {
      if (auto error = add(*kind.head, "organs." + kind.name + ".head")) {
        return error;
      }
    }
  }
  return std::nullopt;
}

std::vector<std::uint32_t> Development::State::decide_kinds(const Head& head, const HeadPattern& pattern,
                                                            std::span<const LocalPlace> mature) const {
  const std::span<const Primordium> primordia = pattern.primordia();
  std::vector<std::uint32_t> kinds(mature.size());
  for (std::size_t i = 0; i < pattern.kinds().size(); ++i) {
    const PrimordiumKind kind = pattern.kinds()[i];
    kinds[i] = kind_named(kind == PrimordiumKind::kBract         ? head.active_ring->bract
                          : kind == PrimordiumKind::kTransFloret ? head.active_ring->trans_floret
                                                                 : head.active_ring->floret);
  }
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    for (const Zone& zone : head.zones) {
      if (primordia[i].s_at_birth >= zone.from && (primordia[i].s_at_birth < zone.to || zone.to == 1.0)) {
        kinds[i] = kind_named(zone.organ);
      }
    }
  }
  if (!head.fate) {
    return kinds;
  }
  std::vector<std::size_t> candidates;
  std::vector<Vec2> plan_mm;  // seen along the axis of the head, whose centre is the origin
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] == kind_named(head.fate->of)) {
      const auto [sine, cosine] = math::sin_cos(primordia[i].azimuth_rad);
      candidates.push_back(i);
      plan_mm.push_back(mature[i].radius_mm * Vec2{cosine, sine});
    }
  }
  const std::vector<double> room = nearest_in_cone_mm(plan_mm, {}, math::radians(head.fate->cone_deg));
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (std::isinf(room[k])) {
      kinds[candidates[k]] = kind_named(head.fate->with_room);
    }
  }
  return kinds;
}

/// All organs, those that organs carry included. An organ's own head lives by the organ's age.
std::optional<Error> Development::State::bear_organs() {
  std::vector<Organ> borne;               // parents before what they carry; `parent` counts in this order
  std::vector<std::uint32_t> borne_rank;  // number in the pattern
  const auto bear = [&](const PatternOfHead& head, const Head& made_from, std::uint32_t parent, double birth) {
    const std::span<const Primordium> primordia = head.pattern.primordia();
    for (std::size_t i = 0; i < head.kinds.size() && birth + primordia[i].birth <= 1.0; ++i) {
      if (borne.size() == kMaxOrgans) {
        return false;
      }
      Organ organ;
      organ.parent = {parent};
      organ.kind = head.kinds[i];
      organ.birth = birth + primordia[i].birth;
      if (i > 0 && made_from.rule == PlacementRule::kActiveRing) {
        organ.divergence_rad = std::remainder(primordia[i].azimuth_rad - primordia[i - 1].azimuth_rad, math::kTurnRad);
      } else if (i > 0) {
        const int turns = primordia[i].index - primordia[i - 1].index;  // 1 unless two fronts take turns
        organ.divergence_rad = turns * math::radians(made_from.divergence_deg);
      }
      organ.azimuth_rad = primordia[i].azimuth_rad;
      organ.mature_area_mm2 = primordia[i].mature_area_mm2;
      borne.push_back(organ);
      borne_rank.push_back(static_cast<std::uint32_t>(i));
    }
    return true;
  };
  bool room = bear(heads[0], species.head, 0, 0.0);
  for (std::uint32_t i = 0; room && i < borne.size(); ++i) {
    if (const std::uint32_t head = head_of_kind[borne[i].kind]; head != 0) {
      room = bear(heads[head], *species.organs[borne[i].kind].head, i + 1, borne[i].birth);
    }
  }
  if (!room) {
    return Error{ErrorCode::kTooLarge, "organs",
                 "must be at most " + std::to_string(kMaxOrgans) + " with all that organs carry, got more"};
  }
  // Ids go by birth.
  std::vector<std::uint32_t> order(borne.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return borne[a].birth < borne[b].birth; });
  std::vector<OrganId> id_of(borne.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    id_of[order[k]] = {static_cast<std::uint32_t>(k + 1)};
  }
  for (const std::uint32_t i : order) {
    Organ organ = borne[i];
    organ.id = id_of[i];
    if (organ.parent.value != 0) {
      organ.parent = id_of[organ.parent.value - 1];
    }
    organs.push_back(organ);
    rank.push_back(borne_rank[i]);
  }
  return std::nullopt;
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
  std::vector<OrganShape> shapes;
  for (const OrganKind& kind : species.organs) {
    shapes.push_back(kind.shape);
    if (kind.head && !kind.head->receptacle_pigment.empty()) {
      shapes.back().columns.push_back(receptacle_column(*kind.head));
    }
  }
  std::vector<std::optional<Expected<OrganTemplate>>> built(jobs.size());
  const bool finished = parallel_for(
      jobs.size(),
      [&](std::size_t i) {
        // Kinds must not share their individuals' numbers; any odd constant keeps the seeds apart.
        const std::uint64_t seed = options.seed + 0x9E3779B97F4A7C15u * (jobs[i].kind + 1u);
        built[i] = OrganTemplate::build(shapes[jobs[i].kind], options.detail, seed, jobs[i].variant);
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

void Development::State::draw_deviations() {
  for (const OrganKind& kind : species.organs) {
    functions.push_back({FunctionGraph(kind.growth), FunctionGraph(kind.opening), FunctionGraph(kind.size),
                         FunctionGraph(kind.pitch_deg)});
    organ_from_form.push_back(anthesis::organ_from_form(kind));
  }
  // Layers are counted among organs of one kind on one head.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::size_t, std::size_t>> layers;  // of how many, seen
  for (const Organ& organ : organs) {
    ++layers[{organ.parent.value, organ.kind}].first;
  }
  for (std::size_t i = 0; i < organs.size(); ++i) {
    const Organ& organ = organs[i];
    const OrganKind& kind = species.organs[organ.kind];
    const OrganVariation& v = kind.variation;
    const std::uint64_t seed = options.seed;
    auto& [count, seen] = layers[{organ.parent.value, organ.kind}];
    const double layer = count > 1 ? static_cast<double>(seen) / static_cast<double>(count - 1) : 0.0;
    ++seen;
    Deviation d;
    d.size = draw(seed, organ.id, RandomPurpose::kSize, v.size);
    d.pitch_rad =
        math::radians(draw(seed, organ.id, RandomPurpose::kPitch, v.pitch_deg) + kind.layering_deg * (1.0 - layer));
    d.yaw_rad = math::radians(draw(seed, organ.id, RandomPurpose::kYaw, v.yaw_deg));
    d.roll_rad = math::radians(draw(seed, organ.id, RandomPurpose::kRoll, v.roll_deg));
    d.stage = draw(seed, organ.id, RandomPurpose::kStage, v.stage);
    deviations.push_back(d);
    double size = d.size * functions[organ.kind].size(head_of(organ).mature_s[rank[i]]);
    if (kind.fits_radius_mm > 0.0) {
      size *= std::sqrt(organ.mature_area_mm2 / math::kPi) / kind.fits_radius_mm;
    }
    mature_size.push_back(size);
  }
}

Canopy Development::at(double time) const {
  const State& state = *state_;
  const SurfaceOfRevolution surface = state.heads[0].pattern.surface(time);
  const std::vector<LocalPlace> places = local_places(state.heads[0].pattern, time, surface);
  // Heads of one kind at one age are equal.
  std::map<std::pair<std::uint32_t, double>, std::vector<LocalPlace>> places_on_organs;
  Canopy canopy;
  canopy.time = time;
  for (std::size_t i = 0; i < state.organs.size() && state.organs[i].birth <= time; ++i) {
    const Organ& organ = state.organs[i];
    const OrganKind& kind = state.species.organs[organ.kind];
    const KindFunctions& functions = state.functions[organ.kind];
    const Deviation& deviation = state.deviations[i];
    const double age = time - organ.birth;
    const LocalPlace* place = nullptr;
    Placement world_from_head;
    if (organ.parent.value == 0) {
      place = &places[state.rank[i]];
    } else {
      const Organ& parent = state.organs[organ.parent.value - 1];
      const std::uint32_t head = state.head_of_kind[parent.kind];
      const HeadPattern& pattern = state.heads[head].pattern;
      // At its birth an organ's own head would find it a rounding too early.
      const double head_time = std::max(time - parent.birth, pattern.primordia()[state.rank[i]].birth);
      auto [found, is_new] = places_on_organs.try_emplace({head, head_time});
      if (is_new) {
        found->second = local_places(pattern, head_time, pattern.surface(head_time));
      }
      place = &found->second[state.rank[i]];
      Placement organ_from_head;
      organ_from_head.position_mm.z = state.species.organs[parent.kind].head->height_mm;
      world_from_head = canopy.organs[organ.parent.value - 1].world_from_organ * organ_from_head;
    }
    const SurfaceFrame& frame = place->frame;
    OrganState organ_state;
    organ_state.id = organ.id;
    organ_state.stage = std::clamp(functions.opening(age) + deviation.stage, 0.0, 1.0);
    organ_state.s = place->s;
    organ_state.radius_mm = place->radius_mm;
    organ_state.area_mm2 = place->area_mm2;
    Placement& placement = organ_state.world_from_organ;
    placement.scale = state.mature_size[i] * functions.growth(age);
    placement.position_mm = frame.position_mm - placement.scale * kind.sink_mm * frame.normal;
    const double pitch = math::radians(functions.pitch_deg(age)) + deviation.pitch_rad;
    placement.rotation = normalized(
        rotation_from_axes(frame.meridian, frame.parallel, frame.normal) * rotation_about({0.0, 1.0, 0.0}, pitch) *
        rotation_about({1.0, 0.0, 0.0}, deviation.yaw_rad) * rotation_about({0.0, 0.0, 1.0}, deviation.roll_rad));
    placement = world_from_head * placement * state.organ_from_form[organ.kind];
    organ_state.normal = rotate(world_from_head.rotation, frame.normal);
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

SurfaceOfRevolution Development::receptacle(double time) const {
  return state_->heads[0].pattern.surface(time);
}

std::vector<PatternOrgan> pattern_of(const Development& development, double time) {
  const SurfaceOfRevolution receptacle = development.receptacle(time);
  std::vector<PatternOrgan> pattern;
  for (const OrganState& state : development.at(time).organs) {
    const Organ& organ = development.organs()[state.id.value - 1];
    if (organ.parent.value == 0) {
      const Vec2 place = receptacle.profile_mm().at(receptacle.t_from_s(state.s));
      pattern.push_back({organ.azimuth_rad, state.s * receptacle.length_mm(), place.x, place.y});
    }
  }
  return pattern;
}

std::string organ_name(const Development& development, OrganId id) {
  const Organ& organ = development.organs()[id.value - 1];
  return development.species().organs[organ.kind].name + "." + std::to_string(id.value);
}

}  // namespace anthesis
