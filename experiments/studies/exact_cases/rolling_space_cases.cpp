// Rolling and sliding bodies in space: tippe-top and rattleback by a second method, a ball in a vertical cylinder.
#include "experiments/studies/exact_cases/reference_motion.h"
#include "experiments/studies/exact_cases/space_groups.h"

#include <orthant/core/scenes/rattleback.h>

namespace orthant {
namespace {

using Energy = ExactCase::Energy;
using System = SystemOf<Spatial>;
using Real33 = Eigen::Matrix<Real, 3, 3>;

/// Tippe-top: a sphere of radius R on a rough table, its mass centre at a below the middle along its axis e.
struct TippeTop {
  double R = 0.02, a = 0.003, mass = 0.006, across = 8e-7, along = 7e-7, mu = 0.1, g = 9.81;
  double spin = 150, tilt = 1;  // [rad/s, rad]
};

/// y = (v_x, v_y, L, e), L about the mass centre, e from there to the middle of the sphere. With r = a e − R z, slip
/// u = v + ω × r, F = −μ N u/|u|:  L̇ = r × (N z + F),  ė = ω × e,  m v̇ = F;  z = R − a e_z gives N.
RealVector rate_of(const TippeTop& p, const RealVector& y) {
  const Real A = p.across, C = p.along, a = p.a;
  const Real3 L = y.segment<3>(2), e = y.tail<3>(), up(0, 0, 1);
  const Real3 omega = L / A + (1 / C - 1 / A) * L.dot(e) * e, e_rate = omega.cross(e), r = a * e - Real(p.R) * up;
  const Real3 v(y[0], y[1], -a * e_rate.z());
  Real3 slip = v + omega.cross(r);
  slip.z() = 0;
  const Real3 push = up - Real(p.mu) * slip / slip.norm(), turn = r.cross(push);
  // ω̇ = steady + N by,  ë_z = of these.
  const Real3 steady = (1 / C - 1 / A) * L.dot(e) * e_rate + (1 / C - 1 / A) * L.dot(e_rate) * e;
  const Real3 by = turn / A + (1 / C - 1 / A) * turn.dot(e) * e;
  const Real3 fixed = steady.cross(e) + omega.cross(e_rate), more = by.cross(e);
  const Real N = Real(p.mass) * (Real(p.g) - a * fixed.z()) / (1 + Real(p.mass) * a * more.z());
  RealVector rate(8);
  rate << N * push.x() / Real(p.mass), N * push.y() / Real(p.mass), N * turn, e_rate;
  return rate;
}

/// Jellett's constant L · r of any sphere with an axis of inertia through its middle, whatever the friction, and the
/// axis itself by the second method.
void tippe_top(std::vector<ExactCase>& all) {
  const TippeTop p;
  const double duration = 0.4;
  const Vector3d e(std::sin(p.tilt), 0, std::cos(p.tilt)), omega(0, 0, p.spin);
  const Vector3d inertia(p.across, p.across, p.along);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(p.tilt, Vector3d::UnitY()).toRotationMatrix();
  const Vector3d L = R * inertia.cwiseProduct(R.transpose() * omega);
  RealVector y(8);
  y << 0, 0, L.cast<Real>(), e.cast<Real>();
  y = extrapolate([p](const RealVector& at) { return rate_of(p, at); }, y, duration, 400);
  const Vector3d axis = y.tail<3>().cast<double>();
  const double jellett = L.dot(p.a * e - p.R * Vector3d::UnitZ());
  spatial::Scene s;
  s.gravity = {0, 0, -p.g};
  const auto top = s.body({.name = "top",
                           .mass = p.mass,
                           .inertia = inertia.asDiagonal(),
                           .position = {0, 0, p.R - p.a * e.z()},
                           .orientation = quaternion_of(R),
                           .omega = omega});
  s.contact(spatial::SpherePlane{"table", top, {0, 0, p.a}, p.R, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = p.mu}});
  all.push_back({.id = "S17",
                 .title = "tippe-top rises while it slips: Jellett's constant, its axis by a second method",
                 .measure = "relative error of the constant and error of the axis at the end",
                 .scene = s,
                 .duration = duration,
                 .h = 1e-3,
                 .error_in_space = [=](const System& system, const State& x) {
                   const auto k = poses(system, x);
                   const Vector3d now = k.at(0).turn(Vector3d::UnitZ()), w = k.rate(0).omega;
                   const Vector3d momentum = p.across * w + (p.along - p.across) * w.dot(now) * now;
                   const double kept = momentum.dot(p.a * now - p.R * Vector3d::UnitZ());
                   return std::abs(kept / jellett - 1) + (now - axis).norm();
                 }});
}

/// Rolling without slip in the body's frame: y = (γ, ω), γ the vertical, r(γ) the contact from the mass centre:
///   (J + m (r² 1 − r rᵀ)) ω̇ = −ω × Jω + m r × (ṙ × ω + ω × (r × ω) + g γ),   γ̇ = γ × ω.
/// Source: Kane & Levinson (1982); Borisov & Mamaev, Physics-Uspekhi 46 (2003) 393.
void rattleback_case(std::vector<ExactCase>& all) {
  const Rattleback p{.spin = -3, .tilt = 10, .mu = 1};
  const spatial::Scene s = rattleback(p);
  const auto& stone = s.bodies[0];
  const auto& table = std::get<spatial::EllipsoidPlane>(s.contacts[0]);
  const Real33 J = stone.inertia.cast<Real>();
  const Real3 S2 = table.semi_axes.cast<Real>().cwiseAbs2(), centre = table.centre.cast<Real>();
  const Real m = stone.mass, g = 9.81;
  const auto rate = [=](const RealVector& y) {
    const Real3 gamma = y.head<3>(), w = y.tail<3>(), turned = gamma.cross(w);
    const Real size = std::sqrt(S2.dot(gamma.cwiseAbs2()));
    const Real3 r = centre - S2.cwiseProduct(gamma) / size;
    const Real3 r_rate = -S2.cwiseProduct(turned) / size +
                         S2.cwiseProduct(gamma) * S2.cwiseProduct(gamma).dot(turned) / (size * size * size);
    const Real33 whole = J + m * (r.squaredNorm() * Real33::Identity() - r * r.transpose());
    const Real3 pull = r_rate.cross(w) + w.cross(r.cross(w)) + g * gamma;
    RealVector d(6);
    d << turned, whole.ldlt().solve(m * r.cross(pull) - w.cross(J * w));
    return d;
  };
  const double duration = 1.5;
  const Eigen::Matrix3d R = quaternions::matrix_of(stone.orientation);
  RealVector y(6);
  y << (R.transpose() * Vector3d::UnitZ()).cast<Real>(), (R.transpose() * stone.omega).cast<Real>();
  y = extrapolate(rate, y, duration, 400);
  const Vector3d omega = y.tail<3>().cast<double>(), vertical = y.head<3>().cast<double>();
  all.push_back({.id = "S18",
                 .title = "rattleback rolls and rattles: reduced equations by a second method",
                 .measure = "error of its angular velocity [rad/s] and of the vertical in its frame",
                 .scene = s,
                 .duration = duration,
                 .h = 2e-3,
                 .energy = Energy::conserved,
                 .error_in_space = [=](const System& system, const State& x) {
                   const auto k = poses(system, x);
                   return (k.at(0).turn_back(k.rate(0).omega) - omega).norm() +
                          (k.at(0).turn_back(Vector3d::UnitZ()) - vertical).norm();
                 }});
}

/// The centre goes round at the constant rate Ω, and its height oscillates:
///   z = −5 g / (2 Ω²) (1 − cos(√(2/7) Ω t)): never lower than 5 g / Ω² below the start.
/// Source: Neimark & Fufaev, Dynamics of Nonholonomic Systems (1972), ch. III; Gualtieri, Tokieda et al., The golfer's
/// dilemma, American Journal of Physics 74 (2006) 497.
void ball_in_cylinder(std::vector<ExactCase>& all) {
  const double path = 1, R = 0.1, Omega = 5, g = 9.81, mass = 0.5;
  const auto at = [=](double t) {
    return Vector3d(path * std::cos(Omega * t), path * std::sin(Omega * t),
                    -5 * g / (2 * Omega * Omega) * (1 - std::cos(std::sqrt(2.0 / 7) * Omega * t)));
  };
  spatial::Scene s;
  s.gravity = {0, 0, -g};
  const auto ball = s.body({.name = "ball",
                            .mass = mass,
                            .inertia = Vector3d::Constant(0.4 * mass * R * R).asDiagonal(),
                            .position = {path, 0, 0},
                            .velocity = {0, Omega * path, 0},
                            .omega = {0, 0, -Omega * path / R}});
  s.contact(spatial::SphereBush{"wall", ball, {0, 0, 0}, R, kGround, {0, 0, 0}, {0, 0, 1}, path + R, {.mu = 1}});
  all.push_back({.id = "S19",
                 .title = "ball rolls in a vertical cylinder: its height oscillates",
                 .measure = "largest position error [m]",
                 .scene = s,
                 .duration = 3,
                 .h = 2e-3,
                 .throughout = true,
                 .energy = Energy::conserved,
                 .error_in_space = [=](const System&, const State& x) { return (place(x) - at(x.t)).norm(); }});
}

}  // namespace

void rolling_cases_in_space(std::vector<ExactCase>& all) {
  tippe_top(all);
  rattleback_case(all);
  ball_in_cylinder(all);
}

}  // namespace orthant
