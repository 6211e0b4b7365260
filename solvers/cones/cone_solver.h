// solvers/cones/cone_solver.h — base of the solvers of problems with friction discs.
//
//   They work on the scaled form (cone_form.h) and stop by its scale-free residual
//     sf = ‖z' − P_K(z' − û')‖ / ‖q'‖
//   at half the tolerance. The judge (certify_cones.h) then decides contact by contact. If it does not accept z, the
//   target becomes half the residual of that z: a power of ten less may be below rounding. Methods that sweep leave
//   operators of kUnformed rows and more unformed (operator_sweeps.h). They take intervals, boxes
//   and free rows as well, so planar contact problems and LCPs are special cases.
#pragma once

#include <orthant/solvers/cones/cone_form.h>
#include <orthant/solvers/solver.h>

namespace orthant {

class ConeSolver : public Solver {
 public:
  std::string why_not(const Lcp& problem) const override;

  static constexpr Index kUnformed = 3000;  // rows

 protected:
  bool takes_discs() const final { return true; }
  const ConeForm& form() const { return form_; }
  /// The method itself, in scaled numbers; z is the start on entry. It ends when finished() says so or its own limits
  /// are reached.
  virtual Claim iterate(Vector& z, int& iterations) = 0;
  /// The method can do without the entries of A: operators of many rows stay unformed. It looks at the start itself
  /// then, and needs no product with A.
  virtual bool takes_operators() const { return false; }
  void release() override;
  /// The end: z solves the problem, or time is over. Fills residual().
  bool finished(const Vector& z);
  /// The same of a z whose residual is known.
  bool finished(const Vector& z, double residual);
  bool solved() const { return solved_; }
  /// Another end: a proof that there is no solution.
  bool proved() { return proves_infeasible(*problem_, *solution_); }
  double residual() const { return sf_; }  // of the z last given to finished()
  double target() const { return target_; }

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) final;
  ConeForm form_;
  Vector z_, w_, best_;
  const Lcp* problem_ = nullptr;
  Solution* solution_ = nullptr;
  double sf_ = kInf, least_ = kInf, target_ = 0;
  bool solved_ = false;
};

}  // namespace orthant
