// integrators/fixed_step/velocity_stepping.h — velocity stepping: schemes with one problem at velocity level.
//
//   q_a = q + a h v;  f, G at (t + a h, q_a, v);  the scheme specifies closed contacts and targets of their rates
//   M̂ (v⁺ − v) = h f + Gᵀ Λ_G + W_Nᵀ Λ_N + W_Tᵀ Λ_T,   M̂ = M + h²aθ K + h a C
//   q⁺ = q + h (θ v⁺ + (1−θ) v)
// Springs and dampers are so, linearly implicit, those at q + a (q⁺ − q) and v + a (v⁺ − v): bounded at any step. So is
// what loaded joints give light bodies, where it swings faster than the step shows (geometric_stiffness.h).
// Impacts by another law than Newton's on all contacts at once come first, at v (impact.h); v_free has them then.
// Joints, by the option `joints`:
//   none       G v⁺ = ṡ                      positions drift by O(h) over a fixed time; ṡ = 0 except for driven joints
//   position   G v⁺ = ṡ, then q⁺ is projected onto Φ = 0 (in the metric of M)
//   symmetric  G (a v⁺ + (1−a) v) = ṡ, then q⁺ and v⁺ are projected onto Φ = 0, G v⁺ = ṡ. For a = θ = ½ the smooth
//              motion is of second order; contact impulses act through the constrained inverse and leave G v⁺ as it
//              was.
// A failed solve leaves the state as it was; so does a projection that does not reach the joints, in steps much too
// long, and so do rates that joints which contradict each other leave unmet (`none`: by more than 1e-6 of 1 m/s + the
// bodies').
#pragma once

#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/mechanics/dynamics/geometric_stiffness.h>
#include <orthant/core/mechanics/dynamics/joint_load.h>
#include <orthant/integrators/fixed_step/stuck_contacts.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/formulate.h>
#include <orthant/integrators/step/gyroscopic.h>
#include <orthant/integrators/step/impact.h>
#include <orthant/integrators/step/in_plane.h>
#include <orthant/integrators/step/magnitudes.h>
#include <orthant/integrators/step/projection.h>
#include <orthant/integrators/step/sleep.h>
#include <orthant/integrators/step/spatial_tunnelling.h>
#include <orthant/solvers/linear_algebra/anderson.h>

#include <array>
#include <optional>
#include <string_view>

namespace orthant {

enum class Joints { none, position, symmetric };
inline constexpr std::array<std::string_view, 3> kJointsNames = {"none", "position", "symmetric"};

/// Of the schemes that have no others.
struct VelocitySteppingOptions {
  Joints joints = Joints::symmetric;
  Form form = Form::reduced;
  SleepOptions sleep;
  template <class V> void visit(V&& v) {
    v("joints", joints, kJointsNames), v("form", form, kFormNames);
    v("sleep_after", sleep.after, 0.0, 1e9), v("sleep_speed", sleep.speed, 0.0, 1e3);
  }
};

template <class Space> class VelocitySteppingOf : public IntegratorOf<Space> {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;
  using RateTarget = RateTargetOf<Space>;
  using Impulse = ImpulseOf<Space>;
  using BasicSystem = BasicSystemOf<Space>;
  using ClosedContact = ClosedContactOf<Space>;

  StepReport step(double h, Solver& solver, State& x) final;
  /// From now on a step that friction and restitution leave without a solution ends the run (formulate.h).
  void keep_restitution() { formulation_.let_friction_win(false); }
  void remember(CheckpointData& memory) final;
  const Lcp& problem() const final { return shown_->problem(); }
  std::span<const Pair> pairs() const final { return terms_.pairs; }
  /// Of the last step, for its derivative: the contacts that were closed, and their problem.
  const std::vector<ClosedContact>& closed() const { return terms_.closed; }
  const FormulationOf<Space>& formulation() const { return formulation_; }

 protected:
  struct Plan {
    double at, theta;  // a, θ
    Joints joints;
    Form form;
    Cone cone = Cone::coulomb;
    SleepOptions sleep = {};
    double parted = 0;  // of the way that the applied forces move a body, how far open counts as closed
  };
  VelocitySteppingOf(const System& system, std::string_view name, const Capabilities& can, const Plan& plan);

  /// The step at hand, as its scheme sees it.
  struct Step {
    const System& system;
    const double h;
    const State& x;  // at its start
    Terms& terms;
    std::vector<RateTarget>& targets;  // one per closed contact
    Eigen::VectorXd& v;                // before the contacts act: v_free; then v⁺
    Eigen::VectorXd& q_end;            // room for poses on the way
    std::vector<int>& joined;          // contacts that take part whatever free flight makes of them
    const Magnitudes& near;
    const std::vector<Eigen::Matrix3d>& frames;

    /// [m] Gaps up to this may be the rounding of positions and of the last step's impulses, and what the plan calls
    /// parted.
    double nearly(const ContactRowsOf<Space>& rows) const {
      const double most = near.of(rows.normal);
      return terms.unit == 1 ? most : most * unit_of(rows.normal, terms.unit) / terms.unit;
    }
    double nearly() const { return near.largest() / terms.unit; }  // of any contact, [rad] too

    /// In space rows that are evaluated elsewhere than at q_a are to stand in the frames of the step all the same.
    void set_frames() {
      if constexpr (!kPlanar<Space>)
        for (std::size_t i = 0; i < frames.size(); ++i) terms.at.pose[i].axes = frames[i];
    }
  };

  /// step.terms is at q_a, step.v is v_free: sets step.terms.closed and step.targets.
  virtual void close(Step& step) = 0;

  /// The step is solved, step.v is v⁺. True: the solution violates contacts that close() left out; they are in
  /// step.joined, and step.v is v_free again.
  virtual bool missed(Step& /*step*/) { return false; }

 private:
  using IntegratorOf<Space>::system_;
  using IntegratorOf<Space>::gaps_;
  using IntegratorOf<Space>::impulses_;
  using IntegratorOf<Space>::frictions_;
  using IntegratorOf<Space>::why_;
  using IntegratorOf<Space>::touching;
  using IntegratorOf<Space>::fail;
  using IntegratorOf<Space>::pool;

  void measure(double h, const State& x);  // near_
  /// Free flight again, the joints' geometric stiffness in M̂, where the step needs it.
  bool stiffen(double h, const State& x, StepReport& report);
  /// v_new_ without contact impulses (full form: without any).
  bool free_flight(double h, const State& x, StepReport& report);
  /// The change of v by force_ in the step, with joints such that G (share v + change) = share ṡ; their impulses in
  /// lambda_.
  void change_joined(const Eigen::VectorXd& v, Eigen::VectorXd& change);
  bool factorize(double h, StepReport& report);
  void fly(double h, const State& x);  // v_new_, by basic_
  /// Space: fly(), repeated until the gyroscopic impulses are those of the step without contacts (gyroscopic.h).
  bool fly_gyroscopic(double h, const State& x, StepReport& report);
  bool turn_more(double h, const State& x);
  StepFrames frames(double h) const;
  /// All of the step's impulses in joints, those that contacts cause too: lambda_.
  void find_joint_impulses(double h, const State& x);
  /// Geometric stiffness by the joints' impulses, those caused by contacts included: carried_, for the next step.
  void note_stiffness(double h, const State& x);
  /// The pairs that can be closed in the step, terms_.at being on its way.
  bool find_pairs(double h, const State& x, StepReport& report);
  /// The step's problem and what it does to v_new_. From a new start joints' loads are not known, and are found by
  /// repetition.
  bool solve_contacts(double h, const State& x, Solver& solver, StepReport& report);
  /// The joints' loads in the step, where friction depends on them, for the next one. Returns the largest change [N].
  double note_loads(double h, const State& x);
  /// Projection; joint residual and penetration at the end.
  bool settle(double t, StepReport& report);

  Terms terms_;
  std::vector<RateTarget> targets_;
  Eigen::VectorXd v_new_, q_new_;
  std::vector<int> joined_;
  Plan plan_;
  double share_;       // 1 where joints hold for v⁺; 1 / a where for the mean velocity, a v⁺ + (1−a) v
  BasicSystem basic_;  // of the step: with joints in the reduced form
  ProjectionOf<Space> projection_;
  ImpactOf<Space> impact_;
  Magnitudes near_;  // [m]
  BroadPhaseOf<Space> broad_phase_;
  SleepOf<Space> sleep_;
  TunnellingDetectorOf<Space> tunnelling_;
  StuckContacts<Space> stuck_;
  FormulationOf<Space> formulation_;
  const FormulationOf<Space>* shown_;            // by problem()
  std::vector<ContactWork> taken_;               // by contacts that the scheme pushed
  std::vector<JointLoadOf<Space>> joint_loads_;  // one a friction that depends on a load
  std::vector<double> loads_;                    // [N] of the last step, one a friction; empty: none depends on a load
  Eigen::VectorXd last_q_, last_v_;
  InPlane<Space, GeometricStiffness> geometric_;
  Eigen::VectorXd added_, carried_;          // dof: to M, in this step; by the impulses of the last
  bool stiffened_ = false;                   // M̂ has added_
  std::optional<BasicSystem> joined_basic_;  // of the full form, to find the joints' forces
  Eigen::VectorXd q_mid_;                    // q_a
  Eigen::VectorXd reach_;                    // how far bodies may move in the step, for searched pairs
  Eigen::VectorXd change_of_v_;              // by known impulses
  Eigen::VectorXd rates_;                    // of the joints, for joined_basic_
  Eigen::VectorXd from_, v_free_, force_, rate_, lambda_;
  Anderson anderson_;                     // likewise
  Eigen::VectorXd scale_;                 // likewise: √M
  Eigen::VectorXd applied_, gyroscopic_;  // space: impulses of the applied forces, and of the axes' turning
  std::vector<Eigen::Matrix3d> frames_;   // space: F of each body and the ground
};
extern template class VelocitySteppingOf<Planar>;
extern template class VelocitySteppingOf<Spatial>;
using VelocityStepping = VelocitySteppingOf<Planar>;

}  // namespace orthant
