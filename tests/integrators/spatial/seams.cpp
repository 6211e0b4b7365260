// Boxes on flush tiles in space: every scheme of fixed step moves them as on one tile.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include <algorithm>

using namespace orthant;

namespace {

constexpr std::string_view kOverSeams[] = {"moreau-jean",     "stewart-trinkle",   "anitescu-potra",
                                           "paoli-schatzman", "generalized-alpha", "rattle"};

struct Throw {
  Eigen::Matrix3d R;
  double half = 0.4, height = 0;  // [m]
  Vector3d velocity{0, 0, 0};
};

/// A box of `parts` × `parts` flush pieces that starts on a corner, above a floor of nx × ny tiles.
spatial::Scene thrown_on_tiles(const Throw& t, int nx, int ny, double mu, int parts = 1) {
  constexpr double kSide = 8;  // [m]
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  const spatial::Solid box = spatial::box(Vector3d::Constant(2 * t.half));
  Vector3d lowest(0, 0, 0);
  for (const Vector3d& p : spatial::box_corners(Vector3d::Constant(t.half)))
    if ((t.R * p).z() < lowest.z()) lowest = t.R * p;
  const Eigen::Quaterniond q(t.R);
  s.body({.mass = 1,
          .inertia = box.inertia,
          .position = Vector3d(-0.4, 0.1, t.height) - lowest,
          .orientation = {q.w(), q.x(), q.y(), q.z()},
          .velocity = t.velocity});
  spatial::Collision c{.name = "floor", .shapes = {}, .law = {.mu = mu}};
  const double part = t.half / parts;
  for (int i = 0; i < parts; ++i)
    for (int j = 0; j < parts; ++j) {
      spatial::Shape piece{0, spatial::box_corners({part, part, t.half}), 0};
      for (Vector3d& p : piece.corners) p += Vector3d((2 * i + 1) * part - t.half, (2 * j + 1) * part - t.half, 0);
      c.shapes.push_back(piece);
    }
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      spatial::Shape tile{kGround, spatial::box_corners({kSide / nx / 2, kSide / ny / 2, 0.5}), 0};
      for (Vector3d& p : tile.corners)
        p += Vector3d((i + 0.5) * kSide / nx - kSide / 2, (j + 0.5) * kSide / ny - kSide / 2, -0.5);
      c.shapes.push_back(tile);
    }
  s.collision(c);
  return s;
}

Throw some_throw(Random& random) {
  const double x = random.uniform(-0.7, 0.7), y = random.uniform(-0.7, 0.7), v = random.uniform(0.5, 2);
  return {Eigen::AngleAxisd(x, Vector3d::UnitX()).toRotationMatrix() *
              Eigen::AngleAxisd(y, Vector3d::UnitY()).toRotationMatrix(),
          0.4,
          0,
          {v, random.uniform(-1, 1), 0}};
}

/// The largest difference between the states on one tile and on several. [m, m/s, rad, rad/s]
double apart(const Throw& t, int nx, int ny, double mu, std::string_view scheme, double duration, int parts = 1) {
  const State one = run_in_space(SpatialSystem(thrown_on_tiles(t, 1, 1, mu)), scheme, 1e-3, duration).final;
  const State many = run_in_space(SpatialSystem(thrown_on_tiles(t, nx, ny, mu, parts)), scheme, 1e-3, duration).final;
  return std::max(between<Spatial>(one.q, many.q).lpNorm<Eigen::Infinity>(),
                  (one.v - many.v).lpNorm<Eigen::Infinity>());
}

/// A throw on floors of tiles, by every scheme: the end is that on one tile.
void ends_as_on_one_tile(const Throw& t, double mu, double duration, double allowed) {
  for (const std::string_view scheme : kOverSeams) {
    CAPTURE(scheme);
    CHECK(apart(t, 80, 1, mu, scheme, duration) < allowed);
    CHECK(apart(t, 23, 29, mu, scheme, duration) < allowed);
  }
}

}  // namespace

TEST_CASE("a box that slides on a corner over seams moves as on one tile, by every scheme of fixed step") {
  Random random(3);
  for (int round = 0; round < 4; ++round) {
    CAPTURE(round);
    ends_as_on_one_tile(some_throw(random), 0.3, 0.1, 1e-9);
  }
}

TEST_CASE("a box that tips over from a corner lands on tiles, without friction, as on one tile") {
  Random random(4);  // with friction rigid bodies do not determine the shares of four corners
  for (int round = 0; round < 4; ++round) {
    Throw t = some_throw(random);
    t.half = round % 2 == 0 ? 0.4 : 0.1, t.height = round < 2 ? 0 : 0.01;
    CAPTURE(round);
    ends_as_on_one_tile(t, 0, 0.5, 1e-6);
  }
}

TEST_CASE("a box of flush pieces tips over from a corner as one box, on one tile and on several") {
  Random random(4);
  for (int round = 0; round < 3; ++round) {
    const Throw t = some_throw(random);
    for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle", "rattle", "generalized-alpha"}) {
      CAPTURE(round);
      CAPTURE(scheme);
      CHECK(apart(t, 1, 1, 0, scheme, 0.5, 2) < 0.1);  // normals of faces that are almost parallel may be either's
      CHECK(apart(t, 23, 29, 0, scheme, 0.5, 2) < 0.1);
    }
  }
}

TEST_CASE("a box that spins flat on tiles stops as on one tile") {
  const auto turned_after = [](int nx, int ny) {
    Throw t{Eigen::AngleAxisd(0.3, Vector3d::UnitZ()).toRotationMatrix()};
    spatial::Scene s = thrown_on_tiles(t, nx, ny, 0.3);
    s.bodies[0].omega = {0, 0, 5};
    return run_in_space(SpatialSystem(s), "moreau-jean", 1e-3, 0.1).final.v[5];
  };
  const double one = turned_after(1, 1);
  CHECK(one > 1);
  CHECK(std::abs(turned_after(2, 1) - one) < 1e-3 * one);
  CHECK(std::abs(turned_after(80, 1) - one) < 1e-3 * one);
}
