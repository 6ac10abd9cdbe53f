#include "anthesis/contact/detector.h"

#include <gmock/gmock.h>
#include <hwy/targets.h>

#include <algorithm>
#include <map>
#include <set>

#include "anthesis/base/math.h"
#include "anthesis/base/parallel.h"
#include "anthesis/base/random.h"
#include "anthesis/contact/continuous.h"
#include "sheets.h"

namespace anthesis {
namespace {

/// Bodies in space with all that a detector wants to know.
struct Scene {
  std::vector<Sheet> sheets;
  std::vector<ContactBody> bodies;
  std::vector<Vec3> from_mm;
  std::vector<Vec3> to_mm;
};

Vec3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

/// Where a vertex is before anything moves it.
Vec3 flat_place(std::size_t vertex) {
  return {0.5 * static_cast<double>(vertex % 4), 0.5 * static_cast<double>(vertex / 4), 0.0};
}

/// Patches and loose triangles in a cube, crumpled, turned and moving; a third of them asleep, some deaf to themselves.
/// With odd seeds sheets have a shape of their own, by which a detector groups their triangles.
Scene random_scene(std::uint64_t seed, std::uint32_t body_count, double side_mm) {
  Rng rng(seed, 0, RandomPurpose::kTest);
  Scene scene;
  scene.sheets = {grid_sheet(4, 5), grid_sheet(6, 3), make_sheet(3, std::vector<Triangle>{{0, 1, 2}}),
                  // a fan in which an edge has three triangles, and a vertex that no triangle uses
                  make_sheet(6, std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}), Sheet{}};
  for (Sheet& sheet : scene.sheets) {
    for (std::size_t i = 0; seed % 2 == 1 && i < sheet.vertex_count; ++i) {
      sheet.shape_mm.push_back(flat_place(i));
    }
  }
  for (std::uint32_t b = 0; b < body_count; ++b) {
    ContactBody body;
    body.sheet = rng.bits() % static_cast<std::uint32_t>(scene.sheets.size());
    body.first_vertex = static_cast<std::uint32_t>(scene.from_mm.size());
    body.reach_mm = rng.bits() % 4 == 0 ? 0.0 : rng.uniform(0.0, 0.3);
    body.awake = rng.bits() % 3 != 0;
    body.within = rng.bits() % 3 != 0;
    const Vec3 centre = random_vector(rng, side_mm);
    const Vec3 way = body.awake ? random_vector(rng, 0.4) : Vec3{};
    const Quaternion turn = rotation_about(normalized(random_vector(rng, 1.0)), rng.uniform(0.0, 3.0));
    const std::size_t vertex_count = scene.sheets[body.sheet].vertex_count;
    for (std::size_t i = 0; i < vertex_count; ++i) {
      scene.from_mm.push_back(centre + rotate(turn, flat_place(i) + random_vector(rng, 0.15)));
      scene.to_mm.push_back(scene.from_mm.back() + way + (body.awake ? random_vector(rng, 0.1) : Vec3{}));
    }
    scene.bodies.push_back(body);
  }
  return scene;
}

using Key = std::tuple<bool, std::array<std::uint32_t, 4>>;

/// One name for a pair, however its edges are ordered.
Key key_of(bool edges, std::array<std::uint32_t, 4> v) {
  if (edges) {
    if (v[0] > v[1]) {
      std::swap(v[0], v[1]);
    }
    if (v[2] > v[3]) {
      std::swap(v[2], v[3]);
    }
    if (v[0] > v[2]) {
      v = {v[2], v[3], v[0], v[1]};
    }
  } else {
    std::sort(v.begin() + 1, v.end());
  }
  return {edges, v};
}

/// Calls visit(edges, vertices, first body, second body) for every pair of primitives that the bodies allow.
template <class Visit>
void for_all_pairs(const Scene& scene, const Visit& visit) {
  const auto distinct = [](std::array<std::uint32_t, 4> v) {
    std::sort(v.begin(), v.end());
    return std::adjacent_find(v.begin(), v.end()) == v.end();
  };
  for (std::uint32_t a = 0; a < scene.bodies.size(); ++a) {
    for (std::uint32_t b = 0; b < scene.bodies.size(); ++b) {
      const ContactBody& one = scene.bodies[a];
      const ContactBody& other = scene.bodies[b];
      if (a == b ? !one.awake || !one.within : !one.awake && !other.awake) {
        continue;
      }
      const Sheet& sheet = scene.sheets[one.sheet];
      const Sheet& other_sheet = scene.sheets[other.sheet];
      std::set<std::uint32_t> vertices;
      for (const Triangle& t : sheet.triangles) {
        vertices.insert(t.begin(), t.end());
      }
      for (const std::uint32_t v : vertices) {
        for (const Triangle& t : other_sheet.triangles) {
          const std::array<std::uint32_t, 4> pair = {one.first_vertex + v, other.first_vertex + t[0],
                                                     other.first_vertex + t[1], other.first_vertex + t[2]};
          if (distinct(pair)) {
            visit(false, pair, a, b);
          }
        }
      }
      for (std::size_t e = 0; a <= b && e < sheet.edges.size(); ++e) {
        for (std::size_t f = a == b ? e + 1 : 0; f < other_sheet.edges.size(); ++f) {
          const std::array<std::uint32_t, 4> pair = {
              one.first_vertex + sheet.edges[e][0], one.first_vertex + sheet.edges[e][1],
              other.first_vertex + other_sheet.edges[f][0], other.first_vertex + other_sheet.edges[f][1]};
          if (distinct(pair)) {
            visit(true, pair, a, b);
          }
        }
      }
    }
  }
}

std::array<Vec3, 4> points_of(const std::vector<Vec3>& positions_mm, const std::array<std::uint32_t, 4>& vertices) {
  return {positions_mm[vertices[0]], positions_mm[vertices[1]], positions_mm[vertices[2]], positions_mm[vertices[3]]};
}

/// Distances of all pairs that must be found, and of all others that may be asked about.
struct Expected {
  std::map<Key, double> near;
  std::map<Key, double> limit;
};

Expected near_by_brute_force(const Scene& scene, const std::vector<Vec3>& positions_mm) {
  Expected expected;
  for_all_pairs(scene, [&](bool edges, const std::array<std::uint32_t, 4>& v, std::uint32_t a, std::uint32_t b) {
    const std::array<Vec3, 4> points = points_of(positions_mm, v);
    const double distance = (edges ? nearest_edge_edge(points) : nearest_vertex_triangle(points)).distance;
    const double limit = scene.bodies[a].reach_mm + scene.bodies[b].reach_mm;
    expected.limit[key_of(edges, v)] = limit;
    if (distance <= limit) {
      expected.near[key_of(edges, v)] = distance;
    }
  });
  return expected;
}

/// Returns how many contacts there are.
std::size_t expect_near(const Scene& scene, const std::vector<Vec3>& positions_mm,
                        const std::vector<Contact>& contacts) {
  const Expected expected = near_by_brute_force(scene, positions_mm);
  std::set<Key> found;
  for (const Contact& contact : contacts) {
    const Key key = key_of(contact.edges, contact.vertices);
    EXPECT_TRUE(found.insert(key).second) << "a pair twice";
    const auto limit = expected.limit.find(key);
    if (limit == expected.limit.end()) {
      ADD_FAILURE() << "a pair that nobody asked for";
      continue;
    }
    EXPECT_LE(contact.gap_mm, limit->second + 1e-9);
    Vec3 difference;
    for (int k = 0; k < 4; ++k) {
      difference += contact.weights[k] * positions_mm[contact.vertices[k]];
    }
    EXPECT_NEAR(length(difference - contact.gap_mm * contact.normal), 0.0, 1e-12);
    EXPECT_NEAR(length(contact.normal), 1.0, 1e-12);
    const auto owner = [&](std::uint32_t vertex, std::uint32_t body) {
      const std::uint32_t first = scene.bodies[body].first_vertex;
      return vertex >= first && vertex < first + scene.sheets[scene.bodies[body].sheet].vertex_count;
    };
    EXPECT_TRUE(owner(contact.vertices[0], contact.first_body));
    EXPECT_TRUE(owner(contact.vertices[3], contact.second_body));
  }
  for (const auto& [key, distance] : expected.near) {
    EXPECT_TRUE(found.count(key) == 1) << "missed at distance " << distance;
  }
  return contacts.size();
}

TEST(FindNear, FindsWhatBruteForceFindsAndNothingBeyondReach) {
  std::size_t total = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Scene scene = random_scene(seed, 12, 1.2);
    Detector detector(scene.sheets);
    std::vector<Contact> contacts;
    detector.find_near(scene.from_mm, scene.bodies, contacts);
    total += expect_near(scene, scene.from_mm, contacts);
  }
  EXPECT_GT(total, 3000u);  // the scenes are crowded
}

TEST(FindNear, AnswersAreThoseOfAFreshDetectorWhateverItSawBefore) {
  Scene scene = random_scene(101, 14, 1.2);
  Detector detector(scene.sheets);
  Rng rng(7, 0, RandomPurpose::kTest);
  for (int step = 0; step < 12; ++step) {
    std::vector<Contact> contacts;
    std::vector<Contact> fresh;
    detector.find_near(scene.from_mm, scene.bodies, contacts);
    Detector(scene.sheets).find_near(scene.from_mm, scene.bodies, fresh);
    ASSERT_EQ(contacts.size(), fresh.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts[i].vertices, fresh[i].vertices);
      EXPECT_EQ(contacts[i].gap_mm, fresh[i].gap_mm);
    }
    if (step % 3 == 1) {
      std::vector<CandidatePair> pairs;  // bounds of a motion must not be taken for those of a pose
      detector.find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
    }
    // Some fall asleep or wake up, and who is awake moves; one changes its reach, two their numbers, some leave.
    for (ContactBody& body : scene.bodies) {
      body.awake = rng.bits() % 2 == 0;
      for (std::size_t i = 0; i < scene.sheets[body.sheet].vertex_count; ++i) {
        Vec3& from = scene.from_mm[body.first_vertex + i];
        from += body.awake ? random_vector(rng, 0.1) : Vec3{};
        scene.to_mm[body.first_vertex + i] = from + (body.awake ? random_vector(rng, 0.1) : Vec3{});
      }
    }
    scene.bodies[rng.bits() % scene.bodies.size()].reach_mm = rng.uniform(0.0, 0.3);
    std::swap(scene.bodies[rng.bits() % scene.bodies.size()], scene.bodies.back());
    if (step % 4 == 2) {
      scene.bodies.pop_back();
    }
  }
}

TEST(FindNear, SameAnswersForAnyNumberOfThreads) {
  const Scene scene = random_scene(102, 60, 2.0);
  std::vector<std::vector<Contact>> answers(2);
  std::vector<std::vector<CandidatePair>> candidates(2);
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    Detector detector(scene.sheets);
    detector.find_near(scene.from_mm, scene.bodies, answers[static_cast<std::size_t>(threads - 1)]);
    detector.find_on_course(scene.from_mm, scene.to_mm, scene.bodies,
                            candidates[static_cast<std::size_t>(threads - 1)]);
  }
  ASSERT_EQ(answers[0].size(), answers[1].size());
  EXPECT_GT(answers[0].size(), 1000u);
  for (std::size_t i = 0; i < answers[0].size(); ++i) {
    EXPECT_EQ(answers[0][i].vertices, answers[1][i].vertices);
    EXPECT_EQ(answers[0][i].weights, answers[1][i].weights);
    EXPECT_EQ(answers[0][i].normal, answers[1][i].normal);
  }
  ASSERT_EQ(candidates[0].size(), candidates[1].size());
  for (std::size_t i = 0; i < candidates[0].size(); ++i) {
    EXPECT_EQ(candidates[0][i].vertices, candidates[1][i].vertices);
  }
}

TEST(FindNear, OrderIsThatOfTheBodiesAndTheirSheets) {
  const Scene scene = random_scene(103, 20, 1.2);
  std::vector<Contact> contacts;
  Detector(scene.sheets).find_near(scene.from_mm, scene.bodies, contacts);
  const auto rank = [](const Contact& c) {
    return std::tuple(std::min(c.first_body, c.second_body), std::max(c.first_body, c.second_body), c.edges);
  };
  EXPECT_TRUE(std::is_sorted(contacts.begin(), contacts.end(),
                             [&](const Contact& a, const Contact& b) { return rank(a) < rank(b); }));
  // The hierarchy is another one when it was made from another pose; the order stays.
  std::vector<Vec3> shuffled = scene.from_mm;
  std::reverse(shuffled.begin(), shuffled.end());
  Detector detector(scene.sheets);
  std::vector<ContactBody> awake = scene.bodies;
  for (ContactBody& body : awake) {
    body.awake = true;
  }
  std::vector<Contact> again;
  detector.find_near(shuffled, awake, again);
  for (ContactBody& body : awake) {
    body.reach_mm += 1.0;  // so that nothing is taken over
  }
  detector.find_near(shuffled, awake, again);
  detector.find_near(scene.from_mm, scene.bodies, again);
  ASSERT_EQ(again.size(), contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    EXPECT_EQ(again[i].vertices, contacts[i].vertices);
  }
}

TEST(FindNear, KeepsItsPromiseFarFromTheOriginAndAtAnySize) {
  for (const auto& [seed, scale] :
       {std::pair(104, 1e-6), {104, 1.0}, {104, 1e6}, {107, 1e-6}, {107, 1.0}, {107, 1e6}}) {
    Scene scene = random_scene(static_cast<std::uint64_t>(seed), 12, 1.0);
    for (Vec3& p : scene.from_mm) {
      p = scale * (p + Vec3{1000.0, -2000.0, 500.0});
    }
    for (ContactBody& body : scene.bodies) {
      body.reach_mm *= scale;
    }
    std::vector<Contact> contacts;
    Detector(scene.sheets).find_near(scene.from_mm, scene.bodies, contacts);
    const Expected expected = near_by_brute_force(scene, scene.from_mm);
    std::set<Key> found;
    for (const Contact& contact : contacts) {
      found.insert(key_of(contact.edges, contact.vertices));
    }
    EXPECT_EQ(found.size(), contacts.size());
    EXPECT_GT(expected.near.size(), 50u);
    for (const auto& [key, distance] : expected.near) {
      EXPECT_TRUE(found.count(key) == 1) << "missed at distance " << distance;
    }
    EXPECT_LE(found.size(), expected.near.size() + 2);
  }
}

TEST(FindNear, FindsThoseThatTouchWithoutReachingOut) {
  // Two triangles through each other, and a vertex exactly on a triangle, all with reach 0.
  const std::vector<Sheet> sheets = {make_sheet(3, std::vector<Triangle>{{0, 1, 2}})};
  const std::vector<Vec3> positions_mm = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 1, 5}, {2, 1, 5}};
  const std::vector<ContactBody> bodies = {{0, 0}, {0, 3}};
  std::vector<Contact> contacts;
  Detector(sheets).find_near(positions_mm, bodies, contacts);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].gap_mm, 0.0);
  EXPECT_EQ(contacts[0].first_body, 1u);
  EXPECT_THAT(contacts[0].vertices, testing::ElementsAre(3, 0, 1, 2));
  EXPECT_THAT(contacts[0].weights, testing::ElementsAre(1.0, -0.5, -0.25, -0.25));
  EXPECT_DOUBLE_EQ(std::abs(contacts[0].normal.z), 1.0);
}

TEST(FindNear, SinglePrecisionPartsNothing) {
  // Two triangles, far smaller than a float can tell apart at their place, that share that place.
  const std::vector<Sheet> sheets = {make_sheet(3, std::vector<Triangle>{{0, 1, 2}})};
  Rng rng(8, 0, RandomPurpose::kTest);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 place = random_vector(rng, 100.0);
    std::vector<Vec3> positions_mm;
    for (int i = 0; i < 6; ++i) {
      positions_mm.push_back(place + (i % 3 == 0 ? Vec3{} : random_vector(rng, 1e-9)));
    }
    std::vector<Contact> contacts;
    Detector(sheets).find_near(positions_mm, std::vector<ContactBody>{{0, 0}, {0, 3}}, contacts);
    // Vertex 0 of each lies on the other, and the two sides there of the one touch the two of the other.
    EXPECT_GE(contacts.size(), 6u);
  }
}

TEST(FindNear, EachVertexLooksAsFarAsItIsTold) {
  // A small triangle hangs at 1 above a large one and looks around by 0.5 in all; the corners of the large one differ.
  const std::vector<Sheet> sheets = {make_sheet(3, std::vector<Triangle>{{0, 1, 2}})};
  const std::vector<Vec3> positions_mm = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {1, 1, 1}, {2, 1, 1}, {1, 2, 1}};
  const auto contacts_at = [&](double reach_mm) {
    const std::vector<double> reaches_mm = {reach_mm, 0.0, 0.0};
    ContactBody large{.first_vertex = 0, .vertex_reach_mm = reaches_mm};
    const std::vector<ContactBody> bodies = {large, {.first_vertex = 3, .reach_mm = 0.5}};
    std::vector<Contact> contacts;
    Detector(sheets).find_near(positions_mm, bodies, contacts);
    return contacts.size();
  };
  EXPECT_EQ(contacts_at(0.49), 0u);
  EXPECT_GE(contacts_at(0.51), 3u);  // the small one's corners at least
}

TEST(FindNear, FindsWhatMayComeNearBySharesOfRidesAndWays) {
  std::size_t wanted = 0;
  std::size_t total = 0;
  for (std::uint64_t seed = 400; seed < 420; ++seed) {
    Scene scene = random_scene(seed, 10, 1.5);
    Rng rng(seed, 1, RandomPurpose::kTest);
    std::vector<Vec3> ways(scene.from_mm.size());
    for (ContactBody& body : scene.bodies) {
      if (!body.awake) {
        continue;
      }
      body.ride_mm = rng.bits() % 3 == 0 ? Vec3{} : random_vector(rng, 0.3);
      body.within_less_mm = rng.bits() % 2 == 0 ? 0.0 : 0.6 * body.reach_mm;
      for (std::size_t i = 0; i < scene.sheets[body.sheet].vertex_count; ++i) {
        ways[body.first_vertex + i] = random_vector(rng, 0.25);
      }
      body.vertex_way_mm = std::span(ways).subspan(body.first_vertex, scene.sheets[body.sheet].vertex_count);
    }
    Detector detector(scene.sheets);
    std::vector<Contact> contacts;
    detector.find_near(scene.from_mm, scene.bodies, contacts);
    total += contacts.size();
    std::set<Key> found;
    for (const Contact& contact : contacts) {
      EXPECT_TRUE(found.insert(key_of(contact.edges, contact.vertices)).second) << "a pair twice";
    }
    // Each vertex at the end of its way, or not, or somewhere on it; each body likewise on its ride.
    const auto share = [&] { return std::clamp(rng.uniform(-0.5, 1.5), 0.0, 1.0); };
    for (int sample = 0; sample < 10; ++sample) {
      std::vector<Vec3> places = scene.from_mm;
      for (const ContactBody& body : scene.bodies) {
        const double ridden = share();
        for (std::size_t i = 0; body.awake && i < scene.sheets[body.sheet].vertex_count; ++i) {
          const std::size_t vertex = body.first_vertex + i;
          places[vertex] += ridden * body.ride_mm + share() * ways[vertex];
        }
      }
      for_all_pairs(scene, [&](bool edges, const std::array<std::uint32_t, 4>& v, std::uint32_t a, std::uint32_t b) {
        const std::array<Vec3, 4> points = points_of(places, v);
        const double distance = (edges ? nearest_edge_edge(points) : nearest_vertex_triangle(points)).distance;
        const double less = a == b ? 2.0 * scene.bodies[a].within_less_mm : 0.0;
        if (distance <= scene.bodies[a].reach_mm + scene.bodies[b].reach_mm - less) {
          EXPECT_TRUE(found.count(key_of(edges, v)) == 1) << "missed at distance " << distance;
          ++wanted;
        }
      });
    }
  }
  EXPECT_GT(wanted, 20'000u);
  EXPECT_LT(total, wanted);  // it does not simply find everything
}

TEST(FindNear, FarFromTheOriginNothingJustWithinReachIsLost) {
  // Two triangles, one above the other by hardly less than both reach, where single precision cannot tell.
  Sheet sheet = make_sheet(3, std::vector<Triangle>{{0, 1, 2}});
  sheet.shape_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  Rng rng(8, 0, RandomPurpose::kTest);
  for (int i = 0; i < 300; ++i) {
    const Quaternion turn = rotation_about(normalized(random_vector(rng, 1.0)), rng.uniform(0.0, 3.0));
    const Vec3 centre = random_vector(rng, 1000.0);
    std::vector<Vec3> positions_mm;
    for (const double height : {0.0, 0.1 - 1e-9}) {
      for (const Vec3 p : sheet.shape_mm) {
        positions_mm.push_back(centre + rotate(turn, p + Vec3{0, 0, height}));
      }
    }
    const std::vector<ContactBody> bodies = {{.first_vertex = 0, .reach_mm = 0.05},
                                             {.first_vertex = 3, .reach_mm = 0.05}};
    std::vector<Contact> contacts;
    Detector(std::span(&sheet, 1)).find_near(positions_mm, bodies, contacts);
    EXPECT_GE(contacts.size(), 6u);  // each corner and the triangle opposite
  }
}

TEST(FindNear, WhatSlidesPastSeesNoMoreThanAtRest) {
  // Two triangles a tenth apart that slide along each other by ten times that see each other no more than at rest.
  const std::vector<Sheet> sheets = {make_sheet(3, std::vector<Triangle>{{0, 1, 2}})};
  const std::vector<Vec3> positions_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.1}, {1, 0, 0.1}, {0, 1, 0.1}};
  const auto contacts_by = [&](Vec3 way, double reach_mm) {
    const std::vector<Vec3> ways_mm(3, way);
    const ContactBody slides{.reach_mm = reach_mm, .vertex_way_mm = ways_mm};
    const std::vector<ContactBody> bodies = {slides, {.first_vertex = 3, .reach_mm = reach_mm}};
    std::vector<Contact> contacts;
    Detector(sheets).find_near(positions_mm, bodies, contacts);
    return contacts.size();
  };
  EXPECT_EQ(contacts_by({1, 0, 0}, 0.049), 0u);
  EXPECT_GT(contacts_by({1, 0, 0}, 0.051), 0u);
  EXPECT_GT(contacts_by({1, 0, 0.1}, 0.001), 0u);
  EXPECT_EQ(contacts_by({1, 0, -9}, 0.049), 0u);
}

TEST(FindNear, GivesTheSameBitsForEveryInstructionSet) {
  const Scene scene = random_scene(401, 60, 2.0);
  const auto found = [&] {
    std::vector<Contact> contacts;
    Detector(scene.sheets).find_near(scene.from_mm, scene.bodies, contacts);
    return contacts;
  };
  const std::vector<Contact> widest = found();
  EXPECT_GT(widest.size(), 1000u);
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const std::vector<Contact> now = found();
    ASSERT_EQ(now.size(), widest.size()) << hwy::TargetName(target);
    for (std::size_t i = 0; i < now.size(); ++i) {
      EXPECT_EQ(now[i].vertices, widest[i].vertices) << hwy::TargetName(target);
      EXPECT_EQ(now[i].weights, widest[i].weights);
      EXPECT_EQ(now[i].gap_mm, widest[i].gap_mm);
      EXPECT_EQ(now[i].normal, widest[i].normal);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(FindNear, BodiesThatAreNotAmongOthersSeeOnlyThemselves) {
  Scene scene = random_scene(105, 12, 1.0);
  for (ContactBody& body : scene.bodies) {
    body.among = false;
  }
  std::vector<Contact> contacts;
  Detector(scene.sheets).find_near(scene.from_mm, scene.bodies, contacts);
  EXPECT_GT(contacts.size(), 100u);
  for (const Contact& contact : contacts) {
    EXPECT_EQ(contact.first_body, contact.second_body);
  }
}

TEST(FindNear, NothingComesOfNothing) {
  const std::vector<Sheet> sheets = {Sheet{}, grid_sheet(2, 2)};
  Detector detector(sheets);
  std::vector<Contact> contacts(3);
  detector.find_near({}, {}, contacts);
  EXPECT_TRUE(contacts.empty());
  const std::vector<ContactBody> bodies = {{0, 0}, {0, 0}};
  detector.find_near({}, bodies, contacts);
  EXPECT_TRUE(contacts.empty());
}

std::map<Key, CandidatePair> by_key(const std::vector<CandidatePair>& pairs) {
  std::map<Key, CandidatePair> keyed;
  for (const CandidatePair& pair : pairs) {
    EXPECT_TRUE(keyed.emplace(key_of(pair.edges, pair.vertices), pair).second) << "a pair twice";
  }
  return keyed;
}

TEST(FindOnCourse, HoldsAllThatComeWithinReachAtAnyTime) {
  std::size_t met = 0;
  std::size_t asked = 0;
  std::size_t candidates = 0;
  for (std::uint64_t seed = 200; seed < 220; ++seed) {
    const Scene scene = random_scene(seed, 10, 1.3);
    std::vector<CandidatePair> pairs;
    Detector(scene.sheets).find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
    const std::map<Key, CandidatePair> found = by_key(pairs);
    candidates += found.size();
    std::vector<std::vector<Vec3>> poses;
    for (int k = 0; k <= 8; ++k) {
      poses.emplace_back(scene.from_mm.size());
      for (std::size_t i = 0; i < poses.back().size(); ++i) {
        poses.back()[i] = lerp(scene.from_mm[i], scene.to_mm[i], k / 8.0);
      }
    }
    for_all_pairs(scene, [&](bool edges, const std::array<std::uint32_t, 4>& v, std::uint32_t a, std::uint32_t b) {
      const double limit = scene.bodies[a].reach_mm + scene.bodies[b].reach_mm;
      ++asked;
      const bool meets = std::any_of(poses.begin(), poses.end(), [&](const std::vector<Vec3>& pose) {
        const std::array<Vec3, 4> points = points_of(pose, v);
        return (edges ? nearest_edge_edge(points) : nearest_vertex_triangle(points)).distance <= limit;
      });
      const std::array<Vec3, 4> from = points_of(scene.from_mm, v);
      const std::array<Vec3, 4> to = points_of(scene.to_mm, v);
      if (meets || (edges ? first_touch_edge_edge(from, to) : first_touch_vertex_triangle(from, to)).touches) {
        ++met;
        EXPECT_EQ(found.count(key_of(edges, v)), 1u);
      }
    });
  }
  EXPECT_GT(met, 3000u);
  EXPECT_LT(candidates, asked / 4);  // it does leave out most of what is far
}

/// The broad phase of Owens et al. 2016, section 3: boxes around the motion of triangles in the cells of a regular
/// grid, and around the motion of vertices to look them up; likewise for edges.
class VoxelGrid {
 public:
  VoxelGrid(const Scene& scene, double cell_mm) : scene_(scene), cell_mm_(cell_mm) {}

  /// Calls visit(item, other) at least once for each pair of items and others whose motions' boxes overlap.
  template <class Visit>
  void pairs(const std::vector<std::vector<std::uint32_t>>& items,
             const std::vector<std::vector<std::uint32_t>>& others, const Visit& visit) const {
    std::map<std::array<int, 3>, std::vector<std::size_t>> cells;
    for (std::size_t i = 0; i < others.size(); ++i) {
      for_cells(others[i], [&](const std::array<int, 3>& cell) { cells[cell].push_back(i); });
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
      for_cells(items[i], [&](const std::array<int, 3>& cell) {
        if (const auto found = cells.find(cell); found != cells.end()) {
          for (const std::size_t other : found->second) {
            visit(i, other);
          }
        }
      });
    }
  }

 private:
  template <class Visit>
  void for_cells(const std::vector<std::uint32_t>& vertices, const Visit& visit) const {
    std::array<int, 3> low = {std::numeric_limits<int>::max(), std::numeric_limits<int>::max(),
                              std::numeric_limits<int>::max()};
    std::array<int, 3> high = {std::numeric_limits<int>::min(), std::numeric_limits<int>::min(),
                               std::numeric_limits<int>::min()};
    for (const std::uint32_t v : vertices) {
      for (const Vec3& p : {scene_.from_mm[v], scene_.to_mm[v]}) {
        const std::array<double, 3> coordinates = {p.x, p.y, p.z};
        for (std::size_t k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], static_cast<int>(std::floor((coordinates[k] - 1e-6) / cell_mm_)));
          high[k] = std::max(high[k], static_cast<int>(std::floor((coordinates[k] + 1e-6) / cell_mm_)));
        }
      }
    }
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int z = low[2]; z <= high[2]; ++z) {
          visit({x, y, z});
        }
      }
    }
  }

  const Scene& scene_;
  double cell_mm_;
};

TEST(FindOnCourse, LeadsToTheTouchesThatAVoxelGridLeadsTo) {
  Scene scene = random_scene(301, 60, 3.0);
  std::vector<std::vector<std::uint32_t>> vertices;
  std::vector<std::vector<std::uint32_t>> triangles;
  std::vector<std::vector<std::uint32_t>> edges;
  for (ContactBody& body : scene.bodies) {
    body.awake = true;
    body.within = true;
    body.reach_mm = 0.0;
    const Sheet& sheet = scene.sheets[body.sheet];
    std::set<std::uint32_t> used;
    for (const Triangle& t : sheet.triangles) {
      triangles.push_back({body.first_vertex + t[0], body.first_vertex + t[1], body.first_vertex + t[2]});
      used.insert(triangles.back().begin(), triangles.back().end());
    }
    for (const std::uint32_t v : used) {
      vertices.push_back({v});
    }
    for (const auto& e : sheet.edges) {
      edges.push_back({body.first_vertex + e[0], body.first_vertex + e[1]});
    }
  }
  const auto touches = [&](bool of_edges, const std::array<std::uint32_t, 4>& v) {
    const std::array<Vec3, 4> from = points_of(scene.from_mm, v);
    const std::array<Vec3, 4> to = points_of(scene.to_mm, v);
    return (of_edges ? first_touch_edge_edge(from, to) : first_touch_vertex_triangle(from, to)).touches;
  };
  std::set<Key> by_grid;
  const auto keep = [&](bool of_edges, const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    std::vector<std::uint32_t> all = a;
    all.insert(all.end(), b.begin(), b.end());
    if (std::set<std::uint32_t>(all.begin(), all.end()).size() == 4) {
      const std::array<std::uint32_t, 4> v = {all[0], all[1], all[2], all[3]};
      if (by_grid.count(key_of(of_edges, v)) == 0 && touches(of_edges, v)) {
        by_grid.insert(key_of(of_edges, v));
      }
    }
  };
  const VoxelGrid grid_of_cells(scene, 0.6);
  grid_of_cells.pairs(vertices, triangles,
                      [&](std::size_t i, std::size_t j) { keep(false, vertices[i], triangles[j]); });
  grid_of_cells.pairs(edges, edges, [&](std::size_t i, std::size_t j) {
    if (i < j) {
      keep(true, edges[i], edges[j]);
    }
  });
  std::set<Key> by_hierarchy;
  std::vector<CandidatePair> pairs;
  Detector(scene.sheets).find_on_course(scene.from_mm, scene.to_mm, scene.bodies, pairs);
  for (const CandidatePair& pair : pairs) {
    if (touches(pair.edges, pair.vertices)) {
      by_hierarchy.insert(key_of(pair.edges, pair.vertices));
    }
  }
  EXPECT_GT(by_grid.size(), 500u);
  EXPECT_EQ(by_hierarchy, by_grid);
}

}  // namespace
}  // namespace anthesis
