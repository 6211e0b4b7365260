#include <orthant/solvers/linear_algebra/basis.h>

#include <orthant/solvers/factorization_count.h>

#include <cmath>
#include <limits>
#include <type_traits>

namespace orthant {
namespace {

constexpr Index kDiagnosed = 2000;  // columns of a sparse core that a dense factorization looks at when it is singular

using std::abs, std::ilogb, std::isfinite, std::ldexp;  // those of Float256 are found by its namespace

template <class T> const T kZero = 64 * std::numeric_limits<T>::epsilon();     // a pivot of a scaled core
template <class T> const T kUpdate = 1e5 * std::numeric_limits<T>::epsilon();  // |x_k| relative to ‖x‖∞

}  // namespace

template <class T> void Basis<T>::reset(Index n, Storage storage, int update_limit, const Budget* budget) {
  n_ = n;
  budget_ = budget;
  sparse_ = storage == Storage::sparse && std::is_same_v<T, double>;
  update_limit_ = update_limit;
}

template <class T> bool Basis<T>::factorize_gathered() {
  eta_position_.clear();
  eta_pivot_.clear();
  eta_index_.clear();
  eta_value_.clear();
  eta_start_.assign(1, 0);
  missing_.clear();
  if (budget_ != nullptr && budget_->exhausted()) return false;
  whole_.resize(at(n_));
  for (const T& value : value_)
    if (!isfinite(value)) return false;
  gather_core();
  const auto m = static_cast<Index>(core_row_.size());
  core_.resize(at(m));
  core_double_.resize(at(m));
  const auto for_each_entry = [&](const auto& use) {
    for (Index c = 0; c < m; ++c)
      for (auto e = at(start_[at(core_column_[at(c)])]); e < at(start_[at(core_column_[at(c)]) + 1]); ++e)
        if (const Index r = place_[at(row_[e])]; r >= 0) use(r, c, value_[e]);
  };
  // Middle of the exponents of each row, then of each column, twice; at last each column's largest entry to [1, 2), so
  // that a pivot is small or not relative to that.
  row_scale_.assign(at(m), T(1));
  col_scale_.assign(at(m), T(1));
  const auto center = [&](std::vector<T>& scale, bool rows, bool middle) {
    low_.assign(at(m), std::numeric_limits<int>::max());
    high_.assign(at(m), std::numeric_limits<int>::min());
    for_each_entry([&](Index r, Index c, T value) {
      const int exponent = ilogb(value * row_scale_[at(r)] * col_scale_[at(c)]);
      int& low = low_[at(rows ? r : c)];
      int& high = high_[at(rows ? r : c)];
      low = std::min(low, exponent), high = std::max(high, exponent);
    });
    for (Index i = 0; i < m; ++i)
      if (low_[at(i)] <= high_[at(i)])
        scale[at(i)] = ldexp(scale[at(i)], middle ? -(low_[at(i)] + high_[at(i)]) / 2 : -high_[at(i)]);
  };
  for (int sweep = 0; sweep < 2; ++sweep) center(row_scale_, true, true), center(col_scale_, false, true);
  center(col_scale_, false, false);

  count_factorization(m);
  if (sparse_) {
    klu_start_.assign(1, 0);
    klu_row_.clear();
    klu_value_.clear();
    for_each_entry([&](Index r, Index c, T value) {
      while (static_cast<Index>(klu_start_.size()) <= c) klu_start_.push_back(static_cast<int>(klu_row_.size()));
      klu_row_.push_back(static_cast<int>(r));
      klu_value_.push_back(static_cast<double>(value * row_scale_[at(r)] * col_scale_[at(c)]));
    });
    while (static_cast<Index>(klu_start_.size()) <= m) klu_start_.push_back(static_cast<int>(klu_row_.size()));
    if (klu_.factorize(klu_start_, klu_row_, klu_value_, static_cast<double>(kZero<T>), budget_)) {
      pivot_ratio_ = static_cast<T>(klu_.least_pivot() / klu_.largest_pivot());
      return true;
    }
    if (m > kDiagnosed || (budget_ != nullptr && budget_->exhausted())) return false;
  }
  typename DenseLu<T>::Dense dense(dense_.reset(m), m, m);
  dense.setZero();
  for_each_entry([&](Index r, Index c, T value) { dense(r, c) = value * row_scale_[at(r)] * col_scale_[at(c)]; });
  const Index rank = dense_.factorize(kZero<T>, budget_);
  if (rank < 0) return false;
  for (Index k = rank; k < m; ++k)
    missing_.push_back({core_column_[at(dense_.column(k))], core_row_[at(dense_.row(k))]});
  if (rank == m && sparse_) sparse_ = false;  // the two do not agree on what is singular: dense it is, until reset()
  pivot_ratio_ = dense_.least_pivot() / dense_.largest_pivot();
  return rank == m;
}

template <class T> void Basis<T>::gather_core() {
  unit_.assign(at(n_), -1);
  place_.assign(at(n_), -1);
  core_column_.clear();
  core_row_.clear();
  for (Index k = 0; k < n_; ++k) {
    const auto first = at(start_[at(k)]);
    if (at(start_[at(k) + 1]) == first + 1 && unit_[at(row_[first])] < 0)
      unit_[at(row_[first])] = k;
    else
      core_column_.push_back(k);
  }
  for (Index r = 0; r < n_; ++r)
    if (unit_[at(r)] < 0) {
      place_[at(r)] = static_cast<Index>(core_row_.size());
      core_row_.push_back(r);
    }
}

template <class T> void Basis<T>::solve(View x) {
  const auto m = static_cast<Index>(core_row_.size());
  const auto core_solve = [&](auto& lu, auto* v) {
    for (Index r = 0; r < m; ++r)
      v[r] = static_cast<std::remove_reference_t<decltype(*v)>>(x[core_row_[at(r)]] * row_scale_[at(r)]);
    lu.solve(v);
    for (Index c = 0; c < m; ++c) core_[at(c)] = static_cast<T>(v[c]) * col_scale_[at(c)];
  };
  if (sparse_)
    core_solve(klu_, core_double_.data());
  else
    core_solve(dense_, core_.data());
  for (Index c = 0; c < m; ++c) {
    const T z = core_[at(c)];
    if (z == T(0)) continue;
    for (auto e = at(start_[at(core_column_[at(c)])]); e < at(start_[at(core_column_[at(c)]) + 1]); ++e)
      x[row_[e]] -= value_[e] * z;  // rows of the core are written over below
  }
  for (Index r = 0; r < n_; ++r)
    if (const Index k = unit_[at(r)]; k >= 0) whole_[at(k)] = x[r] / value_[at(start_[at(k)])];
  for (Index c = 0; c < m; ++c) whole_[at(core_column_[at(c)])] = core_[at(c)];
  std::copy(whole_.begin(), whole_.end(), x.data());
  for (std::size_t e = 0; e < eta_position_.size(); ++e) {
    T& pivot = x[eta_position_[e]];
    if (pivot == T(0)) continue;
    pivot /= eta_pivot_[e];
    for (std::size_t i = eta_start_[e]; i < eta_start_[e + 1]; ++i) x[eta_index_[i]] -= eta_value_[i] * pivot;
  }
}

template <class T> void Basis<T>::solve_transposed(View y) {
  for (std::size_t e = eta_position_.size(); e-- > 0;) {
    T sum = y[eta_position_[e]];
    for (std::size_t i = eta_start_[e]; i < eta_start_[e + 1]; ++i) sum -= eta_value_[i] * y[eta_index_[i]];
    y[eta_position_[e]] = sum / eta_pivot_[e];
  }
  const auto m = static_cast<Index>(core_row_.size());
  for (Index r = 0; r < n_; ++r)
    if (const Index k = unit_[at(r)]; k >= 0) whole_[at(r)] = y[k] / value_[at(start_[at(k)])];
  for (Index c = 0; c < m; ++c) {
    T sum = y[core_column_[at(c)]];
    for (auto e = at(start_[at(core_column_[at(c)])]); e < at(start_[at(core_column_[at(c)]) + 1]); ++e)
      if (place_[at(row_[e])] < 0) sum -= value_[e] * whole_[at(row_[e])];
    core_[at(c)] = sum * col_scale_[at(c)];
  }
  if (sparse_) {
    for (Index c = 0; c < m; ++c) core_double_[at(c)] = static_cast<double>(core_[at(c)]);
    klu_.solve_transposed(core_double_.data());
    for (Index c = 0; c < m; ++c) core_[at(c)] = static_cast<T>(core_double_[at(c)]);
  } else {
    dense_.solve_transposed(core_.data());
  }
  for (Index r = 0; r < m; ++r) whole_[at(core_row_[at(r)])] = core_[at(r)] * row_scale_[at(r)];
  std::copy(whole_.begin(), whole_.end(), y.data());
}

template <class T> bool Basis<T>::replace(Index k, ConstView x) {
  const T size = x.cwiseAbs().maxCoeff(), pivot = abs(x[k]);
  if (updates() >= update_limit_ || !(pivot > kUpdate<T> * size)) return false;
  pivot_ratio_ = std::min(pivot_ratio_, pivot / size);
  for (Index i = 0; i < n_; ++i) {
    if (i == k || x[i] == T(0)) continue;
    eta_index_.push_back(i);
    eta_value_.push_back(x[i]);
  }
  eta_position_.push_back(k);
  eta_pivot_.push_back(x[k]);
  eta_start_.push_back(eta_index_.size());
  return true;
}

template class Basis<double>;
template class Basis<long double>;
template class Basis<detail::Float256>;

}  // namespace orthant
