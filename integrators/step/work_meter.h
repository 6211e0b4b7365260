// integrators/step/work_meter.h — work of drives, loads and moving surfaces between events and in impacts.
//
//   Smooth motion: the power (ContactMotion::power) at three Gauss points of an interval, at positions of Hermite
//   polynomials (whole steps of event-driven: stage_quadrature.h).
//   Impacts: v̄ · M (v⁺ − v⁻) − Σ Λ γ̄ with the mean velocities, which is Σ Λ_i ṡ_i of the drives.
//   Steps of fixed-step schemes: step_work.h.
// Cost: nothing if a scene has none of these; else three factorizations per interval.
#pragma once

#include <orthant/integrators/between_events/contact_watch.h>
#include <orthant/integrators/step/step_work.h>

#include <memory>

namespace orthant {

class WorkMeter : public StepWorkOf<Planar> {
 public:
  explicit WorkMeter(const System& system);

  /// [J] of the smooth motion of length s [s] from a, at the time t, to b, in these modes.
  double over_motion(double t, double s, const MotionPoint& a, const MotionPoint& b,
                     const std::vector<ContactMode>& modes);

  /// The same between two states, whose accelerations it evaluates.
  double over_motion(const State& from, const State& to, const std::vector<ContactMode>& modes);

  /// [J] of an instant: the velocity jumps from `before` to `after` by these impulses at the contacts terms.closed.
  double over_impact(const Terms& terms, const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                     const std::vector<Impulse>& impulses) const;

  /// Makes the next result independent of earlier matrices (BasicSystem::forget).
  void forget();

 private:
  double power(double t, const MotionPoint& p);

  const System& system_;
  std::unique_ptr<ContactMotion> motion_;  // of over_motion()
  MotionPoint point_, from_, to_point_;
  Eigen::VectorXd acceleration_;
};

}  // namespace orthant
