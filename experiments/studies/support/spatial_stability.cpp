#include "experiments/studies/support/spatial_stability.h"

#include "experiments/runs/warnings.h"

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/scenes/elliptic.h>
#include <orthant/core/scenes/masse.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace orthant {
namespace {

using SpatialSystem = SystemOf<Spatial>;

constexpr double kFall = 9.81;  // [m/s²]

Vector3d place(const State& x, Index body) { return place_of<Spatial>(x.q, body); }
Vector3d velocity(const State& x, Index body) { return translation<Spatial>(x.v, body); }
Vector3d spin_in_world(const SpatialSystem& system, const State& x, int body) {
  KinematicsOf<Spatial> k;
  set_poses(system, x.t, x.q, k);
  return k.at(body).axes * Vector3d(rotation<Spatial>(x.v, body));
}

std::vector<double> decades_of(int from, int to, int stride) {
  std::vector<double> values;
  for (int k = from; from < to ? k <= to : k >= to; k += from < to ? stride : -stride)
    values.push_back(std::pow(10.0, k));
  return values;
}

spatial::Scene timed(spatial::Scene s, double step, double duration) {
  s.step = step, s.duration = duration;
  return s;
}

spatial::Body ball(const char* name, double mass, double radius, const Vector3d& position) {
  return {.name = name,
          .mass = mass,
          .inertia = Vector3d::Constant(0.4 * mass * radius * radius).asDiagonal(),
          .position = position};
}

/// Both balls have the radius r. The heavy one comes along x at 1 m/s, its surface at 0.5 m/s across.
///   p = (1 + e) / (1/m + 1/M);  friction μ p along y, while it slips;  r Δω = −5/2 μ p / mass of each.
SpatialTrial strike(double ratio) {
  constexpr double r = 0.1, e = 0.5, mu = 0.05, kMeets = 0.05037;  // [m], 1, 1, [s]
  spatial::Scene s;
  spatial::Body heavy = ball("heavy", ratio, r, {-2 * r - kMeets, 0, 0});
  heavy.velocity = {1, 0, 0}, heavy.omega = {0, 0, 0.5 / r};
  const BodyId striking = s.body(heavy), light = s.body(ball("light", 1, r, {0, 0, 0}));
  s.contact(spatial::SphereSphere{"between", striking, {0, 0, 0}, r, light, {0, 0, 0}, r, {.mu = mu, .e = e}});
  const double p = (1 + e) / (1 + 1 / ratio), f = mu * p;
  const auto error = [=](const SpatialSystem& system, const State& x) {
    const double all[] = {(velocity(x, 0) - Vector3d(1 - p / ratio, -f / ratio, 0)).norm(),
                          (velocity(x, 1) - Vector3d(p, f, 0)).norm(),
                          (r * spin_in_world(system, x, 0) - Vector3d(0, 0, 0.5 - 2.5 * f / ratio)).norm(),
                          (r * spin_in_world(system, x, 1) - Vector3d(0, 0, -2.5 * f)).norm()};
    return *std::ranges::max_element(all);
  };
  return {timed(s, 1e-4, 0.1), error};
}

SpatialTrial load(double ratio) {
  constexpr double r = 0.1;
  spatial::Scene s;
  s.gravity = {0, 0, -kFall};
  const BodyId low = s.body(ball("low", 1, r, {0, 0, r})), high = s.body(ball("high", ratio, r, {0, 0, 3 * r}));
  const ContactLaw law{.mu = 0.3};
  s.contact(spatial::SpherePlane{"floor", low, {0, 0, 0}, r, kGround, {0, 0, 0}, {0, 0, 1}, law});
  s.contact(spatial::SphereSphere{"between", high, {0, 0, 0}, r, low, {0, 0, 0}, r, law});
  return {timed(s, 1e-3, 0.5), [](const SpatialSystem& system, const State& x) {
            const State start = system.initial_state();
            return std::max((place(x, 0) - place(start, 0)).norm(), (place(x, 1) - place(start, 1)).norm());
          }};
}

/// A free body with the moments 1, 1, `along`:  R(t) = exp(L t) R₀ exp(e₃ ω₃ (1 − along) t).
SpatialTrial poinsot(double along, const Vector3d& spin, double step, double duration) {
  const Eigen::Vector4d start = quaternions::exponential(Vector3d(0.4, -0.3, 0.9));
  const Eigen::Matrix3d R = quaternions::matrix_of(start);
  spatial::Scene s;
  s.body({.name = "body", .inertia = Vector3d(1, 1, along).asDiagonal(), .orientation = start, .omega = R * spin});
  const Vector3d L = R * Vector3d(spin.x(), spin.y(), along * spin.z());
  return {timed(s, step, duration), [=](const SpatialSystem& system, const State& x) {
            const Eigen::Matrix3d exact =
                Eigen::AngleAxisd(L.norm() * x.t, L.normalized()).toRotationMatrix() * R *
                Eigen::AngleAxisd(spin.z() * (1 - along) * x.t, Vector3d::UnitZ()).toRotationMatrix();
            KinematicsOf<Spatial> k;
            set_poses(system, x.t, x.q, k);
            return std::max((k.at(0).turn(Vector3d::UnitX()) - exact.col(0)).norm(),
                            (k.at(0).turn(Vector3d::UnitZ()) - exact.col(2)).norm());
          }};
}

Vector3d momentum(const SpatialSystem& system, const State& x) {
  KinematicsOf<Spatial> k;
  set_poses(system, x.t, x.q, k);
  const Vector3d J = rotation<Spatial>(system.mass(), 0), omega = rotation<Spatial>(x.v, 0);
  return k.at(0).axes * J.cwiseProduct(omega);
}

SpatialTrial free_body(const Vector3d& moments, double step, double duration) {
  spatial::Scene s;
  s.body({.name = "body", .inertia = moments.asDiagonal(), .omega = {1, 1.2, 0.7}});
  return {timed(s, step, duration), [](const SpatialSystem& system, const State& x) {
            const Vector3d before = momentum(system, system.initial_state());
            return (momentum(system, x) - before).norm() / before.norm();
          }};
}

/// The slip u keeps its direction and falls by 7/2 μ g a second; then the ball rolls.
SpatialTrial shot(double step, double duration, const Vector3d& away) {
  const Masse p;
  spatial::Scene s = masse(p);
  s.bodies[0].position += away;
  std::get<spatial::SpherePlane>(s.contacts[0]).plane_point += away;
  return {timed(s, step, duration), [=](const SpatialSystem&, const State& x) {
            const Vector3d v(p.vx, p.vy, 0), slip(p.vx - p.radius * p.wy, p.vy + p.radius * p.wx, 0);
            const double rolls = 2 * slip.norm() / (7 * p.mu * p.g), t = std::min(x.t, rolls);
            const Vector3d a = -p.mu * p.g * slip.normalized();
            const Vector3d exact = Vector3d(0, 0, p.radius) + t * v + t * t / 2 * a + (x.t - t) * (v + t * a);
            return (place(x, 0) - away - exact).norm();
          }};
}

/// Released at 60°: T = 4 K(sin 30°) √(c/g).
SpatialTrial swing(double clearance, int steps) {
  spatial::Scene s;
  s.gravity = {0, 0, -kFall};
  const Vector3d start = clearance * Vector3d(std::sqrt(0.75), 0, -0.5);
  const BodyId body = s.body(ball("ball", 1, 0.05, start));
  s.contact(spatial::Socket{"socket", body, {0, 0, 0}, 0.05, kGround, {0, 0, 0}, 0.05 + clearance, {}});
  const double period = 4 * quarter_period(std::sqrt(0.75)) * std::sqrt(clearance / kFall);
  return {timed(s, period / steps, period),
          [=](const SpatialSystem&, const State& x) { return (place(x, 0) - start).norm() / clearance; }};
}

/// On a circle of radius l sin θ at the rate √(g / (l cos θ)); the ball's inertia has no part in it but its own spin.
SpatialTrial conical(double steps) {
  constexpr double l = 1, tilt = 0.6;
  spatial::Scene s;
  s.gravity = {0, 0, -kFall};
  spatial::Body bob = ball("bob", 1, 0.1, {l * std::sin(tilt), 0, -l * std::cos(tilt)});
  const double rate = std::sqrt(kFall / (l * std::cos(tilt)));
  bob.velocity = {0, rate * l * std::sin(tilt), 0}, bob.omega = {0, 0, rate};
  const Vector3d to_pivot = -bob.position;
  const BodyId body = s.body(bob);
  s.joint(spatial::Spherical{"pivot", kGround, body, {0, 0, 0}, to_pivot});
  return {timed(s, 1e-3, 1e-3 * steps), [=](const SpatialSystem&, const State& x) {
            const Vector3d p = place(x, 0);
            return std::hypot(p.z() + l * std::cos(tilt), std::hypot(p.x(), p.y()) - l * std::sin(tilt));
          }};
}

SpatialTrial bouncing(double steps) {
  spatial::Scene s;
  s.gravity = {0, 0, -kFall};
  const BodyId body = s.body(ball("ball", 1, 0.1, {0, 0, 1.1}));
  s.contact(spatial::SpherePlane{"floor", body, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, {0, 0, 1}, {.e = 1}});
  return {timed(s, 1e-3, 1e-3 * steps), [](const SpatialSystem& system, const State& x) {
            const double before = energy(system, system.initial_state());
            return std::abs(energy(system, x) - before) / std::abs(before);
          }};
}

}  // namespace

std::vector<SpatialStudy> spatial_studies(bool quick) {
  const int stride = quick ? 3 : 1;
  const double most = quick ? 200 : 2000, many = quick ? 1e5 : 1e7;  // steps
  const Vector3d spin(1.5, -0.5, 2), fast = Vector3d(0.1, 0, 1).normalized();
  const auto far = [](double d) { return Vector3d(d, d, 0); };
  return {
      {"mass ratio", "m/s", decades_of(0, 12, stride), strike},
      {"load ratio", "m", decades_of(0, 12, stride), load},
      {"needle", "1", decades_of(0, 12, stride), [=](double r) { return poinsot(1 / r, spin, 1e-2, 4); }},
      {"plate", "1", decades_of(0, 12, stride),
       [](double r) { return free_body(Vector3d(1 / r, 1, 1 + (1 - 1e-9) / r), 1e-2, 4); }},
      {"spin [rad/s]", "1", decades_of(0, 6, stride),
       [=](double w) { return poinsot(1.7, w * fast, 0.02 / w, 20 / w); }},
      {"turn per step [rad]", "1", decades_of(-4, 1, 1),
       [=](double turn) { return poinsot(1.7, 1e3 * fast, 1e-3 * turn, 1e-3 * turn * most); }},
      {"step [s]", "m", decades_of(-1, -7, quick ? 2 : 1),
       [=](double h) { return shot(h, std::min(1.0, most * h), far(0)); }},
      {"clearance [m]", "1", decades_of(-2, -7, quick ? 2 : 1), [=](double c) { return swing(c, quick ? 400 : 2000); }},
      {"distance [m]", "m", decades_of(0, 6, stride), [=](double d) { return shot(1e-3, 1, far(d)); }},
      {"steps of a body",
       "1",
       {many / 100, many},
       [](double n) {
         return free_body({1, 2, 2.6}, 1e-3, 1e-3 * n);
       }},
      {"steps of a pendulum", "m", {many / 100, many}, conical},
      {"steps of a ball", "1", {many / 100, many}, bouncing},
  };
}

SpatialTrialResult run_trial(const SpatialTrial& trial, const std::string& integrator, double limit) {
  SpatialTrialResult result;
  try {
    const SpatialSystem system(trial.scene);
    const auto scheme = make_integrator(integrator, system);
    const auto solver = make_solver("auto");
    const long every = std::max(1L, std::lround(trial.scene.duration / trial.scene.step / 10));
    const Run run =
        simulate(*scheme, *solver,
                 {.step = trial.scene.step, .duration = trial.scene.duration, .every = every, .time_limit = limit});
    result.end = name(run.status), result.why = run.why, result.steps = static_cast<double>(run.steps);
    result.residual = run.max_lcp_residual, result.drift = run.max_joint_residual;
    result.penetration = run.max_penetration, result.seconds = run.seconds;
    result.warned = !warnings_of(system, run, integrator, trial.scene.step).empty();
    result.error = trial.error(system, run.final);
  } catch (const std::invalid_argument& error) {
    result.end = "refused", result.why = error.what();
  }
  return result;
}

}  // namespace orthant
