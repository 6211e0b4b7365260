// tests/solvers/derivatives/differences_256.h — solutions and their differences in 256 bits.
#pragma once

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/derivatives/sensitivity.h>
#include <orthant/solvers/registry.h>

#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

namespace orthant {

using Bits256 =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<256, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;

using Bits256Matrix = Eigen::Matrix<Bits256, Eigen::Dynamic, Eigen::Dynamic>;

using Bits256Vector = Eigen::Matrix<Bits256, Eigen::Dynamic, 1>;

// The data at step · change, in 256 bits.
struct Bits256Problem {
  Bits256Matrix A;
  Bits256Vector b, lo, hi, mu;
  std::vector<Friction> friction;

  Bits256Problem(const Lcp& p, const Perturbation& change, const Bits256& step, const Bits256& regularization) {
    const auto wide = [](const auto& x) { return x.template cast<Bits256>().eval(); };
    if (const auto* operator_ = std::get_if<Delassus>(&p.A)) {
      const auto* parts = change.A ? &std::get<Delassus>(*change.A) : nullptr;
      Bits256Matrix W = wide(Eigen::MatrixXd(operator_->W.view()));
      Bits256Vector inverse_mass = wide(operator_->inverse_mass);
      Bits256Vector R = Bits256Vector::Zero(p.size());
      if (operator_->regularization.size() > 0) R = wide(operator_->regularization);
      if (parts != nullptr && parts->W.rows > 0) W += step * wide(Eigen::MatrixXd(parts->W.view()));
      if (parts != nullptr && parts->inverse_mass.size() > 0) inverse_mass += step * wide(parts->inverse_mass);
      if (parts != nullptr && parts->regularization.size() > 0) R += step * wide(parts->regularization);
      A = W * inverse_mass.asDiagonal() * W.transpose();
      A.diagonal() += R;
    } else {
      DenseMatrix dense;
      to_dense(p.A, dense);
      A = wide(dense);
      if (change.A) to_dense(*change.A, dense), A += step * wide(dense);
    }
    for (Index i = 0; i < p.size(); ++i) A(i, i) += regularization;
    const auto moved = [&](const Vector& at, const Vector& by) {
      Bits256Vector x = wide(at);
      if (by.size() > 0) x += step * wide(by);
      return x;
    };
    b = moved(p.b, change.b), lo = moved(p.lo, change.lo), hi = moved(p.hi, change.hi);
    friction = p.friction;
    Vector coefficients(Eigen::VectorXd::Zero(static_cast<Index>(friction.size())));
    for (std::size_t k = 0; k < friction.size(); ++k) coefficients[static_cast<Index>(k)] = friction[k].mu;
    mu = moved(coefficients, change.mu);
  }
};

// Semismooth Newton's method on the natural map, from `start`: no pattern is given to it. False: no convergence.
inline bool solve_in_256_bits(const Bits256Problem& p, Bits256Vector& z, Bits256Vector& w) {
  const Index n = p.b.size();
  std::vector<int> friction_of(at(n), -1);
  for (std::size_t k = 0; k < p.friction.size(); ++k)
    for (Index i = 0; i < p.friction[k].rows; ++i) friction_of[at(p.friction[k].first + i)] = static_cast<int>(k);
  Bits256Matrix J(n, n);
  Bits256Vector F(n);
  for (int iteration = 0; iteration < 60; ++iteration) {
    w = p.A * z + p.b;
    for (Index i = 0; i < n; ++i) {
      const int k = friction_of[at(i)];
      const Bits256 d = p.A(i, i) > 0 ? p.A(i, i) : Bits256(1);
      if (k < 0) {
        const Bits256 x = z[i] - w[i] / d;
        if (x > p.lo[i] && x < p.hi[i]) {
          F[i] = w[i], J.row(i) = p.A.row(i);
        } else {
          F[i] = z[i] - (x <= p.lo[i] ? p.lo[i] : p.hi[i]);
          J.row(i).setZero(), J(i, i) = 1;
        }
        continue;
      }
      const Friction& f = p.friction[static_cast<std::size_t>(k)];
      if (f.first != i) continue;
      const Bits256 mu = p.mu[k], radius = z[f.normal] > 0 ? Bits256(mu * z[f.normal]) : Bits256(0);
      Bits256Vector x = z.segment(i, f.rows) - w.segment(i, f.rows) / d;
      const Bits256 length = x.norm();
      if (length <= radius) {
        F.segment(i, f.rows) = w.segment(i, f.rows);
        J.middleRows(i, f.rows) = p.A.middleRows(i, f.rows);
        continue;
      }
      x /= length;
      F.segment(i, f.rows) = z.segment(i, f.rows) - radius * x;
      Bits256Matrix across = -x * x.transpose();
      across.diagonal().array() += Bits256(1);
      across *= radius / length;
      Bits256Matrix move = Bits256Matrix::Zero(f.rows, n);
      for (Index r = 0; r < f.rows; ++r) move(r, i + r) = 1;
      J.middleRows(i, f.rows) = move - across * (move - p.A.middleRows(i, f.rows) / d);
      if (z[f.normal] > 0) J.middleRows(i, f.rows).col(f.normal) -= mu * x;
    }
    if (F.cwiseAbs().maxCoeff() < Bits256("1e-60")) return true;
    z -= J.partialPivLu().solve(F);
  }
  return false;
}

struct Difference256 {
  Eigen::VectorXd z, w;
  bool found = true;
};

// (z(ε) − z(−ε)) / 2ε; one-sided: (z(ε) − z(0)) / ε.
inline Difference256 difference_256(const Lcp& p, const Vector& z0, const Perturbation& change, bool one_sided = false,
                                    double regularization = 0) {
  const Bits256 step = ldexp(Bits256(1), -80);
  Bits256Vector z[2], w[2];
  Difference256 d;
  for (int k = 0; k < 2; ++k) {
    z[k] = z0.cast<Bits256>();
    const Bits256 at = k == 1 ? step : one_sided ? Bits256(0) : Bits256(-step);
    d.found = solve_in_256_bits(Bits256Problem(p, change, at, Bits256(regularization)), z[k], w[k]) && d.found;
  }
  const Bits256 over = one_sided ? step : Bits256(2 * step);
  d.z = Bits256Vector((z[1] - z[0]) / over).cast<double>();
  d.w = Bits256Vector((w[1] - w[0]) / over).cast<double>();
  return d;
}

inline Vector normal_vector(Random& random, Index n) {
  Vector x(Eigen::VectorXd::Zero(n));
  for (Index i = 0; i < n; ++i) x[i] = random.normal();
  return x;
}

// Every part of the data changes at random, A on its own pattern.
inline Perturbation random_change(const Lcp& p, Random& random) {
  Perturbation change;
  const Index n = p.size();
  const auto redrawn = [&](RowSparse rows) {
    for (double& value : rows.value) value = random.normal();
    return rows;
  };
  if (std::holds_alternative<DenseMatrix>(p.A)) {
    Eigen::MatrixXd A(n, n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) A(i, j) = random.normal();
    change.A = DenseMatrix(A);
  } else if (const auto* sparse = std::get_if<RowSparse>(&p.A)) {
    change.A = redrawn(*sparse);
  } else {
    const auto& parts = std::get<Delassus>(p.A);
    change.A = Delassus{redrawn(parts.W), normal_vector(random, parts.W.cols), normal_vector(random, n)};
  }
  change.b = normal_vector(random, n), change.lo = normal_vector(random, n), change.hi = normal_vector(random, n);
  for (Index i = 0; i < n; ++i)
    if (p.lo[i] == p.hi[i]) change.hi[i] = change.lo[i];
  for (const Friction& f : p.friction) change.lo[f.normal] = 0;  // z_n ≥ 0 stays
  change.mu = normal_vector(random, static_cast<Index>(p.friction.size()));
  return change;
}

}  // namespace orthant
