#include <orthant/core/support/options.h>
#include <orthant/integrators/integrator.h>

#include <algorithm>
#include <stdexcept>

namespace orthant {

bool StepReport::note(int rows, Status status_of_it, double residual, int iterations, const Miss& missed) {
  if (status_of_it == Status::rounded && rounded++ == 0) miss = missed;
  status = has_answer(status_of_it) ? Status::solved : status_of_it;
  if (status == Status::solved) lcp_residual = std::max(lcp_residual, residual);
  lcp_rows = std::max(lcp_rows, rows);
  lcp_iterations += iterations;
  ++lcp_solves;
  return status == Status::solved;
}

template <class Space> void IntegratorOf<Space>::employ(std::vector<std::unique_ptr<Solver>> helpers) {
  pool_ = std::make_unique<SolverPool>(std::move(helpers));
}

template <class Space> void IntegratorOf<Space>::check_pyramids(const Solver& solver) const {
  if (kPlanar<Space> || takes_pyramids_ || solver.pyramid_sides() == 0) return;
  throw std::invalid_argument("solver option facets = " + std::to_string(solver.pyramid_sides()) +
                              ": must be 0 with integrator " + name_ + ", or the integrator one of " +
                              integrators_that_take(&Capabilities::pyramids));
}

template <class Space> bool IntegratorOf<Space>::fail(StepReport& report, Status status, std::string why) {
  report.status = status;
  why_ = std::move(why);
  return false;
}

template class IntegratorOf<Planar>;
template class IntegratorOf<Spatial>;

}  // namespace orthant
