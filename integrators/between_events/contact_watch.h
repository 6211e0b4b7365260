// integrators/between_events/contact_watch.h — contact watch: finds the end of a lasting contact's mode within a step.
//
//   Watched are λ_N → opening; of a contact that sticks μ λ_N ∓ λ_T → sliding off; of one that slides σ γ_T → stopping.
//   While no mode changes they are smooth functions of the state (contact_motion.h), for any scheme.
//   Known are q, v, a at both ends of the step; at 1/4, 1/2, 3/4 of it the state is that of Hermite polynomials of
//   degree 5 (q) and 3 (v).
//   Between these five points a force is the quartic through its values, a slip the cubic through values and rates of
//   neighbours; the first zero is found by first_crossing.h. The forces' impulses come from the same five values
//   (Boole's rule, weights > 0: forces in the friction cone at all points add up to an impulse in the cone).
//   Cost: 3 evaluations of the accelerations a step. Limits: errors of the polynomials, (ω s)⁴ / 384 of the velocity's
//   amplitude at the most; a dip narrower than a quarter of the step may be overlooked.
//   Source: Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I (1993), II.6; Davis & Rabinowitz,
//   Methods of Numerical Integration (1984), 2.2.
#pragma once

#include <orthant/integrators/between_events/contact_motion.h>
#include <orthant/integrators/between_events/first_crossing.h>
#include <orthant/integrators/integrator.h>

namespace orthant {

struct MotionPoint {  // of a smooth motion: everything known there
  Eigen::VectorXd q, v, a;
  Watched w;
  void remember(CheckpointData& memory) { memory(q, v, a, w); }
  explicit MotionPoint(const System& system)
      : q(Eigen::VectorXd::Zero(system.dof())), v(q), a(q), w(system.contacts()) {}
};

/// a and w at p.q, p.v. False: no accelerations.
bool observe(ContactMotion& motion, double t, MotionPoint& p);

/// Between two points s [s] apart, at x ∈ (0, 1) of the way: q and v, of the Hermite polynomials of degree 5 and 3.
void interpolate(const MotionPoint& a, const MotionPoint& b, double s, double x, MotionPoint& inner);

enum class Watch { gap, force, cone_up, cone_down, slip, approach };  // approach: of a contact that overlaps
struct Sign {                                                         // of an event: this function turned negative
  Watch watch = Watch::gap;
  int contact = 0;
  Crossing crossing;         // x: of the step
  double low = 0, high = 1;  // likewise: it is between these
};

class ContactWatch {
 public:
  explicit ContactWatch(ContactMotion& motion);

  /// Looks into the step of length s [s] from a, at t, to b: accelerations, forces and slips at the inner points, at no
  /// time after `stop` [s]. False: they are not finite.
  bool look(double t, double s, const MotionPoint& a, const MotionPoint& b, double stop = kInf);
  /// In the step looked at last. Without forces: only slips that stop.
  std::optional<Sign> first(bool forces = true) const;

  double value(const Sign& sign, const Watched& w) const;                // ≥ 0 while the mode lasts
  double slack(const Sign& sign) const;                                  // what counts as 0 of it
  Impulse impulse(int contact) const;                                    // [N s] of the step
  const MotionPoint& point(std::size_t i) const { return *points_[i]; }  // i = 0..4, i/4 of the way
  static constexpr std::size_t kPoints = 5;

  std::vector<double> slow;  // [m/s] one per contact: slips taken as none; set before first() and slack()

 private:
  ContactMotion& motion_;
  std::vector<double> weight_;  // [N] of both bodies, one per listed contact; else 0
  std::array<MotionPoint, kPoints - 2> inner_;
  std::array<const MotionPoint*, kPoints> points_{};
  double s_ = 0;
};

}  // namespace orthant
