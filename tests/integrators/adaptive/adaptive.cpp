// Accuracy of the adaptive scheme: errors follow the tolerance on every scene with an exact answer.
#include "tests/integrators/adaptive/runs_to_tolerance.h"
#include "tests/support/mechanics.h"

#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/scenes/stick_slip.h>

#include <cmath>
#include <numbers>

using namespace orthant;

namespace {

double slider_crank_error(const SliderCrankExact& exact, double tolerance, long* steps = nullptr) {
  const Run r = run_to(slider_crank({.mu = exact.mu, .e = exact.e}), 0.2, tolerance);
  if (steps != nullptr) *steps = r.accepted + r.rejected;
  CHECK(r.max_joint_residual <= 1e-12);
  CHECK(r.max_joint_rate <= 1e-11);  // |v| reaches 150
  CHECK(std::abs(r.final.q[kTheta3]) <= 1e-9);
  return std::abs(r.final.q[kTheta1] - exact.theta1);
}

}  // namespace

TEST_CASE("slider-crank, e <= 0.4: the error stays below the tolerance, from 1e-3 to 1e-10") {
  for (const double tolerance : {1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10}) {
    double worst = 0;
    long most = 0;
    for (const SliderCrankExact& exact : slider_crank_exact())
      if (exact.e <= 0.4) {
        long steps = 0;
        worst = std::max(worst, slider_crank_error(exact, tolerance, &steps));
        most = std::max(most, steps);
      }
    MESSAGE("tolerance " << tolerance << ": worst error " << worst << " rad, steps taken and rejected " << most);
    CHECK(worst <= 0.1 * tolerance);
    CHECK(static_cast<double>(most) <= 250 + 50 * std::log10(1e-3 / tolerance));
  }
}

TEST_CASE("slider-crank, e = 0.9: the motion's sensitivity multiplies the tolerance") {
  for (const SliderCrankExact& exact : slider_crank_exact())
    if (exact.e > 0.4) CHECK(slider_crank_error(exact, 1e-9) <= (exact.mu < 0.1 ? 1e-7 : 3e-6));
}

TEST_CASE("slider-crank with other friction and restitution: two tolerances agree") {
  for (const auto& [mu, e] : {std::pair{0.003, 0.1}, {0.03, 0.25}, {0.2, 0.35}, {0.5, 0.0}}) {
    const Scene scene = slider_crank({.mu = mu, .e = e});
    const double coarse = run_to(scene, 0.2, 1e-6).final.q[kTheta1], fine = run_to(scene, 0.2, 1e-9).final.q[kTheta1];
    CHECK(std::abs(coarse - fine) <= 1e-5);
  }
}

TEST_CASE("scenes with contacts: the error follows the tolerance") {
  const auto error = [](const Scene& scene, double duration, const Motion& exact, double tolerance, Index i = 0) {
    const Run r = run_to(scene, duration, tolerance);
    return std::max(std::abs(r.final.q[i] - exact.x), std::abs(r.final.v[i] - exact.v));
  };
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    CAPTURE(tolerance);
    const BouncingBall half, lively{.e = 0.9}, elastic{.e = 1}, dead{.e = 0};
    CHECK(error(bouncing_ball(half), 1.3, half.at(1.3), tolerance, 1) <= 10 * tolerance);
    CHECK(error(bouncing_ball(half), 2, {}, tolerance, 1) <= tolerance);  // past the accumulation: rests
    CHECK(error(bouncing_ball(lively), 10, {}, tolerance, 1) <= tolerance);
    CHECK(error(bouncing_ball(dead), 2, {}, tolerance, 1) <= tolerance);
    CHECK(error(bouncing_ball(elastic), 20, elastic.at(20), tolerance, 1) <= 20 * tolerance);
    const ImpactOscillator driven, off{.disturbance = 0.1};
    CHECK(error(impact_oscillator(driven), 100.3, driven.at(100.3), tolerance) <= 10 * tolerance);
    CHECK(error(impact_oscillator(off), 300.3, off.at(300.3), tolerance) <=
          10 * tolerance);  // the disturbance dies out
    const StickSlip belt;
    CHECK(error(stick_slip(belt), 16, belt.at(16), tolerance) <= 10 * tolerance + 1e-6);  // see the header's limits
    const CoulombDecay decay;
    CHECK(error(coulomb_decay(decay), 20, decay.at(20), tolerance) <= 10 * tolerance);
    CHECK(error(coulomb_decay(decay), 30, decay.at(30), tolerance) <= 10 * tolerance);
    for (const Incline& p : {Incline{}, Incline{.mu = 0.8, .speed = -2},
                             Incline{.mu = 0.3, .mu_static = 0.6, .speed = 1}, Incline{.mu = 0.4, .speed = 0}})
      CHECK(error(incline(p), 1.5, p.at(1.5), tolerance) <= 10 * tolerance);
  }
}

TEST_CASE("smooth scenes: the error follows the tolerance, joints hold to rounding") {
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    CAPTURE(tolerance);
    const auto check = [&](const Run& r, double error, double factor) {
      CHECK(error <= factor * tolerance + 1e-10);
      CHECK(r.max_joint_residual <= 1e-13);
      CHECK(r.max_joint_rate <= 1e-12);
    };
    const Pendulum p;
    const Run swing = run_to(pendulum(p), 4, tolerance);
    const double theta = p.at(4).x;
    check(swing, (swing.final.q.head<2>() - Vector2d(std::sin(theta), -std::cos(theta))).norm(), 100);
    for (const ChainExact& exact : chain_exact()) {
      const Run r = run_to(chain({.links = exact.links}), exact.t, tolerance);
      check(r, (r.final.q.segment<2>(3 * (exact.links - 1)) - Vector2d(exact.tip[0], exact.tip[1])).norm(), 50);
    }
    const NFourBar bars;
    const Run turns =
        run_to(n_four_bar(bars), 10, tolerance);  // ten times through the poses where all rods are in line
    check(turns, std::abs(turns.final.q[2] + bars.at(10).x), 50);
    CHECK(std::abs(turns.energy_final - bars.energy()) <= 500 * tolerance + 1e-9);
  }
}

TEST_CASE("arcs are of high order, lasting contacts included") {
  const auto steps = [](const Scene& scene, double duration, double tolerance) {
    return run_to(scene, duration, tolerance).accepted;
  };
  CHECK(steps(pendulum(), 4, 1e-10) <= 8 * steps(pendulum(), 4, 1e-5));
  CHECK(steps(coulomb_decay(), 3, 1e-10) <= 4 * steps(coulomb_decay(), 3, 1e-5));  // slides all the time
  CHECK(steps(coulomb_decay(), 3, 1e-10) <= 60);
}

TEST_CASE("corners that strike almost together: followed to the end, within what the exact motion allows") {
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) {
    const Run r = run_to(slider_crank({.omega3 = -0.01}), 0.2, tolerance);
    CHECK(r.final.q[kTheta1] > 18.078);
    CHECK(r.final.q[kTheta1] < 18.084);
    CHECK(r.accepted + r.rejected < 5000);
  }
}

TEST_CASE("curved contacts end where their force does: off a disc, over a polygon's corner, every force in its cone") {
  Scene off{.gravity = {0, -9.81}};  // a particle slides off a disc
  off.body({.inertia = 1e9, .position = {0, 1}, .velocity = {1, 0}});
  off.contact(DiscDisc{"", 0, {0, 0}, 0.5, kGround, {0, 0}, 0.5, {.mu = 0.1}});
  std::vector<std::pair<Scene, double>> scenes = {{off, 0.1}};
  for (const double mu :
       {50.0, 3.0, 1.0, 0.5}) {  // a disc rolls off a step: the contact's curvature jumps at the corner
    Scene over{.gravity = {0, -9.81}};
    over.body({.inertia = 0.5, .position = {-0.5, 1}, .velocity = {0.5, 0}, .omega = -0.5});
    over.contact(DiscPolygon{"", 0, {0, 0}, 1, kGround, {{-3, -2}, {0, -2}, {0, 0}, {-3, 0}}, {.mu = mu}});
    scenes.emplace_back(over, mu);
  }
  for (const auto& [scene, mu] : scenes) {
    const double duration = mu == 0.1 ? 1.2 : 2.2;
    const auto exact = run_for(scene, duration, "event-driven", duration).final.q;
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
      CAPTURE(mu);
      CAPTURE(tolerance);
      double worst = 0;
      const Recorder look = [&, mu = mu](const RunSample& m) {
        for (const Impulse& i : m.impulses) worst = std::max({worst, -i.normal, std::abs(i.tangent) - mu * i.normal});
      };
      const Run r = run_to(scene, duration, tolerance, look, 0.01);
      CHECK((r.final.q - exact).lpNorm<Eigen::Infinity>() <= 10 * tolerance);
      CHECK(worst <= 1e-12);
    }
  }
}

TEST_CASE("a ball against the inside of a ring, no gravity: only the turning of the normal presses it on") {
  // It comes at 60 degrees to the wall; each impact halves its normal speed, each chord spans 2 atan(v_n / v_t).
  constexpr double e = 0.5;
  Scene s{.gravity = {0, 0}, .duration = 8};
  s.body({.position = {0.5, 0}, .velocity = {0, -1}});
  s.contact(Journal{"", 0, {0, 0}, 0.25, kGround, {0, 0}, 1.25, {.e = e}});
  double t = std::sqrt(3) / 2, angle = -std::numbers::pi / 3, normal = e * std::sqrt(3) / 2;
  const double tangential = 0.5;
  for (; normal > 1e-17; normal *= e) {
    angle -= 2 * std::atan2(normal, tangential);
    t += 2 * normal / (normal * normal + tangential * tangential);
  }
  angle -= tangential * (s.duration - t);
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    CAPTURE(tolerance);
    const Run r = run_to(s, s.duration, tolerance);
    CHECK(std::hypot(r.final.q[0] - std::cos(angle), r.final.q[1] - std::sin(angle)) <= 10 * tolerance);
    CHECK(r.accepted + r.rejected < 300);
  }
}

TEST_CASE("contacts that end cost few steps: their gaps begin like t³, and are not taken for ones that close") {
  long steps = 0;
  CHECK(slider_crank_error(slider_crank_exact(0.01, 0).value(), 3e-4, &steps) <= 3e-4);
  CHECK(steps < 250);
}

TEST_CASE("a lever that jams on a wall: the impact leaves no motion, and it stays") {
  Scene s{.gravity = {0, -9.81}};
  const auto lever = s.body({.mass = 1, .inertia = 0.1, .position = {0.5, 0}});
  s.joint(Revolute{"pin", kGround, lever, {0, 0}, {-0.5, 0}});
  s.contact(CornerWall{"", lever, {0.5, -0.1}, kGround, {0, -0.7}, Vector2d(-0.3, 1).normalized(), {.mu = 1.5}});
  const auto exact = run_for(s, 0.6, "event-driven", 0.1).final;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    const Run r = run_to(s, 0.6, tolerance);
    CHECK((r.final.q - exact.q).lpNorm<Eigen::Infinity>() <= 10 * tolerance);
    CHECK(r.final.v.lpNorm<Eigen::Infinity>() <= 1e-12);
  }
  std::get<CornerWall>(s.contacts[0]).law.e = 0.6;  // no impulse of the cone makes it rebound as it should
  CHECK(run_for(s, 0.6, "event-driven", 0.1).why.find("friction jams") != std::string::npos);
}

TEST_CASE("slip that turns round and back between two looks: to tolerance at any output step") {
  Scene s{.gravity = {0, -9.81}};
  const auto box = s.body({.inertia = 0.02, .velocity = {0.6, 0}});
  s.contact(CornerWall{"", box, {0, 0}, kGround, {0, 0}, {0, 1}, {.mu = 0.3}});
  s.load({.body = box, .force = {7.2, 0}, .factor = [](double t) { return -std::sin(12 * t); }, .omega = 12});
  for (const double duration : {0.83, 1.3, 2.0}) {
    const double exact = run_for(s, duration, "event-driven", duration).final.q[0];
    for (const double tolerance : {1e-4, 1e-6, 1e-8})
      for (const double step : {duration, duration / 7}) {
        CAPTURE(duration);
        CAPTURE(tolerance);
        CAPTURE(step);
        CHECK(std::abs(run_to(s, duration, tolerance, {}, step).final.q[0] - exact) <= tolerance / 10);
      }
  }
}

TEST_CASE("a load that swings twelve times in an output step: looks in step with it would see it at rest") {
  Scene s;
  const auto body = s.body({.velocity = {0.6, 0}});
  s.load({.body = body, .force = {-7.2, 0}, .factor = [](double t) { return std::sin(12 * t); }, .omega = 12});
  CHECK(std::abs(run_to(s, 2 * std::numbers::pi, 1e-6).final.q[0]) <= 1e-5);  // 0.05 sin 12 t
}
