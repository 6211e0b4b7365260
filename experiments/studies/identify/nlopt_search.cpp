#include "experiments/studies/identify/nlopt_search.h"

#include <exception>
#include <memory>
#include <stdexcept>
#include <string>

namespace orthant {

namespace {

struct Call {
  const SearchCost& cost;
  nlopt_opt optimizer;
  std::exception_ptr error;
};

double evaluate(unsigned n, const double* x, double* gradient, void* data) {
  auto& call = *static_cast<Call*>(data);
  try {
    const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(x, n);
    if (gradient == nullptr) return call.cost(at, nullptr);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    const double value = call.cost(at, &g);
    Eigen::Map<Eigen::VectorXd>(gradient, n) = g;
    return value;
  } catch (...) {  // not through C code
    call.error = std::current_exception();
    nlopt_force_stop(call.optimizer);
    return 0;
  }
}

}  // namespace

void search(const NloptSearch& plan, const SearchCost& cost, Eigen::VectorXd& x) {
  const auto n = static_cast<unsigned>(x.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimizer(nlopt_create(plan.algorithm, n),
                                                                         &nlopt_destroy);
  Call call{cost, optimizer.get(), {}};
  nlopt_set_min_objective(optimizer.get(), evaluate, &call);
  nlopt_set_lower_bounds(optimizer.get(), plan.low.data()), nlopt_set_upper_bounds(optimizer.get(), plan.high.data());
  nlopt_set_xtol_rel(optimizer.get(), plan.x_relative), nlopt_set_stopval(optimizer.get(), plan.enough);
  nlopt_set_maxeval(optimizer.get(), plan.most);
  double least = 0;
  const nlopt_result result = nlopt_optimize(optimizer.get(), x.data(), &least);
  if (call.error) std::rethrow_exception(call.error);
  if (result < 0 && result != NLOPT_ROUNDOFF_LIMITED)
    throw std::runtime_error("NLopt ended as " + std::to_string(result));
}

}  // namespace orthant
