// Contacts of polygons: against distances found by brute force, continuous where they matter, and as good as the
// half-planes and discs that they stand for.
#include <doctest/doctest.h>

#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

namespace orthant {
namespace {

using testing::Draws;
using testing::mismatch;
using testing::VectorXd;

constexpr double kTurn = 6.283185307179586;

Polygon regular(std::size_t n, double radius) {
  Polygon corners(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = kTurn * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    corners[i] = radius * Vector2d(std::cos(angle), std::sin(angle));
  }
  return corners;
}

Polygon placed(const Polygon& p, const VectorXd& q, Index body) {
  Polygon world;
  for (const Vector2d& corner : p)
    world.push_back(q.segment<2>(3 * body) + Eigen::Rotation2Dd(q[3 * body + 2]) * corner);
  return world;
}

double to_segment(const Vector2d& p, const Vector2d& from, const Vector2d& to) {
  const double s = std::clamp((p - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
  return (p - from - s * (to - from)).norm();
}

/// Distance of two polygons in the plane; of those that overlap, less the shortest way out.
double distance(const Polygon& a, const Polygon& b) {
  double beyond = -kInf, nearest = kInf;
  const auto look = [&](const Polygon& x, const Polygon& y) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vector2d& from = x[i];
      const Vector2d& to = x[(i + 1) % x.size()];
      const Vector2d n = Vector2d((to - from).y(), -(to - from).x()).normalized();
      double least = kInf;
      for (const Vector2d& p : y)
        least = std::min(least, n.dot(p - from)), nearest = std::min(nearest, to_segment(p, from, to));
      beyond = std::max(beyond, least);
    }
  };
  look(a, b), look(b, a);
  return beyond > 0 ? nearest : beyond;
}

struct Couple {
  Polygon a, b;
  System system() const {
    Scene s;
    s.body({}), s.body({});
    s.contact_set(polygon_polygon({"pair", 0, a, 1, b, 0, {}}));
    return System(s);
  }
};

const Couple kCouples[] = {{rectangle(2, 1), rectangle(1, 1)}, {rectangle(4, 0.5), rectangle(0.2, 1.5)},
                           {regular(6, 1), rectangle(2, 2)},   {regular(3, 1), regular(3, 0.7)},
                           {regular(5, 1), regular(4, 0.7)},   {regular(16, 1), rectangle(3, 1)}};

Vector2d gaps(const System& system, const VectorXd& q) {
  return testing::all_terms(system, q, VectorXd::Zero(q.size())).gap;
}

}  // namespace

TEST_CASE("the nearer of a pair's two points is as far as the polygons are, where they are near") {
  Draws random(3);
  int near = 0;
  for (const Couple& pair : kCouples) {
    const System system = pair.system();
    for (int i = 0; i < 3000; ++i) {
      VectorXd q = random.vector(6, 3);
      q.segment<2>(0) *= 0.6, q.segment<2>(3) *= 0.6;
      const double exact = distance(placed(pair.a, q, 0), placed(pair.b, q, 1));
      if (std::abs(exact) > 0.05) continue;
      ++near;
      const double found = gaps(system, q).minCoeff();
      CAPTURE(q.transpose());
      CHECK(std::abs(found - exact) <= 0.1 * std::abs(exact) + 1e-14);  // sin(tilt) of faces side by side
    }
  }
  CHECK(near > 200);
}

TEST_CASE(
    "both gaps are continuous near contact while a polygon slides, rocks and rolls on a face, overhanging or not") {
  Draws random(4);
  double worst = 0;
  const double sizes[] = {0.4, 1, 3};  // of the lower polygon's half-width
  for (const std::size_t corners : {4u, 6u, 16u})
    for (const double half : sizes)
      for (int path = 0; path < 10; ++path) {
        const Polygon table{{-half, -1}, {half, -1}, {half, 0}, {-half, 0}}, roller = regular(corners, 0.5);
        const System system = Couple{table, roller}.system();
        // Overhanging ones only rock; those on a wide table turn over several times.
        const bool wide = half > 2;
        const double x = random(-0.4, 0.4), slide = random(-1, 1) * (wide ? 1 : half / 4);
        const double turn = wide ? random(-9, 9) : random(-0.05, 0.05), start = wide ? random(-3, 3) : 0;
        const double tilt = random(-3, 3);  // of the whole plane
        Vector2d before(kInf, kInf);
        constexpr int kSteps = 2000;
        for (int k = 0; k < kSteps; ++k) {
          const double s = static_cast<double>(k) / kSteps, angle = start + turn * s;
          VectorXd q(6);
          q << 0, 0, 0, x + slide * s, 0, angle;
          double lowest = kInf;
          for (const Vector2d& corner : placed(roller, q, 1)) lowest = std::min(lowest, corner.y());
          q[4] = 1e-5 - lowest;
          q.segment<2>(3) = Eigen::Rotation2Dd(tilt) * Vector2d(q.segment<2>(3));
          q[2] += tilt, q[5] += tilt;
          const Vector2d now = gaps(system, q);
          for (int p = 0; p < 2; ++p)
            if (before[p] < 1e-3 && k > 0) worst = std::max(worst, std::abs(now[p] - before[p]));
          before = now;
        }
      }
  CHECK(worst < 0.01);  // a step moves no point by more than that
}

TEST_CASE("a pair of polygons does not know which of them is the first, nor where their corners begin to be counted") {
  Draws random(5);
  for (const Couple& pair : kCouples) {
    Polygon turned(pair.a.begin() + 1, pair.a.end());
    turned.push_back(pair.a[0]);
    const System one = pair.system(), begun = Couple{turned, pair.b}.system();
    const System other = Couple{pair.b, pair.a}.system();
    for (int i = 0; i < 500; ++i) {
      VectorXd q = random.vector(6, 2), swapped(6);
      swapped << q.tail(3), q.head(3);
      Vector2d a = gaps(one, q), b = gaps(other, swapped), c = gaps(begun, q);
      for (Vector2d* x : {&a, &b, &c})
        if (x->x() > x->y()) std::swap(x->x(), x->y());
      CHECK(mismatch(a, b) < 1e-14);
      CHECK(mismatch(a, c) < 1e-14);
    }
  }
}

TEST_CASE("flat faces touch at the ends of their overlap, with the normal of both") {
  const auto touch = [](double x) {
    Scene s;
    s.body({}), s.body({});
    s.contact_set(polygon_polygon({"", 0, rectangle(2, 1), 1, rectangle(4, 1), 0, {}}));
    VectorXd q(6);
    q << x, 1, 0, 0, 0, 0;
    const Terms terms = testing::all_terms(System(s), q, VectorXd::Zero(6));
    CHECK(std::abs(terms.gap[0]) < 1e-15);
    CHECK(std::abs(terms.gap[1]) < 1e-15);
    Vector2d ends;
    for (int i = 0; i < 2; ++i) {
      const VectorXd normal = testing::dense(terms.closed[static_cast<std::size_t>(i)].rows.normal, 6);
      CHECK(mismatch(normal.segment<2>(0), Vector2d(0, 1)) < 1e-15);
      ends[i] = normal[2] + x;  // the arm of the normal about the upper one's centre
    }
    if (ends[0] > ends[1]) std::swap(ends[0], ends[1]);
    return ends;
  };
  CHECK(mismatch(touch(0), Vector2d(-1, 1)) < 1e-15);
  CHECK(mismatch(touch(0.5), Vector2d(-0.5, 1.5)) < 1e-15);
  CHECK(mismatch(touch(2), Vector2d(1, 2)) < 1e-15);  // overhanging to the right
  CHECK(mismatch(touch(-2.9), Vector2d(-2, -1.9)) < 1e-14);
}

TEST_CASE("a disc against a polygon is one against its faces and corners") {
  Draws random(6);
  const Polygon corners = regular(5, 1);
  for (int i = 0; i < 2000; ++i) {
    Scene s;
    s.body({}), s.body({});
    const double radius = random(0.05, 0.5);
    const Vector2d centre = random.point();
    s.contact(DiscPolygon{"", 0, centre, radius, 1, corners, {}});
    VectorXd q = random.vector(6, 2);
    const Vector2d c = q.segment<2>(0) + Eigen::Rotation2Dd(q[2]) * centre;
    const Polygon world = placed(corners, q, 1);
    double outside = kInf, beyond = -kInf;
    for (std::size_t k = 0; k < 5; ++k) {
      const Vector2d along = (world[(k + 1) % 5] - world[k]).normalized();
      beyond = std::max(beyond, Vector2d(along.y(), -along.x()).dot(c - world[k]));
      outside = std::min(outside, to_segment(c, world[k], world[(k + 1) % 5]));
    }
    const double exact = (beyond > 0 ? outside : beyond) - radius;
    CHECK(std::abs(testing::all_terms(System(s), q, VectorXd::Zero(6)).gap[0] - exact) < 1e-14);
  }
}

namespace {

/// A block slides on, rocks on and falls onto a floor that is a half-plane or a large polygon.
Scene block_on_floor(bool polygon, double angle) {
  Scene s{.gravity = {std::sin(angle) * 9.81, -std::cos(angle) * 9.81}, .duration = 1};
  const auto block = s.body({.name = "block",
                             .mass = 2,
                             .inertia = 0.1,
                             .position = {0, 0.45},
                             .angle = 0.2,
                             .velocity = {1, 0},
                             .omega = -1});
  const ContactLaw law{.mu = 0.3, .e = 0.2};
  if (polygon)
    s.contact_set(
        polygon_polygon({"floor", block, rectangle(0.6, 0.4), kGround, {{-9, -9}, {9, -9}, {9, 0}, {-9, 0}}, 0, law}));
  else
    s.contact_set(polygon_wall({"floor", block, {}, kGround, {0, 0}, {0, 1}, law}, rectangle(0.6, 0.4)));
  return s;
}

}  // namespace

TEST_CASE("a block on a polygon moves as on a half-plane, with every integrator") {
  for (const std::string scheme :
       {"moreau-jean", "stewart-trinkle", "generalized-alpha", "rattle", "event-driven", "adaptive"}) {
    CAPTURE(scheme);
    const Run on_polygon = run(block_on_floor(true, 0.1), scheme, 1e-3),
              on_wall = run(block_on_floor(false, 0.1), scheme, 1e-3);
    REQUIRE(on_polygon.status == Status::solved);
    REQUIRE(on_wall.status == Status::solved);
    CHECK(mismatch(on_polygon.final.q, on_wall.final.q) < (scheme == "adaptive" ? 1e-5 : 1e-9));
  }
}

TEST_CASE("a square thrown along the floor rolls over its corners as on a half-plane") {
  const auto thrown = [](bool polygon) {
    Scene s{.gravity = {0, -9.81}, .duration = 2};
    const auto block =
        s.body({.name = "block", .mass = 1, .inertia = 1.0 / 6, .position = {0, 0.5}, .velocity = {6, 0}, .omega = -6});
    const ContactLaw law{.mu = 1};
    if (polygon)
      s.contact_set(
          polygon_polygon({"floor", block, rectangle(1, 1), kGround, {{-9, -9}, {90, -9}, {90, 0}, {-9, 0}}, 0, law}));
    else
      s.contact_set(polygon_wall({"floor", block, {}, kGround, {0, 0}, {0, 1}, law}, rectangle(1, 1)));
    return s;
  };
  for (const std::string scheme : {"moreau-jean", "event-driven"}) {
    CAPTURE(scheme);
    const Run on_polygon = run(thrown(true), scheme, 1e-3), on_wall = run(thrown(false), scheme, 1e-3);
    REQUIRE(on_polygon.status == Status::solved);
    CHECK(on_wall.final.q[2] < -1.5);  // it has turned over
    CHECK(mismatch(on_polygon.final.q, on_wall.final.q) < 1e-7);
  }
}

TEST_CASE("stacked boxes stand: each pair of points carries the weight above it") {
  constexpr int kBoxes = 8;
  Scene s{.gravity = {0, -10}, .duration = 0.2};
  for (int i = 0; i < kBoxes; ++i) s.body({.mass = 1.0 + i, .inertia = 0.1, .position = {0, 0.25 + 0.5 * i}});
  s.contact_set(polygon_wall({"floor", 0, {}, kGround, {0, 0}, {0, 1}, {.mu = 0.5}}, rectangle(1, 0.5)));
  for (int i = 1; i < kBoxes; ++i)
    s.contact_set(
        polygon_polygon({"joint" + std::to_string(i), i, rectangle(1, 0.5), i - 1, rectangle(1, 0.5), 0, {.mu = 0.5}}));
  for (const std::string scheme : {"generalized-alpha", "event-driven"}) {
    CAPTURE(scheme);
    double worst = 0;
    const Run r = run(s, scheme, 0.01, [&](const RunSample& m) {
      if (m.state.t == 0) return;
      double above = 0;
      for (int i = kBoxes - 1; i > 0; --i) {
        above += 10 * (1.0 + i) * 0.01;
        const auto k = static_cast<std::size_t>(4 + 2 * (i - 1));
        worst = std::max(worst, std::abs(m.impulses[k].normal + m.impulses[k + 1].normal - above));
      }
    });
    REQUIRE(r.status == Status::solved);
    CHECK(worst < 1e-10);
    CHECK((r.final.q - System(s).initial_state().q).lpNorm<Eigen::Infinity>() < 1e-12);
  }
}

}  // namespace orthant
