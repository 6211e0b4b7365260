#include <orthant/solvers/pivoting/revised_lemke.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace orthant::detail {

namespace {
constexpr double kPivot = 0x1p-36, kTie = 0x1p-36, kNoise = 0x1p-44;
}

template <class Add> void RevisedLemke::column(int variable, const Add& add) const {
  if (variable < n_) {
    add(variable, 1.0);
  } else if (variable == covering()) {
    for (int i = 0; i < n_; ++i)
      if (!free_[at(i)]) add(i, -cover_[i]);
  } else {
    for (int k = start_[at(variable - n_)]; k < start_[at(variable - n_) + 1]; ++k) add(row_[at(k)], -value_[at(k)]);
  }
}

bool RevisedLemke::load(const Lcp& problem, const Vector& cover, const Budget& budget) {
  budget_ = &budget;
  q_ = problem.b;
  rows_ = problem.size();
  n_ = static_cast<int>(problem.size());
  cover_ = cover;
  iterations_ = 0;
  leaving_row_ = covering_row_ = -1;
  start_.assign(at(n_) + 1, 0);
  row_.clear();
  value_.clear();
  const auto* const sparse = std::get_if<RowSparse>(&problem.A);
  if (sparse != nullptr) {  // rows to columns: count, then place
    for (const int j : sparse->column) ++start_[at(j) + 1];
    for (int j = 0; j < n_; ++j) start_[at(j) + 1] += start_[at(j)];
    row_.resize(sparse->column.size());
    value_.resize(sparse->column.size());
    for (int i = 0; i < n_; ++i)
      for (int k = sparse->start[at(i)]; k < sparse->start[at(i) + 1]; ++k) {
        const int place = start_[at(sparse->column[at(k)])]++;
        row_[at(place)] = i;
        value_[at(place)] = sparse->value[at(k)];
      }
    for (int j = n_; j > 0; --j) start_[at(j)] = start_[at(j) - 1];
    start_[0] = 0;
  } else {
    const auto& M = std::get<DenseMatrix>(problem.A);
    for (int j = 0; j < n_; ++j) {
      for (int i = 0; i < n_; ++i)
        if (M(i, j) != 0) row_.push_back(i), value_.push_back(M(i, j));
      start_[at(j) + 1] = static_cast<int>(row_.size());
    }
  }
  free_.resize(at(n_));
  basic_.resize(at(n_));
  for (int i = 0; i < n_; ++i) {
    free_[at(i)] = problem.lo[i] == -kInf;
    basic_[at(i)] = free_[at(i)] ? n_ + i : i;
  }
  const auto storage = sparse != nullptr ? Basis<double>::Storage::sparse : Basis<double>::Storage::dense;
  basis_.reset(n_, storage, 64, budget_);
  if (factorize()) return true;
  if (!split()) return false;
  basis_.reset(n_, storage, 64, budget_);
  return factorize();
}

// Every free row i gets a twin with the sign turned: z_i = z⁺ − z⁻, w_i ≥ 0 and −w_i ≥ 0: two complementary rows.
bool RevisedLemke::split() {
  const int n = n_;
  twin_.assign(at(n), -1);
  origin_.clear();
  for (int i = 0; i < n; ++i)
    if (free_[at(i)]) twin_[at(i)] = n_++, origin_.push_back(i);
  if (n_ == n) return false;
  const std::vector<int> start = start_, row = row_;
  const std::vector<double> value = value_;
  start_.assign(1, 0);
  row_.clear();
  value_.clear();
  for (int j = 0; j < n_; ++j) {
    const int from = j < n ? j : origin_[at(j - n)];
    const double sign = j < n ? 1 : -1;
    for (int k = start[at(from)]; k < start[at(from) + 1]; ++k) {
      const int i = row[at(k)];
      row_.push_back(i), value_.push_back(sign * value[at(k)]);
      if (twin_[at(i)] >= 0) row_.push_back(twin_[at(i)]), value_.push_back(-sign * value[at(k)]);
    }
    start_.push_back(static_cast<int>(row_.size()));
  }
  q_.conservativeResize(n_);
  cover_.conservativeResize(n_);
  for (int j = n; j < n_; ++j) q_[j] = -q_[origin_[at(j - n)]], cover_[j] = cover_[origin_[at(j - n)]];
  free_.assign(at(n_), 0);
  basic_.resize(at(n_));
  for (int i = 0; i < n_; ++i) basic_[at(i)] = i;
  return true;
}

// B again, and x_B = B⁻¹ q from the data, with one step of refinement in long double.
bool RevisedLemke::factorize() {
  if (!basis_.factorize([this](Index k, const auto& add) { column(basic_[at(k)], add); })) return false;
  x_ = q_;
  basis_.solve(x_);
  exact_.resize(at(n_));
  for (int i = 0; i < n_; ++i) exact_[at(i)] = q_[i];
  for (int k = 0; k < n_; ++k)
    column(basic_[at(k)], [&](int i, double value) { exact_[at(i)] -= static_cast<long double>(value) * x_[k]; });
  residual_.resize(n_);
  for (int i = 0; i < n_; ++i) residual_[i] = static_cast<double>(exact_[at(i)]);
  basis_.solve(residual_);
  x_ += residual_;
  return x_.allFinite();
}

// The row that z₀ replaces: the least q_i / d_i, and among equals the least of the perturbation: the last.
bool RevisedLemke::enter_covering() {
  perturbation_.resize(n_);
  std::minstd_rand random;  // the same numbers on every machine and in every run
  for (int i = 0; i < n_; ++i) perturbation_[i] = cover_[i] * (1 + 0x1p-31 * static_cast<double>(random()));
  second_ = perturbation_;
  basis_.solve(second_);
  std::pair<double, double> least{0, kInf};
  for (int i = 0; i < n_; ++i)
    if (!free_[at(i)] && x_[i] < 0)
      if (const std::pair ratio{x_[i] / cover_[i], second_[i] / cover_[i]}; ratio < least)
        least = ratio, leaving_row_ = i;
  if (leaving_row_ < 0) return false;
  entering_ = covering();
  u_.resize(n_);
  u_.setZero();
  column(entering_, [this](int i, double value) { u_[i] += value; });
  basis_.solve(u_);
  return true;
}

int RevisedLemke::exchange() {
  const int r = leaving_row_, leaving = basic_[at(r)];
  const double step = x_[r] / u_[r];
  x_ -= step * u_;
  x_[r] = step;
  basic_[at(r)] = entering_;
  if (entering_ == covering()) covering_row_ = r;
  ++iterations_;
  const bool last = leaving == covering();
  if ((last || !basis_.replace(r, u_)) && !factorize()) return kLost;
  return leaving;
}

bool RevisedLemke::price() {
  for (;;) {
    u_.setZero();
    column(entering_, [this](int i, double value) { u_[i] += value; });
    basis_.solve(u_);
    leaving_row_ = ratio_test();
    if (leaving_row_ >= 0 || basis_.updates() == 0) return true;
    if (!factorize()) return false;  // a ray only from fresh factors
  }
}

int RevisedLemke::ratio_test() {
  double largest = 0;
  for (int i = 0; i < n_; ++i)
    if (!free_[at(i)]) largest = std::max(largest, std::abs(u_[i]));
  const double tiny = kPivot * largest, noise = kNoise * x_.lpNorm<Eigen::Infinity>();
  const auto value = [&](int i) { return x_[i] > noise ? x_[i] : 0.0; };
  double least = kInf;
  for (int i = 0; i < n_; ++i)
    if (!free_[at(i)] && u_[i] > tiny) least = std::min(least, value(i) / u_[i]);
  if (least == kInf) return -1;
  ties_.clear();
  for (int i = 0; i < n_; ++i)
    if (!free_[at(i)] && u_[i] > tiny && value(i) / u_[i] <= least * (1 + kTie)) {
      if (i == covering_row_) return i;
      ties_.push_back(i);
    }
  return ties_.size() == 1 ? ties_[0] : perturbed();
}

// The tied row with the least of (B⁻¹ p)_i / u_i; of those that rounding leaves equal, the largest pivot.
int RevisedLemke::perturbed() {
  second_ = perturbation_;
  basis_.solve(second_);
  int best = ties_[0];
  for (const int i : ties_) {
    const double a = second_[i] / u_[i], b = second_[best] / u_[best];
    const bool equal = std::abs(a - b) <= kTie * std::max(std::abs(a), std::abs(b));
    if (equal ? u_[i] > u_[best] : a < b) best = i;
  }
  return best;
}

void RevisedLemke::add(int variable, double amount, Vector& z) const {
  const int j = variable - n_;
  if (j < 0 || j >= n_) return;
  if (j < rows_)
    z[j] += amount;
  else
    z[origin_[at(j - rows_)]] -= amount;
}

void RevisedLemke::point(Vector& z) const {
  z.resize(rows_);
  z.setZero();
  for (int k = 0; k < n_; ++k) add(basic_[at(k)], free_[at(k)] ? x_[k] : std::max(x_[k], 0.0), z);
}

void RevisedLemke::ray(Vector& z) const {
  z.resize(rows_);
  z.setZero();
  add(entering_, 1, z);
  for (int k = 0; k < n_; ++k) add(basic_[at(k)], -u_[k], z);
}

}  // namespace orthant::detail
