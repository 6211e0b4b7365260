// solvers/external/ipopt.h — Ipopt: the problem as a quadratic program, solved by a primal-dual interior-point method.
//
//   Minimized (minimizer.h): the quadratic form, or the merit
//     Σ (z_i − r_i) w_i + Σ_box (hi_i − lo_i) m_i,   lo ≤ z ≤ hi,   w = A z + b,   m ≥ 0,
//     w_i ≥ 0 on [lo, ∞), ≤ 0 on (−∞, hi], = 0 on free rows, w_i + m_i ≥ 0 on boxes;   r_i the bound (lo_i on boxes, 0
//     on free rows): zero exactly at a solution, ≥ 0 elsewhere; convex when xᵀA x ≥ 0.
//   Exact sparse derivatives: the Hessian is A, or A + Aᵀ, by its lower triangle. A Delassus operator is formed.
//   Ipopt ends about 1e-8 off; the polish gives the rest. A local minimum with positive merit is no solution → stalled.
//   If the polish of a start value does not solve the problem, the iteration begins there, multipliers included (no
//   gain where w spans many powers of ten). The symbolic work is kept between solves of one pattern. Time and
//   cancellation are polled once an iteration, which costs one sparse LDLᵀ factorization (MUMPS). No file is read,
//   nothing is printed.
//   Source: Wächter & Biegler, Math. Programming 106 (2006) 25-57.  Program: Ipopt (COIN-OR).
#pragma once

#include <orthant/solvers/external/minimizer.h>

#include <memory>

namespace orthant {

struct IpoptOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_iterations = 500;  // of each start
  int restarts = 3;          // random starts for the merit
  Minimizer::Form form = Minimizer::Form::automatic;
  bool polish = true;
  template <class V> void visit(V&& v) {
    using namespace std::string_view_literals;
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000);
    v("restarts", restarts, 0, 1000), v("form", form, std::array{"automatic"sv, "quadratic"sv, "merit"sv});
    v("polish", polish);
  }
};

class IpoptSolver final : public Minimizer {
 public:
  using Options = IpoptOptions;
  explicit IpoptSolver(const Options& options = {});
  ~IpoptSolver() override;
  std::string why_not(const Lcp& problem) const override;

 private:
  Plan plan() const override { return {options_.form, options_.restarts, options_.polish}; }
  Claim minimize(const ScaledProblem& problem, bool quadratic, bool warm, Vector& z) override;
  double tolerance() const override { return options_.tolerance; }

  Options options_;
  struct Work;
  std::unique_ptr<Work> work_;  // null in a build without Ipopt
};

}  // namespace orthant
