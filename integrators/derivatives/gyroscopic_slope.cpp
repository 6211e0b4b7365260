#include <orthant/integrators/derivatives/gyroscopic_slope.h>

#include <Eigen/LU>

#include <cmath>

namespace orthant {

Eigen::Matrix3d cross_matrix(const Vector3d& x) {
  return Eigen::Matrix3d{{0, -x.z(), x.y()}, {x.z(), 0, -x.x()}, {-x.y(), x.x(), 0}};
}

Eigen::Matrix3d turn_of(const Vector3d& phi) { return quaternions::matrix_of(quaternions::exponential(phi)); }

Eigen::Matrix3d right_jacobian(const Vector3d& phi) {
  const double square = phi.squaredNorm();
  double one = 0, two = 0;  // (1 − cos a) / a² and (a − sin a) / a³
  if (square < 0.01) {      // the next terms of the series are below 1e-17
    one = 0.5 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56 * (1 - square / 90))));
    two = (1 - square / 20 * (1 - square / 42 * (1 - square / 72 * (1 - square / 110)))) / 6;
  } else {
    const double a = std::sqrt(square);
    one = (1 - std::cos(a)) / square, two = (a - std::sin(a)) / (a * square);
  }
  const Eigen::Matrix3d across = cross_matrix(phi);
  return Eigen::Matrix3d::Identity() - one * across + two * across * across;
}

TurnSlope::TurnSlope(const StepFrames& frames, const Vector3d& omega, const Vector3d& w, const Vector3d& end)
    : h_(frames.h), at_(frames.at), theta_(frames.theta), omega_(omega), w_(w), end_(end) {
  const Vector3d xi = at_ * h_ * omega, eta = h_ * ((1 - theta_) * omega + theta_ * end);
  const Matrix3d unit = Matrix3d::Identity(), there = turn_of(eta);
  back_ = turn_of(xi).transpose(), C_ = back_ * there;
  at_xi_ = right_jacobian(xi), at_eta_ = right_jacobian(eta);
  middle_by_turn = back_, middle_by_omega = at_ * h_ * at_xi_;
  const Matrix3d swing = h_ * cross_matrix(end) * at_eta_;
  const Matrix3d solve = (unit - theta_ * swing).inverse();
  omega_by_w = solve * C_.transpose();
  omega_by_omega = solve * ((1 - theta_) * swing - C_.transpose() * cross_matrix(w) * middle_by_omega);
  end_by_turn = there.transpose();
  end_by_end = h_ * theta_ * at_eta_, end_by_omega = h_ * (1 - theta_) * at_eta_;
}

void TurnSlope::of_impulse(const Vector3d& moments, Matrix3d& by_omega, Matrix3d& by_w) const {
  if (moments[0] == moments[1] && moments[1] == moments[2]) {
    by_omega.setZero(), by_w.setZero();
    return;
  }
  const Matrix3d J = moments.asDiagonal();
  const Vector3d momentum = J * end_, m = C_ * momentum, y = back_ * (J * omega_);
  const Matrix3d turned = cross_matrix(momentum) * at_eta_;  // [Jω⁺]× J_η
  by_w = J - C_ * (J - h_ * theta_ * turned) * omega_by_w;
  by_omega =
      -C_ * (J * omega_by_omega - h_ * turned * ((1 - theta_) * Matrix3d::Identity() + theta_ * omega_by_omega)) - J +
      back_ * J + cross_matrix(y - m) * middle_by_omega;
}

Vector3d TurnSlope::impulse_of(const Matrix3d& tensor) const {
  return tensor * w_ - C_ * (tensor * end_) - tensor * omega_ + back_ * (tensor * omega_);
}

}  // namespace orthant
