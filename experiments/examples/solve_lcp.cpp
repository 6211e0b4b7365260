// Solve a linear complementarity problem: 0 <= z, w = M z + q >= 0, z'w = 0.
#include <orthant/solvers/registry.h>

#include <iostream>

int main() {
  const Eigen::MatrixXd M = (Eigen::MatrixXd(2, 2) << 2, 1, 1, 2).finished();
  const auto problem = orthant::Lcp::standard(orthant::DenseMatrix(M), {-5, -6});

  orthant::Solution solution;  // keep it: the second problem of a size allocates nothing
  const auto solver = orthant::make_solver("auto");
  solver->solve(problem, solution);

  std::cout << name(solution.status) << ", residual " << solution.residual << "\nz = " << solution.z.transpose()
            << "\nw = " << solution.w.transpose() << '\n';
  return solution.status == orthant::Status::solved ? 0 : 1;
}
