// Spinning bodies with exact motions: the free asymmetric body, a coin on its edge.
#include "experiments/studies/exact_cases/reference_motion.h"
#include "experiments/studies/exact_cases/space_groups.h"

#include <orthant/core/scenes/elliptic.h>
#include <orthant/core/scenes/euler_disc.h>

namespace orthant {
namespace {

using Energy = ExactCase::Energy;
using Kind = ExactCase::Motion;
using System = SystemOf<Spatial>;

/// Free body with moments A < B < C that turns about its axes 1 and 3 at the start, with M² > 2 E B:
///   ω = (ω1 cn τ, ω2 sn τ, ω3 dn τ),  τ = p t;   M along Z, Euler's angles z-x-z:
///   cos θ = C ω3 / M,  tan ψ = A ω1 / (B ω2),  φ̇ = M (A ω1² + B ω2²) / ((A ω1)² + (B ω2)²), φ by quadrature.
/// Source: Landau & Lifshitz, Mechanics (1976), § 37.
class AsymmetricBody {
 public:
  AsymmetricBody(const Vector3d& J, double w1, double w3) : J_(J), w1_(w1), w3_(w3) {
    const double E2 = J[0] * w1 * w1 + J[2] * w3 * w3, M2 = std::pow(J[0] * w1, 2) + std::pow(J[2] * w3, 2);
    M_ = std::sqrt(M2);
    w2_ = std::sqrt((E2 * J[2] - M2) / (J[1] * (J[2] - J[1])));
    p_ = std::sqrt((J[2] - J[1]) * (M2 - E2 * J[0]) / (J[0] * J[1] * J[2]));
    k_prime_ = std::sqrt(1 - (J[1] - J[0]) * (E2 * J[2] - M2) / ((J[2] - J[1]) * (M2 - E2 * J[0])));
  }
  Vector3d omega(double t) const {
    const double phi = amplitude(p_ * t, k_prime_), s = std::sin(phi), c = std::cos(phi);
    return {w1_ * c, w2_ * s, w3_ * std::sqrt(c * c + k_prime_ * k_prime_ * s * s)};
  }
  Eigen::Matrix3d turned(double t) const {
    const Vector3d M = J_.cwiseProduct(omega(t));
    const auto rate = [this](Real at) {
      const Vector3d w = omega(static_cast<double>(at));
      const double sum = J_[0] * w[0] * w[0] + J_[1] * w[1] * w[1];
      return static_cast<Real>(M_ * sum / (std::pow(J_[0] * w[0], 2) + std::pow(J_[1] * w[1], 2)));
    };
    const auto phi = static_cast<double>(integrate(rate, 0, t, 12));
    return (Eigen::AngleAxisd(phi, Vector3d::UnitZ()) * Eigen::AngleAxisd(std::acos(M[2] / M_), Vector3d::UnitX()) *
            Eigen::AngleAxisd(std::atan2(M[0], M[1]), Vector3d::UnitZ()))
        .toRotationMatrix();
  }

 private:
  Vector3d J_;
  double w1_, w3_, w2_ = 0, M_ = 0, p_ = 0, k_prime_ = 1;
};

void asymmetric_body(std::vector<ExactCase>& all) {
  const Vector3d J(1, 2, 2.6);
  const AsymmetricBody exact(J, 2.5, 2.6);
  spatial::Scene s;
  s.body({.name = "book",
          .inertia = J.asDiagonal(),
          .orientation = quaternion_of(exact.turned(0)),
          .omega = exact.turned(0) * exact.omega(0)});
  all.push_back({.id = "S15",
                 .title = "free asymmetric body: Jacobi's elliptic functions, 6 s",
                 .measure = "error of its axes at the end",
                 .scene = s,
                 .duration = 6,
                 .h = 0.04,
                 .motion = Kind::smooth,
                 .energy = Energy::conserved,
                 .error_in_space = [=](const System& system, const State& x) {
                   return axes_error(poses(system, x), exact.turned(x.t));
                 }});
}

/// Steady motion of a thin coin of radius R, tilt α, its centre on a circle of radius c inside that of the contact:
///   Ω² = g R cos α / (sin α (A cos α + (C/R + R) c)),  A = R²/4, C = R²/2 per mass;  spin −Ω (c/R + cos α).
/// Source: balance of momentum and angular momentum; O'Reilly, Nonlinear Dynamics 10 (1996) 287.
void coin(std::vector<ExactCase>& all, const char* title, double tilt, double c, double duration, double h) {
  const double R = 0.0375, g = 9.81, mass = 0.44;
  const double Omega =
      std::sqrt(g * R * std::cos(tilt) / (std::sin(tilt) * (R * R / 4 * std::cos(tilt) + 1.5 * R * c)));
  const double spin = -Omega * (c / R + std::cos(tilt));
  const Vector3d up_the_disc(std::cos(tilt), 0, std::sin(tilt)), axis(-std::sin(tilt), 0, std::cos(tilt));
  Eigen::Matrix3d start;
  start << up_the_disc, Vector3d::UnitY(), axis;
  const Vector3d centre(-c, 0, R * std::sin(tilt));
  spatial::Scene s;
  s.gravity = {0, 0, -g};
  const auto disc = s.body({.name = "coin",
                            .mass = mass,
                            .inertia = mass * R * R * Vector3d(0.25, 0.25, 0.5).asDiagonal(),
                            .position = centre,
                            .orientation = quaternion_of(start),
                            .velocity = Omega * Vector3d::UnitZ().cross(centre),
                            .omega = Omega * Vector3d::UnitZ() + spin * axis});
  s.contact(spatial::RimPlane{.name = "edge", .a = disc, .radius = R, .law = {.mu = 0.5}});
  all.push_back({.id = "S16",
                 .title = title,
                 .measure = "largest error of its axes and of its centre over the radius",
                 .scene = s,
                 .duration = duration,
                 .h = h,
                 .throughout = true,
                 .energy = Energy::conserved,
                 .error_in_space = [=](const System& system, const State& x) {
                   const Eigen::AngleAxisd about(Omega * x.t, Vector3d::UnitZ());
                   const Eigen::Matrix3d turned =
                       about.toRotationMatrix() * start * Eigen::AngleAxisd(spin * x.t, Vector3d::UnitZ());
                   return axes_error(poses(system, x), turned) + (place(x) - about * centre).norm() / R;
                 }});
}

}  // namespace

void spinning_cases(std::vector<ExactCase>& all) {
  asymmetric_body(all);
  coin(all, "Euler's disc: rolls on its edge, its centre at rest", kPi / 9, 0, 0.5, 2e-4);
  coin(all, "coin that rolls around a circle", 70 * kPi / 180, 0.1, 1, 1e-3);
}

}  // namespace orthant
