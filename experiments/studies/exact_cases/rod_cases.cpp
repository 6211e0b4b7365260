// Painlevé's rod in space, and a four-bar mechanism with redundant rows.
#include "experiments/studies/exact_cases/reference_motion.h"
#include "experiments/studies/exact_cases/space_groups.h"

#include <orthant/core/scenes/elliptic.h>
#include <orthant/core/scenes/painleve_rod.h>

namespace orthant {
namespace {

using Energy = ExactCase::Energy;
using Kind = ExactCase::Motion;
using System = SystemOf<Spatial>;

const Eigen::Matrix3d kOblique = Eigen::AngleAxisd(1.1, Vector3d(0.3, -1, 0.5).normalized()).toRotationMatrix();

/// Painlevé's rod (painleve_rod.h) in an oblique plane of space: a body of length 2 with its tip on the floor.
spatial::Scene oblique_rod(const PainleveRod& p) {
  const double c = std::cos(p.angle), s = std::sin(p.angle);
  spatial::Scene scene;
  scene.gravity = kOblique * Vector3d(0, -p.g, 0);
  scene.body({.name = "rod",
              .inertia = Vector3d(0.01, 1.0 / 3, 1.0 / 3).asDiagonal(),
              .position = kOblique * Vector3d(c, s, 0),
              .orientation = quaternion_of(kOblique * Eigen::AngleAxisd(p.angle, Vector3d::UnitZ())),
              .velocity = kOblique * Vector3d(-p.slide - p.omega * s, p.omega * c, 0),
              .omega = kOblique * Vector3d(0, 0, p.omega)});
  scene.contact(spatial::SpherePlane{"tip", 0, {-1, 0, 0}, 0, kGround, {0, 0, 0}, kOblique.col(1), {.mu = p.mu}});
  return scene;
}

void painleve_in_space(std::vector<ExactCase>& all) {
  // The tip slides: y = (x, φ, ẋ, φ̇),  N (1 + 3 c² − 3 μ s c) = g − s φ̇²,  ẍ = μ N,  φ̈ = 3 N (μ s − c).
  const PainleveRod p{.mu = 1};
  const double duration = 0.015;
  const auto rate = [p](const RealVector& y) {
    const Real c = std::cos(y[1]), s = std::sin(y[1]), mu = p.mu;
    const Real N = (Real(p.g) - s * y[3] * y[3]) / (1 + 3 * c * c - 3 * mu * s * c);
    RealVector d(4);
    d << y[2], y[3], mu * N, 3 * N * (mu * s - c);
    return d;
  };
  RealVector y(4);
  y << std::cos(Real(p.angle)), p.angle, -p.slide - p.omega * std::sin(Real(p.angle)), p.omega;
  y = extrapolate(rate, y, duration, 50);
  const Vector3d there = kOblique * Vector3d(static_cast<double>(y[0]), static_cast<double>(std::sin(y[1])), 0);
  all.push_back({.id = "S22",
                 .title = "Painleve's rod in space, one solution: slides, reduced equations by a second method",
                 .measure = "position error at the end [m]",
                 .scene = oblique_rod(p),
                 .duration = duration,
                 .h = 1e-3,
                 .error_in_space = [=](const System&, const State& x) { return (place(x) - there).norm(); }});
  const auto add = [&all](const char* title, const char* word, double omega) {
    all.push_back({.id = "S22",
                   .title = title,
                   .measure = "steps that could not be solved",
                   .scene = oblique_rod({.omega = omega}),
                   .duration = 1e-3,
                   .h = 1e-4,
                   .motion = Kind::instant,
                   .word = word,
                   .error_in_space = [](const System&, const State&) { return 0.0; }});
  };
  add("Painleve's rod in space, no consistent acceleration: named, and velocity-level steps go on", "none", 0);
  add("Painleve's rod in space, two consistent accelerations: named, and velocity-level steps go on", "several", 4);
}

/// Parallelogram of two equal cranks and a coupler on four hinges, three rows more than rank: a pendulum,
///   θ̈ = −w² sin θ,  w² = g (m + M) / ((2/3 m + M) l);   sin(θ/2) = k sn(w t + K, k), k = sin(θ₀/2).
void parallelogram(std::vector<ExactCase>& all) {
  const double l = 0.5, base = 0.8, crank = 1.5, coupler = 2, g = 9.81, start = 1.2;
  const double w = std::sqrt(g * (crank + coupler) / ((2.0 / 3 * crank + coupler) * l));
  const auto theta = [=](double t) {
    const double k = std::sin(start / 2), k_prime = std::cos(start / 2);
    return 2 * std::asin(k * std::sin(amplitude(w * t + quarter_period(k_prime), k_prime)));
  };
  spatial::Scene s;
  s.gravity = kOblique * Vector3d(0, -g, 0);
  const auto rod = [&](const char* name, double mass, double length, const Vector3d& from, const Vector3d& to) {
    const Vector3d along = (to - from) / length;
    Eigen::Matrix3d R;
    R << along, Vector3d::UnitZ().cross(along), Vector3d::UnitZ();
    const double across = mass * length * length / 12;
    return s.body({.name = name,
                   .mass = mass,
                   .inertia = Vector3d(across / 50, across, across).asDiagonal(),
                   .position = kOblique * ((from + to) / 2),
                   .orientation = quaternion_of(kOblique * R)});
  };
  const Vector3d A(0, 0, 0), B(base, 0, 0), down(l * std::sin(start), -l * std::cos(start), 0);
  const auto left = rod("left", crank, l, A, A + down), right = rod("right", crank, l, B, B + down),
             bar = rod("bar", coupler, base, A + down, B + down);
  const auto hinge = [&](const char* name, BodyId a, BodyId b, const Vector3d& on_a, const Vector3d& on_b) {
    const Vector3d axis = Vector3d::UnitZ();
    spatial::Revolute j{.name = name, .a = a, .b = b, .point_a = on_a, .point_b = on_b, .axis_a = axis, .axis_b = axis};
    if (a == kGround) j.point_a = kOblique * on_a, j.axis_a = kOblique.col(2);
    s.joint(j);
  };
  const Vector3d end(l / 2, 0, 0), tip(base / 2, 0, 0);
  hinge("A", kGround, left, A, -end), hinge("B", kGround, right, B, -end);
  hinge("C", left, bar, end, -tip), hinge("D", right, bar, end, tip);
  all.push_back({.id = "S23",
                 .title = "four-bar mechanism in space, three rows more than rank: a pendulum by elliptic functions",
                 .measure = "error of the crank's angle at the end [rad]",
                 .scene = s,
                 .duration = 2.2,
                 .h = 4e-3,
                 .motion = Kind::smooth,
                 .energy = Energy::conserved,
                 .error_in_space = [=](const System& system, const State& x) {
                   const Vector3d along = kOblique.transpose() * poses(system, x).at(0).turn(Vector3d::UnitX());
                   return apart(std::atan2(along.x(), -along.y()), theta(x.t));
                 }});
}

}  // namespace

void rod_cases(std::vector<ExactCase>& all) {
  painleve_in_space(all);
  parallelogram(all);
}

}  // namespace orthant
