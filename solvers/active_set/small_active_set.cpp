#include <orthant/solvers/active_set/small_active_set.h>

#include <orthant/solvers/active_set/active_rows.h>
#include <orthant/solvers/factorization_count.h>
#include <orthant/solvers/linear_algebra/dense_lu.h>
#include <orthant/solvers/linear_algebra/kernels.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace orthant {
namespace {

constexpr double kRoundoff = std::numeric_limits<double>::epsilon();
constexpr int kMost = 12;          // factorizations
constexpr Index kFromInside = 20;  // rows from which a start with all of them inside may be worth its factorization
constexpr int kMostLayers = 24;    // of a Z-matrix: a string may have as many layers as rows
constexpr int kPasses = 3;         // of them that make nothing better
constexpr Index kDear = 200;       // rows from which one such pass is enough
constexpr Index kSingly = 8;       // rows up to which one at a time is tried then; beyond, pivoting does that for less
constexpr double kMissed = 1e-9;
constexpr double kRoundings = 16;  // roundings of its terms by which a w_i = 0 may look wrong
constexpr Index kAny = Eigen::Dynamic;

/// Room for n entries: within the object where n is known when compiled.
template <class T, Index N> class List {
 public:
  void fit(Index) {}
  T& operator[](Index i) { return items_[at(i)]; }
  const T& operator[](Index i) const { return items_[at(i)]; }
  T* data() { return items_.data(); }

 private:
  std::array<T, at(N)> items_;
};
template <class T> class List<T, kAny> {
 public:
  void fit(Index n) {
    if (at(n) > items_.size()) items_.resize(at(n));
  }
  T& operator[](Index i) { return items_[at(i)]; }
  const T& operator[](Index i) const { return items_[at(i)]; }
  T* data() { return items_.data(); }

 private:
  std::vector<T> items_;
};

/// One problem of N rows (kAny: of as many as it has).
template <Index N> class Attempt {
 public:
  bool solve(const Lcp& problem, double* z, int& iterations, const Budget& budget, double mostly);

 private:
  Index size() const { return N == kAny ? size_known_late_ : N; }
  void load(const Lcp& problem);
  bool at_rest(const double* z) const;
  bool z_matrix() const;
  void guess(double* z);
  void release_most(double share);
  bool newton(double* z);
  void correct(double* z);
  Index mend(const double* z, bool one);
  void product(const double* z);
  void bounds(const double* z);

  const Lcp* problem_ = nullptr;
  const double *A_ = nullptr, *b_ = nullptr;
  int* iterations_ = nullptr;
  const Budget* budget_ = nullptr;
  Index size_known_late_ = 0;
  Index inside_count_ = 0, sliding_count_ = 0, rank_ = 0;
  bool friction_ = false;
  List<Side, N> side_;
  List<Index, N> inside_, place_, normal_;  // place_: among the inside rows, or −1; normal_: of a friction row, or −1
  List<Friction, N> sliding_;               // mu: with the sign of the side
  List<double, N> mu_, lo_, hi_, w_, terms_, rhs_;
  DenseLu<double, N == kAny ? Eigen::Dynamic : N> lu_;
};

template <Index N> void Attempt<N>::load(const Lcp& problem) {
  problem_ = &problem;
  A_ = std::get<DenseMatrix>(problem.A).data(), b_ = problem.b.data();
  size_known_late_ = problem.size();
  const Index n = size();
  for (List<double, N>* each : {&mu_, &lo_, &hi_, &w_, &terms_, &rhs_}) each->fit(n);
  for (List<Index, N>* each : {&inside_, &place_, &normal_}) each->fit(n);
  side_.fit(n), sliding_.fit(n);
  for (Index i = 0; i < n; ++i) lo_[i] = problem.lo[i], hi_[i] = problem.hi[i], normal_[i] = -1;
  friction_ = !problem.friction.empty();
  for (const Friction& f : problem.friction) normal_[f.first] = f.normal, mu_[f.first] = f.mu;
}

template <Index N> void Attempt<N>::bounds(const double* z) {
  for (const Friction& f : problem_->friction)
    hi_[f.first] = f.mu * std::max(z[f.normal], 0.0), lo_[f.first] = -hi_[f.first];
}

/// No positive entry outside a positive diagonal.
template <Index N> bool Attempt<N>::z_matrix() const {
  const Index n = size();
  for (Index j = 0; j < n; ++j) {
    const double* const column = A_ + j * n;
    bool fits = column[j] > 0;
    for (Index i = 0; i < n; ++i) fits &= (i == j) | (column[i] <= 0);
    if (!fits) return false;
  }
  return problem_->friction.empty();
}

/// Two Gauss-Seidel sweeps, w = A z + b kept up to date column by column; then each row on the side where that leaves
/// it.
template <Index N> void Attempt<N>::guess(double* z) {
  const Index n = size();
  double* const w = w_.data();
  double* const by = rhs_.data();  // 1 / A_ii: the sweeps' rows wait for one another, and would for divisions
  for (Index i = 0; i < n; ++i) {
    const double d = A_[i * n + i];
    w[i] = b_[i], by[i] = d > 0 ? 1 / d : 0;
  }
  const auto move = [&](Index j, double change) {
    const double* const column = A_ + j * n;
    if constexpr (N == kAny)
      detail::subtract(w, -change, column, n);
    else
      for (Index i = 0; i < n; ++i) w[i] += change * column[i];
  };
  for (Index j = 0; j < n; ++j)
    if (z[j] != 0) move(j, z[j]);
  for (int sweep = 0; sweep < 2; ++sweep)
    for (Index i = 0; i < n; ++i) {
      if (friction_ && normal_[i] >= 0) hi_[i] = mu_[i] * std::max(z[normal_[i]], 0.0), lo_[i] = -hi_[i];
      const double to = std::clamp(z[i] - w[i] * by[i], lo_[i], hi_[i]);
      if (to != z[i]) move(i, to - z[i]);
      z[i] = to;
    }
  for (Index i = 0; i < n; ++i) {
    const double to = z[i] - w[i] * (A_[i * n + i] > 0 ? by[i] : 1);
    side_[i] = to <= lo_[i] ? Side::lower : to >= hi_[i] ? Side::upper : Side::inside;
  }
}

/// Where the guess has that share of the rows inside, all of them.
template <Index N> void Attempt<N>::release_most(double share) {
  const Index n = size();
  if (n < kFromInside || !problem_->friction.empty()) return;
  Index inside = 0;
  for (Index i = 0; i < n; ++i) inside += side_[i] == Side::inside;
  if (static_cast<double>(inside) < share * static_cast<double>(n)) return;
  for (Index i = 0; i < n; ++i) side_[i] = Side::inside;
}

/// terms ← |b| + |A| |z|, w ← A z + b.
template <Index N> void Attempt<N>::product(const double* z) {
  const Index n = size();
  double* const w = w_.data();
  double* const terms = terms_.data();
  for (Index i = 0; i < n; ++i) w[i] = b_[i], terms[i] = std::abs(w[i]);
  for (Index j = 0; j < n; ++j) {
    if (z[j] == 0) continue;
    if constexpr (N == kAny)
      detail::add_with_size(w, terms, z[j], A_ + j * n, n);
    else
      for (Index i = 0; i < n; ++i) {
        const double term = z[j] * A_[j * n + i];
        w[i] += term, terms[i] += std::abs(term);
      }
  }
}

/// z of the present sides; false where they do not determine it, or the budget was over before they did.
template <Index N> bool Attempt<N>::newton(double* z) {
  const Index n = size();
  Index m = 0;
  for (Index i = 0; i < n; ++i) {
    const bool inside = side_[i] == Side::inside;
    place_[i] = inside ? m : -1;
    if (inside) inside_[m++] = i;
    z[i] = inside || (friction_ && normal_[i] >= 0) ? 0 : side_[i] == Side::lower ? lo_[i] : hi_[i];
  }
  inside_count_ = rank_ = m;
  sliding_count_ = 0;
  for (const Friction& f : problem_->friction) {  // those of an open contact stay at ±μ z_n too
    if (side_[f.first] == Side::inside) continue;
    const double slope = side_[f.first] == Side::lower ? -f.mu : f.mu;
    if (place_[f.normal] < 0)
      z[f.first] = slope * z[f.normal];
    else
      sliding_[sliding_count_++] = {f.normal, f.first, 1, slope};
  }
  product(z);
  if (m == 0) return true;
  ++*iterations_;
  count_factorization(m);
  double* const block = lu_.reset(m);
  double largest = 0;
  for (Index c = 0; c < m; ++c) {
    const double* const from = A_ + inside_[c] * n;
    double* const to = block + c * m;
    for (Index r = 0; r < m; ++r) to[r] = from[inside_[r]];
  }
  for (Index k = 0; k < sliding_count_; ++k) {
    const Friction& f = sliding_[k];
    for (Index r = 0; r < m; ++r) block[r + m * place_[f.normal]] += f.mu * A_[inside_[r] + n * f.first];
  }
  if constexpr (N == kAny)
    largest = detail::largest(block, m * m);
  else
    for (Index k = 0; k < m * m; ++k) largest = std::max(largest, std::abs(block[k]));
  if (!(largest < kInf)) return false;
  const double zero = static_cast<double>(2 * m) * kRoundoff * largest;
  if constexpr (N == kAny)
    rank_ = lu_.factorize(zero, budget_);
  else
    rank_ = lu_.factorize(zero);
  if (rank_ < 0) return false;
  correct(z);
  return true;
}

/// z ← z − J⁻¹ w on the inside rows, the sliding ones with their normals; then w of it.
template <Index N> void Attempt<N>::correct(double* z) {
  const Index m = inside_count_;
  for (Index r = 0; r < m; ++r) rhs_[r] = w_[inside_[r]];
  if (m > 0) lu_.solve(rhs_.data(), rank_);
  for (Index r = 0; r < m; ++r) z[inside_[r]] -= rhs_[r];
  for (Index k = 0; k < sliding_count_; ++k) z[sliding_[k].first] = sliding_[k].mu * z[sliding_[k].normal];
  product(z);
}

/// Rows whose sign is wrong by more than rounding, put on the side where it would be right: all, or the last of them
/// alone.
template <Index N> Index Attempt<N>::mend(const double* z, bool one) {
  const Index n = size();
  double reach = 0;
  for (Index i = 0; i < n; ++i) reach = std::max(reach, std::abs(z[i]));
  const double z_noise = kRoundings * kRoundoff * reach;
  Index wrong = 0, last = -1;
  Side last_before{};
  for (Index i = 0; i < n; ++i) {
    const double noise = kRoundings * kRoundoff * terms_[i];
    const bool friction = friction_ && normal_[i] >= 0;
    const double normal = friction ? z[normal_[i]] : 0;
    const double hi = friction ? mu_[i] * std::max(normal, 0.0) : hi_[i], lo = friction ? -hi : lo_[i];
    Side& side = side_[i];
    const Side before = side;
    if (side == Side::inside) {
      if (z[i] < lo - z_noise) side = Side::lower;
      if (z[i] > hi + z_noise) side = Side::upper;
      const bool missed = rank_ < inside_count_ && std::abs(w_[i]) > kMissed * terms_[i];
      if (side == before && missed && std::abs(w_[i] > 0 ? lo : hi) < kInf)
        side = w_[i] > 0 ? Side::lower : Side::upper;  // its equation depends on others and contradicts them
    } else if (lo < hi && (side == Side::lower ? w_[i] < -noise : w_[i] > noise)) {
      side = Side::inside;
    }
    if (side == before) continue;
    ++wrong;
    if (one && last >= 0) side_[last] = last_before;
    last = i, last_before = before;
  }
  for (const Friction& f : problem_->friction)  // a contact that closes sticks at first
    if (side_[f.normal] == Side::inside && place_[f.normal] < 0) side_[f.first] = Side::inside;
  return wrong;
}

/// z = 0 and all rows on a bound that b holds them at: contacts that stay open.
template <Index N> bool Attempt<N>::at_rest(const double* z) const {
  bool rest = true;
  for (Index i = 0; i < size(); ++i)
    rest &= z[i] == 0 && (b_[i] == 0 || (b_[i] > 0 ? lo_[i] == 0 : hi_[i] == 0) || (friction_ && normal_[i] >= 0));
  return rest;
}

template <Index N>
bool Attempt<N>::solve(const Lcp& problem, double* z, int& iterations, const Budget& budget, double mostly) {
  load(problem);
  iterations_ = &iterations;
  budget_ = &budget;
  const Index n = size();
  for (Index i = 0; i < n; ++i) z[i] = std::clamp(z[i], lo_[i], hi_[i]);
  if (at_rest(z)) return true;
  const bool monotone = n >= kFromInside && z_matrix();
  if (monotone)  // rows then leave in large blocks, while from the bounds they enter one layer an iteration
    for (Index i = 0; i < n; ++i) side_[i] = Side::inside;
  else
    guess(z), release_most(mostly);
  const auto settled = [&] {
    for (Index r = 0; r < inside_count_; ++r)
      if (!(std::abs(w_[inside_[r]]) <= kRoundings * kRoundoff * terms_[inside_[r]])) return false;
    return true;
  };
  Index least = n + 1;
  const Index passes = n < kDear ? kPasses : 1;
  for (Index k = 0, patience = passes; k < (monotone ? kMostLayers : kMost); ++k) {
    if ((k > 0 && budget.exhausted()) || !newton(z)) return false;
    const Index wrong = mend(z, patience < 0 && !monotone);
    if (wrong == 0) {
      if (!settled()) correct(z);
      if (!settled()) return false;
      for (Index r = 0; r < inside_count_; ++r) {
        const Index i = inside_[r];
        if (normal_[i] < 0) z[i] = std::clamp(z[i], lo_[i], hi_[i]);
      }
      bounds(z);
      for (const Friction& f : problem.friction) z[f.first] = std::clamp(z[f.first], lo_[f.first], hi_[f.first]);
      double sum = 0;
      for (Index i = 0; i < n; ++i) sum += 0 * z[i];
      return sum == 0;
    }
    if (wrong < least)
      least = wrong, patience = passes;
    else if (--patience < 0 && n > kSingly && !monotone)
      return false;
  }
  return false;
}

}  // namespace

struct SmallActiveSet::Work {
  Attempt<kAny> any;
};

SmallActiveSet::SmallActiveSet() : work_(std::make_unique<Work>()) {}
SmallActiveSet::~SmallActiveSet() = default;

bool SmallActiveSet::solve(const Lcp& problem, Vector& z, int& iterations, const Budget& budget, double mostly) {
  const auto of_size = [&]<Index N>() {
    Attempt<N> attempt;  // nothing of it is set to zero
    return attempt.solve(problem, z.data(), iterations, budget, mostly);
  };
  switch (problem.size()) {
    case 1:
      return of_size.template operator()<1>();
    case 2:
      return of_size.template operator()<2>();
    case 3:
      return of_size.template operator()<3>();
    case 4:
      return of_size.template operator()<4>();
    case 5:
      return of_size.template operator()<5>();
    case 6:
      return of_size.template operator()<6>();
    case 8:
      return of_size.template operator()<8>();
    default:
      return work_->any.solve(problem, z.data(), iterations, budget, mostly);
  }
}

}  // namespace orthant
