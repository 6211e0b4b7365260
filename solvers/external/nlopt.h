// solvers/external/nlopt.h — NLopt: the problem as a smooth minimum within bounds, by a gradient method.
//
//   Minimized (minimizer.h): the quadratic form; or the merit ½ ‖Φ‖², Φ_i Fischer and Burmeister's function of row i
//   (fischer_burmeister.h), smooth although Φ is not, and without a false minimum when all principal minors are ≥ 0.
//     lbfgs        quasi-Newton of limited memory, O(nnz + n) an evaluation
//     var1, var2   the same by shifted variable metric
//     tnewton      truncated Newton, preconditioned, with restarts
//     ccsa, mma    separable convex approximations
//     slsqp        sequential least squares: O(n³) an iteration, n ≤ 1000 (friction rows count four times)
//   They end where rounding of the objective hides descent, some 1e-8 off, and converge slowly where A is
//   ill-conditioned; the polish gives the rest where the active rows are right by then. A minimum of the merit above 0
//   → stalled.
//   The start value is used. Time and cancellation are polled once an evaluation.
//   Sources: Nocedal, Math. Comp. 35 (1980); Vlček & Lukšan, J. Comput. Appl. Math. 186 (2006); Dembo & Steihaug, Math.
//   Programming 26 (1983); Svanberg, SIAM J. Optim. 12 (2002); Kraft, DFVLR-FB 88-28 (1988).  Program: NLopt (Johnson).
#pragma once

#include <orthant/solvers/external/minimizer.h>

namespace orthant {

struct NloptOptions {
  enum class Algorithm { lbfgs, var1, var2, tnewton, ccsa, mma, slsqp };
  double tolerance = 1e-10;     // accepted residual relative to the problem's scale, as certify() measures it
  int max_evaluations = 20000;  // of each start
  int restarts = 3;             // random starts for the merit
  Algorithm algorithm = Algorithm::lbfgs;
  Minimizer::Form form = Minimizer::Form::automatic;
  bool polish = true;
  template <class V> void visit(V&& v) {
    using namespace std::string_view_literals;
    v("tolerance", tolerance, 0.0, 1.0), v("max_evaluations", max_evaluations, 1, 1000000000);
    v("restarts", restarts, 0, 1000);
    v("algorithm", algorithm, std::array{"lbfgs"sv, "var1"sv, "var2"sv, "tnewton"sv, "ccsa"sv, "mma"sv, "slsqp"sv});
    v("form", form, std::array{"automatic"sv, "quadratic"sv, "merit"sv}), v("polish", polish);
  }
};

class NloptSolver final : public Minimizer {
 public:
  using Options = NloptOptions;
  explicit NloptSolver(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Plan plan() const override { return {options_.form, options_.restarts, options_.polish}; }
  Claim minimize(const ScaledProblem& problem, bool quadratic, bool warm, Vector& z) override;
  double tolerance() const override { return options_.tolerance; }
  double value(const ScaledProblem& problem, bool quadratic, const Vector& z, double* gradient);

  Options options_;
  Vector at_, w_, slope_, pressed_;
};

}  // namespace orthant
