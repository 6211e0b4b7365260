#include <orthant/solvers/external/nlopt.h>

#include <orthant/solvers/active_set/fischer_burmeister.h>

#include <nlopt.h>

#include <cmath>
#include <memory>

namespace orthant {

namespace {

constexpr Index kSlsqpRows = 1000;
constexpr double kRunaway = 1e12;  // |z| in scaled units: beyond, rounding hides w, no judge accepts it

constexpr nlopt_algorithm kAlgorithms[] = {
    NLOPT_LD_LBFGS, NLOPT_LD_VAR1, NLOPT_LD_VAR2, NLOPT_LD_TNEWTON_PRECOND_RESTART,
    NLOPT_LD_CCSAQ, NLOPT_LD_MMA,  NLOPT_LD_SLSQP};

/// `objective(n, z, gradient or null)`, as NLopt calls it.
template <class Objective> double call(unsigned n, const double* z, double* gradient, void* objective) {
  return (*static_cast<Objective*>(objective))(n, z, gradient);
}

}  // namespace

std::string NloptSolver::why_not(const Lcp& problem) const {
  const Index n = problem.size() + 3 * static_cast<Index>(problem.friction.size());
  if (options_.algorithm == Options::Algorithm::slsqp && n > kSlsqpRows)
    return "n = " + std::to_string(n) + ": algorithm=slsqp takes at most " + std::to_string(kSlsqpRows) + " rows";
  return Minimizer::why_not(problem);
}

double NloptSolver::value(const ScaledProblem& p, bool quadratic, const Vector& z, double* gradient) {
  const Index n = p.size();
  p.multiply(z, w_);
  if (quadratic) {
    const double result = z.dot(0.5 * w_ + p.b);
    if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, n) = w_ + p.b;
    return result;
  }
  slope_.resize(n), pressed_.resize(n);
  double result = 0;
  for (Index i = 0; i < n; ++i) {
    const auto row = detail::complementarity_row(1, z[i], w_[i] + p.b[i], p.lo[i], p.hi[i]);
    result += 0.5 * row.value * row.value;
    slope_[i] = row.value * row.da, pressed_[i] = row.value * row.db;
  }
  if (gradient != nullptr) {
    p.add_transposed(pressed_, slope_);
    Eigen::Map<Eigen::VectorXd>(gradient, n) = slope_;
  }
  return result;
}

Claim NloptSolver::minimize(const ScaledProblem& problem, bool quadratic, bool, Vector& z) {
  const auto n = static_cast<unsigned>(problem.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> owner(
      nlopt_create(kAlgorithms[static_cast<std::size_t>(options_.algorithm)], n), &nlopt_destroy);
  nlopt_opt opt = owner.get();
  if (opt == nullptr) return Claim::numerical_error;
  auto objective = [&](unsigned size, const double* x, double* gradient) {
    at_ = Eigen::Map<const Eigen::VectorXd>(x, size);
    const double result = value(problem, quadratic, at_, gradient);
    if (!proceed(result, 0, quadratic ? "quadratic" : "merit") || !std::isfinite(result) ||
        !(at_.lpNorm<Eigen::Infinity>() < kRunaway))
      nlopt_force_stop(opt);
    return result;
  };
  nlopt_set_min_objective(opt, &call<decltype(objective)>, &objective);
  nlopt_set_lower_bounds(opt, problem.lo.data());
  nlopt_set_upper_bounds(opt, problem.hi.data());
  nlopt_set_maxeval(opt, options_.max_evaluations);
  nlopt_set_xtol_rel(opt, 1e-15);
  double least = 0;
  switch (nlopt_optimize(opt, z.data(), &least)) {
    case NLOPT_MAXEVAL_REACHED:
      return Claim::iteration_limit;
    case NLOPT_FORCED_STOP:
      return budget().exhausted() ? Claim::time_limit : Claim::stalled;
    case NLOPT_INVALID_ARGS:
    case NLOPT_OUT_OF_MEMORY:
      return Claim::numerical_error;
    default:
      return Claim::candidate;  // no further descent: the judge says what it is worth
  }
}

}  // namespace orthant
