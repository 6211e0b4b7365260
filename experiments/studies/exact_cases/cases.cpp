#include "experiments/studies/exact_cases/case_groups.h"

#include <algorithm>
#include <string>

namespace orthant {

std::vector<ExactCase> exact_cases() {
  std::vector<ExactCase> all;
  ball_cases(all);
  friction_cases(all);
  rolling_cases(all);
  painleve_cases(all);
  rocking_cases(all);
  impact_cases(all);
  driven_cases(all);
  rest_cases(all);
  arch_cases(all);
  thinnest_arch_cases(all);
  impact_law_cases(all);
  equivalent_cases(all);
  solver_cases(all);
  linkage_cases(all);
  slanting_impact_cases(all);
  slider_crank_cases(all);
  const auto number = [](const ExactCase& e) {  // B1 … B20, C3 … C7, the slider-crank
    return e.id[0] == 'S' ? 2000 : (e.id[0] == 'C' ? 1000 : 0) + std::stoi(e.id.substr(1));
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const ExactCase& a, const ExactCase& b) { return number(a) < number(b); });
  return all;
}

}  // namespace orthant
