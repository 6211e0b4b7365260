#include <orthant/solvers/external/ipopt.h>
#include <orthant/solvers/linear_algebra/sparse_budget.h>

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

namespace orthant {

namespace {

namespace ip = ::Ipopt;
using ip::Number;
using Int = ip::Index;
using Map = Eigen::Map<Eigen::VectorXd>;
using ConstMap = Eigen::Map<const Eigen::VectorXd>;

/// Either program of ipopt.h as Ipopt asks for it: x = (z, m), g = w + m.
class Program final : public ip::TNLP {
 public:
  Vector z;                                                  // start, then result
  std::function<bool(double, double, const char*)> proceed;  // error, step, event

  /// The program of `problem`, which must outlive it. True when its pattern is that of the last one.
  bool load(const ScaledProblem& problem, bool quadratic) {
    problem_ = &problem;
    quadratic_ = quadratic;
    const ScaledProblem& p = problem;
    kind_.resize(at(p.size()));
    boxes_.clear();
    for (Index i = 0; i < p.size(); ++i) {
      const bool below = p.lo[i] != -kInf, above = p.hi[i] != kInf;
      kind_[at(i)] = p.lo[i] == p.hi[i] ? fixed : below && above ? box : below ? lower : above ? upper : free;
      if (!quadratic && kind_[at(i)] == box) boxes_.push_back(i);
    }
    reference_ = Eigen::VectorXd::Zero(p.size());
    for (Index i = 0; i < p.size(); ++i)
      if (kind_[at(i)] != free) reference_[i] = kind_[at(i)] == upper ? p.hi[i] : p.lo[i];
    const bool same =
        quadratic == last_quadratic_ && kind_ == last_kind_ && p.A.start == last_start_ && p.A.row == last_row_;
    last_quadratic_ = quadratic, last_kind_ = kind_, last_start_ = p.A.start, last_row_ = p.A.row;
    return same;
  }

  /// The last problem was not optimized: there is no structure for the next one to keep.
  void forget() { last_start_.clear(); }

  /// Whether there are numbers at the start, within the bounds: without, Ipopt reads an iterate that it has not made.
  bool starts() {
    scratch_ = z.cwiseMax(p().lo).cwiseMin(p().hi);
    force(scratch_);
    return w_.allFinite() &&
           std::isfinite(quadratic_ ? 0.5 * scratch_.dot(w_ + p().b) : (scratch_ - reference_).dot(w_));
  }

 private:
  enum Kind : char { free, lower, upper, box, fixed };

  const ScaledProblem& p() const { return *problem_; }

  bool get_nlp_info(Int& n, Int& m, Int& nnz_jac, Int& nnz_h, IndexStyleEnum& style) override {
    n = static_cast<Int>(p().size()) + extra();
    m = quadratic_ ? 0 : static_cast<Int>(p().size());
    nnz_jac = quadratic_ ? 0 : static_cast<Int>(p().A.row.size()) + extra();
    nnz_h = 0;
    for (Index j = 0; j < p().size(); ++j) p().A.each(j, [&](int i, double) { nnz_h += counts(i, j); });
    style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Int n, Number* x_l, Number* x_u, Int m, Number* g_l, Number* g_u) override {
    for (Int i = 0; i < n; ++i) x_l[i] = i < p().size() ? p().lo[i] : 0, x_u[i] = i < p().size() ? p().hi[i] : kInf;
    for (Int i = 0; i < m; ++i) {
      const char kind = kind_[at(i)];
      g_l[i] = kind == upper || kind == fixed ? -kInf : 0;
      g_u[i] = kind == upper || kind == free ? 0 : kInf;
    }
    return true;
  }
  bool get_starting_point(Int n, bool init_x, Number* x, bool init_z, Number* z_l, Number* z_u, Int m, bool init_lambda,
                          Number* lambda) override {
    force(z);
    for (Int i = 0; i < n; ++i) {
      const bool own = i < p().size();
      const Index row = own ? i : boxes_[at(i - p().size())];
      if (init_x) x[i] = own ? z[i] : std::max(-w_[row], 0.0);
      if (init_z) z_l[i] = own ? std::max(w_[i], 0.0) : p().hi[row] - z[row];
      if (init_z) z_u[i] = own ? std::max(-w_[i], 0.0) : 0;
    }
    for (Int i = 0; init_lambda && i < m; ++i) lambda[i] = reference_[i] - z[i];
    return true;
  }
  bool eval_f(Int, const Number* x, bool, Number& value) override {
    const ConstMap at_z(x, p().size());
    force(at_z);
    value = quadratic_ ? 0.5 * at_z.dot(w_ + p().b) : (at_z - reference_).dot(w_);
    for (Int k = 0; k < extra(); ++k) value += x[p().size() + k] * gap(k);
    return std::isfinite(value);
  }
  bool eval_grad_f(Int, const Number* x, bool, Number* gradient) override {
    const ConstMap at_z(x, p().size());
    force(at_z);
    if (!quadratic_) {
      scratch_ = at_z - reference_;
      p().add_transposed(scratch_, w_);
    }
    Map(gradient, p().size()) = w_;
    for (Int k = 0; k < extra(); ++k) gradient[p().size() + k] = gap(k);
    return w_.allFinite();
  }
  bool eval_g(Int, const Number* x, bool, Int m, Number* g) override {
    if (m == 0) return true;
    force(ConstMap(x, p().size()));
    Map(g, m) = w_;
    for (Int k = 0; k < extra(); ++k) g[boxes_[at(k)]] += x[p().size() + k];
    return w_.allFinite();
  }
  bool eval_jac_g(Int, const Number*, bool, Int m, Int, Int* row, Int* column, Number* values) override {
    if (m == 0) return true;
    std::size_t e = 0;
    const auto put = [&](Index i, Index j, double v) {
      if (values != nullptr)
        values[e] = v;
      else
        row[e] = static_cast<Int>(i), column[e] = static_cast<Int>(j);
      ++e;
    };
    for (Index j = 0; j < p().size(); ++j) p().A.each(j, [&](int i, double v) { put(i, j, v); });
    for (Int k = 0; k < extra(); ++k) put(boxes_[at(k)], p().size() + k, 1);
    return true;
  }
  /// Entries in one place are summed by Ipopt: A_ij and A_ji both go below the diagonal.
  bool eval_h(Int, const Number*, bool, Number factor, Int, const Number*, bool, Int, Int* row, Int* column,
              Number* values) override {
    std::size_t e = 0;
    for (Index j = 0; j < p().size(); ++j)
      p().A.each(j, [&](int i, double v) {
        if (!counts(i, j)) return;
        if (values != nullptr)
          values[e] = factor * v * (!quadratic_ && i == j ? 2 : 1);
        else
          row[e] = std::max(i, static_cast<Int>(j)), column[e] = std::min(i, static_cast<Int>(j));
        ++e;
      });
    return true;
  }
  void finalize_solution(ip::SolverReturn, Int, const Number* x, const Number*, const Number*, Int, const Number*,
                         const Number*, Number, const ip::IpoptData*, ip::IpoptCalculatedQuantities*) override {
    z = ConstMap(x, p().size());
  }
  bool intermediate_callback(ip::AlgorithmMode mode, Int, Number, Number inf_pr, Number inf_du, Number mu, Number,
                             Number, Number, Number alpha_pr, Int, const ip::IpoptData*,
                             ip::IpoptCalculatedQuantities*) override {
    return proceed(std::max({inf_pr, inf_du, mu}), alpha_pr,
                   mode == ip::RestorationPhaseMode ? "restoration"
                   : quadratic_                     ? "quadratic"
                                                    : "merit");
  }

  Int extra() const { return static_cast<Int>(boxes_.size()); }
  double gap(Int k) const { return p().hi[boxes_[at(k)]] - p().lo[boxes_[at(k)]]; }
  bool counts(int i, Index j) const { return !quadratic_ || i >= j; }
  template <class X> void force(const X& x) {  // w_ ← A x + b
    p().multiply(x, w_);
    w_ += p().b;
  }

  const ScaledProblem* problem_ = nullptr;
  bool quadratic_ = false, last_quadratic_ = false;
  std::vector<Kind> kind_, last_kind_;
  std::vector<int> last_start_, last_row_;
  std::vector<Index> boxes_;
  Vector reference_, w_, scratch_;
};

Claim status(ip::ApplicationReturnStatus code) {
  switch (code) {
    case ip::Solve_Succeeded:
    case ip::Solved_To_Acceptable_Level:
    case ip::Feasible_Point_Found:
      return Claim::candidate;  // the judge says whether it is
    case ip::Infeasible_Problem_Detected:
    case ip::Diverging_Iterates:
    case ip::Search_Direction_Becomes_Too_Small:
    case ip::Restoration_Failed:
    case ip::Not_Enough_Degrees_Of_Freedom:
      return Claim::stalled;
    case ip::Maximum_Iterations_Exceeded:
      return Claim::iteration_limit;
    case ip::User_Requested_Stop:
    case ip::Maximum_CpuTime_Exceeded:
      return Claim::time_limit;
    default:
      return Claim::numerical_error;
  }
}

}  // namespace

struct IpoptSolver::Work {
  ip::SmartPtr<Program> program = new Program;
  ip::SmartPtr<ip::IpoptApplication> application = new ip::IpoptApplication(false);  // no console

  Work() {
    ip::OptionsList& o = *application->Options();
    o.SetIntegerValue("print_level", 0);
    o.SetStringValue("sb", "yes");                   // no banner
    o.SetStringValue("nlp_scaling_method", "none");  // ScaledProblem's knows both z and w
    o.SetNumericValue("diverging_iterates_tol",
                      1e12);  // in scaled units: beyond, rounding hides w, no judge accepts it
    // (hessian_constant would keep the last problem's matrix when the structure is kept.)
    for (const char* push : {"warm_start_bound_push", "warm_start_bound_frac", "warm_start_slack_bound_push",
                             "warm_start_slack_bound_frac", "warm_start_mult_bound_push"})
      o.SetNumericValue(push, 1e-6);
    std::istringstream nothing;  // in place of the file ipopt.opt
    application->Initialize(nothing);
  }
};

IpoptSolver::IpoptSolver(const Options& options) : options_(options), work_(std::make_unique<Work>()) {
  work_->program->proceed = [this](double error, double step, const char* event) {
    return proceed(error, step, event);
  };
}
IpoptSolver::~IpoptSolver() = default;

std::string IpoptSolver::why_not(const Lcp& problem) const { return Minimizer::why_not(problem); }

Claim IpoptSolver::minimize(const ScaledProblem& problem, bool quadratic, bool warm, Vector& z) {
  ip::IpoptApplication& application = *work_->application;
  Program& program = *work_->program;
  const Columns& A = problem.A;  // a part of the matrices that Ipopt factorizes, between which it polls
  if (!affords_factorization(&budget(), static_cast<int>(A.size()), A.start.data(), A.row.data(), 1))
    return Claim::time_limit;
  const bool same = program.load(problem, quadratic);
  program.z = z;
  if (!program.starts()) {
    program.forget();
    return Claim::numerical_error;
  }
  ip::OptionsList& o = *application.Options();
  o.SetIntegerValue("max_iter", options_.max_iterations);
  o.SetStringValue("warm_start_init_point", warm ? "yes" : "no");
  // One steep row makes the w of others small, so rounding must decide, not a tolerance. The merit wants one: its
  // centre may lie at infinity, where the solutions are unbounded. Mehrotra's rule halves the iterations, without a
  // safeguard.
  o.SetNumericValue("tol", quadratic ? 1e-14 : 1e-10);
  o.SetStringValue("mehrotra_algorithm", quadratic ? "yes" : "no");
  o.SetNumericValue("mu_init", warm ? 1e-6 : 0.1);
  o.SetStringValue("warm_start_same_structure", same ? "yes" : "no");
  Claim result = Claim::numerical_error;
  try {
    result = status(same ? application.ReOptimizeTNLP(&program) : application.OptimizeTNLP(&program));
  } catch (...) {  // Ipopt's own are caught inside; what is left is no answer
  }
  z = program.z;
  return result;
}

}  // namespace orthant
