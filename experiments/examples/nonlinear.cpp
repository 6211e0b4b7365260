// A nonlinear complementarity problem by two callbacks: z >= 0, F(z) >= 0, z'F = 0 (Kojima & Shindo's four unknowns).
#include <orthant/solvers/pivoting/path.h>

#include <iostream>

int main() {
  using namespace orthant;
  Mcp problem;
  problem.lo = Eigen::VectorXd::Zero(4), problem.hi = Eigen::VectorXd::Constant(4, kInf);
  problem.F = [](const Vector& z, Vector& F) {
    const double a = z[0], b = z[1], c = z[2], d = z[3];
    F = Vector{3 * a * a + 2 * a * b + 2 * b * b + c + 3 * d - 6, 2 * a * a + a + b * b + 10 * c + 2 * d - 2,
               3 * a * a + a * b + 2 * b * b + 2 * c + 9 * d - 9, a * a + 3 * b * b + 2 * c + 3 * d - 3};
  };
  problem.jacobian = [](const Vector& z, Matrix& J) {
    const double a = z[0], b = z[1];
    Eigen::Matrix4d rows;
    rows << 6 * a + 2 * b, 2 * a + 4 * b, 1, 3, 4 * a + 1, 2 * b, 10, 2, 6 * a + b, a + 4 * b, 2, 9, 2 * a, 6 * b, 2, 3;
    J = DenseMatrix(rows);
  };
  Solution solution;
  Path().solve(problem, solution);
  std::cout << name(solution.status) << ", residual " << solution.residual << "\nz = " << solution.z.transpose()
            << '\n';
  return solution.status == Status::solved ? 0 : 1;
}
