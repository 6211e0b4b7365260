// integrators/derivatives/skew_saddle.h — saddle-point system of joints that push at one pose and hold at another.
//
//   M̂ x = f + Gᵀ λ,   G⁺ x = c:   S λ = c − G⁺ M̂⁻¹ f,  S = G⁺ M̂⁻¹ Gᵀ,  M̂ as factorized (basic_system.h)
//   adjoint of x, x̄:  M̂ f̄ = x̄ − G⁺ᵀ κ,  G f̄ = 0,  c̄ = κ
// S is dense and inverted, up to 48 joint rows; beyond, or where joints are redundant, both are fixed points of the
// factorization with G on both sides, from which they differ by O(h).
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>

#include <Eigen/LU>

#include <optional>

namespace orthant {

class SkewSaddle {
 public:
  explicit SkewSaddle(const System& system);

  /// push: G and springs, with the damping weight of M̂; hold: G⁺. Both are referred to. `joined` has push's G.
  void set_up(const Terms& push, const std::vector<Row>& hold, double damping_weight, const BasicSystem& joined);

  /// x of f and c; c null: 0.
  void solve(const Eigen::VectorXd& f, const double* c, Eigen::VectorXd& x);
  /// f̄ and c̄ of x̄.
  void solve_adjoint(const Eigen::VectorXd& of_x, Eigen::VectorXd& of_f, Eigen::VectorXd& of_c);

 private:
  void free(const Eigen::VectorXd& f, Eigen::VectorXd& x);  // M̂⁻¹ f
  void find(const Eigen::VectorXd& f, const std::vector<Row>& push, const std::vector<Row>& hold, bool transposed,
            Eigen::VectorXd& lambda, Eigen::VectorXd& x);

  const System& system_;
  std::optional<BasicSystem> loose_;  // M̂ alone, where it is not M
  const std::vector<Row>*push_ = nullptr, *hold_ = nullptr;
  const BasicSystem* joined_ = nullptr;
  bool damped_ = false, dense_ = true;
  Eigen::MatrixXd pushed_, S_;  // M̂⁻¹ Gᵀ
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  Eigen::VectorXd off_, left_, force_, step_, lambda_step_, none_, one_;
};

}  // namespace orthant
