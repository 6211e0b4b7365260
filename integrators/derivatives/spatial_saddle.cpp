#include <orthant/integrators/derivatives/spatial_saddle.h>

#include <Eigen/QR>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace orthant {

IndependentRows::IndependentRows(const SystemOf<Spatial>& system) : system_(system), basic_(system) {}

const std::vector<Eigen::Index>& IndependentRows::find(const TermsOf<Spatial>& terms) {
  constexpr double kDependent = 3e-7;  // of a row's length: drift, as of basic_system.h
  const Eigen::Index joints = system_.joint_rows();
  rows_.resize(static_cast<std::size_t>(joints));
  std::iota(rows_.begin(), rows_.end(), Eigen::Index{0});
  if (joints == 0) return rows_;
  if (!basic_.factorize(system_, terms)) throw std::runtime_error("derivatives of a step: not finite");
  if (!basic_.redundant()) return rows_;
  const Eigen::VectorXd root = system_.inverse_mass().cwiseSqrt();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(system_.dof(), joints);
  for (Eigen::Index j = 0; j < joints; ++j) {
    each_entry(terms.G[static_cast<std::size_t>(j)],
               [&](Eigen::Index place, double value) { columns(place, j) = root[place] * value; });
    if (const double length = columns.col(j).norm(); length > 0) columns.col(j) /= length;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  qr.setThreshold(kDependent);
  const auto order = qr.colsPermutation().indices();
  rows_.resize(static_cast<std::size_t>(qr.rank()));
  for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i] = order[static_cast<Eigen::Index>(i)];
  std::sort(rows_.begin(), rows_.end());
  return rows_;
}

SpatialSaddle::SpatialSaddle(const SystemOf<Spatial>& system)
    : system_(system),
      root_(system.mass().cwiseSqrt()),
      push_scale_(system.joint_rows()),
      hold_scale_(system.joint_rows()) {}

void SpatialSaddle::set_up(const std::vector<Slope>& added, const std::vector<Row>& push, const std::vector<Row>& hold,
                           const std::vector<Eigen::Index>& rows) {
  constexpr Eigen::Index kDenseEquations = 96;
  constexpr double kSingular = 1e-14;  // of K, whose entries are at most about 1
  const Eigen::Index dof = system_.dof();
  rows_ = rows;
  const Eigen::Index size = dof + std::ssize(rows_);
  dense_ = size <= kDenseEquations;
  std::vector<Eigen::Triplet<double, int>> entries;
  if (dense_) K_.setZero(size, size);
  const auto put = [&](Eigen::Index i, Eigen::Index j, double value) {
    if (dense_)
      K_(i, j) += value;
    else
      entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
  };
  for (Eigen::Index i = 0; i < dof; ++i) put(i, i, 1);
  for (const Slope& s : added) put(s.of, s.by, s.value / (root_[s.of] * root_[s.by]));
  const auto scale_of = [&](const Row& row) {
    double square = 0;
    each_entry(row, [&](Eigen::Index place, double j) { square += j * j / (root_[place] * root_[place]); });
    return square > 0 ? 1 / std::sqrt(square) : 1;
  };
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const Eigen::Index r = rows_[k], place = dof + static_cast<Eigen::Index>(k);
    const Row &pushes = push[static_cast<std::size_t>(r)], &holds = hold[static_cast<std::size_t>(r)];
    push_scale_[r] = scale_of(pushes), hold_scale_[r] = scale_of(holds);
    each_entry(pushes, [&](Eigen::Index i, double j) { put(i, place, -j * push_scale_[r] / root_[i]); });
    each_entry(holds, [&](Eigen::Index i, double j) { put(place, i, j * hold_scale_[r] / root_[i]); });
  }
  bool regular = true;
  if (dense_) {
    dense_lu_.compute(K_);
    regular = dense_lu_.matrixLU().diagonal().cwiseAbs().minCoeff() > kSingular;  // false for NaN as well
  } else {
    Eigen::SparseMatrix<double> K(size, size);
    K.setFromTriplets(entries.begin(), entries.end());
    std::vector<int> start(K.outerIndexPtr(), K.outerIndexPtr() + size + 1);
    std::vector<int> row(K.innerIndexPtr(), K.innerIndexPtr() + K.nonZeros());
    std::vector<double> value(K.valuePtr(), K.valuePtr() + K.nonZeros());
    regular = lu_.factorize(start, row, value, kSingular);
  }
  if (!regular) throw std::runtime_error("derivatives of a step: its linear equations are singular");
}

void SpatialSaddle::solve(const double* f, const double* c, double* x, double* lambda) {
  const Eigen::Index dof = system_.dof();
  x_.resize(dof + std::ssize(rows_));
  x_.head(dof) = Eigen::Map<const Eigen::VectorXd>(f, dof).cwiseQuotient(root_);
  for (std::size_t k = 0; k < rows_.size(); ++k)
    x_[dof + static_cast<Eigen::Index>(k)] = c != nullptr ? c[rows_[k]] * hold_scale_[rows_[k]] : 0;
  if (dense_)
    x_ = dense_lu_.solve(x_).eval();
  else
    lu_.solve(x_.data());
  Eigen::Map<Eigen::VectorXd>(x, dof) = x_.head(dof).cwiseQuotient(root_);
  if (lambda == nullptr) return;
  std::fill(lambda, lambda + system_.joint_rows(), 0.0);
  for (std::size_t k = 0; k < rows_.size(); ++k)
    lambda[rows_[k]] = x_[dof + static_cast<Eigen::Index>(k)] * push_scale_[rows_[k]];
}

void SpatialSaddle::solve_adjoint(const double* of_x, double* of_f, double* of_c) {
  const Eigen::Index dof = system_.dof();
  x_.resize(dof + std::ssize(rows_));
  x_.head(dof) = Eigen::Map<const Eigen::VectorXd>(of_x, dof).cwiseQuotient(root_);
  x_.tail(std::ssize(rows_)).setZero();
  if (dense_)
    x_ = dense_lu_.transpose().solve(x_).eval();
  else
    lu_.solve_transposed(x_.data());
  Eigen::Map<Eigen::VectorXd>(of_f, dof) = x_.head(dof).cwiseQuotient(root_);
  std::fill(of_c, of_c + system_.joint_rows(), 0.0);
  for (std::size_t k = 0; k < rows_.size(); ++k)
    of_c[rows_[k]] = x_[dof + static_cast<Eigen::Index>(k)] * hold_scale_[rows_[k]];
}

}  // namespace orthant
