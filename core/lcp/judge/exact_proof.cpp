#include <orthant/core/lcp/judge/exact_proof.h>

#include <orthant/core/lcp/judge/exact.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace orthant {
namespace {

using exact::Rational;
using Integer = boost::multiprecision::number<boost::multiprecision::gmp_int, boost::multiprecision::et_off>;

constexpr double kNear = 0x1p-30;  // of its terms: a sum that may be meant to be 0
constexpr int kRounds = 8;         // of new equations
constexpr double kMostWork = 5e8;  // products in one elimination or solution: some seconds

/// √x, or a little more: exact where it is rational.
Rational root_above(const Rational& x) {
  const Integer square = numerator(x) * denominator(x), scale = Integer(1) << 128;
  const Integer root = sqrt(square);
  if (root * root == square) return Rational(root, denominator(x));
  return Rational(sqrt(Integer(square * scale * scale)) + 1, denominator(x) * scale);
}

using Word = std::uint64_t;
constexpr Word kPrime = 2147483647;  // 2³¹ − 1

Word power(Word base, Word exponent) {
  Word result = 1;
  for (; exponent > 0; exponent >>= 1, base = base * base % kPrime)
    if ((exponent & 1) != 0) result = result * base % kPrime;
  return result;
}
Word inverse(Word x) { return power(x, kPrime - 2); }
Word remainder(const Integer& x) {
  const auto r = static_cast<std::int64_t>(Integer(x % kPrime));  // of x's sign
  return static_cast<Word>(r < 0 ? r + static_cast<std::int64_t>(kPrime) : r);
}

struct Pivots {
  std::vector<std::size_t> rows, columns;
};

/// A largest regular block, the first columns preferred, by elimination modulo the prime. Empty: stopped or too long.
Pivots find_pivots(const std::vector<std::vector<Integer>>& A, std::size_t columns, const std::function<bool()>& stop) {
  std::vector<std::vector<Word>> m;
  std::vector<std::size_t> place(A.size());
  std::iota(place.begin(), place.end(), std::size_t{0});
  for (const auto& row : A) {
    m.emplace_back();
    for (const Integer& x : row) m.back().push_back(remainder(x));
  }
  Pivots result;
  double work = 0;
  for (std::size_t c = 0; c < columns && result.rows.size() < m.size(); ++c) {
    const std::size_t rank = result.rows.size();
    std::size_t r = rank;
    while (r < m.size() && m[r][c] == 0) ++r;
    if (r == m.size()) continue;
    std::swap(m[rank], m[r]), std::swap(place[rank], place[r]);
    work += static_cast<double>((m.size() - rank) * (columns - c));
    if (work > 4 * kMostWork || (stop && stop())) return {};
    const Word unit = inverse(m[rank][c]);
    for (r = rank + 1; r < m.size(); ++r) {
      if (m[r][c] == 0) continue;
      const Word factor = kPrime - m[r][c] * unit % kPrime;
      for (std::size_t k = c; k < columns; ++k) m[r][k] = (m[r][k] + factor * m[rank][k]) % kPrime;
    }
    result.rows.push_back(place[rank]), result.columns.push_back(c);
  }
  return result;
}

/// The inverse of a matrix that is regular modulo the prime.
std::vector<std::vector<Word>> inverse(const std::vector<std::vector<Integer>>& A) {
  const std::size_t n = A.size();
  std::vector<std::vector<Word>> m(n, std::vector<Word>(2 * n));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) m[i][j] = remainder(A[i][j]);
    m[i][n + i] = 1;
  }
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t r = c;
    while (r < n && m[r][c] == 0) ++r;
    if (r == n) return {};
    std::swap(m[c], m[r]);
    const Word unit = inverse(m[c][c]);
    for (Word& x : m[c]) x = x * unit % kPrime;
    for (r = 0; r < n; ++r) {
      if (r == c || m[r][c] == 0) continue;
      const Word factor = kPrime - m[r][c];
      for (std::size_t k = c; k < 2 * n; ++k) m[r][k] = (m[r][k] + factor * m[c][k]) % kPrime;
    }
  }
  for (auto& row : m) row.erase(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(n));
  return m;
}

struct Ratios {
  std::vector<Integer> numerators;
  Integer denominator = 1;
};

/// The fractions with numerators and denominator below √(modulus / 2) that are x modulo `modulus`, if they exist.
std::optional<Ratios> reconstruct(const std::vector<Integer>& x, const Integer& modulus) {
  const Integer bound = sqrt(Integer(modulus / 2));
  Ratios result;
  for (const Integer& each : x) {
    Integer y = each * result.denominator % modulus;
    if (y > modulus - bound) y -= modulus;
    if (abs(y) > bound) {  // Euclid's algorithm, half way
      Integer r0 = modulus, r1 = y < 0 ? Integer(y + modulus) : y, t0 = 0, t1 = 1;
      while (r1 > bound) {
        const Integer q = r0 / r1;
        Integer r = r0 - q * r1, t = t0 - q * t1;
        r0 = std::move(r1), r1 = std::move(r);
        t0 = std::move(t1), t1 = std::move(t);
      }
      if (t1 < 0) r1 = -r1, t1 = -t1;
      if (t1.is_zero() || t1 > bound) return std::nullopt;
      for (Integer& before : result.numerators) before *= t1;
      result.denominator *= t1;
      if (result.denominator > bound) return std::nullopt;
      y = r1;
    }
    result.numerators.push_back(y);
  }
  return result;
}

/// M x = right by Dixon's lifting: x modulo the prime's powers, until the fractions that these stand for solve it.
std::optional<Ratios> solve_exactly(const std::vector<std::vector<Integer>>& M, const std::vector<Integer>& right,
                                    const std::function<bool()>& stop) {
  const std::size_t n = M.size();
  if (static_cast<double>(n) * static_cast<double>(n) * static_cast<double>(n) > kMostWork) return std::nullopt;
  const auto inverse_of = inverse(M);
  if (inverse_of.empty()) return std::nullopt;
  std::vector<Integer> x(n, 0), rest = right;
  std::vector<Word> digit(n), modulo(n);
  // Entries that are small: sums in 64 bits.
  std::vector<std::vector<std::int64_t>> few(n < 4096 ? n : 0);
  for (std::size_t i = 0; i < few.size(); ++i)
    for (const Integer& entry : M[i]) {
      if (abs(entry) >= 1 << 20) {
        few.clear();
        break;
      }
      few[i].push_back(static_cast<std::int64_t>(entry));
    }
  Integer modulus = 1;
  double work = 0;
  for (int lifts = 1, look_at = 8;; ++lifts) {
    for (std::size_t i = 0; i < n; ++i) modulo[i] = remainder(rest[i]);
    for (std::size_t i = 0; i < n; ++i) {
      Word sum = 0;
      for (std::size_t j = 0; j < n; ++j) sum = (sum + inverse_of[i][j] * modulo[j]) % kPrime;
      digit[i] = sum;
      x[i] += modulus * sum;
    }
    modulus *= kPrime;
    for (std::size_t i = 0; i < n; ++i) {
      std::int64_t sum = 0;
      for (std::size_t j = 0; j < n && !few.empty(); ++j) sum += few[i][j] * static_cast<std::int64_t>(digit[j]);
      rest[i] -= sum;
      for (std::size_t j = 0; j < n && few.empty(); ++j)
        if (digit[j] != 0 && !M[i][j].is_zero()) rest[i] -= M[i][j] * digit[j];
      rest[i] /= kPrime;
    }
    work += 2 * static_cast<double>(n * n);
    if (work > kMostWork || (stop && stop())) return std::nullopt;
    if (lifts < look_at) continue;
    look_at *= 2;
    const std::optional<Ratios> found = reconstruct(x, modulus);
    bool solves = found.has_value();
    for (std::size_t i = 0; i < n && solves; ++i) {
      Integer sum = -right[i] * found->denominator;
      for (std::size_t j = 0; j < n; ++j) sum += M[i][j] * found->numerators[j];
      solves = sum.is_zero();
    }
    if (solves) return found;
  }
}

/// Σ_i a_i û_i, and Σ_i |a_i u_i|.
struct Sum {
  Rational value;
  double terms = 0;

  void add(const Rational& product, double size) {
    if (!product.is_zero()) value += product;
    terms += size;
  }
};

/// û and what its conditions demand of it.
class ExactProof {
 public:
  ExactProof(const Lcp& problem, const std::function<bool()>& stop)
      : p_(problem), stop_(stop), operator_(std::get_if<Delassus>(&problem.A)) {}

  /// Only the columns of the wrong sign are made 0; else all that may be meant to be.
  bool holds(const Vector& u, bool few) {
    rows_.clear(), weights_.clear(), sizes_.clear(), equations_.clear();
    unit_ = 1;
    for (Index i = 0; i < u.size(); ++i)
      if (u[i] != 0) rows_.push_back(i);
    std::stable_sort(rows_.begin(), rows_.end(), [&](Index i, Index j) { return std::abs(u[i]) > std::abs(u[j]); });
    for (const Index i : rows_) weights_.emplace_back(u[i]), sizes_.push_back(std::abs(u[i]));
    for (int round = 0; round < kRounds && !stopped(); ++round) {
      find_columns();
      if (std::none_of(columns_.begin(), columns_.end(), [this](Index j) { return wrong(j); })) return below_zero();
      if (!take_equations(round == 0 && !few) || !solve(u)) return false;
    }
    return false;
  }

  /// u ← the least whole multiple of û, where doubles hold it. Others would stand for another û.
  void put(Vector& u) const {
    Integer scale = 1;
    for (const Rational& x : weights_) scale = lcm(scale, Integer(denominator(x)));
    std::vector<Integer> whole;
    Integer divisor = 0;
    for (const Rational& x : weights_) {
      whole.push_back(numerator(x) * (scale / denominator(x)));
      divisor = gcd(divisor, whole.back());
    }
    for (Integer& x : whole) x /= divisor;
    if (std::ranges::any_of(whole, [](const Integer& x) { return abs(x) > Integer(1) << 53; })) return;
    for (std::size_t k = 0; k < rows_.size(); ++k) u[rows_[k]] = static_cast<double>(whole[k]);
  }

 private:
  using Equation = std::vector<Rational>;  // per entry of rows_

  bool stopped() const { return stop_ && stop_(); }

  // g_ ← Aᵀû, inner_ ← Wᵀû; columns_ ← where there is a condition.
  void find_columns() {
    const auto n = at(p_.size());
    g_.assign(n, {});
    if (operator_ == nullptr) {
      for (std::size_t k = 0; k < rows_.size(); ++k)
        for_each_in_row(p_.A, rows_[k], [&](Index j, double a) {
          if (a != 0) g_[at(j)].add(Rational(a) * weights_[k], std::abs(a) * sizes_[k]);
        });
    } else {
      const auto& [W, inverse_mass, regularization] = *operator_;
      inner_.assign(at(W.cols), {});
      for (std::size_t k = 0; k < rows_.size(); ++k)
        W.for_each_in_row(rows_[k], [&](Index m, double w) {
          inner_[at(m)].add(Rational(w) * weights_[k], std::abs(w) * sizes_[k]);
        });
      std::vector<Rational> velocity(at(W.cols));
      for (Index m = 0; m < W.cols; ++m) velocity[at(m)] = inner_[at(m)].value * Rational(inverse_mass[m]);
      for (Index j = 0; j < W.rows; ++j)
        W.for_each_in_row(j, [&, &masses = inverse_mass](Index m, double w) {
          const Sum& inner = inner_[at(m)];
          if (inner.terms > 0) g_[at(j)].add(Rational(w) * velocity[at(m)], std::abs(w) * masses[m] * inner.terms);
        });
      if (regularization.size() != 0)
        for (std::size_t k = 0; k < rows_.size(); ++k) {
          const double r = regularization[rows_[k]];
          g_[at(rows_[k])].add(Rational(r) * weights_[k], r * sizes_[k]);
        }
    }
    c_ = g_;
    std::vector<char> friction(n, 0);
    for (const Friction& f : p_.friction) {
      Rational square = 0;
      double terms = 0;
      for (Index t = f.first; t < f.first + f.rows; ++t) {
        friction[at(t)] = 1;
        square += g_[at(t)].value * g_[at(t)].value;
        terms += g_[at(t)].terms;
      }
      Sum& c = c_[at(f.normal)];
      c.value += Rational(f.mu) * (f.rows == 1 ? Rational(abs(g_[at(f.first)].value)) : root_above(square));
      c.terms += f.mu * terms;
    }
    columns_.clear();
    for (Index j = 0; j < p_.size(); ++j)
      if (friction[at(j)] == 0 && c_[at(j)].terms > 0) columns_.push_back(j);
  }

  bool wrong(Index j) const {
    const Rational& c = c_[at(j)].value;
    return (p_.hi[j] == kInf && c > 0) || (p_.lo[j] == -kInf && c < 0);
  }
  // Within rounding of u.
  bool near_zero(const Sum& sum) const {
    return sum.value.is_zero() || std::abs((sum.value / unit_).convert_to<double>()) <= kNear * sum.terms;
  }
  bool bounded(Index j) const { return p_.hi[j] < kInf && p_.lo[j] > -kInf; }

  // The last line of (1).
  bool below_zero() const {
    Rational most = 0;
    for (std::size_t k = 0; k < rows_.size(); ++k) most += weights_[k] * Rational(p_.b[rows_[k]]);
    for (const Index j : columns_) {
      const Rational& c = c_[at(j)].value;
      const double bound = c > 0 ? p_.hi[j] : p_.lo[j];
      if (!c.is_zero() && bound != 0) most += c * Rational(bound);
    }
    return most < 0;
  }

  // False: none is new, or a sum is too far from 0.
  bool take_equations(bool all) {
    const std::size_t before = equations_.size();
    if (all && operator_ != nullptr)
      for (Index m = 0; m < operator_->W.cols; ++m)
        if (inner_[at(m)].terms > 0 && near_zero(inner_[at(m)])) take({m, -1}, velocity_of(m));
    for (const Index j : columns_) {
      const bool is_wrong = wrong(j);
      if (is_wrong && !near_zero(c_[at(j)])) return false;
      if (!is_wrong && !(all && !bounded(j) && near_zero(c_[at(j)]))) continue;
      if (operator_ != nullptr && all && !is_wrong) continue;  // mostly what the velocities demand already
      Equation equation = column(j);
      for (const Friction& f : p_.friction) {
        if (f.normal != j || f.mu == 0) continue;
        bool still = true;
        for (Index t = f.first; t < f.first + f.rows; ++t) still = still && near_zero(g_[at(t)]);
        if (still) {
          for (Index t = f.first; t < f.first + f.rows; ++t) take({t, 0}, column(t));
        } else if (f.rows == 1) {
          const Equation along = column(f.first);
          const Rational factor(g_[at(f.first)].value > 0 ? f.mu : -f.mu);
          for (std::size_t k = 0; k < along.size(); ++k) exact::add_product(equation[k], factor, along[k]);
        } else {
          return false;  // no linear equation
        }
      }
      take({j, 0}, std::move(equation));
    }
    return equations_.size() > before;
  }
  void take(std::pair<Index, int> name, Equation equation) { equations_.emplace(name, std::move(equation)); }

  Equation velocity_of(Index m) const {
    Equation equation;
    for (const Index i : rows_) equation.emplace_back(operator_->W.entry(i, m));
    return equation;
  }
  Equation column(Index j) const {
    Equation equation;
    for (const Index i : rows_) {
      if (const auto* dense = std::get_if<DenseMatrix>(&p_.A)) {
        equation.emplace_back((*dense)(i, j));
      } else if (const auto* sparse = std::get_if<RowSparse>(&p_.A)) {
        equation.emplace_back(sparse->entry(i, j));
      } else {
        Rational sum(i == j && operator_->regularization.size() != 0 ? operator_->regularization[i] : 0.0);
        operator_->W.for_each_in_row(i, [&](Index m, double w) {
          const double other = operator_->W.entry(j, m);
          if (w != 0 && other != 0) sum += Rational(w) * Rational(operator_->inverse_mass[m]) * Rational(other);
        });
        equation.push_back(std::move(sum));
      }
    }
    return equation;
  }

  // weights_ ← a multiple of (2). False: only 0 is left, or a sign is wrong, or it takes too long.
  bool solve(const Vector& u) {
    std::vector<std::vector<Integer>> rows;
    for (const auto& [name, equation] : equations_) {
      Integer scale = 1;
      for (const Rational& x : equation) scale = lcm(scale, Integer(denominator(x)));
      rows.emplace_back();
      for (const Rational& x : equation) rows.back().push_back(numerator(x) * (scale / denominator(x)));
    }
    const std::size_t unknowns = rows_.size();
    const Pivots pivots = find_pivots(rows, unknowns, stop_);
    if (pivots.columns.empty() || pivots.columns.size() == unknowns) return false;
    std::vector<char> dependent(unknowns, 0);
    for (const std::size_t c : pivots.columns) dependent[c] = 1;
    const bool one_free = pivots.columns.size() + 1 == unknowns;  // its size has no meaning
    Integer unit = 1;
    std::vector<Integer> free(unknowns, 0);
    for (std::size_t k = 0; k < unknowns; ++k)
      if (dependent[k] == 0 && !one_free) unit = lcm(unit, Integer(denominator(Rational(u[rows_[k]]))));
    for (std::size_t k = 0; k < unknowns; ++k) {
      if (dependent[k] != 0) continue;
      const Rational x(u[rows_[k]]);
      free[k] = one_free ? Integer(x < 0 ? -1 : 1) : Integer(numerator(x) * (unit / denominator(x)));
    }
    std::vector<std::vector<Integer>> M;
    std::vector<Integer> right;
    for (const std::size_t r : pivots.rows) {
      M.emplace_back();
      for (const std::size_t c : pivots.columns) M.back().push_back(rows[r][c]);
      right.emplace_back(0);
      for (std::size_t k = 0; k < unknowns; ++k)
        if (!free[k].is_zero() && !rows[r][k].is_zero()) right.back() -= rows[r][k] * free[k];
    }
    const std::optional<Ratios> solution = solve_exactly(M, right, stop_);
    if (!solution) return false;
    for (std::size_t k = 0; k < unknowns; ++k) weights_[k] = Rational(free[k] * solution->denominator);
    for (std::size_t k = 0; k < pivots.columns.size(); ++k)
      weights_[pivots.columns[k]] = Rational(solution->numerators[k]);
    for (std::size_t k = 0; k < unknowns; ++k) {
      const Index i = rows_[k];
      if ((weights_[k] < 0 && p_.lo[i] > -kInf) || (weights_[k] > 0 && p_.hi[i] < kInf)) return false;
    }
    unit_ = abs(weights_[0]) / Rational(sizes_[0]);
    return !unit_.is_zero();
  }

  const Lcp& p_;
  const std::function<bool()>& stop_;
  const Delassus* operator_;
  std::vector<Index> rows_;        // with û ≠ 0, the largest first
  std::vector<Rational> weights_;  // û there
  std::vector<double> sizes_;      // |u| there
  Rational unit_ = 1;              // of û over u
  std::vector<Sum> g_, c_, inner_;
  std::vector<Index> columns_;
  std::map<std::pair<Index, int>, Equation> equations_;  // by column, or by velocity and −1
};

}  // namespace

bool proves_exactly(const Lcp& problem, Vector& u, const std::function<bool()>& stop) {
  ExactProof proof(problem, stop);
  for (const bool few : {false, true})
    if (proof.holds(u, few)) return proof.put(u), true;
  return false;
}

}  // namespace orthant
