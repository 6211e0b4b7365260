// core/lcp/judge/exact_classes.h — matrix classes of a small matrix, decided in rationals: definiteness, minors,
// copositivity, sufficiency. All subsets of rows are examined.
#pragma once

#include <orthant/core/lcp/judge/analyse.h>
#include <orthant/core/lcp/judge/exact.h>

#include <functional>
#include <utility>
#include <vector>

namespace orthant::exact {

inline Table symmetric_part(const Table& A) {
  Table S = A;
  for (std::size_t i = 0; i < A.size(); ++i)
    for (std::size_t j = 0; j < A.size(); ++j) S[i][j] = (A[i][j] + A[j][i]) / 2;
  return S;
}

inline Table transposed(const Table& A) {
  Table T = A;
  for (std::size_t i = 0; i < A.size(); ++i)
    for (std::size_t j = 0; j < A.size(); ++j) T[i][j] = A[j][i];
  return T;
}

inline Table comparison(const Table& A) {
  Table C = A;
  for (std::size_t i = 0; i < A.size(); ++i)
    for (std::size_t j = 0; j < A.size(); ++j) C[i][j] = i == j ? Rational(abs(A[i][i])) : Rational(-abs(A[i][j]));
  return C;
}

/// All pivots on the diagonal, in the given order, are positive: all leading principal minors are.
inline bool leading_minors_positive(Table A) {
  for (std::size_t k = 0; k < A.size(); ++k) {
    if (A[k][k] <= 0) return false;
    for (std::size_t i = k + 1; i < A.size(); ++i) {
      const Rational factor = A[i][k] / A[k][k];
      for (std::size_t j = k; j < A.size(); ++j) subtract_product(A[i][j], factor, A[k][j]);
    }
  }
  return true;
}

/// S symmetric. Diagonal pivots where positive; the rest must then be zero.
inline bool semidefinite(Table S) {
  std::vector<char> done(S.size(), 0);
  for (;;) {
    std::size_t p = 0;
    while (p < S.size() && (done[p] != 0 || S[p][p].is_zero())) ++p;
    if (p == S.size()) break;
    if (S[p][p] < 0) return false;
    done[p] = 1;
    for (std::size_t i = 0; i < S.size(); ++i) {
      if (done[i] != 0) continue;
      const Rational factor = S[i][p] / S[p][p];
      for (std::size_t j = 0; j < S.size(); ++j)
        if (done[j] == 0) subtract_product(S[i][j], factor, S[p][j]);
    }
  }
  for (std::size_t i = 0; i < S.size(); ++i)
    for (std::size_t j = 0; j < S.size(); ++j)
      if (done[i] == 0 && done[j] == 0 && !S[i][j].is_zero()) return false;
  return true;
}

/// Solves B x = rhs (last column) for a principal block; the sign of det B, zero or unknown: x is not to be used.
template <class T> Sign eliminate(std::vector<std::vector<T>>& B) {
  const std::size_t m = B.size();
  int det = 1;
  for (std::size_t k = 0; k < m; ++k) {
    std::size_t r = k;
    bool open = false;
    for (std::size_t i = k; i < m; ++i) {
      open = open || sign(B[i][k]) == Sign::unknown;
      if (weight(B[i][k]) > weight(B[r][k])) r = i;
    }
    if (weight(B[r][k]) == 0) return open ? Sign::unknown : Sign::zero;
    if (r != k) std::swap(B[r], B[k]), det = -det;
    if (sign(B[k][k]) == Sign::negative) det = -det;
    for (std::size_t i = 0; i < m; ++i) {
      if (i == k) continue;
      const T factor = quotient(B[i][k], B[k][k]);
      for (std::size_t j = k + 1; j < B[i].size(); ++j) subtract_product(B[i][j], factor, B[k][j]);
    }
  }
  for (std::size_t k = 0; k < m; ++k)
    for (std::size_t j = m; j < B[k].size(); ++j) B[k][j] = quotient(B[k][j], B[k][k]);
  return static_cast<Sign>(det);
}

template <class T> std::vector<std::vector<T>> block(const Table& A, const std::vector<std::size_t>& rows) {
  std::vector<std::vector<T>> B(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::size_t j : rows) B[i].push_back(T(A[rows[i]][j]));
    B[i].push_back(T(1.0));
  }
  return B;
}

struct Late {};  // thrown where the caller has waited long enough

inline void ask(const std::function<bool()>& stop) {
  if (stop && stop()) throw Late{};
}

template <class Visit>  // not ∅; visit returns false to end
inline void for_each_subset(std::size_t n, const std::function<bool()>& stop, Visit&& visit) {
  std::vector<std::size_t> rows;
  for (unsigned long subset = 1; subset >> n == 0; ++subset) {
    ask(stop);
    rows.clear();
    for (std::size_t i = 0; i < n; ++i)
      if ((subset >> i & 1UL) != 0) rows.push_back(i);
    if (!visit(rows)) return;
  }
}

/// p, p0 and the rows of a principal minor ≤ 0.
inline void principal_minors(const Table& A, const std::function<bool()>& stop, Analysis& result) {
  Verdict p = Verdict::yes, p0 = Verdict::yes;
  for_each_subset(A.size(), stop, [&](const std::vector<std::size_t>& rows) {
    auto fast = block<Filtered>(A, rows);
    Sign det = eliminate(fast);
    if (det == Sign::unknown) {
      auto slow = block<Rational>(A, rows);
      det = eliminate(slow);
    }
    if (det != Sign::positive && p == Verdict::yes) {
      p = result.p = Verdict::no;
      result.not_p.assign(rows.begin(), rows.end());
    }
    if (det == Sign::negative) p0 = Verdict::no;
    return p0 == Verdict::yes;
  });
  result.p = p, result.p0 = p0;
}

/// A minimizer of xᵀS x on the simplex with the fewest entries has a regular block S_αα, and S_αα x_α = λ e: λ < 0 ⟺
/// S_αα⁻¹ e < 0.
inline bool copositive(const Table& S, const std::function<bool()>& stop) {
  bool yes = true;
  const auto negative = [](const auto& B) {
    bool all = true;
    for (const auto& row : B) {
      const Sign s = sign(row.back());
      if (s == Sign::positive || s == Sign::zero) return Sign::positive;
      all = all && s == Sign::negative;
    }
    return all ? Sign::negative : Sign::unknown;
  };
  for_each_subset(S.size(), stop, [&](const std::vector<std::size_t>& rows) {
    auto fast = block<Filtered>(S, rows);
    Sign outcome = eliminate(fast);
    if (outcome != Sign::unknown && outcome != Sign::zero) outcome = negative(fast);
    if (outcome == Sign::unknown) {
      auto slow = block<Rational>(S, rows);
      outcome = eliminate(slow);
      if (outcome != Sign::zero) outcome = negative(slow);
    }
    return yes = outcome != Sign::negative;
  });
  return yes;
}

/// For each support α and signs σ: some x_α > 0 with B x ≤ 0, B x ≠ 0, B = σ A_αα σ, is a counterexample. The sum of
/// all generators of { x ≥ 0, B x ≤ 0 } has every x_i > 0 and every (B x)_i < 0 that any member has.
inline bool column_sufficient(const Table& A, const std::function<bool()>& stop) {
  bool yes = true;
  for_each_subset(A.size(), stop, [&](const std::vector<std::size_t>& rows) {
    const std::size_t m = rows.size();
    for (unsigned long signs = 0; yes && signs >> (m - 1) == 0; ++signs) {
      Table G(2 * m, Row(m));
      for (std::size_t i = 0; i < m; ++i) {
        G[i][i] = 1;
        for (std::size_t j = 0; j < m; ++j)
          G[m + i][j] = ((signs >> i ^ signs >> j) & 1UL) != 0 ? A[rows[i]][rows[j]] : Rational(-A[rows[i]][rows[j]]);
      }
      Row sum(m);
      for (const Row& ray : cone(G, m).rays)
        for (std::size_t i = 0; i < m; ++i) sum[i] += ray[i];
      bool positive = true, strict = false;
      for (std::size_t i = 0; i < m; ++i) {
        positive = positive && sum[i] > 0;
        Rational value = 0;
        for (std::size_t j = 0; j < m; ++j) value += G[m + i][j] * sum[j];
        strict = strict || value > 0;
      }
      yes = !(positive && strict);
    }
    return yes;
  });
  return yes;
}

}  // namespace orthant::exact
