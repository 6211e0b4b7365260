// Redundant joints: told in words, told apart from singular poses, and without influence on the motion.
#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

#include <orthant/core/mechanics/dynamics/redundancy.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/pendulum.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>

using namespace orthant;

namespace {

Redundancy at_start(const System& system) { return find_redundancy(system, system.initial_state().q); }

/// Three equal cranks under one coupler: the third and its pins are not needed, in any pose.
Scene three_cranks() {
  Scene s = n_four_bar({.loops = 2});
  s.joints.clear(), s.bodies.resize(3);
  s.gravity = {0, -9.81};
  const auto coupler = s.body({.name = "coupler", .mass = 2, .inertia = 1, .position = {1, 1}, .velocity = {1, 0}});
  for (int i = 0; i < 3; ++i) {
    s.joint(Revolute{"foot" + std::to_string(i), kGround, i, {i, 0}, {0, -0.5}});
    s.joint(Revolute{"head" + std::to_string(i), i, coupler, {0, 0.5}, {i - 1.0, 0}});
  }
  return s;
}

template <class Change> double difference(const Scene& scene, std::string_view integrator, Change&& change) {
  Scene other = scene;
  change(other.joints);
  const Run a = run_for(scene, 1.5, integrator, 1e-3), b = run_for(other, 1.5, integrator, 1e-3);
  REQUIRE(a.status == Status::solved);
  REQUIRE(b.status == Status::solved);
  return (a.final.q - b.final.q).lpNorm<Eigen::Infinity>();
}

}  // namespace

TEST_CASE("redundant joints are named, with rows and rank") {
  const System free(n_four_bar());
  CHECK(at_start(free).dependent.empty());
  CHECK(at_start(free).dof == 1);
  CHECK(describe(at_start(free), free).empty());

  const System cranks(three_cranks());
  const Redundancy r = at_start(cranks);
  CHECK(r.rows == 12);
  CHECK(r.rank == 11);
  CHECK(r.dof == 1);
  CHECK(r.redundant());
  CHECK(!r.singular());
  REQUIRE(r.dependent.size() == 1);
  CHECK(r.dependent[0].row >= 8);  // of the third crank
  CHECK(
      describe(r, cranks).starts_with("the joints' 12 rows have rank 11, which leaves 1 degree of freedom; row y of "
                                      "joint \"head2\" repeats what joints \"foot0\", \"head0\""));

  Scene twice = pendulum();
  twice.joint(std::get<Distance>(twice.joints[0]));
  std::get<Distance>(twice.joints[1]).name = "again";
  const System doubled(twice);
  CHECK(describe(at_start(doubled), doubled) ==
        "the joints' 2 rows have rank 1, which leaves 2 degrees of freedom; row length of joint \"again\" repeats what "
        "joint \"rod\" already says");
}

TEST_CASE("rows that ask for something else than those before them contradict, and a drive's row is its motion") {
  Scene scene = pendulum();
  auto longer = std::get<Distance>(scene.joints[0]);
  longer.name = "longer", longer.length += 0.1;
  scene.joint(longer);
  const System twice(scene);
  CHECK(at_start(twice).dependent.at(0).contradicts);
  CHECK(describe(at_start(twice), twice)
            .find("row length of joint \"longer\" contradicts what joint \"rod\" already says") != std::string::npos);

  Scene driven;
  driven.body({.name = "wheel"});
  driven.joint(Revolute{"axle", kGround, 0});
  for (const double rate : {2.0, 3.0}) driven.joint(Drive{"", Angle{kGround, 0}, {.rate_of_change = rate}});
  const System motors(driven);
  CHECK(describe(at_start(motors), motors).find("row motion of joint \"joint3\" contradicts what joint \"joint2\"") !=
        std::string::npos);
}

TEST_CASE("a singular pose is distinguished from permanently redundant rows") {
  NFourBar p{.loops = 1};
  Scene flat = n_four_bar(p);  // all rods in one line: cranks to the right, the coupler beyond
  for (int i = 0; i < 2; ++i)
    flat.bodies[static_cast<std::size_t>(i)].position = {i + 0.5, 0},
    flat.bodies[static_cast<std::size_t>(i)].angle = -std::acos(0.0);
  flat.bodies[2].position = {1.5, 0};
  const System system(flat);
  const Redundancy r = at_start(system);
  CHECK(r.rank == 7);
  CHECK(r.singular());
  CHECK(!r.redundant());
  CHECK(describe(r, system).find("in this singular pose") != std::string::npos);
  flat.joint(Revolute{"copy", kGround, 0, {0, 0}, {0, -0.5}});
  const System both(flat);
  CHECK(at_start(both).singular());
  CHECK(at_start(both).redundant());
  CHECK(at_start(both).dependent.size() == 3);
}

TEST_CASE("the motion does not depend on the order of redundant joints, nor on how often they are said") {
  for (const char* integrator : {"moreau-jean", "rattle"})
    for (const Scene& scene : {three_cranks(), n_four_bar()}) {
      CAPTURE(integrator);
      CHECK(difference(scene, integrator, [](auto& joints) { std::reverse(joints.begin(), joints.end()); }) < 1e-10);
      CHECK(difference(scene, integrator,
                       [](auto& joints) { std::rotate(joints.begin(), joints.begin() + 2, joints.end()); }) < 1e-10);
      CHECK(difference(scene, integrator, [](auto& joints) {
              for (std::size_t i = 0, n = joints.size(); i < n; ++i) {
                joints.push_back(joints[i]);
                std::visit([](auto& j) { j.name += "_copy"; }, joints.back());
              }
            }) < 1e-10);
    }
}

TEST_CASE(
    "joint friction with a load shared by other joints is reported; copies of its own joint do not count as others") {
  const auto words = [](Scene s) {
    const System system(std::move(s));
    return describe(at_start(system), system);
  };
  Scene cranks = three_cranks();
  cranks.friction({"bearing", Angle{kGround, 0}, 0, 0.1, 0.01, 0});
  CHECK(words(cranks).find("the load of joint \"foot0\", on which friction \"bearing\" depends, is not determined") !=
        std::string::npos);
  Scene wheel;
  wheel.body({.name = "wheel"});
  wheel.joint(Revolute{"axle", kGround, 0}), wheel.joint(Revolute{"axle_too", 0, kGround});
  wheel.friction({"bearing", Angle{kGround, 0}, 0, 0.1, 0.01, 0});
  CHECK(words(wheel).find("repeat what joint \"axle\" already says") != std::string::npos);
  CHECK(words(wheel).find("load") == std::string::npos);
}

TEST_CASE("copies of a joint share its force") {
  Scene scene = three_cranks();
  const System once(scene);
  const auto joints = scene.joints;
  for (Joint j : joints) {
    std::visit([](auto& x) { x.name += "_copy"; }, j);
    scene.joint(j);
  }
  const System twice(scene);
  const State x = once.initial_state();
  const auto a = testing::accelerations(once, x.q, x.v), b = testing::accelerations(twice, x.q, x.v);
  CHECK(testing::mismatch(b.x, a.x) < 1e-12);
  CHECK(testing::mismatch(b.lambda.head(12), a.lambda / 2) < 1e-10);
  CHECK(testing::mismatch(b.lambda.tail(12), a.lambda / 2) < 1e-10);
}

TEST_CASE("redundant cranks of unlike masses: no rounding makes their rows independent in any pose") {
  const std::array<double, 4> masses{24.883, 0.0197, 0.0929, 4.516};
  constexpr double kApart = 0.1144, kHalf = 0.178, kTurned = 0.7;
  const Vector2d base(std::cos(kTurned), std::sin(kTurned));
  Scene s;
  const auto coupler = s.body({.mass = 0.163, .inertia = 0.00165});
  for (int i = 0; i < 4; ++i) {
    const double mass = masses[static_cast<std::size_t>(i)];
    const auto crank = s.body({.mass = mass, .inertia = mass * kHalf * kHalf / 3});
    s.joint(Revolute{"", kGround, crank, i * kApart * base, {-kHalf, 0}});
    s.joint(Revolute{"", crank, coupler, {kHalf, 0}, {(i - 1.5) * kApart, 0}});
  }
  const System system(s);
  BasicSystem basic(system);
  Terms terms(system);
  Eigen::VectorXd q(system.dof());
  for (int k = 0; k < 500; ++k) {
    INFO(k);
    const double angle = kTurned + 0.5 + 0.004 * k;
    const Vector2d arm = kHalf * Vector2d(std::cos(angle), std::sin(angle));
    q.head<3>() << 1.5 * kApart * base + 2 * arm, kTurned;
    for (int i = 0; i < 4; ++i) q.segment<3>(3 * i + 3) << i * kApart * base + arm, angle;
    set_poses(system, 0, q, terms.at);
    evaluate_joint_rows(system, terms);
    REQUIRE(basic.factorize(system, terms));
    CHECK(basic.rank() == 14);  // of 16
    CHECK(basic.independence() > 1e-3);
  }
}
