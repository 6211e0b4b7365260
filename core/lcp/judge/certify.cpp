#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/judge/certify_sums.h>
#include <orthant/core/lcp/judge/exact.h>
#include <orthant/core/lcp/judge/row_rule.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace orthant {
namespace {

using detail::against, detail::limit_of_rounded, detail::limit_of_solved, detail::nearest_to_zero, detail::wrong_by;
using detail::kDouble, detail::kEpsilon, detail::kLeastNormal, detail::kLong, detail::kProducts, detail::kRoundings,
    detail::kSure;
constexpr double kMost = std::numeric_limits<double>::max();
constexpr double kCoarse = 1e-4;       // of β_P: a larger violation is worth another attempt
constexpr Index kExactOperator = 400;  // rows of an operator up to which a w_i is summed in rationals
constexpr double kFormed = 7e7;        // products up to which an operator's entries are formed

/// w_i in rationals.
exact::Rational exact_w(const Lcp& problem, Index i, const Vector& z) {
  exact::Rational w = problem.b[i];
  const auto add = [&z](exact::Rational& to, double a, Index j) {
    if (a != 0 && z[j] != 0) to += exact::Rational(a) * exact::Rational(z[j]);
  };
  const auto row = [](const RowSparse& A, Index r, const auto& use) {
    for (std::size_t k = at(A.start[at(r)]); k < at(A.start[at(r) + 1]); ++k) use(A.column[k], A.value[k]);
  };
  if (!for_each_in_row(problem.A, i, [&](Index j, double value) { add(w, value, j); })) {
    const auto& [W, inverse_mass, regularization] = std::get<Delassus>(problem.A);
    std::map<Index, exact::Rational> velocity;  // of the columns that row i has
    row(W, i, [&](Index k, double) { velocity[k] = 0; });
    for (Index j = 0; j < z.size(); ++j)
      row(W, j, [&](Index k, double value) {
        if (const auto found = velocity.find(k); found != velocity.end()) add(found->second, value, j);
      });
    row(W, i, [&, &m = inverse_mass](Index k, double value) {
      w += exact::Rational(value) * exact::Rational(m[k]) * velocity[k];
    });
    if (regularization.size() != 0) add(w, regularization[i], i);
  }
  return w;
}

/// v_i where it is positive, summed in rationals.
double exactly_wrong_by(const Lcp& problem, Index i, const Vector& z, double lo, double hi) {
  return detail::exactly_wrong_by(exact_w(problem, i, z), z[i], lo, hi);
}

}  // namespace

/// Room for problems of that size, needed now or not: a later z must find it there.
void Judge::prepare(const Lcp& problem) {
  const auto n = problem.size();
  if (const auto* delassus = std::get_if<Delassus>(&problem.A); delassus != nullptr)
    for (auto* each : {&inner_ld_, &inner_abs_ld_}) each->reserve(at(delassus->W.cols));
  if (const auto* rows = std::get_if<RowSparse>(&problem.A))
    couplings_.reserve(rows->value.size() + problem.friction.size());
  if (at(n) <= part_.capacity()) return;
  for (Vector* each : {&lo_, &hi_, &beta_, &data_, &part_data_}) each->resize(n);
  for (auto* each : {&g_, &g_abs_, &g_error_}) each->reserve(at(n));
  part_.reserve(at(n));
  heap_.reserve(at(2 * n + 1));
}

void Judge::find_bounds(const Lcp& problem, const Vector& z) {
  lower_ = problem.lo.data(), upper_ = problem.hi.data();
  if (problem.friction.empty()) return;
  lo_.resize(problem.size()), hi_.resize(problem.size());
  std::copy_n(problem.lo.data(), problem.size(), lo_.data());
  std::copy_n(problem.hi.data(), problem.size(), hi_.data());
  for (const Friction& f : problem.friction) {
    hi_[f.first] = f.mu * std::max(z[f.normal], 0.0);
    lo_[f.first] = -hi_[f.first];
  }
  lower_ = lo_.data(), upper_ = hi_.data();
}

// data_ ← β_i; returns their largest.   b = (1, −3), lo = 0: (1, 3).   A = 2, b = 1, z = hi = 5: 11.
double Judge::find_data(const Lcp& problem, const Vector& z) {
  const Index n = problem.size();
  const auto& [lo, hi] = std::tie(problem.lo, problem.hi);
  bool bounded = false;
  for (Index i = 0; i < n && !bounded; ++i)
    bounded = nearest_to_zero(lo[i], hi[i]) != 0 || (z[i] != 0 && detail::on_bound(z[i], lo[i], hi[i]));
  data_.resize(n);
  if (bounded) {
    beta_.resize(n);
    for (Index i = 0; i < n; ++i)
      beta_[i] = detail::on_bound(z[i], lo[i], hi[i]) ? z[i] : nearest_to_zero(lo[i], hi[i]);
    detail::sum_rows(problem.A, problem.b, beta_, floor_, data_, inner_, inner_abs_);
  } else {
    for (Index i = 0; i < n; ++i) data_[i] = std::abs(problem.b[i]);
  }
  return n > 0 ? data_.maxCoeff() : 0;
}

// Fills w, residual and rounding. True: solved, with doubles alone and since a row's own |b_i|
// is at most β_i. Most problems end here.
bool Judge::surely_solved(const Lcp& problem, double tolerance, Solution& s) {
  const Index n = problem.size();
  detail::sum_rows(problem.A, problem.b, s.z, s.w, size_, inner_, inner_abs_);
  find_bounds(problem, s.z);
  double least = kInf;
  for (const double b : problem.b)
    if (b != 0) least = std::min(least, std::abs(b));
  const double* const b = problem.b.data();
  double residual = 0, size = 0;
  bool sure = true;
  for (Index i = 0; i < n; ++i) {
    const double wrong = wrong_by(s.z[i], s.w[i], lower_[i], upper_[i]);
    const double limit = b[i] != 0 ? kSure * limit_of_solved(tolerance, size_[i], least) : 0;
    sure = sure && size_[i] > kProducts && size_[i] < kInf && wrong + unit_ * size_[i] <= limit;
    residual = std::max(residual, wrong);
    size = std::max(size, size_[i]);
  }
  s.residual = residual;
  s.rounding = kEpsilon * size;
  return sure;
}

// True: some row misses by so much that no data would let it pass.
bool Judge::surely_missed(const Lcp& problem, double tolerance, Solution& s, double data) {
  double worst = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    const double wrong = wrong_by(s.z[i], s.w[i], lower_[i], upper_[i]);
    const double least = wrong - unit_ * size_[i];
    const double limit = std::max(limit_of_solved(tolerance, size_[i], data), limit_of_rounded(size_[i])) + kProducts;
    if (std::isfinite(s.w[i]) && wrong < kInf && least <= 1.001 * limit) continue;
    const double ratio = std::isfinite(s.w[i]) && wrong < kInf ? wrong / limit : kInf;
    if (ratio <= worst && worst > 0) continue;
    worst = ratio;
    s.miss = {i, against(s.z[i], lower_[i], upper_[i]), wrong, limit_of_solved(tolerance, size_[i], data), tolerance};
  }
  if (worst > 0) excess_ = worst, accepted_ = std::isfinite(s.residual) ? s.residual / worst : 0;
  return worst > 0;
}

// part_data_ ← at each part's first row the largest data of its rows, β_P.
void Judge::find_part_data(const Lcp& problem) {
  label_parts(problem);
  part_data_.resize(problem.size());
  part_data_.setZero();
  for (Index i = 0; i < problem.size(); ++i) {
    double& whole = part_data_[part_[at(i)]];
    whole = std::max(whole, data_[i]);
  }
}

// The rule itself, in long double.
Judge::Pass Judge::weigh(const Lcp& problem, double tolerance, Solution& s) {
  const Index n = problem.size();
  product(problem.A, s.z, false);
  const auto* delassus = std::get_if<Delassus>(&problem.A);
  if (delassus == nullptr || to_rows(*delassus, entries_, kFormed)) {
    spread(problem, s.z, data_);
  } else {  // too large to be formed: the largest of its part
    find_part_data(problem);
    for (Index i = 0; i < n; ++i) data_[i] = part_data_[part_[at(i)]];
  }
  const long double unit = kLong * (unit_ / kDouble);
  const bool few_factors = delassus == nullptr || n <= kExactOperator;
  bool floors = false, parts = false;
  Pass pass = Pass::solved;
  double worst = 0, worst_solved = 0, residual = 0, size = 0;
  Miss solved_miss;
  for (Index i = 0; i < n; ++i) {
    const long double w = problem.b[i] + g_[at(i)], terms = std::abs(problem.b[i]) + g_abs_[at(i)];
    const auto sum = std::min(static_cast<double>(terms), kMost);  // not infinite
    long double wrong = wrong_by(s.z[i], w, lower_[i], upper_[i]), off = unit * terms;
    const auto within = [&](double limit) {  // where rounding leaves it open, rationals decide
      if (wrong + off > limit && wrong - off <= limit && few_factors) {
        wrong = exactly_wrong_by(problem, i, s.z, lower_[i], upper_[i]);
        off = kEpsilon * std::abs(wrong);
      }
      return wrong + off <= limit;
    };
    s.w[i] = static_cast<double>(w);
    const double beta = data_[i];
    const double solved = kSure * limit_of_solved(tolerance, sum, beta);
    const bool passes = within(solved);
    size = std::max(size, sum), residual = std::max(residual, static_cast<double>(wrong));
    if (passes) continue;
    double rounded = kSure * limit_of_rounded(sum);
    if (!within(rounded) && wrong < kProducts) {
      if (!floors) {  // beta_ ← 2⁻¹⁰²² (1 + Σ_j |A_ij|)
        floors = true;
        beta_.resize(n);
        beta_.setOnes();
        detail::sum_rows(problem.A, beta_, beta_, zero_w_, floor_, inner_, inner_abs_);
      }
      const double least = std::min(kLeastNormal * floor_[i], kProducts);
      rounded = std::max(rounded, kSure * kRoundings * kEpsilon * least);
    }
    const bool is_rounded = within(rounded);
    const auto by = static_cast<double>(wrong);
    const Miss miss{i, against(s.z[i], lower_[i], upper_[i]), by, solved, tolerance};
    const auto ratio = [by](double limit) { return limit > 0 && by < kInf ? by / limit : kInf; };
    if (is_rounded) {
      if (!parts) find_part_data(problem), parts = true;
      coarse_ = coarse_ || by > std::max(kCoarse * part_data_[part_[at(i)]], kProducts);
      if (pass == Pass::solved) pass = Pass::rounded;
      if (ratio(solved) >= worst_solved) worst_solved = ratio(solved), solved_miss = miss;
    } else {
      pass = Pass::no;
      if (ratio(std::max(solved, rounded)) >= worst) worst = ratio(std::max(solved, rounded)), s.miss = miss;
    }
  }
  if (pass == Pass::rounded) s.miss = solved_miss;
  s.coarse = coarse_ = coarse_ && pass == Pass::rounded;
  s.residual = residual;
  s.rounding = kEpsilon * size;
  excess_ = worst;
  accepted_ = worst > 0 && residual < kInf ? residual / worst : residual;
  return pass;
}

void Judge::certify(const Lcp& problem, double tolerance, Claim claim, Solution& s) {
  proved_ = nullptr;
  judge(problem, tolerance, claim, s);
  trusted_ = nullptr;
}

void Judge::judge(const Lcp& problem, double tolerance, Claim claim, Solution& s) {
  const Index n = problem.size();
  if (s.z.size() != n) {  // a solver that gave up before it had a z
    s.z.resize(n);
    s.z.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  if (problem.discs()) return certify_cones(problem, tolerance, claim, s);
  prepare(problem);
  unit_ = kDouble * (terms(problem.A) + 3);
  s.miss = {};
  const bool solved = surely_solved(problem, tolerance, s);
  accepted_ = s.residual, excess_ = 0, s.coarse = coarse_ = false;
  if (solved) {
    s.status = Status::solved;
    if (s.certificate.size() > 0 || !s.cells.empty()) s.certificate.resize(0), s.cells.clear();
    return;
  }
  const double data = find_data(problem, s.z);
  const Pass pass =
      data < kInf && !surely_missed(problem, tolerance, s, data) ? weigh(problem, tolerance, s) : Pass::no;
  if (pass == Pass::no && excess_ == 0) excess_ = kInf, s.miss = overflown(problem, s, tolerance);
  const auto disproved = [&] {
    const bool proved = s.certificate.size() == n && proves_infeasible(problem, s.certificate);
    if (!proved && claim == Claim::exhausted) return proves_infeasible(problem, s.cells);
    if (!proved && !(claim == Claim::ray && s.ray.size() == n && proves_infeasible(problem, s.ray))) return false;
    s.certificate = proof_;
    return true;
  };
  if (pass == Pass::solved) {
    s.status = Status::solved;
  } else if (disproved()) {
    s.status = Status::infeasible;
    return;
  }
  s.certificate.resize(0), s.cells.clear();
  if (pass == Pass::rounded)
    s.status = Status::rounded;
  else if (pass == Pass::no)
    s.status = claim != Claim::candidate            ? status_of(claim)
               : s.z.allFinite() && s.w.allFinite() ? Status::stalled
                                                    : Status::numerical_error;
}

void Judge::explain(const Lcp& problem, double tolerance, Solution& s) {
  if (s.miss.row < 0 || problem.discs() || !s.z.allFinite() || !s.w.allFinite()) return;
  prepare(problem);
  unit_ = kDouble * (terms(problem.A) + 3);
  find_bounds(problem, s.z);
  if (find_data(problem, s.z) < kInf) weigh(problem, tolerance, s);
}

// The first row with data that overflow.
Miss Judge::overflown(const Lcp& problem, const Solution& s, double tolerance) const {
  for (Index i = 0; i < problem.size(); ++i)
    if (!(data_[i] < kInf)) return {i, against(s.z[i], lower_[i], upper_[i]), kInf, 0, tolerance};
  return s.miss;
}

// Discs: certify_cones.h has the rule.
void Judge::certify_cones(const Lcp& problem, double tolerance, Claim claim, Solution& s) {
  ConeJudge& judge = cones_;
  s.w.resize(problem.size());
  s.miss = {};
  const bool accepted = judge.passes(problem, tolerance, s);
  accepted_ = accepted ? s.residual : 0, excess_ = accepted ? 0 : kInf, s.coarse = coarse_ = false;
  const auto disproved = [&] {
    const auto proves = [&](const Vector& u) { return u.size() == problem.size() && proves_infeasible(problem, u); };
    if (!proves(s.certificate) && !(claim == Claim::ray && proves(s.ray))) return false;
    s.certificate = proof_;
    return true;
  };
  if (accepted && !judge.rounded()) {
    s.status = Status::solved;
  } else if (disproved()) {
    s.status = Status::infeasible;
    return;
  } else if (accepted) {
    s.status = Status::rounded;
  } else {
    s.status = claim != Claim::candidate ? status_of(claim)
               : judge.unknown()         ? Status::numerical_error
                                         : Status::stalled;
  }
  s.certificate.resize(0), s.cells.clear();
}

}  // namespace orthant
