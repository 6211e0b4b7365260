// integrators/fixed_step/gap_stepping.h — gap stepping: velocity_stepping.h with the gap held at the end of the step.
//
//   γ_N⁺ ≥ a target of the scheme for each contact, a function of the gap at the end of free flight, q + h v_free,
//   about which rows are linearized: g_N = 0 at q + h v⁺ is γ_N⁺ = γ_N,free − g_N/h.
// All contacts of the scene have that row; those that free flight leaves satisfied are at first left out. Impulses of
// the others may close them: a contact that the solution violates then joins the problem, which is solved again, until
// no contact is violated. So the answer is that of the whole problem, at the cost of the contacts in it.
// A taut rope over a pulley has no direction at the pulley (pulley_watch.h). Where free flight leads an end beyond it,
// its row and gap are linearized about the step's start.
// What joins is nearer than the two surfaces go against each other by themselves, at v and at v_free, and the forces of
// the step move either: a contact that lasts is open by as much from one step to the next. Farther away (a row of balls
// with gaps) a contact that is shut by an impulse is made in the next step, as in the source, so that pairs found by a
// grid are all there are.
#pragma once

#include <orthant/integrators/fixed_step/velocity_stepping.h>
#include <orthant/integrators/step/pulley_watch.h>

#include <vector>

namespace orthant {

template <class Space> class GapSteppingOf : public VelocitySteppingOf<Space> {
 public:
  using ClosedContact = ClosedContactOf<Space>;

 protected:
  using typename VelocitySteppingOf<Space>::Plan;
  GapSteppingOf(const SystemOf<Space>& system, std::string_view name, const Capabilities& can, const Plan& plan)
      : VelocitySteppingOf<Space>(system, name, can, plan),
        ropes_(ropes_over_pulleys(system.scene())),
        rope_start_(system) {}
  using Step = typename VelocitySteppingOf<Space>::Step;

  /// The least γ_N that the scheme lets the contact have where the velocities after the step are v. [m/s]
  virtual double least(const Step& step, const ClosedContact& c, const Eigen::VectorXd& v) const = 0;
  /// The law of what takes part; step.targets is Newton's.
  virtual void set_targets(Step& step) = 0;

  /// [m] Contacts farther open at the end of free flight need not be evaluated at first.
  virtual double reach(const Step& /*step*/) const { return kInf; }

  /// γ_N⁺ that just closes the gap at the end of the step, to first order.
  double closing(const Step& step, const ClosedContact& c) const {
    return apply(c.rows.normal, flight_.data()) - step.terms.gap[c.contact] / step.h;
  }

 private:
  void close(Step& step) final;
  bool missed(Step& step) final;
  void hold_directions(Step& step);

  Eigen::VectorXd flight_;           // v_free
  std::vector<int> ropes_;           // contacts that are ropes over pulleys
  TermsOf<Space> rope_start_;        // rows of ropes at the step's start
  std::vector<ClosedContact> held_;  // of taut ropes whose end flies beyond its pulley, rows of the start
};
extern template class GapSteppingOf<Planar>;
extern template class GapSteppingOf<Spatial>;
using GapStepping = GapSteppingOf<Planar>;

}  // namespace orthant
