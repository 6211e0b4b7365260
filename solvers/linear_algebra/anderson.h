// solvers/linear_algebra/anderson.h — Anderson acceleration of a fixed-point iteration x = G(x).
//
//   From the last iterates the combination with the least residual:
//     x⁺ = G(x_k) − Σ γ_i (G(x_i+1) − G(x_i)),   γ: least squares of ‖f_k − Σ γ_i (f_i+1 − f_i)‖,   f = G(x) − x.
//   It converges where G itself is not a contraction, along few directions.
//   Each iterate costs a dense QR factorization of n × depth numbers.
// Source: Anderson, J. ACM 12 (1965) 547-560; Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715-1735.
#pragma once

#include <orthant/core/support/reusable.h>

namespace orthant {

class Anderson {
 public:
  /// depth: iterates that are combined, besides the last one.
  explicit Anderson(Index depth = 6) : depth_(depth) {}
  void restart() { known_ = 0; }
  /// x, whose image G(x) is given, becomes the next iterate: the image itself after restart(), or where no combination
  /// is finite. `scale`: of each entry's residual in the norm.
  template <class Iterate> void next(Iterate& x, const Eigen::VectorXd& image, const Eigen::VectorXd& scale) {
    residual_ = scale.cwiseProduct(image - x);
    x = image;
    combine(x, image);
  }
  template <class Iterate> void next(Iterate& x, const Iterate& image) {
    residual_ = image - x;
    x = image;
    combine(x, image);
  }

 private:
  void combine(Eigen::Ref<Eigen::VectorXd> x, const Eigen::Ref<const Eigen::VectorXd>& image);

  Index depth_, known_ = 0;                               // iterates seen
  Eigen::MatrixXd steps_, changes_;                       // of images and of residuals, one column an iterate, in turn
  Eigen::VectorXd last_image_, residual_, last_, share_;  // residual: scaled G(x) − x
};

}  // namespace orthant
