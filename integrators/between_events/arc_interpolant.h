// integrators/between_events/arc_interpolant.h — dense output: the state between the ends of an accepted step.
//
//   On an arc of length s from (q₀, v₀) to (q₁, v₁), x = (t − t₀) / s:
//     a(x) = Σ α_k x^k, k = 0..4, through the accelerations at x = 0, 1/4, 1/2, 3/4, 1,
//     v(x) = v₀ + s Σ α_k x^(k+1) / (k+1) + δv x² (3 − 2x),
//     q(x) = q₀ + s x v₀ + s² Σ α_k x^(k+2) / ((k+1)(k+2)) + δq x² (3 − 2x),
//   where δv and δq make v(1) = v₁, q(1) = q₁. The inner accelerations are those of the equations of motion. The first
//   pass evaluates them at the quintic Hermite polynomial, later passes at the last v(x), q(x). Passes end when these
//   move by less than a tenth of the tolerance. Each pass gains about one order, up to 6 for v and 7 for q.
//   Impulses of lasting contacts: the integrals of the quartics through their forces at the same five points. Where
//   they miss the step's own quadrature by more than the tolerance, of 2, 4, … 32 pieces with five points each.
//   Each state is projected onto the joints and the lasting contacts.
// Cost: 3 to 9 evaluations of the accelerations an arc; then about 30 operations per coordinate and state,
// and the projection.
// Source: Enright, Jackson, Nørsett & Thomsen, ACM Trans. Math. Software 12 (1986) 193-218 (bootstrapped interpolants).
#pragma once

#include <orthant/integrators/between_events/contact_motion.h>
#include <orthant/integrators/integrator.h>

#include <array>

namespace orthant {

/// The smooth motion of an accepted step, before the event at its end.
struct Arc {
  double start = 0, length = 0;            // [s]; length 0: there is none
  Eigen::VectorXd q0, v0, a0, q1, v1, a1;  // at its ends
  std::vector<ContactMode> modes;
  std::vector<Impulse> push;  // [N s] of lasting contacts
  void remember(CheckpointData& memory) { memory(start, length, q0, v0, a0, q1, v1, a1, modes, push); }
};

class ArcInterpolant {
 public:
  explicit ArcInterpolant(const System& system);

  /// tolerance: relative, of v.
  void fit(const Arc& arc, double tolerance);
  /// At t within the arc: q and v.
  void at(double t, Eigen::VectorXd& q, Eigen::VectorXd& v);
  /// [N s] of a lasting contact, from the arc's start to t.
  Impulse impulse(int contact, double t) const;
  /// Of the joints, at the last state.
  const ContactMotion::Residual& residual() const { return residual_; }

  void remember(CheckpointData& memory);

 private:
  static constexpr std::size_t kPoints = 5;
  using Quartic = std::array<double, kPoints>;  // coefficients of 1, x, …, x⁴
  struct Polynomials {                          // of one coordinate
    std::array<double, 7> q{};
    std::array<double, 6> v{};
  };
  struct Force {  // on one piece of the arc
    int contact = 0;
    Quartic normal{}, tangent{};
  };

  static Quartic through(const Quartic& values);
  void begin(const Arc& arc);
  void bend(const Arc& arc);
  double renew();
  void note_forces(std::size_t k);
  void fit_forces(const Arc& arc, double tolerance);
  void add_piece();
  bool divide_forces();
  bool forces_agree(const Arc& arc, double tolerance) const;
  void evaluate(double x, Eigen::VectorXd& q, Eigen::VectorXd& v) const;

  ContactMotion motion_;
  double start_ = 0, length_ = 0;
  ContactMotion::Residual residual_;
  std::vector<Polynomials> of_;
  std::vector<Force> forces_;  // of the lasting contacts, piece by piece
  std::size_t pieces_ = 1;
  std::array<Eigen::VectorXd, kPoints> q_, v_, a_;
  std::array<std::vector<Impulse>, kPoints> push_;  // [N] of lasting contacts
  Eigen::VectorXd trial_q_, trial_v_;
};

}  // namespace orthant
