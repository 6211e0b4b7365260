#include <orthant/core/lcp/judge/exact_proof.h>

#include <orthant/core/lcp/judge/dixon_lifting.h>
#include <orthant/core/lcp/judge/exact.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

namespace orthant {
namespace {

using exact::Integer;
using exact::Rational;

constexpr double kNear = 0x1p-30;  // of its terms: a sum that may be meant to be 0
constexpr int kRounds = 8;         // of new equations

/// √x, or a little more: exact where it is rational.
Rational root_above(const Rational& x) {
  const Integer square = numerator(x) * denominator(x), scale = Integer(1) << 128;
  const Integer root = sqrt(square);
  if (root * root == square) return Rational(root, denominator(x));
  return Rational(sqrt(Integer(square * scale * scale)) + 1, denominator(x) * scale);
}

bool whole(const Rational& x) { return mpz_cmp_ui(mpq_denref(x.backend().data()), 1) == 0; }

/// Σ_i a_i û_i, and Σ_i |a_i u_i|.
struct Sum {
  Rational value;
  long double terms = 0;  // beyond the range of doubles

  void add(const Rational& product, long double size) {
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
    load(u);
    for (int round = 0; round < kRounds && !stopped(); ++round) {
      find_columns();
      if (std::none_of(columns_.begin(), columns_.end(), [this](Index j) { return wrong(j); })) return below_zero();
      if (!take_equations(round == 0 && !few) || !solve(u)) return false;
    }
    return false;
  }

  /// Of û = u.
  std::vector<Index> wrong_columns(const Vector& u) {
    load(u);
    find_columns();
    std::vector<Index> result;
    std::copy_if(columns_.begin(), columns_.end(), std::back_inserter(result), [this](Index j) { return wrong(j); });
    return result;
  }

  /// u ← the least whole multiple of û, where doubles hold it, or else over a power of 2. False: no multiple is in
  /// doubles, and rounded ones would stand for another û.
  bool put(Vector& u) const {
    Integer scale = 1;
    for (const Rational& x : weights_) scale = lcm(scale, Integer(denominator(x)));
    std::vector<Integer> whole;
    Integer divisor = 0;
    for (const Rational& x : weights_) {
      whole.push_back(numerator(x) * (scale / denominator(x)));
      divisor = gcd(divisor, whole.back());
    }
    int most = 0;  // binary digits
    for (Integer& x : whole) {
      x /= divisor;
      if (!x.is_zero()) most = std::max(most, static_cast<int>(msb(Integer(abs(x)))) + 1);
    }
    const int shift = std::max(most - kDigits, 0);
    for (const Integer& x : whole)
      if (!x.is_zero() && (digits(x) > kDigits || static_cast<int>(lsb(Integer(abs(x)))) - shift < kLeast))
        return false;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const Integer& x = whole[k];
      const int zeros = x.is_zero() ? 0 : static_cast<int>(lsb(Integer(abs(x))));
      u[rows_[k]] = std::ldexp(static_cast<double>(Integer(x / (Integer(1) << zeros))), zeros - shift);
    }
    return true;
  }

 private:
  using Equation = std::vector<Rational>;             // per entry of rows_
  static constexpr int kDigits = 53, kLeast = -1000;  // of a double; its last one, well above the least, 2⁻¹⁰⁷⁴

  static int digits(const Integer& x) {
    const Integer size = abs(x);
    return static_cast<int>(msb(size)) - static_cast<int>(lsb(size)) + 1;
  }

  // û ← u.
  void load(const Vector& u) {
    rows_.clear(), weights_.clear(), sizes_.clear(), equations_.clear();
    for (Index i = 0; i < u.size(); ++i)
      if (u[i] != 0) rows_.push_back(i);
    std::stable_sort(rows_.begin(), rows_.end(), [&](Index i, Index j) { return std::abs(u[i]) > std::abs(u[j]); });
    for (const Index i : rows_) weights_.emplace_back(u[i]), sizes_.push_back(std::abs(u[i]));
    Integer scale = 1;  // whole numbers cost less
    for (const Rational& x : weights_) scale = lcm(scale, Integer(denominator(x)));
    unit_ = scale;
    for (Rational& x : weights_) x *= unit_;
  }

  bool stopped() const { return stop_ && stop_(); }

  // g_ ← Aᵀû, inner_ ← Wᵀû; columns_ ← where there is a condition.
  void find_columns() {
    const auto n = at(p_.size());
    g_.assign(n, {});
    if (operator_ == nullptr) {
      for (std::size_t k = 0, rows = sum_in_integers() ? 0 : rows_.size(); k < rows; ++k)
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
          if (inner.terms > 0) g_[at(j)].add(Rational(w) * velocity[at(m)], std::abs(w) * inner.terms * masses[m]);
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
      long double terms = 0;
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

  // Likewise where û and A are in whole numbers, which costs a tenth. False: they are not.
  bool sum_in_integers() {
    constexpr double kMostEntry = 0x1p53;
    std::vector<Integer> sums(g_.size(), 0);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (!whole(weights_[k])) return false;
      const auto* const weight = mpq_numref(weights_[k].backend().data());
      bool all = true;
      for_each_in_row(p_.A, rows_[k], [&](Index j, double a) {
        all = all && a == std::trunc(a) && std::abs(a) <= kMostEntry;
        if (a == 0 || !all) return;
        const auto size = static_cast<unsigned long>(std::abs(a));
        (a > 0 ? mpz_addmul_ui : mpz_submul_ui)(sums[at(j)].backend().data(), weight, size);
        g_[at(j)].terms += std::abs(a) * sizes_[k];
      });
      if (!all) return g_.assign(g_.size(), {}), false;
    }
    for (std::size_t j = 0; j < sums.size(); ++j) g_[j].value = sums[j];
    return true;
  }

  bool wrong(Index j) const {
    const Rational& c = c_[at(j)].value;
    return (p_.hi[j] == kInf && c > 0) || (p_.lo[j] == -kInf && c < 0);
  }
  // Within rounding of u.
  bool near_zero(const Sum& sum) const {
    return sum.value.is_zero() || abs(sum.value) <= unit_ * Rational(kNear * sum.terms);
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
      if (operator_ == nullptr) {
        equation.emplace_back(entry(p_.A, i, j));
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
    exact::IntegerTable rows;
    for (const auto& [name, equation] : equations_) {
      Integer scale = 1;
      for (const Rational& x : equation)
        if (!whole(x)) scale = lcm(scale, Integer(denominator(x)));
      rows.emplace_back();
      for (const Rational& x : equation)
        rows.back().push_back(scale == 1 ? Integer(numerator(x)) : Integer(numerator(x) * (scale / denominator(x))));
    }
    const std::size_t unknowns = rows_.size();
    const exact::ModularPivots pivots = exact::find_pivots(rows, unknowns, stop_);
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
    exact::IntegerTable M;
    std::vector<Integer> right;
    for (const std::size_t r : pivots.rows) {
      M.emplace_back();
      for (const std::size_t c : pivots.columns) M.back().push_back(rows[r][c]);
      right.emplace_back(0);
      for (std::size_t k = 0; k < unknowns; ++k)
        if (!free[k].is_zero() && !rows[r][k].is_zero()) right.back() -= rows[r][k] * free[k];
    }
    const std::optional<exact::Ratios> solution = exact::solve_exactly(M, right, stop_);
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
  const std::function<bool()> stop_;
  const Delassus* operator_;
  std::vector<Index> rows_;         // with û ≠ 0, the largest first
  std::vector<Rational> weights_;   // û there
  std::vector<long double> sizes_;  // |u| there
  Rational unit_ = 1;               // of û over u
  std::vector<Sum> g_, c_, inner_;
  std::vector<Index> columns_;
  std::map<std::pair<Index, int>, Equation> equations_;  // by column, or by velocity and −1
};

}  // namespace

std::vector<Index> columns_of_wrong_sign(const Lcp& problem, const Vector& u) {
  return ExactProof(problem, {}).wrong_columns(u);
}

Proved prove_exactly(const Lcp& problem, Vector& u, const std::function<bool()>& stop) {
  ExactProof proof(problem, stop);
  for (const bool few : {false, true})
    if (proof.holds(u, few)) return proof.put(u) ? Proved::by_doubles : Proved::by_exact_neighbor;
  return Proved::no;
}

}  // namespace orthant
