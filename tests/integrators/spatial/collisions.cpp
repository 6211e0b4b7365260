// Searched collisions, rims and ellipsoids in space: motions against exact ones, the search against all pairs.
#include "tests/support/sanitized.h"
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/boxes.h>
#include <orthant/core/scenes/euler_disc.h>
#include <orthant/core/scenes/rattleback.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

using namespace orthant;

namespace {

constexpr std::string_view kStackers[] = {"moreau-jean", "stewart-trinkle", "paoli-schatzman", "rattle",
                                          "generalized-alpha"};

BodyId add_box(spatial::Scene& s, const Vector3d& size, const Vector3d& position,
               const Vector3d& velocity = {0, 0, 0}) {
  return s.body({.mass = size.prod(),
                 .inertia = size.prod() * spatial::box(size).inertia,
                 .position = position,
                 .velocity = velocity});
}
spatial::Shape box_shape(BodyId body, const Vector3d& size) { return {body, spatial::box_corners(size / 2), 0}; }

/// The largest way of any body from its start.
double moved(const SpatialSystem& system, const State& x) {
  return between<Spatial>(system.initial_state().q, x.q).lpNorm<Eigen::Infinity>();
}

}  // namespace

TEST_CASE("the search finds a pair that the way of its bodies can close, by translation or by rotation") {
  spatial::Scene s;
  s.collision({.name = "rods",
               .shapes = {{s.body({.name = "rod"}), {{-1, 0, 0}, {1, 0, 0}}, 0.01},
                          {s.body({.name = "ball", .position = {0, 0, 0.5}}), {{0, 0, 0}}, 0.01}},
               .law = {}});
  const SpatialSystem system(s);
  TermsOf<Spatial> terms(system);
  set_poses(system, 0, system.initial_state().q, terms.at);
  const auto found = [&](Index entry, double way) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(system.dof());
    all[entry] = way;
    REQUIRE(BroadPhaseOf<Spatial>(system).find(all, terms));
    return std::ranges::any_of(terms.pairs, [](const Pair& pair) { return !pair.none(); });
  };
  CHECK(!found(2, 0.3));
  CHECK(found(2, 0.6));  // [m] up
  CHECK(!found(4, 0.2));
  CHECK(found(4, 0.6));  // [rad] about y: its ends rise by as many metres
}

TEST_CASE("the search finds the pairs that a look at all of them finds, spheres, capsules and boxes of any size") {
  Random random(7);
  const auto draw = [&] { return random.uniform(-1, 1); };
  for (int round = 0; round < 20; ++round) {
    spatial::Scene s;
    spatial::Collision c{.name = "all", .shapes = {}, .law = {}, .neighbours = 100};
    for (int i = 0; i < 40; ++i) {
      const double size = i % 13 == 0 ? 1.5 : 0.2;
      const double x = draw(), y = draw();
      const BodyId body = add_box(s, Vector3d::Constant(size), Vector3d(1.2 * x, 1.2 * y, 1.2 * draw()));
      spatial::Shape shape = box_shape(body, Vector3d::Constant(size));
      if (i % 3 == 1) shape = {body, {{0, 0, 0}}, size / 2};
      if (i % 3 == 2) shape = {body, {{-size, 0, 0}, {size, 0, 0}}, size / 4};
      c.shapes.push_back(shape);
    }
    s.collision(c);
    const SpatialSystem system(s);
    TermsOf<Spatial> terms(system);
    const State x = system.initial_state();
    set_poses(system, 0, x.q, terms.at);
    BroadPhaseOf<Spatial> search(system);
    REQUIRE(search.find(Eigen::VectorXd::Constant(system.dof(), 0.01), terms));
    std::vector<Pair> found, all;
    for (const Pair& pair : terms.pairs)
      if (!pair.none() && pair.point == 0) found.push_back(pair);
    const auto& shapes = system.scene().collisions[0].shapes;
    for (int a = 0; a < 40; ++a)
      for (int b = a + 1; b < 40; ++b) {
        const Pair pair{0, a, b, 0};
        const spatial::TouchPoints points = touch(system.scene().collisions[0], pair, terms.at);
        for (int i = 0; i < points.count; ++i)
          if (points.points[static_cast<std::size_t>(i)].gap <= 0) {
            all.push_back(pair);
            break;
          }
      }
    CHECK(std::is_sorted(found.begin(), found.end()));
    for (const Pair& pair : all) CHECK(std::binary_search(found.begin(), found.end(), pair));
    CHECK(all.size() > 10);
    CHECK(found.size() < shapes.size() * (shapes.size() - 1) / 2);
  }
}

TEST_CASE("a searched pair of spheres moves as a listed one") {
  const auto scene = [](bool searched) {
    spatial::Scene s;
    s.gravity = {0, 0, -9.81};
    const Eigen::Matrix3d J = Vector3d::Constant(0.4 * 0.01).asDiagonal();
    s.body({.name = "low", .inertia = J, .position = {0, 0, 0.1}});
    s.body({.name = "high", .inertia = J, .position = {0.05, 0.02, 0.5}, .omega = {3, 1, 2}});
    for (int i = 0; i < 2; ++i)
      s.contact(spatial::SpherePlane{
          "floor" + std::to_string(i), i, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = 0.4, .e = 0.3}});
    const ContactLaw law{.mu = 0.3, .e = 0.5};
    if (searched)
      s.collision({.name = "touch", .shapes = {{0, {{0, 0, 0}}, 0.1}, {1, {{0, 0, 0}}, 0.1}}, .law = law});
    else
      s.contact(spatial::SphereSphere{"touch", 0, {0, 0, 0}, 0.1, 1, {0, 0, 0}, 0.1, law});
    return SpatialSystem(s);
  };
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle"}) {
    const Run one = run_in_space(scene(true), scheme, 1e-3, 1), other = run_in_space(scene(false), scheme, 1e-3, 1);
    CHECK((one.final.q - other.final.q).lpNorm<Eigen::Infinity>() < 1e-11);
    CHECK((one.final.v - other.final.v).lpNorm<Eigen::Infinity>() < 1e-11);
  }
}

TEST_CASE("stacks stay: a tower of planks, a pyramid of cubes, a house of cards") {
  for (const auto& [scene, name] :
       {std::pair{kapla_tower(), "tower"}, std::pair{box_pyramid(), "pyramid"}, std::pair{card_house(), "house"}})
    for (const std::string_view scheme : kStackers) {
      CAPTURE(name);
      CAPTURE(scheme);
      const SpatialSystem system(scene);
      const Run run = run_in_space(system, scheme, scene.step, kSanitized ? 0.01 : 0.1);
      CHECK(moved(system, run.final) < 1e-4);
      CHECK(run.max_penetration < 1e-5);
    }
}

TEST_CASE("a box that slides off a table tips over its edge: nothing carries the part beside the table") {
  // Truth: the box about the table's edge as an ordinary differential equation, from x = 0 on.
  constexpr double kX = 0.13527, kZ = 0.04261;
  for (const std::string_view scheme : kStackers)
    for (const double h : {1e-3, 2.5e-4}) {
      CAPTURE(scheme);
      CAPTURE(h);
      spatial::Scene s;
      s.gravity = {0, 0, -9.81};
      const Vector3d size(0.4, 0.3, 0.2);
      const BodyId box =
          s.body({.inertia = spatial::box(size).inertia, .position = {-0.05, 0, 0.1}, .velocity = {0.5, 0, 0}});
      spatial::Shape table = box_shape(kGround, {1, 1, 0.2});
      for (Vector3d& p : table.corners) p += Vector3d(-0.5, 0, -0.1);
      s.collision({.name = "table", .shapes = {table, box_shape(box, size)}});
      const SpatialSystem system(s);
      const Run run = run_in_space(system, scheme, h, 0.35);
      CHECK(std::abs(run.final.q[0] - kX) < 1e-5 + 0.5 * h);
      CHECK(std::abs(run.final.q[2] - kZ) < 1e-5 + 0.8 * h);
    }
}

TEST_CASE("a box slides on over the seam of two tiles: no ghost collision") {
  Random random(11);
  const auto draw = [&] { return random.uniform(); };
  for (const double mu : {0.0, 0.1})
    for (int i = 0; i < 12; ++i) {
      const double speed = 0.5 + 4 * draw(), size = 0.05 + 0.3 * draw(), start = -0.3 * draw();
      const double turn = i % 3 == 0 ? 0 : draw();
      CAPTURE(i);
      spatial::Scene s;
      s.gravity = {0, 0, -10};
      const BodyId box = add_box(s, Vector3d::Constant(size), {start, 0, size / 2}, {speed, 0, 0});
      s.bodies[0].orientation = quaternions::exponential(Vector3d(0, 0, turn)).normalized();
      spatial::Shape left = box_shape(kGround, {4, 4, 1}), right = left;
      for (Vector3d& p : left.corners) p += Vector3d(-2, 0, -0.5);
      for (Vector3d& p : right.corners) p += Vector3d(2, 0, -0.5);
      s.collision(
          {.name = "tiles", .shapes = {box_shape(box, Vector3d::Constant(size)), left, right}, .law = {.mu = mu}});
      const SpatialSystem system(s);
      const Run run = run_in_space(system, "moreau-jean", 1e-3, 0.2);
      CHECK(std::abs(run.final.q[0] - (start + speed * 0.2 - mu * 5 * 0.04)) < 1e-5);
      CHECK(std::abs(run.final.v[0] - (speed - mu * 10 * 0.2)) < 1e-8);
    }
}

TEST_CASE("a cube that falls with an edge along the seam of two boxes lands") {
  for (const char* scheme : {"moreau-jean", "stewart-trinkle", "paoli-schatzman"})
    for (const double beside : {0.0, 1e-12, 1e-9, 1e-7, 1e-5, -1e-5, 1e-3}) {
      CAPTURE(scheme);
      CAPTURE(beside);
      spatial::Scene s;
      s.gravity = {0, 0, -10};
      const BodyId cube = add_box(s, Vector3d::Constant(0.2), {beside, 0, 0.2}, {0, 0, -1});
      s.bodies[0].orientation = quaternions::exponential(Vector3d(0, std::numbers::pi / 4, 0)).normalized();
      spatial::Shape left = box_shape(kGround, {2, 4, 1}), right = left;
      for (Vector3d& p : left.corners) p += Vector3d(-1, 0, -0.5);
      for (Vector3d& p : right.corners) p += Vector3d(1, 0, -0.5);
      s.collision(
          {.name = "all", .shapes = {box_shape(cube, Vector3d::Constant(0.2)), left, right}, .law = {.mu = 0.5}});
      const SpatialSystem system(s);
      const Run run = run_in_space(system, scheme, 1e-3, 0.6);
      CHECK(run.final.q[2] > 0.09);
      CHECK(run.max_penetration < 2e-3);
    }
}

TEST_CASE("Euler's disc goes round at its tilt, with the period of the closed form") {
  const EulerDisc p{.mu = 10};
  const double tilt = p.tilt * std::numbers::pi / 180, Omega = std::sqrt(4 * p.g / (p.radius * std::sin(tilt)));
  const double period = 2 * std::numbers::pi / Omega;
  double before = 0;
  for (const double steps : {400.0, 800.0}) {
    const SpatialSystem system(euler_disc(p));
    const Run run = run_in_space(system, "moreau-jean", period / steps, period);
    const double height = std::abs(run.final.q[2] - p.radius * std::sin(tilt)) / p.radius;
    const Vector3d axis = poses_of(system, run.final).at(0).turn(Vector3d::UnitZ());
    const Vector3d start(-std::sin(tilt), 0, std::cos(tilt));
    const double off = (axis - start).norm() + height;
    CHECK(off < 4e-2);
    if (before > 0) CHECK(off < 0.6 * before);
    before = off;
  }
}

TEST_CASE("a rattleback turns back when spun the wrong way, and only then") {
  for (const double spin : {-5.0, 5.0}) {
    const SpatialSystem system(rattleback({.spin = spin}));
    double least = spin, most = spin;
    const auto note = [&](const SpatialSample& moment) {
      const double now = world_omega(system, moment.state, 0).z();
      least = std::min(least, now), most = std::max(most, now);
    };
    const Run run = run_in_space(system, "moreau-jean", 1e-4, 8, note);
    CHECK(run.energy_final < run.energy_initial * (1 + 1e-3));
    if (spin < 0)
      CHECK(most > 2);
    else
      CHECK(least > 0);
  }
}

TEST_CASE("a cylinder stands, a cone and a capsule lie still; rows of rims keep their gaps") {
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  const spatial::Solid can = spatial::cylinder(0.1, 0.4);
  const auto body = s.body({.name = "can", .inertia = can.inertia, .position = {0, 0, 0.2}});
  spatial::RimPlane rim{.name = "rim", .a = body, .centre = {0, 0, -0.2}, .radius = 0.1, .law = {.mu = 0.3}};
  s.contact_set(spatial::standing_rim(rim));
  const SpatialSystem system(s);
  const Run run = run_in_space(system, "moreau-jean", 1e-3, 0.5);
  CHECK(moved(system, run.final) < 1e-9);
}

TEST_CASE("spheres poured into a well stay in it, and the floor and walls carry their weight in the mean") {
  const Spheres p{.count = 27};
  const SpatialSystem system(spheres(p));
  const auto scheme = make_integrator("moreau-jean", system);
  const auto solver = make_solver("prox:tolerance=1e-8");
  State x = system.initial_state();
  const double momentum = [&] {
    double sum = 0;
    for (int i = 0; i < p.count; ++i) sum += system.mass()[6 * i];
    return sum * p.g;
  }();
  const double h = 2e-3;
  double lifted = 0, counted = 0;  // impulse along z, over the time after the fall
  for (int k = 0; k < 300; ++k) {
    const Eigen::VectorXd before = x.v;
    REQUIRE(scheme->step(h, *solver, x).status == Status::solved);
    if (k < 150) continue;
    counted += h;
    for (int i = 0; i < p.count; ++i) lifted += system.mass()[6 * i] * (x.v[6 * i + 2] - before[6 * i + 2] + p.g * h);
  }
  CHECK(lifted / counted == doctest::Approx(momentum).epsilon(0.02));
  for (int i = 0; i < p.count; ++i) {
    const double width = 3 * 2.2 * p.radius;
    for (int k = 0; k < 3; ++k) CHECK(x.q[7 * i + k] > 0.85 * p.radius);
    for (int k = 0; k < 2; ++k) CHECK(x.q[7 * i + k] < width - 0.85 * p.radius);
  }
}

TEST_CASE("spheres that fall in close layers: momentum of sweeps that circles is left out, every step has its answer") {
  for (const int count : {100, 200}) {
    const SpatialSystem system(pour({.count = count, .apart = 1.001, .spread = 0.001}));
    const auto scheme = make_integrator("moreau-jean", system);
    const auto solver = make_solver("nncg:tolerance=1e-4");
    State x = system.initial_state();
    for (int k = 0; k < 20; ++k) {
      CAPTURE(k);
      REQUIRE(scheme->step(1e-3, *solver, x).status == Status::solved);
    }
  }
}

TEST_CASE("spheres of many sizes that fall in close layers: sweeps that circle without momentum are combined") {
  const SpatialSystem system(pour({.count = 100, .apart = 1, .spread = 0.01}));
  const auto scheme = make_integrator("moreau-jean", system);
  const auto solver = make_solver("nncg:tolerance=1e-4");
  State x = system.initial_state();
  for (int k = 0; k < 30; ++k) {
    CAPTURE(k);
    REQUIRE(scheme->step(2e-3, *solver, x).status == Status::solved);
  }
}

TEST_CASE("a capsule that falls on the corner of a cube stops on it, in every fixed-step scheme") {
  const double top = std::sqrt(3) * 0.2;  // [m] of the corner
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  const auto rod = s.body({.name = "rod", .inertia = 0.01 * Eigen::Matrix3d::Identity(), .position = {0, 0, 0.6}});
  const Eigen::Matrix3d R = Eigen::Quaterniond::FromTwoVectors(Vector3d(1, 1, 1), Vector3d::UnitZ()).toRotationMatrix();
  spatial::Shape cube{.body = kGround, .corners = spatial::box_corners({0.2, 0.2, 0.2})};
  for (Vector3d& p : cube.corners) p = R * p;
  s.collision({.name = "c", .shapes = {{rod, {{-0.3, 0, 0}, {0.3, 0, 0}}, 0.1}, cube}, .law = {}});
  const SpatialSystem system(s);
  for (const char* scheme :
       {"moreau-jean", "stewart-trinkle", "anitescu-potra", "paoli-schatzman", "generalized-alpha", "rattle"}) {
    CAPTURE(scheme);
    const Run run = run_in_space(system, scheme, 1e-3, 0.4);
    CHECK(std::abs(run.final.q[2] - (top + 0.1)) < 2e-3);
    CHECK(run.final.v.norm() < 1e-9);
  }
}
