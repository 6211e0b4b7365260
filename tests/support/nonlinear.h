// tests/support/nonlinear.h — nonlinear complementarity problems from functions, with dense Jacobians.
#pragma once

#include <orthant/core/lcp/mcp.h>

#include <functional>
#include <utility>
#include <variant>

namespace orthant {

/// 0 ≤ z ⊥ F(z) ≥ 0 of n rows; jacobian() gets a matrix of zeros.
inline Mcp complementarity(Index n, std::function<void(const Vector&, Vector&)> F,
                           std::function<void(const Vector&, DenseMatrix&)> jacobian) {
  Mcp p;
  p.lo = Eigen::VectorXd::Zero(n);
  p.hi = Eigen::VectorXd::Constant(n, kInf);
  p.F = std::move(F);
  p.jacobian = [jacobian = std::move(jacobian), n](const Vector& z, Matrix& J) {
    if (!std::holds_alternative<DenseMatrix>(J)) J = DenseMatrix();
    auto& dense = std::get<DenseMatrix>(J);
    dense.resize(n, n);
    dense.setZero();
    jacobian(z, dense);
  };
  return p;
}

}  // namespace orthant
