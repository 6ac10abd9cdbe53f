#include "anthesis/contact/continuous.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <functional>
#include <string>

#include "anthesis/base/random.h"

namespace anthesis {
namespace {

using Points = std::array<Vec3, 4>;
using Rational = boost::multiprecision::cpp_rational;

Vec3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

Points random_points(Rng& rng, double size) {
  return {random_vector(rng, size), random_vector(rng, size), random_vector(rng, size), random_vector(rng, size)};
}

Nearest nearest_of(const Points& points, bool edges) {
  return edges ? nearest_edge_edge(points) : nearest_vertex_triangle(points);
}

Touch first_touch_of(const Points& from, const Points& to, bool edges) {
  return edges ? first_touch_edge_edge(from, to) : first_touch_vertex_triangle(from, to);
}

/// The nearest points are nearest if, and only if, a slab as thick as their distance fits between the primitives, and
/// they are points of the primitives if the weights say so.
void expect_nearest(const Points& points, bool edges, double tolerance) {
  const Nearest nearest = nearest_of(points, edges);
  const std::size_t first_count = edges ? 2 : 1;
  double first_sum = 0.0;
  double second_sum = 0.0;
  Vec3 difference;
  for (std::size_t i = 0; i < 4; ++i) {
    const double own = i < first_count ? nearest.weights[i] : -nearest.weights[i];
    EXPECT_GE(own, 0.0);
    EXPECT_LE(own, 1.0);
    (i < first_count ? first_sum : second_sum) += own;
    difference += nearest.weights[i] * points[i];
  }
  EXPECT_NEAR(first_sum, 1.0, 1e-15);
  EXPECT_NEAR(second_sum, 1.0, 1e-15);
  EXPECT_NEAR(length(difference - nearest.difference), 0.0, tolerance);
  EXPECT_DOUBLE_EQ(length(nearest.difference), nearest.distance);
  for (std::size_t i = 0; i < first_count; ++i) {
    for (std::size_t j = first_count; j < 4; ++j) {
      // Not divided by the distance, as rounding leaves a short difference no good direction.
      EXPECT_GE(dot(nearest.difference, points[i] - points[j]), nearest.distance * nearest.distance - tolerance);
    }
  }
}

TEST(NearestPoints, LeaveRoomForASlabAsThickAsTheirDistance) {
  Rng rng(1, 0, RandomPurpose::kTest);
  for (int k = 0; k < 20'000; ++k) {
    const Points points = random_points(rng, 2.0);
    expect_nearest(points, false, 1e-13);
    expect_nearest(points, true, 1e-13);
  }
}

TEST(NearestPoints, HoldForNeedlesPointsAndParallels) {
  Rng rng(2, 0, RandomPurpose::kTest);
  for (int k = 0; k < 20'000; ++k) {
    Points points = random_points(rng, 2.0);
    // The last point comes to lie on, or within a whisker of, the line of two others.
    const double whisker = std::array{0.0, 1e-15, 1e-12, 1e-8, 1e-4}[rng.bits() % 5];
    const double s = std::array{0.0, 1.0, -0.5, 0.5, 2.0}[rng.bits() % 5];
    Points needle = points;
    needle[3] = lerp(points[1], points[2], s) + random_vector(rng, whisker);
    expect_nearest(needle, false, 1e-7);
    Points parallel = points;
    parallel[3] = parallel[2] + s * (parallel[1] - parallel[0]) + random_vector(rng, whisker);
    expect_nearest(parallel, true, 1e-7);
    parallel[1] = parallel[0] + random_vector(rng, whisker);
    expect_nearest(parallel, true, 1e-7);
  }
}

TEST(NearestPoints, AreWhereSymmetryPutsThem) {
  const Vec3 a{0, 0, 0};
  const Vec3 b{4, 0, 0};
  const Vec3 c{0, 4, 0};
  const auto weights = [&](Vec3 p) { return nearest_vertex_triangle({p, a, b, c}).weights; };
  EXPECT_THAT(weights({1, 1, 3}), testing::ElementsAre(1.0, -0.5, -0.25, -0.25));  // above the inside
  EXPECT_THAT(weights({-1, -2, 1}), testing::ElementsAre(1.0, -1.0, 0.0, 0.0));    // corners
  EXPECT_THAT(weights({9, -1, 1}), testing::ElementsAre(1.0, 0.0, -1.0, 0.0));
  EXPECT_THAT(weights({-1, 9, 1}), testing::ElementsAre(1.0, 0.0, 0.0, -1.0));
  EXPECT_THAT(weights({2, -5, 0}), testing::ElementsAre(1.0, -0.5, -0.5, 0.0));  // sides
  EXPECT_THAT(weights({-5, 2, 0}), testing::ElementsAre(1.0, -0.5, 0.0, -0.5));
  EXPECT_THAT(weights({5, 5, 0}), testing::ElementsAre(1.0, 0.0, -0.5, -0.5));
  EXPECT_DOUBLE_EQ(nearest_vertex_triangle({Vec3{1, 1, 3}, a, b, c}).distance, 3.0);
  EXPECT_EQ(nearest_vertex_triangle({Vec3{1, 1, -3}, a, b, c}).difference, (Vec3{0, 0, -3}));

  const Nearest crossed = nearest_edge_edge({Vec3{-1, 0, 1}, Vec3{1, 0, 1}, Vec3{0, -1, 0}, Vec3{0, 1, 0}});
  EXPECT_THAT(crossed.weights, testing::ElementsAre(0.5, 0.5, -0.5, -0.5));
  EXPECT_EQ(crossed.difference, (Vec3{0, 0, 1}));
  EXPECT_EQ(nearest_edge_edge({a, b, Vec3{5, 1, 0}, Vec3{9, 1, 0}}).distance, std::sqrt(2.0));  // parallel, one behind
  EXPECT_EQ(nearest_edge_edge({a, b, Vec3{1, 2, 0}, Vec3{9, 2, 0}}).distance, 2.0);  // parallel, side by side
  EXPECT_EQ(nearest_edge_edge({a, a, c, c}).distance, 4.0);                          // two points
  EXPECT_EQ(nearest_edge_edge({a, b, Vec3{1, 0, 0}, Vec3{3, 0, 0}}).distance, 0.0);  // one within the other
}

/// A motion whose answer is known without rounding: all coordinates are whole numbers times a power of two.
struct Query {
  Points from;
  Points to;
  bool edges = false;
  double touch_at = 0.0;  ///< they touch then, and perhaps before
};

Vec3 whole(Rng& rng, int most) {
  const auto one = [&] { return static_cast<double>(rng.bits() % (2 * static_cast<std::uint32_t>(most) + 1)) - most; };
  const double x = one();
  const double y = one();
  return {x, y, one()};
}

constexpr int kParts = 8;  // times and weights are eighths

/// Weights of a point of each primitive, in eighths: inside, on a side or in a corner.
std::array<double, 4> random_weights(Rng& rng, bool edges) {
  const auto eighths = [&](std::uint32_t most) {
    const std::uint32_t kind = rng.bits() % 4;
    return kind == 0 ? 0u : kind == 1 ? most : most == 0 ? 0u : rng.bits() % (most + 1);
  };
  std::array<double, 4> weights;
  if (edges) {
    const double s = eighths(kParts);
    const double t = eighths(kParts);
    weights = {kParts - s, s, kParts - t, t};
  } else {
    const std::uint32_t v = eighths(kParts);
    const std::uint32_t w = eighths(kParts - v);
    weights = {kParts, static_cast<double>(kParts - v - w), static_cast<double>(v), static_cast<double>(w)};
  }
  for (double& w : weights) {
    w /= kParts;
  }
  return weights;
}

enum class Family { kGeneric, kGrazing, kCoplanar, kNearlyParallel, kCollapsed, kSharedMotion, kStill, kCount };

/// A touch at an exactly known time at exactly known places. The places there and the velocities are chosen; the ends
/// of the motion follow.
Query touching(Rng& rng, Family family) {
  Query query;
  query.edges = rng.bits() % 2 == 0;
  const std::size_t first_count = query.edges ? 2 : 1;
  query.touch_at = static_cast<double>(rng.bits() % (kParts + 1)) / kParts;
  const int most = std::array{3, 50, 1 << 12, 1 << 20}[rng.bits() % 4];
  std::array<double, 4> weights = random_weights(rng, query.edges);
  Points at;  // when they touch
  for (Vec3& p : at) {
    p = static_cast<double>(kParts) * whole(rng, most);
  }
  if (family == Family::kNearlyParallel) {
    if (query.edges) {
      at[3] = at[2] + 4.0 * (at[1] - at[0]) + static_cast<double>(kParts) * whole(rng, 1);
    } else {
      at[3] = 2.0 * at[2] - at[1] + static_cast<double>(kParts) * whole(rng, 1);
    }
  } else if (family == Family::kCollapsed) {
    at[3] = rng.bits() % 2 == 0 ? at[2] : query.edges ? at[2] + at[1] - at[0] : 2.0 * at[2] - at[1];
  } else if (family == Family::kCoplanar) {
    for (Vec3& p : at) {
      p.z = 2.0 * p.x - 3.0 * p.y;
    }
  }
  Points velocity;
  for (Vec3& v : velocity) {
    v = static_cast<double>(kParts) * static_cast<double>(kParts) * whole(rng, most);
    if (family == Family::kCoplanar) {
      v.z = 2.0 * v.x - 3.0 * v.y;
    }
  }
  // The whole first primitive is moved so that the places meet, and for a graze so that they do not leave the common
  // tangent plane while they do.
  const auto gap = [&](const Points& p) {
    Vec3 sum;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += (i < first_count ? -weights[i] : weights[i]) * p[i];
    }
    return sum;
  };
  const Vec3 move = gap(at);
  for (std::size_t i = 0; i < first_count; ++i) {
    at[i] += move;
  }
  if (family == Family::kGrazing) {
    const Vec3 along = static_cast<double>(kParts) * (at[3] - at[2]);
    const Vec3 faster = gap(velocity) + (rng.bits() % 2 == 0 ? along : -along);
    for (std::size_t i = 0; i < first_count; ++i) {
      velocity[i] += faster;
    }
  } else if (family == Family::kSharedMotion) {
    velocity = {velocity[0], velocity[0], velocity[0], velocity[0]};
  } else if (family == Family::kStill) {
    velocity = {};
  }
  const Vec3 offset =
      static_cast<double>(kParts) *
      (rng.bits() % 2 == 0 ? Vec3{} : whole(rng, std::array{1 << 10, 1 << 24, 1 << 30}[rng.bits() % 3]));
  const double scale = std::ldexp(1.0, static_cast<int>(rng.bits() % 41) - 30);
  for (std::size_t i = 0; i < 4; ++i) {
    query.from[i] = scale * (at[i] - query.touch_at * velocity[i] + offset);
    query.to[i] = scale * (at[i] + (1.0 - query.touch_at) * velocity[i] + offset);
  }
  // The construction itself, checked in rational numbers.
  const Rational t = query.touch_at;
  for (double Vec3::*const axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    Rational sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Rational place = (1 - t) * Rational(query.from[i].*axis) + t * Rational(query.to[i].*axis);
      sum += (i < first_count ? 1 : -1) * Rational(weights[i]) * place;
    }
    if (sum != 0) {
      ADD_FAILURE() << "the query does not touch";
    }
  }
  return query;
}

TEST(FirstTouch, NeverMissesATouchThatIsExactlyKnown) {
  Rng rng(3, 0, RandomPurpose::kTest);
  std::array<int, static_cast<std::size_t>(Family::kCount)> undecided = {};
  constexpr int kQueriesEach = 16'000;
  for (std::size_t f = 0; f < undecided.size(); ++f) {
    int missed = 0;
    int late = 0;
    for (int k = 0; k < kQueriesEach; ++k) {
      const Query query = touching(rng, static_cast<Family>(f));
      const Touch touch = first_touch_of(query.from, query.to, query.edges);
      missed += !touch.touches;
      late += touch.time > query.touch_at;
      undecided[f] += touch.undecided;
    }
    EXPECT_EQ(missed, 0) << "family " << f;
    EXPECT_EQ(late, 0) << "family " << f;
  }
  RecordProperty("undecided", testing::PrintToString(undecided));
}

/// Both stay on their sides of a plane, which is exact in whole numbers; the closest they can be is `gap` of `most`.
Query separated(Rng& rng, int most, double gap) {
  Query query;
  query.edges = rng.bits() % 2 == 0;
  const std::size_t first_count = query.edges ? 2 : 1;
  const double slope_x = static_cast<double>(rng.bits() % 7) - 3.0;
  const double slope_y = static_cast<double>(rng.bits() % 7) - 3.0;
  const bool below = rng.bits() % 2 == 0;
  const Vec3 offset = rng.bits() % 2 == 0 ? Vec3{} : whole(rng, 1 << 24);
  for (std::size_t i = 0; i < 4; ++i) {
    for (Points* const end : {&query.from, &query.to}) {
      Vec3 p = whole(rng, most);
      // Half the corners keep to the border of their side all the time.
      const double height = rng.bits() % 2 == 0 ? 0.0 : std::abs(p.z);
      p.z = i < first_count ? gap + height : -height;
      p.z = slope_x * p.x + slope_y * p.y + (below ? -p.z : p.z);
      (*end)[i] = p + offset;
    }
  }
  return query;
}

TEST(FirstTouch, SeesThatAPlaneKeepsThemApart) {
  Rng rng(4, 0, RandomPurpose::kTest);
  for (const int most : {3, 1000, 1 << 20, 1 << 28}) {
    int wrong = 0;
    for (int k = 0; k < 10'000; ++k) {
      const Query query = separated(rng, most, 1.0);
      wrong += first_touch_of(query.from, query.to, query.edges).touches;
    }
    EXPECT_EQ(wrong, 0) << "of motions that stay one part in " << most << " apart";
  }
}

/// Coefficients in Bernstein's basis of the six-fold volume of the four points over [low, high], exactly.
using Place = std::array<Rational, 3>;
struct ExactMotion {
  std::array<Place, 4> from;
  std::array<Place, 4> to;

  ExactMotion(const Points& a, const Points& b) {
    for (std::size_t i = 0; i < 4; ++i) {
      from[i] = {a[i].x, a[i].y, a[i].z};
      to[i] = {b[i].x, b[i].y, b[i].z};
    }
  }
  Place between(std::size_t i, std::size_t j, const Rational& t) const {  // from point j to point i
    Place p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = (1 - t) * (from[i][k] - from[j][k]) + t * (to[i][k] - to[j][k]);
    }
    return p;
  }
};

Place cross(const Place& a, const Place& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational dot(const Place& a, const Place& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

enum class Verdict { kTouches, kApart, kUnknown };

/// Generic motions decided in rational numbers: where the four points are never in one plane they do not touch; where
/// they pass from one side of it to the other while the nearest points stay inside the primitives they do.
Verdict exact_verdict(const ExactMotion& motion, bool edges, const Rational& low, const Rational& high, int depth) {
  const Place ends[2][3] = {{motion.between(1, 0, low), motion.between(2, 0, low), motion.between(3, 0, low)},
                            {motion.between(1, 0, high), motion.between(2, 0, high), motion.between(3, 0, high)}};
  // Blossom: the coefficient k takes k of the three factors at the end and the mean over which.
  std::array<Rational, 4> volume;
  for (int mask = 0; mask < 8; ++mask) {
    const int count = (mask & 1) + (mask >> 1 & 1) + (mask >> 2 & 1);
    const Rational value = dot(ends[mask & 1][0], cross(ends[mask >> 1 & 1][1], ends[mask >> 2 & 1][2]));
    volume[static_cast<std::size_t>(count)] += (count == 0 || count == 3) ? value : value / 3;
  }
  const auto all = [](const auto& values, int sign) {
    return std::all_of(values.begin(), values.end(), [&](const Rational& v) { return v * sign > 0; });
  };
  if (all(volume, 1) || all(volume, -1)) {
    return Verdict::kApart;
  }
  const Place mean_normal = [&] {
    const Rational middle = (low + high) / 2;
    return edges ? cross(motion.between(1, 0, middle), motion.between(3, 2, middle))
                 : cross(motion.between(2, 1, middle), motion.between(3, 1, middle));
  }();
  // Sign of the turn (a - c) x (b - c) about the normal, over the whole interval: 0 where it is not one sign.
  const auto turn = [&](std::size_t a, std::size_t b, std::size_t c) {
    const Place a0 = motion.between(a, c, low);
    const Place a1 = motion.between(a, c, high);
    const Place b0 = motion.between(b, c, low);
    const Place b1 = motion.between(b, c, high);
    const std::array<Rational, 3> values = {dot(cross(a0, b0), mean_normal),
                                            dot(cross(a0, b1), mean_normal) + dot(cross(a1, b0), mean_normal),
                                            dot(cross(a1, b1), mean_normal)};
    return all(values, 1) ? 1 : all(values, -1) ? -1 : 0;
  };
  const bool changes = volume[0] * volume[3] < 0;
  if (edges) {
    const int sides[4] = {turn(0, 1, 2), turn(0, 1, 3), turn(2, 3, 0), turn(2, 3, 1)};
    if ((sides[0] != 0 && sides[0] == sides[1]) || (sides[2] != 0 && sides[2] == sides[3])) {
      return Verdict::kApart;  // in every common plane one edge is on one side of the other
    }
    if (changes && sides[0] * sides[1] < 0 && sides[2] * sides[3] < 0) {
      return Verdict::kTouches;
    }
  } else {
    const int sides[3] = {turn(1, 2, 0), turn(2, 3, 0), turn(3, 1, 0)};
    const int plus = static_cast<int>(std::count(sides, sides + 3, 1));
    const int minus = static_cast<int>(std::count(sides, sides + 3, -1));
    if (plus > 0 && minus > 0) {
      return Verdict::kApart;
    }
    if (changes && (plus == 3 || minus == 3)) {
      return Verdict::kTouches;
    }
  }
  if (depth == 0) {
    return Verdict::kUnknown;
  }
  const Rational middle = (low + high) / 2;
  const Verdict first = exact_verdict(motion, edges, low, middle, depth - 1);
  if (first == Verdict::kTouches) {
    return first;
  }
  const Verdict second = exact_verdict(motion, edges, middle, high, depth - 1);
  return second == Verdict::kTouches || second == Verdict::kUnknown ? second : first;
}

TEST(FirstTouch, AgreesWithRationalArithmeticOnGenericMotions) {
  Rng rng(5, 0, RandomPurpose::kTest);
  int touches = 0;
  int apart = 0;
  for (int k = 0; k < 4'000; ++k) {
    const bool edges = k % 2 == 0;
    const Points from = random_points(rng, 1.0);
    const Points to = random_points(rng, 1.0);
    const Verdict verdict = exact_verdict(ExactMotion(from, to), edges, 0, 1, 12);
    const Touch touch = first_touch_of(from, to, edges);
    if (verdict != Verdict::kUnknown) {
      EXPECT_EQ(touch.touches, verdict == Verdict::kTouches);
      (verdict == Verdict::kTouches ? touches : apart)++;
    }
  }
  EXPECT_GT(touches, 300);
  EXPECT_GT(apart, 1000);
}

TEST(FirstTouch, TimeIsThatOfTheTouch) {
  // A vertex falls onto a triangle that lies still, turns away below it, and rises towards it.
  const Points from = {Vec3{1, 1, 4}, Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
  Points to = from;
  to[0].z = -4;
  EXPECT_NEAR(first_touch_vertex_triangle(from, to).time, 0.5, 1e-9);
  EXPECT_LE(first_touch_vertex_triangle(from, to).time, 0.5);
  to[3].z = to[2].z = -8;  // weights 1/2, 1/4, 1/4 of heights 0, -8 t, -8 t against 4 - 8 t
  EXPECT_NEAR(first_touch_vertex_triangle(from, to).time, 1.0, 1e-9);
  EXPECT_LE(first_touch_vertex_triangle(from, to).time, 1.0);
  to[1].z = to[2].z = to[3].z = 4;
  EXPECT_NEAR(first_touch_vertex_triangle(from, to).time, 1.0 / 3.0, 1e-9);

  // Touching edges that part: from the start.
  const Points crossed = {Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 1, 0}};
  Points parted = crossed;
  parted[0].z = parted[1].z = 1;
  EXPECT_TRUE(first_touch_edge_edge(crossed, parted).touches);
  EXPECT_EQ(first_touch_edge_edge(crossed, parted).time, 0.0);
  EXPECT_NEAR(first_touch_edge_edge(parted, crossed).time, 1.0, 1e-9);
}

TEST(FirstTouch, TimeNearlyReachesTheTouchOfGenericMotions) {
  Rng rng(6, 0, RandomPurpose::kTest);
  int touches = 0;
  for (int k = 0; k < 20'000; ++k) {
    const bool edges = k % 2 == 0;
    const Points from = random_points(rng, 1.0);
    const Points to = random_points(rng, 1.0);
    const Touch touch = first_touch_of(from, to, edges);
    if (touch.touches) {
      ++touches;
      Points then;
      for (std::size_t i = 0; i < 4; ++i) {
        then[i] = lerp(from[i], to[i], touch.time);
      }
      EXPECT_LT(nearest_of(then, edges).distance, 1e-9);
    }
  }
  EXPECT_GT(touches, 1000);
}

TEST(FirstTouch, EndsSoonWhereLayersSlideAlmostInTouch) {
  // A triangle turns about a line that the vertex follows at a distance of less than rounding's square root.
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 0.0}) {
    const Points from = {Vec3{-1, 0, gap}, Vec3{-3, -1, -1}, Vec3{3, -1, -1}, Vec3{0, 2, 2}};
    const Points to = {Vec3{1, 0, gap}, Vec3{-3, -1, 1}, Vec3{3, -1, 1}, Vec3{0, 2, -2}};
    const Touch touch = first_touch_vertex_triangle(from, to);
    EXPECT_EQ(touch.touches, true) << gap;  // the triangle sweeps the vertex's side
    EXPECT_LE(touch.time, 0.5);
  }
}

TEST(FirstTouch, TakesWhatIsOutOfRangeForATouch) {
  const double huge = 1e200;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Points far = {Vec3{0, 0, huge}, Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};
  EXPECT_TRUE(first_touch_vertex_triangle(far, far).touches);
  EXPECT_TRUE(first_touch_edge_edge(far, far).undecided);
  Points broken = far;
  broken[0].z = nan;
  EXPECT_TRUE(first_touch_vertex_triangle(broken, broken).touches);
  const Points one_place = {};
  EXPECT_TRUE(first_touch_edge_edge(one_place, one_place).touches);
}

}  // namespace
}  // namespace anthesis
