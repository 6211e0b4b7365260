// A bimatrix game by Lemke and Howson's method: matching pennies, played half and half.
#include <orthant/solvers/pivoting/lemke_howson.h>

#include <cmath>
#include <iostream>

int main() {
  const Eigen::MatrixXd gain = (Eigen::MatrixXd(2, 2) << 1, -1, -1, 1).finished();
  for (const auto& e : orthant::lemke_howson_all(-gain, gain)) {  // costs: the first wins what the second loses
    std::cout << "x = " << e.x.transpose() << ", y = " << e.y.transpose() << ", cost " << e.cost_1 << '\n';
    if (std::abs(e.x[0] - 0.5) > 1e-12 || std::abs(e.y[0] - 0.5) > 1e-12) return 1;
  }
}
