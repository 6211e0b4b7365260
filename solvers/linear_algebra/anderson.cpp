#include <orthant/solvers/linear_algebra/anderson.h>

#include <Eigen/QR>
#include <algorithm>

namespace orthant {

void Anderson::combine(Eigen::Ref<Eigen::VectorXd> x, const Eigen::Ref<const Eigen::VectorXd>& image) {
  if (known_ == 0) {
    steps_.resize(image.size(), depth_), changes_.resize(image.size(), depth_);
  } else {
    const Index column = (known_ - 1) % depth_, columns = std::min(known_, depth_);
    steps_.col(column) = image - last_image_;
    changes_.col(column) = residual_ - last_;
    share_ = changes_.leftCols(columns).colPivHouseholderQr().solve(residual_);
    if (share_.allFinite()) x.noalias() -= steps_.leftCols(columns) * share_;
  }
  last_image_ = image, last_ = residual_;
  ++known_;
}

}  // namespace orthant
