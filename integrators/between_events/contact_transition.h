// integrators/between_events/contact_transition.h — contact mode transition: last, stick or slide; Painlevé's paradox.
//
//   Over the contacts that touch and do not separate (g = 0, γ_N = 0), with λ_T = −σ μ λ_N put in where slip γ_T ≠ 0:
//     0 ≤ λ_N ⊥ W_N a + Ẇ_N v ≥ 0,     γ_T = 0:  |λ_T| ≤ μ λ_N,  inside: γ̇_T = 0,  at a bound: opposite to γ̇_T.
//   λ_N > 0: the contact lasts, else it opens. γ_T = 0 with |λ_T| inside its bounds: it sticks, else it slides off in
//   the sense of γ̇_T; with a greater static coefficient the problem is then solved again with the kinetic one.
//   Contacts that joints immobilise (immobility.h) are no candidates, and such combinations of candidates contradict
//   each other only where drives make them. With friction there may be no solution or several (Painlevé). "None" is
//   reported only with a proof (certify.h) that rounding of the problem could not have produced. If the given solver
//   does not solve the problem, path.h is tried; if neither solves nor proves it, the result is undecided(). Several
//   solutions are searched for where a contact's own coupling allows them (W_N B (W_N − σ μ W_T)ᵀ ≤ 0 for a sense σ
//   that it may take), by enumeration of at most 12 rows; solutions count as one where the accelerations are the same.
//   Solutions that only several contacts together make possible are not searched for.
//   Source: Pfeiffer & Glocker, Multibody Dynamics with Unilateral Contacts (1996), ch. 6; Génot & Brogliato,
//   European Journal of Mechanics A 18 (1999) 653-677.
#pragma once

#include <orthant/integrators/between_events/contact_motion.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/immobility.h>
#include <orthant/solvers/pivoting/path.h>
#include <orthant/solvers/refinement.h>

namespace orthant {

class ContactTransition {
 public:
  explicit ContactTransition(const System& system);

  struct Candidate {
    int contact = 0;
    double slip = 0;    // σ, when it slides; 0: γ_T = 0
    bool held = false;  // by joints, along the tangent: it has no friction; written by decide()
  };
  std::vector<Candidate> candidates;  // in the order of the scene

  /// Writes the modes of all contacts; `motion` has just evaluated its accelerations at (q, v). Not solved: why() says
  /// what is wrong, the modes are as they were.
  Status decide(ContactMotion& motion, Solver& solver, StepReport& report);

  /// After decide(): forces well within the cones of friction that begin the same motion, for modes whose shares of
  /// forces that are not unique leave the cones. They come from the problem with a part of the friction. True: found,
  /// and written to the modes.
  bool find_forces_in_cones(ContactMotion& motion, Solver& solver, StepReport& report);

  const Lcp& problem() const { return lcp_; }
  const std::string& why() const { return why_; }
  bool undecided() const { return undecided_; }  // not solved, and not known whether it can be

 private:
  void leave_out_immobile(ContactMotion& motion);
  void formulate(ContactMotion& motion);
  bool doubtful() const;
  enum class Proof { none, immobile, paradox };  // immobile: of a combination that no force moves
  Proof proof();
  bool immobile(const Vector& u);
  bool relax();
  double zero() const;
  Status examine(Solver& solver, const Eigen::VectorXd& free);
  bool slide_off();
  void write_modes(ContactMotion& motion, const Solution& solution, bool known);

  const System& system_;
  Immobility immobility_;
  ContactEquations equations_;
  Lcp lcp_;
  Solution solution_;
  Path second_;
  Refinement refinement_;
  std::vector<ContactRows> rows_;
  std::string why_;
  bool undecided_ = false;
};

}  // namespace orthant
