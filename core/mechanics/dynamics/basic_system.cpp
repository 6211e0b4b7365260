#include <orthant/core/mechanics/dynamics/basic_system.h>

#include <klu.h>
#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace orthant {
namespace {

constexpr int kDenseRows = 32;         // above, a sparse S is faster than a dense one
constexpr double kMostGrowth = 1e-4;   // reciprocal: of entries over those of the matrix
constexpr double kAsChosen = 0.1;      // of that growth where the pivots were chosen
constexpr double kMostEver = 1e-9;     // in any case
constexpr double kDependent = 1e-13;   // of a row's S_ii: what is left of it after the rows before it were taken out
constexpr double kDoubtful = 1e-9;     // likewise: rounding of S makes that, ε times the ratio of the masses
constexpr int kManyRows = 256;         // above, dependent rows of a sparse S are not decomposed: 25 ms a step
constexpr int kMostDecomposed = 1000;  // above, minutes and gigabytes

template <class Space> const auto& side(const RowOf<Space>& row, int which) { return which == 0 ? row.ja : row.jb; }
template <class Space> int body(const RowOf<Space>& row, int which) { return which == 0 ? row.a : row.b; }

/// The rows' bodies without their numbers: the pattern of G and of the springs.
template <class Space> TermsOf<Space> topology(const SystemOf<Space>& system) {
  TermsOf<Space> terms(system);
  const State x = system.initial_state();
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_rows(system, terms);
  evaluate_forces(system, x.t, x.v, terms);
  return terms;
}

}  // namespace

/// [ M̂ −Gᵀ ; G 0 ] by columns. Every number has a place found once; a new matrix is a loop over places.
template <class Space> struct BasicSystemOf<Space>::Sparse {
  static constexpr int kN = Space::kVelocities, kEntries = 2 * kN, kProducts = kEntries * kEntries;  // of a row
  std::vector<int> start, index;  // compressed columns
  std::vector<double> value, rhs;
  std::vector<int> mass_place;    // dof: M's diagonal
  std::vector<int> spring_place;  // kProducts a spring
  std::vector<int> joint_place;   // 2 kEntries a joint row: its entries, then their transposes
  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
  double growth_of_choice = 0;  // growth() of the matrix that the pivots were chosen for
  int n = 0;
  // For independence(): M^−½ Gᵀ, its square S, and S's factors, analysed once.
  mutable Eigen::SparseMatrix<double> half, square;
  mutable Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors;
  mutable Eigen::VectorXd diagonal;

  Sparse(const System& system, const Terms& terms, int rows) : n(system.dof() + rows) {
    struct Entry {
      int row, column, order;
    };
    std::vector<Entry> entries;
    const auto add = [&](int row, int column) {  // −1: belongs to the ground, has no place
      entries.push_back({row, column, static_cast<int>(entries.size())});
    };
    const auto coordinate = [](const Row& r, int k) {
      const int b = body(r, k / kN);
      return b < 0 ? -1 : kN * b + k % kN;
    };
    for (int i = 0; i < system.dof(); ++i) add(i, i);
    for (const auto& s : terms.springs)
      for (int k = 0; k < kProducts; ++k) add(coordinate(s.row, k / kEntries), coordinate(s.row, k % kEntries));
    for (int r = 0; r < rows; ++r) {
      const Row& row = terms.G[static_cast<std::size_t>(r)];
      for (int k = 0; k < kEntries; ++k) add(system.dof() + r, coordinate(row, k));
      for (int k = 0; k < kEntries; ++k) add(coordinate(row, k), system.dof() + r);
    }
    std::vector<int> place(entries.size(), -1);
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return std::tie(a.column, a.row, a.order) < std::tie(b.column, b.row, b.order);
    });
    start.assign(static_cast<std::size_t>(n) + 1, 0);
    int last_row = -1, last_column = -1;
    for (const Entry& e : entries) {
      if (e.row < 0 || e.column < 0) continue;
      if (e.row != last_row || e.column != last_column) {
        index.push_back(e.row);
        ++start[static_cast<std::size_t>(e.column) + 1];
        last_row = e.row, last_column = e.column;
      }
      place[static_cast<std::size_t>(e.order)] = static_cast<int>(index.size()) - 1;
    }
    for (std::size_t j = 0; j < static_cast<std::size_t>(n); ++j) start[j + 1] += start[j];
    value.resize(index.size());
    rhs.resize(static_cast<std::size_t>(n));
    const auto dof_end = place.begin() + system.dof();
    const auto spring_end = dof_end + kProducts * static_cast<std::ptrdiff_t>(terms.springs.size());
    mass_place.assign(place.begin(), dof_end);
    spring_place.assign(dof_end, spring_end);
    joint_place.assign(spring_end, place.end());
    klu_defaults(&common);
    symbolic = klu_analyze(n, start.data(), index.data(), &common);
  }
  ~Sparse() {
    klu_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }
  Sparse(const Sparse&) = delete;
  Sparse& operator=(const Sparse&) = delete;

  void put(int place, double number) {
    if (place >= 0) value[static_cast<std::size_t>(place)] += number;
  }

  /// Fills the matrix and factorizes it; false when it is singular or not finite.
  bool factorize(const System& system, const Terms& terms, double stiffness_weight, double damping_weight,
                 const Eigen::VectorXd* added, const Eigen::VectorXd& inverse_mass) {
    std::fill(value.begin(), value.end(), 0.0);
    for (std::size_t i = 0; i < mass_place.size(); ++i) put(mass_place[i], system.mass()[static_cast<Index>(i)]);
    if (added != nullptr)
      for (std::size_t i = 0; i < mass_place.size(); ++i) put(mass_place[i], (*added)[static_cast<Index>(i)]);
    for (std::size_t i = 0; i < terms.springs.size(); ++i) {
      const Row& row = terms.springs[i].row;
      const double weight = std::visit(
          [&](const auto& s) {
            if constexpr (requires { s.quadratic; })
              return damping_weight * terms.springs[i].damping;
            else
              return stiffness_weight * s.stiffness + damping_weight * s.damping;
          },
          system.scene().springs[i]);
      for (int k = 0; k < kProducts; ++k)
        put(spring_place[kProducts * i + static_cast<std::size_t>(k)],
            weight * number(row, k / kEntries) * number(row, k % kEntries));
    }
    for (std::size_t r = 0; 2 * kEntries * r < joint_place.size(); ++r)
      for (int k = 0; k < kEntries; ++k) {
        const double entry = number(terms.G[r], k);
        put(joint_place[2 * r * kEntries + static_cast<std::size_t>(k)], entry);
        put(joint_place[(2 * r + 1) * kEntries + static_cast<std::size_t>(k)], -entry);
      }
    if (numeric != nullptr && klu_refactor(start.data(), index.data(), value.data(), symbolic, numeric, &common) != 0 &&
        well_conditioned() && pivots_still_fit())
      return true;
    klu_free_numeric(&numeric, &common);
    numeric = klu_factor(start.data(), index.data(), value.data(), symbolic, &common);
    growth_of_choice = numeric != nullptr ? growth() : 0;
    const auto rows = n - static_cast<int>(inverse_mass.size());
    if (numeric != nullptr && well_conditioned() &&
        (finds_known_solution() || independence(inverse_mass) > kDoubtful || (rows > kMostDecomposed && keeps_rates())))
      return true;
    klu_free_numeric(&numeric, &common);  // so that the next matrix is looked at as closely
    return false;
  }
  /// The pivot that is left of a redundant row is rounding: mostly next to 0, but not in every choice of units. False
  /// also for many independent rows: a chain of n links has a condition number of n².
  bool finds_known_solution() {
    const auto known = [](int i) { return 1 + 0.25 * (i * 7 % 5); };
    std::fill(rhs.begin(), rhs.end(), 0.0);
    for (int j = 0; j < n; ++j)
      for (int k = start[static_cast<std::size_t>(j)]; k < start[static_cast<std::size_t>(j) + 1]; ++k)
        rhs[static_cast<std::size_t>(index[static_cast<std::size_t>(k)])] +=
            value[static_cast<std::size_t>(k)] * known(j);
    klu_solve(symbolic, numeric, n, 1, rhs.data(), &common);
    for (int j = 0; j < n; ++j)
      if (!(std::abs(rhs[static_cast<std::size_t>(j)] - known(j)) < 1e-6)) return false;
    return true;
  }
  /// Pushed about, no joint of the solution moves. So it is also where rows depend on each other but for rounding: then
  /// the motion is right, and the forces are some of those that belong to it.
  bool keeps_rates() {
    const auto dof = mass_place.size();
    for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] = i < dof ? 1 + 0.25 * static_cast<double>(i * 7 % 5) : 0;
    klu_solve(symbolic, numeric, n, 1, rhs.data(), &common);
    double most = 0, missing = 0;
    std::vector<double> rate(rhs.size() - dof), sum(rhs.size() - dof);  // of each row; of its products without signs
    for (std::size_t j = 0; j < dof; ++j)
      for (auto k = static_cast<std::size_t>(start[j]); k < static_cast<std::size_t>(start[j + 1]); ++k)
        if (const auto i = static_cast<std::size_t>(index[k]); i >= dof) {
          rate[i - dof] += value[k] * rhs[j];
          sum[i - dof] += std::abs(value[k] * rhs[j]);
        }
    for (std::size_t i = 0; i < rate.size(); ++i)
      most = std::max(most, sum[i]), missing = std::max(missing, std::abs(rate[i]));
    return missing < 1e-6 * most;
  }
  /// Pivots chosen for another matrix may be small in this one, next to a singular pose above all, and entries grow:
  /// more than in the matrix that they were chosen for, where large trees and nets let them grow as well.
  bool pivots_still_fit() {
    const double now = growth();
    return now > kMostGrowth || now > std::max(kAsChosen * growth_of_choice, kMostEver);
  }
  /// Reciprocal: the least ratio of a column's largest entry in the matrix over that in its factor U; 0: not known.
  double growth() {
    return klu_rgrowth(start.data(), index.data(), value.data(), symbolic, numeric, &common) != 0 ? common.rgrowth : 0;
  }
  bool well_conditioned() {  // cheap estimate: the smallest against the largest pivot
    return common.status == KLU_OK && klu_rcond(symbolic, numeric, &common) != 0 && common.rcond > 1e-15;
  }
  /// The least D_i / S_ii of S = G M⁻¹ Gᵀ = L D Lᵀ.
  double independence(const Eigen::VectorXd& inverse_mass) const {
    const Index dof = inverse_mass.size();
    half.resize(dof, n - dof);
    half.reserve(static_cast<Index>(joint_place.size()) / 2);
    for (int r = static_cast<int>(dof); r < n; ++r) {  // the columns of −Gᵀ
      half.startVec(r - dof);
      for (int k = start[static_cast<std::size_t>(r)]; k < start[static_cast<std::size_t>(r) + 1]; ++k)
        if (const int i = index[static_cast<std::size_t>(k)]; i < dof)
          half.insertBack(i, r - dof) = value[static_cast<std::size_t>(k)] * std::sqrt(inverse_mass[i]);
    }
    half.finalize();
    square = half.transpose() * half;
    if (factors.rows() != square.rows()) factors.analyzePattern(square);
    factors.factorize(square);
    if (factors.info() != Eigen::Success) return 0;
    diagonal = factors.permutationP() * square.diagonal();
    return std::max(0.0, factors.vectorD().cwiseQuotient(diagonal).minCoeff());
  }
  bool finite() const {
    return std::all_of(value.begin(), value.end(), [](double number) { return std::isfinite(number); });
  }
  /// M̂ as a dense matrix.
  Eigen::MatrixXd mass(int dof) const {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(dof, dof);
    for (int j = 0; j < dof; ++j)
      for (int k = start[static_cast<std::size_t>(j)]; k < start[static_cast<std::size_t>(j) + 1]; ++k)
        if (const int i = index[static_cast<std::size_t>(k)]; i < dof) dense(i, j) = value[static_cast<std::size_t>(k)];
    return dense;
  }
  static double number(const Row& row, int k) { return side(row, k / kN)[static_cast<std::size_t>(k % kN)]; }
};

/// x and the least λ by an orthogonal decomposition of A = L⁻¹ Gᵀ D, M̂ = L Lᵀ, D: each column of length 1.
///   x = M̂⁻¹ f + L⁻ᵀ y with the least y that has Aᵀ y = D (c − G M̂⁻¹ f);  λ = D μ with the least μ that has A μ = y.
template <class Space> struct BasicSystemOf<Space>::LeastNorm {
  Eigen::LLT<Eigen::MatrixXd> factor;  // of M̂; not used when M̂ is diagonal:
  Eigen::VectorXd inverse_root;        // diagonal of L⁻¹, or empty
  Eigen::VectorXd scale;               // diagonal of D
  Eigen::MatrixXd G;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> A;

  LeastNorm(const Eigen::MatrixXd& mass, std::span<const Row> rows) : factor(mass) { decompose(rows, mass.rows()); }
  LeastNorm(const Eigen::VectorXd& inverse_mass, std::span<const Row> rows) : inverse_root(inverse_mass.cwiseSqrt()) {
    decompose(rows, inverse_mass.size());
  }

  void decompose(std::span<const Row> rows, Index dof) {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(dof, static_cast<Index>(rows.size()));
    for (Index i = 0; i < columns.cols(); ++i)
      apply_transposed(rows[static_cast<std::size_t>(i)], 1.0, columns.col(i).data());
    G = columns.transpose();
    for (Index i = 0; i < columns.cols(); ++i) columns.col(i) = half(columns.col(i));
    scale = columns.colwise().norm();
    scale = (scale.array() > 0).select(scale.cwiseInverse(), 0.0);
    A.setThreshold(std::sqrt(kDependent));  // lengths here, their squares in the Cholesky factor's pivots
    A.compute(columns * scale.asDiagonal());
  }
  double independence() const {
    const double least = A.matrixQTZ().diagonal().head(A.rank()).cwiseAbs().minCoeff();
    return std::min(1.0, least * least);
  }
  Eigen::VectorXd half(const Eigen::VectorXd& v) const {  // L⁻¹ v
    return inverse_root.size() > 0 ? Eigen::VectorXd(inverse_root.cwiseProduct(v)) : factor.matrixL().solve(v);
  }
  Eigen::VectorXd other_half(const Eigen::VectorXd& v) const {  // L⁻ᵀ v
    return inverse_root.size() > 0 ? Eigen::VectorXd(inverse_root.cwiseProduct(v)) : factor.matrixU().solve(v);
  }
  void solve(Index dof, const double* f, const double* c, double* x, double* lambda) const {
    const Eigen::VectorXd free = other_half(half(Eigen::Map<const Eigen::VectorXd>(f, dof)));
    const Eigen::VectorXd wanted = Eigen::Map<const Eigen::VectorXd>(c, G.rows()) - G * free;
    const Eigen::VectorXd y = A.transpose().solve(scale.cwiseProduct(wanted));
    Eigen::Map<Eigen::VectorXd>(x, dof) = free + other_half(y);
    Eigen::Map<Eigen::VectorXd>(lambda, G.rows()) = scale.cwiseProduct(A.solve(y));
  }
};

template <class Space> BasicSystemOf<Space>::BasicSystemOf(const System& system, bool with_joints)
    : dof_(system.dof()),
      rows_(with_joints ? system.joint_rows() : 0),
      inverse_mass_(system.inverse_mass()),
      zero_(Eigen::VectorXd::Zero(std::max(rows_, dof_))),
      force_(dof_),
      lambda_(rows_) {
  if (rows_ == 0 && system.scene().springs.empty()) return;
  const Terms terms = topology(system);
  if (rows_ > kDenseRows) sparse_schur_ = SparseSchurOf<Space>::of(terms.G, system.bodies());
  if (!system.scene().springs.empty() || (rows_ > kDenseRows && !sparse_schur_))
    sparse_ = std::make_unique<Sparse>(system, terms, rows_);
  if (rows_ > 0 && rows_ <= kDenseRows) schur_.emplace(inverse_mass_, terms.G);
}

template <class Space> BasicSystemOf<Space>::~BasicSystemOf() = default;
template <class Space> BasicSystemOf<Space>::BasicSystemOf(BasicSystemOf&&) noexcept = default;

template <class Space> bool BasicSystemOf<Space>::factorize(const System& system, const Terms& terms,
                                                            double stiffness_weight, double damping_weight,
                                                            const Eigen::VectorXd* added) {
  redundant_ = false;
  if (added != nullptr || added_) {
    added_ = added != nullptr;
    inverse_mass_ = system.inverse_mass();
    if (added_) inverse_mass_ = (system.mass() + *added).cwiseInverse();
    if (schur_) schur_->set_inverse_mass(inverse_mass_);
  }
  const std::span<const Row> G(terms.G.data(), static_cast<std::size_t>(rows_));
  const bool springs = !terms.springs.empty() && (stiffness_weight != 0 || damping_weight != 0);
  if (rows_ == 0 && !springs) {
    method_ = Method::diagonal;
    return true;
  }
  if (sparse_schur_ && !springs) {
    method_ = Method::cholesky;
    if (sparse_schur_->factorize(G, inverse_mass_, kDoubtful)) return true;
    if (rows_ > kManyRows) {
      if (!sparse_schur_->factorize_dependent()) return false;
      redundant_ = sparse_schur_->rank() < rows_;
      return true;
    }
  }
  if (rows_ > kDenseRows || springs) {
    method_ = Method::saddle;
    if (!sparse_) sparse_ = std::make_unique<Sparse>(system, terms, rows_);
    if (sparse_->factorize(system, terms, stiffness_weight, damping_weight, added, inverse_mass_)) return true;
    if (!sparse_->finite()) return false;
    least_norm_ = std::make_unique<LeastNorm>(sparse_->mass(dof_), G);
  } else {
    method_ = Method::dense;
    if (schur_->factorize(G, kDoubtful)) return true;
    if (!schur_->finite()) return false;
    least_norm_ = std::make_unique<LeastNorm>(inverse_mass_, G);
  }
  method_ = Method::least_norm;
  redundant_ = true;
  return true;
}

template <class Space> int BasicSystemOf<Space>::rank() const {
  if (method_ == Method::least_norm) return static_cast<int>(least_norm_->A.rank());
  return method_ == Method::cholesky ? sparse_schur_->rank() : rows_;
}

template <class Space> double BasicSystemOf<Space>::independence() const {
  if (rows_ == 0 || rank() == 0) return 1;
  if (method_ == Method::least_norm) return least_norm_->independence();
  if (method_ == Method::cholesky) return sparse_schur_->independence();
  return method_ == Method::dense ? schur_->independence() : sparse_->independence(inverse_mass_);
}

template <class Space> void BasicSystemOf<Space>::forget() {
  if (sparse_) klu_free_numeric(&sparse_->numeric, &sparse_->common);
}

template <class Space>
void BasicSystemOf<Space>::solve(const double* f, const double* c, double* x, double* lambda) const {
  if (method_ == Method::least_norm) return least_norm_->solve(dof_, f, c, x, lambda);
  if (method_ == Method::dense) return schur_->solve(f, c, x, lambda);
  if (method_ == Method::cholesky) return sparse_schur_->solve(f, c, x, lambda);
  if (method_ == Method::saddle) {
    Eigen::Map<Eigen::VectorXd> rhs(sparse_->rhs.data(), sparse_->n);
    rhs.head(dof_) = Eigen::Map<const Eigen::VectorXd>(f, dof_);
    if (rows_ > 0) rhs.tail(rows_) = Eigen::Map<const Eigen::VectorXd>(c, rows_);
    klu_solve(sparse_->symbolic, sparse_->numeric, sparse_->n, 1, sparse_->rhs.data(), &sparse_->common);
    std::copy_n(sparse_->rhs.data(), dof_, x);
    std::copy_n(sparse_->rhs.data() + dof_, rows_, lambda);
    return;
  }
  Eigen::Map<Eigen::VectorXd>(x, dof_) = inverse_mass_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(f, dof_));
}

template <class Space> void BasicSystemOf<Space>::solve_change(std::span<const Row> G, const double* f, const double* v,
                                                               const double* c, double* x, double* lambda) const {
  if (method_ == Method::dense) return schur_->solve_change(f, v, c, x, lambda);
  for (std::size_t i = 0; i < static_cast<std::size_t>(rows_); ++i) lambda[i] = c[i] - apply(G[i], v);
  solve(f, lambda, x, lambda);
}

template <class Space> void BasicSystemOf<Space>::add_rates(const double* c, double* x) const {
  if (method_ == Method::dense) return schur_->add_rates(c, x);
  solve(zero_.data(), c, force_.data(), lambda_.data());
  Eigen::Map<Eigen::VectorXd>(x, dof_) += force_;
}

template <class Space> void BasicSystemOf<Space>::solve_row(const Row& row, double* x) const {
  if (method_ == Method::dense) return schur_->solve_row(row, x);
  // A row touches two bodies at the most, but x is full as soon as joints carry it on.
  force_.setZero();
  apply_transposed(row, 1.0, force_.data());
  solve(force_.data(), zero_.data(), x, lambda_.data());
}

template class BasicSystemOf<Planar>;
template class BasicSystemOf<Spatial>;

}  // namespace orthant
