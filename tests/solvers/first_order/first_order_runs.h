// tests/solvers/first_order/first_order_runs.h — problems for first-order methods, and their runs.
#pragma once

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/pivoting/lemke.h>
#include <orthant/solvers/registry.h>

#include <Eigen/Eigenvalues>

#include "tests/support/allocations.h"
#include "tests/support/judge.h"

namespace orthant {

inline const std::vector<std::string> kAll{"pgs", "psor", "sgs", "jacobi", "nncg", "apgd", "mprgp", "admm"};

inline Solution solve(const std::string& spec, const Lcp& problem, IterationLog* log = nullptr) {
  const auto solver = make_solver(spec);
  solver->set_log(log);
  Solution s;
  solver->solve(problem, s);
  return s;
}

}  // namespace orthant
