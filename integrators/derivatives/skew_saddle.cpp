#include <orthant/integrators/derivatives/skew_saddle.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace orthant {

namespace {

constexpr Eigen::Index kDenseSaddle = 48;  // joint rows

}  // namespace

SkewSaddle::SkewSaddle(const System& system) : system_(system) {
  const auto& springs = system.scene().springs;
  damped_ = std::ranges::any_of(
      springs, [](const Spring& s) { return std::visit([](const auto& one) { return one.damping != 0; }, s); });
  if (damped_) loose_.emplace(system, false);
  for (auto* x : {&off_, &left_, &lambda_step_}) x->setZero(system.joint_rows());
  for (auto* x : {&force_, &step_, &none_, &one_}) x->setZero(system.dof());
}

void SkewSaddle::free(const Eigen::VectorXd& f, Eigen::VectorXd& x) {
  if (damped_)
    loose_->solve(f.data(), nullptr, x.data(), nullptr);
  else
    x = f.cwiseProduct(system_.inverse_mass());
}

void SkewSaddle::set_up(const Terms& push, const std::vector<Row>& hold, double damping_weight,
                        const BasicSystem& joined) {
  push_ = &push.G, hold_ = &hold, joined_ = &joined;
  const Eigen::Index joints = system_.joint_rows();
  if (damped_ && !loose_->factorize(system_, push, 0, damping_weight))
    throw std::runtime_error("derivatives of a step: not finite");
  dense_ = joints > 0 && joints <= kDenseSaddle && !joined.redundant();
  if (!dense_) return;
  S_.resize(joints, joints);
  pushed_.resize(system_.dof(), joints);
  for (Eigen::Index j = 0; j < joints; ++j) {
    const Row& row = push.G[static_cast<std::size_t>(j)];
    if (damped_) {
      loose_->solve_row(row, one_.data());
    } else {
      one_.setZero();
      apply_impulse(row, 1, system_.inverse_mass(), one_);
    }
    pushed_.col(j) = one_;
    for (Eigen::Index i = 0; i < joints; ++i) S_(i, j) = apply(hold[static_cast<std::size_t>(i)], one_.data());
  }
  lu_.compute(S_);
  const auto pivots = lu_.matrixLU().diagonal().cwiseAbs();
  dense_ = pivots.minCoeff() > 1e-11 * S_.cwiseAbs().maxCoeff();  // redundant joints leave rounding
}

// M̂ x = f + pushᵀ λ with hold x = λ on entry; λ becomes that of the solution.
void SkewSaddle::find(const Eigen::VectorXd& f, const std::vector<Row>& push, const std::vector<Row>& hold,
                      bool transposed, Eigen::VectorXd& lambda, Eigen::VectorXd& x) {
  constexpr int kPasses = 30;
  const auto joints = static_cast<Eigen::Index>(push.size());
  free(f, x);
  if (joints == 0) return;
  off_ = lambda;
  for (Eigen::Index i = 0; i < joints; ++i) off_[i] -= apply(hold[static_cast<std::size_t>(i)], x.data());
  if (dense_) {
    lambda = transposed ? Eigen::VectorXd(lu_.transpose().solve(off_)) : Eigen::VectorXd(lu_.solve(off_));
  } else {
    lambda.setZero(), left_ = off_;
    double before = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < kPasses; ++pass) {
      const double now = left_.lpNorm<Eigen::Infinity>();
      if (!(now < 0.5 * before)) break;
      before = now;
      joined_->solve(none_.data(), left_.data(), step_.data(), lambda_step_.data());
      lambda += lambda_step_;
      force_.setZero();
      for (Eigen::Index i = 0; i < joints; ++i)
        apply_transposed(push[static_cast<std::size_t>(i)], lambda[i], force_.data());
      free(force_, step_);
      for (Eigen::Index i = 0; i < joints; ++i)
        left_[i] = off_[i] - apply(hold[static_cast<std::size_t>(i)], step_.data());
    }
  }
  if (dense_ && !transposed) {
    x.noalias() += pushed_ * lambda;
    return;
  }
  force_.setZero();
  for (Eigen::Index i = 0; i < joints; ++i)
    apply_transposed(push[static_cast<std::size_t>(i)], lambda[i], force_.data());
  free(force_, step_);
  x += step_;
}

void SkewSaddle::solve(const Eigen::VectorXd& f, const double* c, Eigen::VectorXd& x) {
  const Eigen::Index joints = system_.joint_rows();
  one_.resize(joints);
  if (c != nullptr)
    one_ = Eigen::Map<const Eigen::VectorXd>(c, joints);
  else
    one_.setZero();
  x.resize(system_.dof());
  find(f, *push_, *hold_, false, one_, x);
  one_.resize(system_.dof());
}

void SkewSaddle::solve_adjoint(const Eigen::VectorXd& of_x, Eigen::VectorXd& of_f, Eigen::VectorXd& of_c) {
  of_c.setZero(system_.joint_rows()), of_f.resize(system_.dof());
  find(of_x, *hold_, *push_, true, of_c, of_f);
  of_c = -of_c;
}

}  // namespace orthant
