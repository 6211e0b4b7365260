#include <orthant/core/mechanics/spatial/inertia.h>

#include <Eigen/Eigenvalues>

namespace orthant::spatial {

Principal principal(const Eigen::Matrix3d& tensor) {
  Principal p{tensor.diagonal(), {1, 0, 0, 0}};
  Eigen::Matrix3d rest = tensor;
  rest.diagonal().setZero();
  if (rest.isZero(0)) return p;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver((tensor + tensor.transpose()) / 2);
  Eigen::Matrix3d A = solver.eigenvectors();
  if (A.determinant() < 0) A.col(2) *= -1;
  const Eigen::Quaterniond q = Eigen::Quaterniond(A).normalized();
  p.moments = solver.eigenvalues(), p.axes = {q.w(), q.x(), q.y(), q.z()};
  return p;
}

}  // namespace orthant::spatial
