// integrators/step/formulate.h — contact laws of one step: its problem formulated and solved, impulses applied.
//
//   Unknown impulses z = [Λ_G; Λ_N; Λ_T] of the rows J = [G; W_N; W_T];  w = J v⁺ − target,  v⁺ = v_free + B Jᵀ z:
//     A = J B Jᵀ,  b = J v_free − target.    RateTarget by the scheme: γ_N⁺ ≥ target, γ_T⁺ → target, G v⁺ = target;
//     by Newton's law −e γ_N⁻ and −e_T γ_T⁻.
//   Slip γ_T is against the moving surface. μ is the static one for a contact that sticks at the step's start and is
//   held by it, and for one whose slip would turn round within the step, as it passes through rest (a second solve,
//   coulomb only).
//   reduced: B is the inverse of the basic system with its joints (block elimination of Λ_G: the Schur complement onto
//            the contacts through one factorization of the saddle matrix); no joint rows in J.
//   full:    B = M̂⁻¹; the joints stay as equality rows.
//   Only closed contacts have rows, and only frictional ones a tangent row. Where B is diagonal and a scene has many
//   contacts, A is kept as a Delassus operator and never formed.
//   Both give the same step.
//   Bodies that do not act on one another in the step are solved separately, one problem per island (islands.h). The
//   answer equals that of the whole problem to rounding. With a pool large islands are solved at the same time.
//   problem() forms the whole problem.
// The parts: rows, bounds and targets (step_problem.h), the solve by islands (island_solve.h), contacts that joints
// immobilise (rank_deficiency.h), and the message where there is no solution (no_solution_message.h).
// Dry friction in joints (joint_friction.h): box rows −h bound ≤ Λ ≤ h bound after all others, w = the rate of the
// coordinate.
// Friction, by Cone:
//   coulomb  |Λ_T| ≤ μ Λ_N against the slip; the matrix of the pure problem is not symmetric.
//   relaxed  the cone's edges n ± μ t are the rows, impulses β± ≥ 0:  0 ≤ β± ⊥ (γ_N − target_N) ± μ (γ_T − target_T) ≥
//            0, Λ_N = β₊ + β₋, Λ_T = μ (β₊ − β₋). A is symmetric positive semidefinite, the problem a convex program;
//            its price: a contact that slides opens at the speed μ |γ_T|.
//            In space the edges n + μ t_j, j = 1 … 8, t_1 along the slip of free flight.
// Source: Brogliato & Acary (2008), ch. 10; Glocker, Set-Valued Force Laws (2001); Anitescu, Math. Program. 105 (2006).
#pragma once

#include <orthant/integrators/step/carried_guess.h>
#include <orthant/integrators/step/island_solve.h>
#include <orthant/integrators/step/spatial_rank_deficiency.h>
#include <orthant/solvers/even_share.h>

namespace orthant {

template <class Space> class FormulationOf {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;
  using Row = RowOf<Space>;
  using RateTarget = RateTargetOf<Space>;
  using Impulse = ImpulseOf<Space>;
  using BasicSystem = BasicSystemOf<Space>;
  using ClosedContacts = std::vector<ClosedContactOf<Space>>;

  explicit FormulationOf(const System& system, Form form = Form::reduced, Cone cone = Cone::coulomb);

  /// From now on dry friction in joints acts for `duration` [s] (of displacements: [s²]); 0, as at first: it has no
  /// rows.
  /// `loads`, one a friction of the scene [N], are those that its bound depends on; null: none does.
  void resist(double duration, const std::vector<double>* loads = nullptr) { problem_.resist(duration, loads); }

  /// Coordinates near those of the terms, but such that they satisfy the joints, at time t: immobilised rows are
  /// looked for there. They stay where they are until the problem is solved. ahead: [s] of the step from there on; 0:
  /// the problem is one of an instant.
  void anchor(double t, const Eigen::VectorXd& q, double ahead = 0) { deficiency_.anchor(t, q, ahead); }

  /// Builds the problem from terms.closed (and terms.G for the full form). v_free: velocities after the step without
  /// the impulses z; targets: one entry a closed contact; joint_rate: the wanted G v⁺ (full form only), joint_rows
  /// entries. `basic` is factorized already, with joints for the reduced and without for the full form.
  void formulate(const Terms& terms, const BasicSystem& basic, const std::vector<RateTarget>& targets,
                 const Eigen::VectorXd& v_free, const Eigen::VectorXd& joint_rate);

  /// The same rows and matrix again with another v_free and other targets.
  void retarget(const std::vector<RateTarget>& targets, const Eigen::VectorXd& v_free,
                const Eigen::VectorXd& joint_rate) {
    problem_.retarget(targets, v_free, joint_rate);
  }

  /// From now on a problem that friction and restitution leave without a solution (jamming), or that is not solved, is
  /// solved with e = e_T = 0, and overlaps stay as they are: friction holds what would rebound. That always has a
  /// solution, where nothing is driven.
  void let_friction_win(bool wins = true) { friction_wins_ = wins; }

  /// Normal impulses are at least e times those of `stored`, one per contact of the scene. Until the next collection.
  void release(const std::vector<Impulse>& stored) { problem_.release(stored); }

  /// All rows become equations, w = 0.
  void bind() { problem_.bind(); }

  /// From now on answers are brought to rounding (solvers/refinement.h), for integrators with error control. In space
  /// impulses that the rows leave open are shared evenly (solvers/even_share.h).
  void refine() { islands_.refine(), precise_ = true; }

  /// Finds z, from the last one as the first guess; true: solved, or nothing to solve. Large islands are shared
  /// with the pool, if there is one: the answer is the same to the last bit. closed: see IslandSolveOf::solve().
  bool solve(Solver& solver, StepReport& report, SolverPool* pool = nullptr, ClosedContacts* closed = nullptr);

  /// In words, why there is no solution; empty: there is no such proof (no_solution_message.h).
  std::string contradiction() const;

  /// Whether joints immobilise closed contact k, so that it has no rows.
  bool immobile(std::size_t k) const { return problem_.immobile(k); }
  /// The place in z and w of closed contact k's normal and tangent; −1: it has no such row. Cone::coulomb only.
  Index normal_row(std::size_t k) const { return problem_.normal_row(k); }
  Index tangent_row(std::size_t k) const { return problem_.tangent_row(k); }

  Index size() const { return problem_.size(); }  // rows of the problem
  /// The whole problem, with its matrix.
  const Lcp& problem() const { return problem_.whole(); }
  const Solution& solution() const { return solution_; }
  /// Its rows, without the matrix.
  const StepProblemOf<Space>& step_problem() const { return problem_; }
  void remember(CheckpointData& memory) {  // the next guess
    memory(solution_.z);
    if constexpr (!kPlanar<Space>) memory(guess_);
  }
  void clear() { problem_.clear(); }  // no problem, until the next is built

  /// The impulse of dry friction i of the scene, where it has rows.
  double joint_friction(std::size_t i) const { return solution_.z[problem_.friction_row(i)]; }

  /// v += B Jᵀ z, and the contacts' impulses; those of open contacts are zero.
  void advance(Eigen::VectorXd& v, std::vector<Impulse>& impulses) const { problem_.advance(solution_.z, v, impulses); }

 private:
  bool share_evenly(Solver& solver);
  bool solve_once(Solver& solver, StepReport& report, SolverPool* pool, ClosedContacts* closed) {
    return islands_.solve(problem_, solver, report, pool, solution_, closed);
  }

  const System& system_;
  StepProblemOf<Space> problem_;
  IslandSolveOf<Space> islands_;
  RankDeficiencyOf<Space> deficiency_;
  EvenShare even_share_;
  struct NoGuess {};
  [[no_unique_address]] std::conditional_t<kPlanar<Space>, NoGuess, CarriedGuess> guess_;
  Solution solution_;
  const Terms* terms_ = nullptr;  // last formulated, for names
  bool friction_wins_ = false, precise_ = false;
};
extern template class FormulationOf<Planar>;
extern template class FormulationOf<Spatial>;
using Formulation = FormulationOf<Planar>;

}  // namespace orthant
