// Dominoes on hinges, and a block held against a moving wall.
#include "experiments/studies/exact_cases/reference_motion.h"
#include "experiments/studies/exact_cases/space_groups.h"

#include <orthant/core/scenes/cross_slope.h>

namespace orthant {
namespace {

using Energy = ExactCase::Energy;
using System = SystemOf<Spatial>;

/// Two dominoes on hinges at their lower front edges; the first falls, its upper edge (two corners) strikes the back of
/// the second. θ from upright. Free:  I θ̈ = m g (H sin θ − b cos θ) / 2,  I = m (H² + b²) / 3, by quadrature of
///   θ̇² = θ̇₀² + m g/I (H (cos θ₀ − cos θ) − b (sin θ − sin θ₀)).
/// Impact at H sin θ = D − b, with h = H cos θ; the edge slides down:
///   Λ = (1 + e) θ̇ / ((h + μ H sin θ + h − μ b) / I),   θ̇₁⁺ = θ̇ − (h + μ H sin θ) Λ / I,   θ̇₂⁺ = (h − μ b) Λ / I.
struct Dominoes {
  double height = 0.05, thickness = 0.008, width = 0.025, apart = 0.028, mass = 0.01;  // [m, kg]
  double push = 3, e = 0.6, mu = 0.15, g = 9.81;                                       // [rad/s]
  double inertia() const { return mass * (height * height + thickness * thickness) / 3; }
  std::function<Real(Real)> rate_after(Real from, Real rate) const {
    return [*this, from, rate](Real to) {
      const Real lift =
          Real(height) * (std::cos(from) - std::cos(to)) - Real(thickness) * (std::sin(to) - std::sin(from));
      return std::sqrt(rate * rate + Real(mass) * Real(g) / Real(inertia()) * lift);
    };
  }
};

struct DominoStrike {
  Real time, angle, first, second;  // [s, rad, rad/s]: of the first at the impact; rates after it
};
DominoStrike strike_of(const Dominoes& p) {
  const Real H = p.height, b = p.thickness, I = p.inertia(), mu = p.mu;
  const Real angle = std::asin((Real(p.apart) - b) / H), h = H * std::cos(angle);
  const auto rate = p.rate_after(0, p.push);
  const Real time = integrate([&](Real at) { return 1 / rate(at); }, 0, angle, 16), before = rate(angle);
  const Real one = h + mu * H * std::sin(angle), other = h - mu * b;
  const Real impulse = (1 + Real(p.e)) * before * I / (one + other);
  return {time, angle, before - one * impulse / I, other * impulse / I};
}

void dominoes(std::vector<ExactCase>& all) {
  const Dominoes p;
  const double H = p.height, b = p.thickness;
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(0.7, Vector3d(0.4, -0.5, 0.8).normalized()).toRotationMatrix();
  const Vector3d forward = Q * Vector3d::UnitX(), across = Q * Vector3d::UnitY(), up = Q * Vector3d::UnitZ();
  spatial::Scene s;
  s.gravity = -p.g * up;
  const Vector3d middle(-b / 2, 0, H / 2);  // from the hinge, in the domino's frame
  for (int i = 0; i < 2; ++i) {
    const Vector3d hinge = i * p.apart * forward;
    const double push = i == 0 ? p.push : 0;
    s.body({.name = i == 0 ? "first" : "second",
            .mass = p.mass,
            .inertia = p.mass / 12 *
                       Vector3d(p.width * p.width + H * H, H * H + b * b, p.width * p.width + b * b).asDiagonal(),
            .position = hinge + Q * middle,
            .orientation = quaternion_of(Q),
            .velocity = push * across.cross(Q * middle),
            .omega = push * across});
    const spatial::Revolute on{.name = i == 0 ? "hinge_1" : "hinge_2",
                               .a = kGround,
                               .b = i,
                               .point_a = hinge,
                               .point_b = -middle,
                               .axis_a = across,
                               .axis_b = Vector3d::UnitY(),
                               .reference_a = up,
                               .reference_b = Vector3d::UnitZ()};
    s.joint(on);
    if (i == 1) s.contact(spatial::Limit{"foot", spatial::Angle(on.angle()), spatial::Limit::Side::lower, 0, {}});
  }
  for (const double side : {-0.5, 0.5})
    s.contact(spatial::SpherePlane{side < 0 ? "left" : "right",
                                   0,
                                   {b / 2, side * p.width, H / 2},
                                   0,
                                   1,
                                   {-b / 2, 0, 0},
                                   {-1, 0, 0},
                                   {.mu = p.mu, .e = p.e}});
  const DominoStrike hit = strike_of(p);
  const double duration = static_cast<double>(hit.time) + 0.003;
  const Real later = Real(duration) - hit.time;
  const auto first = static_cast<double>(angle_after(p.rate_after(hit.angle, hit.first), hit.angle, later));
  const auto second = static_cast<double>(angle_after(p.rate_after(0, hit.second), 0, later));
  all.push_back({.id = "S20",
                 .title = "domino falls and strikes the next, with friction",
                 .measure = "error of both angles 3 ms after the impact [rad]",
                 .scene = s,
                 .duration = duration,
                 .h = duration / 100,
                 .error_in_space = [=](const System& system, const State& x) {
                   return apart(angle(system, x, 0), first) + apart(angle(system, x, 1), second);
                 }});
}

/// A force P holds a block against a wall that moves along itself, level, at v: in the wall's frame that is the block
/// sent across a slope (cross_slope.h) with N = P and the pull m g. When it no longer slips the wall carries it.
void held_block(std::vector<ExactCase>& all) {
  const double mass = 2, g = 9.81, mu = 0.7, press = 45, v = 1.5;
  const double slope = std::atan2(mass * g, press);  // the same ratio of pull and press
  const CrossSlope same{.slope = slope, .mu = mu, .speed = v, .g = std::hypot(g, press / mass)};
  const SlopeStop stop = *stop_on_slope(same);
  spatial::Scene s;
  s.gravity = {0, 0, -g};
  const auto block = s.body({.name = "block", .mass = mass});
  s.load({.name = "hand", .body = block, .force = {0, press, 0}});
  s.contact(spatial::SpherePlane{
      "wall", block, {0, 0, 0}, 0, kGround, {0, 0, 0}, {0, -1, 0}, {.mu = mu, .surface = {.velocity = {v, 0, 0}}}});
  all.push_back({.id = "S21",
                 .title = "block held against a wall that moves along itself: slips down and along, then is carried",
                 .measure = "position error at the end [m]",
                 .scene = s,
                 .duration = 0.6,
                 .h = 1e-2,
                 .energy = Energy::driven,
                 .error_in_space = [=](const System&, const State& x) {
                   return (place(x) - Vector3d(v * x.t - stop.place.x(), 0, stop.place.y())).norm();
                 }});
}

}  // namespace

void wall_cases(std::vector<ExactCase>& all) {
  dominoes(all);
  held_block(all);
}

}  // namespace orthant
