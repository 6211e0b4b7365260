#include <orthant/integrators/integrator.h>

#include <algorithm>

namespace orthant {

bool StepReport::note(const Lcp& problem, const Solution& solution) {
  status = solution.status;
  if (status == Status::solved) lcp_residual = std::max(lcp_residual, solution.residual);
  lcp_rows = std::max(lcp_rows, static_cast<int>(problem.size()));
  lcp_iterations += solution.iterations;
  ++lcp_solves;
  return status == Status::solved;
}

bool Integrator::fail(StepReport& report, Status status, std::string why) {
  report.status = status;
  why_ = std::move(why);
  return false;
}

}  // namespace orthant
