// solvers/external/minimizer.h — minimization base of the solvers ipopt and nlopt: complementarity as a minimum.
//
//   quadratic   min ½ zᵀA z + bᵀz,  lo ≤ z ≤ hi.   A symmetric: its stationary points are the solutions, convex or not.
//   merit       any other function of z that is least, 0, at the solutions: the method's own.
//   Attempts: the quadratic form where A is symmetric, the merit, the merit from `restarts` random starts; each until
//   the judge accepts. Friction rows take the pure form (pure_form.h, stewart_trinkle), whose A is not symmetric.
//   Each end point is polished (polish.h). A start value is, too; if its active rows are right, no minimization
//   follows.
#pragma once

#include <orthant/core/lcp/pure_form.h>
#include <orthant/solvers/active_set/polish.h>
#include <orthant/solvers/external/scaled_problem.h>
#include <orthant/solvers/solver.h>

namespace orthant {

class Minimizer : public Solver {
 public:
  enum class Form { automatic, quadratic, merit };
  std::string why_not(const Lcp& problem) const override;

 protected:
  struct Plan {
    Form form = Form::automatic;
    int restarts = 0;
    bool polish = true;
  };
  /// Called once an iteration: false when it is time to stop.
  bool proceed(double merit, double step, const char* event) {
    log(++iterations_, merit, step, event);
    return !budget().exhausted();
  }

 private:
  virtual Plan plan() const = 0;
  /// z, in scaled units: start, then result, whatever the status; `warm` when the start may be near a solution.
  virtual Claim minimize(const ScaledProblem& problem, bool quadratic, bool warm, Vector& z) = 0;
  Claim run(const Lcp& problem, Solution& s, Start start) final;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) final;

  Pyramid pyramid_;
  const Lcp* pure_ = nullptr;
  ScaledProblem scaled_;
  Polish polish_;
  Vector start_, z_;
  bool warm_ = false;
  int iterations_ = 0;
};

}  // namespace orthant
