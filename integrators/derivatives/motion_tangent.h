// integrators/derivatives/motion_tangent.h — derivatives of the motion itself: variational equations and saltation.
//
//   The motion by event-driven (planar), and δ = ∂(q, v)/∂p at a fixed time along it.
//   Between events   δ̇ = ∂f δ + ∂f/∂p, f the smooth motion in the contacts' modes: the Runge–Kutta step of each arc,
//                    projections included, is differentiated along (δ, 1) by differences of fourth order
//   At an event      with the guard φ, the reset R (impact, projection):
//                      δt = −(φ_x δ⁻ + φ_p) / φ̇⁻,   δ⁺ = R_x (δ⁻ + f⁻ δt) + R_p − f⁺ δt                         (1)
//                    φ: the gap that closes; the slip that stops; μ_static λ_N − |λ_T| where slip begins and f jumps.
//                    Releases, and slip that begins with μ_static = μ, leave f continuous: δ⁺ = δ⁻. A load that jumps
//                    at a breakpoint: δt is that of the breakpoint.
//   At the start     joints are closed as simulate() does. Impacts there are events as others. Contacts that last from
//                    there on: changes of their gaps and rates are taken away along their pushes, n − σ μ t of those
//                    that slide, the limit of a short flight. Such derivatives are one-sided (warnings).
//   Transversality   φ̇⁻ must not be 0. A contact that is touched without a velocity (a graze; slower than rounding of
//                    the gap leaves) has no derivative, nor do contacts that strike together and part with the
//                    parameter, nor crowds of events, nor normals that jump. Near a graze the growth of δ is reported.
//   Accumulations end with a plastic impact of bounces of some 1e-14 m, as the motion itself does: the derivative
//   misses a part of their order.
//   μ = 0            the derivative of μ → 0+: begun_friction.h. Contacts that strike or rest without a slip have none.
//   Cost: for each parameter four evaluations of each step.
//   Source: Müller, Chaos, Solitons & Fractals 5 (1995) 1671-1681 (jump conditions of the linearized equations);
//   Leine & Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems (2004), ch. 7.
#pragma once

#include <orthant/integrators/derivatives/parameter_change.h>
#include <orthant/integrators/event_driven/event_driven.h>

#include <atomic>
#include <functional>
#include <string>
#include <vector>

namespace orthant {

/// An event with a guard.
struct CrossedGuard {
  double t = 0;  // [s]
  EventKind kind = EventKind::impact;
  int contact = 0;
  double rate = 0;            // φ̇⁻ [m/s], of slips [m/s²]
  std::vector<double> moves;  // δt [s per unit of each parameter]
};

struct MotionTangent {
  Status status = Status::solved;
  std::string why;
  State final;
  Eigen::MatrixXd q, v;  // dof × parameters
  std::vector<CrossedGuard> guards;
  /// Where there is no derivative, in words: a graze, contacts that part, a crowd. Empty: there is one.
  std::string none;
  /// Of derivatives that are one-sided or grow fast, in words.
  std::vector<std::string> warnings;
};

/// Called at the start and every `every` seconds, and at the end. Where no parameter changes the scene it may replace
/// the tangents by other ones at this state: they go on from there.
using MotionRecorder = std::function<void(const State&, Eigen::MatrixXd& dq, Eigen::MatrixXd& dv)>;

/// Throws std::invalid_argument as differentiate_run() does, std::runtime_error for impacts by another law than
/// Newton's.
MotionTangent differentiate_motion(const System& system, const std::vector<RunParameter>& parameters,
                                   const EventDrivenOptions& options, Solver& solver, double duration,
                                   double every = kInf, const MotionRecorder& record = {},
                                   const std::atomic<bool>* cancel = nullptr);

}  // namespace orthant
