// Event-driven integration through singular poses and with redundant joints.
#include "tests/support/event_record.h"

#include <orthant/core/mechanics/dynamics/redundancy.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/n_four_bar.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

using namespace orthant;

TEST_CASE("bars through the poses where all lie in one line, however often they are looked at") {
  for (const int loops : {1, 2, 3, 5})
    for (const double step : {10.0, 0.1, 1e-2, 1e-3}) {
      if (loops > 2 && step < 1e-2) continue;  // for time
      CAPTURE(loops);
      CAPTURE(step);
      const NFourBar bars{.loops = loops};
      const System system(n_four_bar(bars));
      double defect = 0;
      const Run r = run_for(n_four_bar(bars), 10, kScheme, step, [&](const RunSample& m) {
        defect = std::max(defect, std::abs(energy(system, m.state) - bars.energy()));
      });
      REQUIRE(r.status == Status::solved);
      MESSAGE(loops << " loops, step " << step << ": angle off by " << r.final.q[2] + bars.at(10).x << ", energy by "
                    << r.energy_final - bars.energy() << " J, at worst " << defect << " J, " << r.seconds << " s");
      CHECK(std::abs(r.final.q[2] + bars.at(10).x) <= 1e-8);
      CHECK(std::abs(r.energy_final - bars.energy()) <= 2e-8);
      CHECK(defect <= 1e-6);
      CHECK(r.max_joint_residual <= 1e-11);
      CHECK(r.accepted <= 2000 + 12 / step);
    }
}

TEST_CASE("singular poses are passed with springs in the scene, and with more joint rows than the dense factor takes") {
  const auto end_of = [](const Scene& scene, double duration, double step) {
    const System system(scene);
    const Run r = run_for(scene, duration, kScheme, step);
    REQUIRE(r.status == Status::solved);
    CHECK(std::abs(r.energy_final - r.energy_initial) <= 1e-7);
    return r.final.q[2];
  };
  const NFourBar bars;
  Scene idle = n_four_bar(bars);  // a spring that does no work
  idle.spring(PointSpring{"idle", 0, kGround, {0, 0}, {0, 0}, 0, 0, 1});
  Scene apart = n_four_bar(bars);  // and one that works on a far body
  const BodyId far = apart.body({.mass = 1, .inertia = 1, .position = {50, 0}});
  apart.spring(PointSpring{"far", far, kGround, {0, 0}, {51, 0}, 30, 0, 0.5});
  for (const Scene& scene : {idle, apart}) CHECK(std::abs(end_of(scene, 10, 1e-2) + bars.at(10).x) <= 1e-7);
  const NFourBar eight{.loops = 8, .speed = 2};  // 50 joint rows: the sparse matrix
  CHECK(std::abs(end_of(n_four_bar(eight), 2, 1e-2) + eight.at(2).x) <= 1e-8);
}

TEST_CASE("adaptive keeps the energy where it crosses a singular pose of redundant joints, at all outputs") {
  const Scene s = read_scene(ORTHANT_ROOT "/tests/data/four_cranks_singular.toml");
  const System system(s);
  for (const double step : {2e-5, s.step}) {
    double least = kInf, most = -kInf;
    const Run r = run(s, "adaptive", step, [&](const RunSample& m) {
      const double now = energy(system, m.state);
      least = std::min(least, now), most = std::max(most, now);
    });
    REQUIRE_MESSAGE(r.status == Status::solved, r.why);
    CHECK(r.crossings > 0);
    CHECK(most - least < 2e-6 * r.motion.energy_scale);
  }
}

TEST_CASE("redundant joints: the tolerance holds in one long step as in many, or it says why not") {
  Scene sliders{.gravity = {0, -9.81},
                .duration = 3};  // two on one rail, welded together, on a spring: x = sin(5 t) / 5
  const auto a = sliders.body({.inertia = 0.1, .velocity = {1, 0}});
  const auto b = sliders.body({.inertia = 0.1, .position = {1, 0}, .velocity = {1, 0}});
  sliders.joint(Prismatic{.a = kGround, .b = a});
  sliders.joint(Prismatic{.a = kGround, .b = b});
  sliders.joint(Fixed{.a = a, .b = b, .point_a = {1, 0}});
  sliders.spring(PointSpring{.a = kGround, .b = a, .point_a = {-10, 0}, .stiffness = 50, .rest = 10});
  Scene once{.gravity = {0, -9.81}, .duration = 3};  // a rod on a pin that is there twice
  const auto rod = once.body({.inertia = 1.0 / 12, .position = {0.5, 0}});
  once.joint(Revolute{.a = kGround, .b = rod, .point_b = {-0.5, 0}});
  Scene twice = once;
  twice.joint(Revolute{.a = kGround, .b = rod, .point_b = {-0.5, 0}});
  const auto simple = run(once, kScheme, once.duration).final.q;
  for (const double step : {3.0, 0.3, 0.01}) {
    CAPTURE(step);
    CHECK(std::abs(run(sliders, kScheme, step).final.q[0] - std::sin(15) / 5) <= 1e-9);
    CHECK((run(twice, kScheme, step).final.q - simple).lpNorm<Eigen::Infinity>() <= 1e-8);
  }

  Scene cranks{.gravity = {0, -9.81}, .duration = 1};  // four, parallel: in line at 0.75 s, where they may part
  const Vector2d along(std::cos(0.7), std::sin(0.7)), swing(-along.y(), along.x());
  for (int i = 0; i < 4; ++i)
    cranks.body(
        {.inertia = 1.0 / 12, .position = Vector2d(i, 0) + along / 2, .angle = 0.7, .velocity = swing, .omega = 2});
  const auto coupler = cranks.body({.mass = 2, .position = Vector2d(1.5, 0) + along, .velocity = 2 * swing});
  for (int i = 0; i < 4; ++i) {
    cranks.joint(Revolute{.a = kGround, .b = i, .point_a = {1.0 * i, 0}, .point_b = {-0.5, 0}});
    cranks.joint(Revolute{.a = i, .b = coupler, .point_a = {0.5, 0}, .point_b = {i - 1.5, 0}});
  }
  const double theta = run(cranks, "adaptive:rtol=1e-9", 1).final.q[2];
  for (const double step : {1.0, 0.1, 0.0033, 1e-3}) {
    CAPTURE(step);
    const Run r = run(cranks, kScheme, step);
    if (r.status == Status::solved)
      CHECK(std::abs(r.final.q[2] - theta) <= 1e-6);
    else
      CHECK(r.why.find("singular pose") != std::string::npos);
  }
}

TEST_CASE("three parallel cranks: one row is redundant in every pose, whichever comes out as the dependent one") {
  for (const double turn : {0.0, 1e-6, std::numbers::pi / 2, 1.0}) {
    const Eigen::Rotation2Dd by(turn);
    Scene s{.gravity = by * Vector2d(9.81, 0)};
    BodyId cranks[3];
    for (int i = 0; i < 3; ++i)
      cranks[i] = s.body({.name = "crank" + std::to_string(i),
                          .inertia = 0.02,
                          .position = by * Vector2d(-0.15, i),
                          .angle = turn,
                          .velocity = by * Vector2d(0, -0.3),
                          .omega = 2});
    const BodyId coupler = s.body({.name = "coupler",
                                   .mass = 2,
                                   .inertia = 0.4,
                                   .position = by * Vector2d(-0.3, 1),
                                   .angle = turn,
                                   .velocity = by * Vector2d(0, -0.6)});
    for (int i = 0; i < 3; ++i) {
      s.joint(Revolute{{}, kGround, cranks[i], by * Vector2d(0, i), {0.15, 0}});
      s.joint(Revolute{{}, cranks[i], coupler, {-0.15, 0}, {0, i - 1.0}});
    }
    const System system(s);
    const Redundancy found = find_redundancy(system, system.initial_state().q);
    CAPTURE(turn);
    CHECK(found.rank == 11);
    CHECK_FALSE(found.singular());
    for (const double step : {1e-3, 1e-2, 0.1}) {
      CAPTURE(step);
      const Run r = run_for(s, 0.3, kScheme, step);
      INFO(r.why);
      CHECK(r.status == Status::solved);
      CHECK(std::abs(r.energy_final - r.energy_initial) < 1e-8);
    }
  }
}
