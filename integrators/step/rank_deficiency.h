// integrators/step/rank_deficiency.h — rank deficiency of a step's problem: contacts, and combinations of them, that
// joints immobilise.
//
// No impulse moves what joints immobilise (immobility.h). Such a contact has no rows, and its rates are what the joints
// make them; one of which the tangent alone is immobile has no friction. Where the joints' drives press it shut before
// the step ends it has a row of zeros with that rate, and the judge proves the contradiction. Combinations of contacts,
// too: where rounding, the discretisation or restitution make their rates inconsistent, targets give way by just as
// much, and the problem is solved again. A proof that is no such combination is due to rounding alone: numerical_error,
// never infeasible.
#pragma once

#include <orthant/integrators/step/immobility.h>
#include <orthant/integrators/step/step_problem.h>

#include <optional>

namespace orthant {

inline constexpr double kPartOfProof = 1e-6;  // of a proof's largest entry: the row takes part

class RankDeficiency {
 public:
  RankDeficiency(const System& system, Form form);

  /// See Formulation::anchor().
  void anchor(double t, const Eigen::VectorXd& q, double ahead) { anchor_t_ = t, anchor_ = &q, ahead_ = ahead; }
  /// Of the anchor; empty: there is none.
  std::optional<double> time() const { return anchor_ != nullptr ? std::optional(anchor_t_) : std::nullopt; }

  /// A new problem, of these terms; they stay where they are until it is solved.
  void begin(const Terms& terms) { terms_ = &terms, stands_ = false, held_.clear(); }
  /// Finds the contacts that joints immobilise. All contacts of the problem still have their rows. True: see held().
  bool find(const StepProblem& problem);
  /// One a closed contact; empty: none is held.
  const std::vector<Held>& held() const { return held_; }

  /// After a solve: true when the targets of the problem have given way, so that it has to be solved once more.
  void start_solving() { undecided_ = relaxed_ = false; }
  bool give_way(StepProblem& problem, const Solution& solution, bool solved, StepReport& report);
  void note_undecided() { undecided_ = true; }

  bool undecided() const { return undecided_; }  // by rounding: whether the problem has a solution
  bool relaxed() const { return relaxed_; }      // the relaxation of cones alone leaves the problem without a solution

 private:
  Held judge(const StepProblem::Contact& c, const ContactRows& rows, bool frictional);
  bool pressed(const StepProblem::Contact& c, double rate);
  Immobility::Verdict judge(const StepProblem& problem, const Vector& u, bool tangents = true);
  bool stand();
  bool relax(StepProblem& problem, const Vector& u);
  bool lifts(const StepProblem& problem, const Vector& u);

  const System& system_;
  double anchor_t_ = 0, ahead_ = 0;          // [s]
  const Eigen::VectorXd* anchor_ = nullptr;  // coordinates that satisfy the joints
  const Terms* terms_ = nullptr;             // of the problem
  std::optional<Immobility> immobility_;     // from the first suspicion on
  bool stands_ = false;                      // immobility_ is at the anchor
  std::vector<Held> held_;
  Vector direction_;  // of a combination that may be immobile
  bool relaxed_ = false, undecided_ = false;
};

}  // namespace orthant
