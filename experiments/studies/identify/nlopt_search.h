// experiments/studies/identify/nlopt_search.h — minimum within bounds by a method of NLopt.
#pragma once

#include <Eigen/Core>

#include <nlopt.h>

#include <functional>

namespace orthant {

struct NloptSearch {
  nlopt_algorithm algorithm = NLOPT_LN_BOBYQA;
  Eigen::VectorXd low, high;
  double x_relative = 0;      // ends where all of x change by less than this part
  double enough = -HUGE_VAL;  // ends at a cost below it
  int most = 500;             // evaluations
};

/// gradient: null where none is needed.
using SearchCost = std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd* gradient)>;

/// From x to the best point found. Rethrows errors of the cost; throws std::runtime_error where NLopt fails otherwise.
void search(const NloptSearch& plan, const SearchCost& cost, Eigen::VectorXd& x);

}  // namespace orthant
