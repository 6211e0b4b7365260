// An American put option: one complementarity problem a time step, value and exercise boundary together.
#include <orthant/core/lcp/problems/american_put.h>
#include <orthant/solvers/registry.h>

#include <iostream>

int main() {
  using namespace orthant;
  const AmericanPut put;  // strike 100, one year
  constexpr int kSteps = 200;
  const double h = put.maturity / kSteps;
  const auto solver = make_solver("auto");
  Vector value = put.payoff();
  Solution z;
  for (int step = 0; step < kSteps; ++step) {
    if (solver->solve(american_put_step(put, value, h, 1), z).status != Status::solved) return 1;
    value = put.payoff() + z.z;
  }
  std::cout << "worth at S = 100: " << put.value(value, 100) << " (6.0904 by a fine binomial tree)\n";
}
