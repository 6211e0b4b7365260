// A stranger's program, built against an installed Orthant and against it as a subdirectory: every library is linked,
// every part does something.
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <cmath>
#include <cstdio>

int main() {
  using namespace orthant;
  const Lcp problem = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(2, 2)), Vector{-1, 2});
  Solution solution;
  if (make_solver("lemke")->solve(problem, solution).status != Status::solved || solution.z[0] != 1) return 1;
#ifdef WITHOUT_OPTIONAL  // the names stay, and say how to get what they stand for
  for (const char* name : {"ipopt", "nlopt"})
    if (make_solver(name)->why_not(problem).find("install") == std::string::npos ||
        make_solver(name)->solve(problem, solution).status != Status::unsupported)
      return 2;
  const Lcp none = Lcp::standard(DenseMatrix(-Eigen::MatrixXd::Identity(150, 150)), Eigen::VectorXd::Constant(150, -1));
  if (make_solver("lemke")->solve(none, solution).status != Status::infeasible) return 3;
#endif

  const System system(slider_crank({.mu = 0.1}));
  const auto integrator = make_integrator("moreau-jean", system);
  const auto solver = make_solver("lemke");
  const Run run = simulate(*integrator, *solver, {.step = 1e-4, .duration = 0.02});
  std::printf("theta1 = %.6f rad, energy = %.6f J\n", run.final.q[2], run.energy_final);
  return run.status == Status::solved && std::isfinite(run.final.q[2]) ? 0 : 1;
}
