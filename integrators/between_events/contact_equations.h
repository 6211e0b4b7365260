// integrators/between_events/contact_equations.h — contact rows against contact forces, the joints eliminated.
//
//   A_ij = J_i B F_jᵀ,  b_i = J_i x + c_i:   forces z along F change the rows J of x (accelerations, or a velocity) to
//   A z + b. B is the inverse of the basic system with its joints, so that the joints hold on either side.
//   F = J for forces along the rows themselves; sliding contacts couple W_T to the normal force, and A is not
//   symmetric.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/core/mechanics/planar/contact_law.h>

#include <Eigen/Dense>

namespace orthant {

template <class Space> class ContactEquationsOf {
 public:
  using System = SystemOf<Space>;
  using Row = RowOf<Space>;
  using BasicSystem = BasicSystemOf<Space>;

  ContactEquationsOf(const System& system, std::size_t most) : dof_(system.dof()), row_(most), force_(most), c_(most) {
    const auto n = static_cast<Index>(most);
    columns_.resize(dof_, n), A.resize(n, n), b.resize(n), z.resize(n);
    clear();
  }

  void clear() { row_.clear(), force_.clear(), c_.clear(), besides_.clear(); }
  void add(const Row& row, const Row& force, double c) {
    row_.push_back(row), force_.push_back(force), c_.push_back(c);
  }
  /// The normal row of a contact that slides, its force W_N − sigma_mu W_T.
  void add_sliding(const ContactRowsOf<Space>& rows, double sigma_mu, double c) {
    const bool same = same_bodies(rows.normal, rows.tangent);
    if (!same) besides_.push_back({size(), rows.tangent, -sigma_mu});  // friction acts on other bodies
    add(rows.normal, same ? combined(rows.normal, -sigma_mu, rows.tangent) : rows.normal, c);
  }
  Index size() const { return static_cast<Index>(row_.size()); }

  void assemble(const BasicSystem& basic, const Eigen::VectorXd& x) {
    const Index n = size();
    A.resize(n, n), b.resize(n), columns_.resize(dof_, n);
    for (Index j = 0; j < n; ++j) {
      basic.solve_row(force_[static_cast<std::size_t>(j)], columns_.col(j).data());
      for (const Beside& more : besides_)
        if (more.equation == j) {
          beside_.resize(dof_);
          basic.solve_row(more.force, beside_.data());
          columns_.col(j) += more.factor * beside_;
        }
      for (Index i = 0; i < n; ++i) A(i, j) = apply(row_[static_cast<std::size_t>(i)], columns_.col(j).data());
    }
    for (Index i = 0; i < n; ++i)
      b[i] = apply(row_[static_cast<std::size_t>(i)], x.data()) + c_[static_cast<std::size_t>(i)];
  }

  /// A z = −b. Where rows depend on each other, the z of least Σ (z_i − known_i)² / share_i: equal forces share a load
  /// in proportion to their shares. share: n, > 0; known: n, or null for zero.
  void solve(const Vector& share, const Vector* known = nullptr) {
    if (size() <= kSmall)
      solve_as<Eigen::Matrix<double, -1, -1, 0, kSmall, kSmall>>(share, known);
    else
      solve_as<Eigen::MatrixXd>(share, known);
  }

  /// Whether x + B Fᵀ z depends on the choice among all z that solve, by more than kOpen of what such forces do, in the
  /// norm of these masses. [dof]
  bool leaves_open(const Eigen::VectorXd& mass) const {
    constexpr double kOpen = 1e-6;
    if (!dependent || z.isZero()) return false;
    Eigen::FullPivLU<Eigen::MatrixXd> decomposition;
    decomposition.setThreshold(1e-10);
    const Eigen::MatrixXd others = decomposition.compute(A).kernel();
    const Eigen::MatrixXd weighted = mass.cwiseSqrt().asDiagonal() * columns_;
    const double all = kOpen * weighted.colwise().norm().sum();
    for (Index k = 0; k < others.cols(); ++k)
      if ((weighted * others.col(k)).norm() > all * others.col(k).lpNorm<Eigen::Infinity>()) return true;
    return false;
  }

  /// x + B Fᵀ z
  void act(const Vector& forces, Eigen::VectorXd& x) const { x.noalias() += columns_ * forces; }

  DenseMatrix A;
  Vector b, z;
  bool dependent = false;  // the rows solved for last

 private:
  static constexpr int kSmall = 16;  // up to here on the stack

  template <class Dense> void solve_as(const Vector& share, const Vector* known) {
    Eigen::CompleteOrthogonalDecomposition<Dense> decomposition;
    decomposition.setThreshold(1e-10);
    using Few = Eigen::Matrix<double, -1, 1, 0, Dense::MaxRowsAtCompileTime, 1>;
    const Few root = share.cwiseSqrt();
    decomposition.compute(Dense(A * root.asDiagonal()));
    dependent = decomposition.rank() < size();
    if (dependent && known != nullptr)
      z = *known + root.cwiseProduct(decomposition.solve(Few(-b - A * *known)));
    else
      z = root.cwiseProduct(decomposition.solve(Few(-b)));
  }

  struct Beside {  // one more part of an equation's force
    Index equation;
    Row force;
    double factor;
  };

  Index dof_;
  std::vector<Row> row_, force_;
  std::vector<Beside> besides_;
  Eigen::VectorXd beside_;
  std::vector<double> c_;
  DenseMatrix columns_;
};
using ContactEquations = ContactEquationsOf<Planar>;

}  // namespace orthant
