// core/lcp/judge/analyse.h — matrix classes: decides whether a matrix belongs to each, and so which methods apply.
//
//   Every answer is yes, no, or not_decided, never a guess. Yes and no come from exact comparisons, from rationals
//   (n ≤ 40 for definiteness, K, H₊ and rank; n ≤ 12 for P, P₀ and copositivity; n ≤ 5 for sufficiency), or from a
//   floating-point proof: Cholesky with a margin for definiteness (definite.h), a vector d > 0 with ⟨A⟩ d > 0 for H₊
//   (and K), a vector or an index set as the witness of a no.
//     positive (semi)definite   xᵀA x > 0 (≥ 0) for x ≠ 0: of the symmetric part
//     Z   A_ij ≤ 0 off the diagonal            K   Z and P
//     H₊  A_ii > 0 and ⟨A⟩ (|A_ii| on the diagonal, −|A_ij| off it) a K-matrix: contains strict diagonal dominance
//     P   all principal minors > 0             P₀  all ≥ 0
//     copositive          xᵀA x ≥ 0 for x ≥ 0: no principal block B of the symmetric part has B⁻¹e < 0
//     column sufficient   x∘(A x) ≤ 0 ⇒ x∘(A x) = 0: sign by sign, by the generators of { x ≥ 0, ±A x ≤ 0 }; row: of Aᵀ
//   Implications used: PD ⇒ P;  H₊ ⇒ P;  PSD ⇒ P₀, sufficient, copositive;  P ⇒ sufficient ⇒ P₀;  A ≥ 0 ⇒ copositive.
//   Cost: exact parts up to about a second; else a sparse Cholesky and an LU factorization, left out where the pattern
//   predicts (factorization_cost.h) that the time left does not suffice.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 3.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <functional>
#include <string_view>
#include <vector>

namespace orthant {

enum class Verdict { no, yes, not_decided };
std::string_view name(Verdict verdict);

struct Analysis {
  Index n = 0;
  Verdict symmetric = Verdict::not_decided, z = Verdict::not_decided, k = Verdict::not_decided;
  Verdict diagonally_dominant = Verdict::not_decided;  // strictly, by rows
  Verdict h_plus = Verdict::not_decided;
  Verdict positive_definite = Verdict::not_decided, positive_semidefinite = Verdict::not_decided;
  Verdict p = Verdict::not_decided, p0 = Verdict::not_decided;
  Verdict copositive = Verdict::not_decided;
  Verdict column_sufficient = Verdict::not_decided, row_sufficient = Verdict::not_decided;
  std::vector<Index> not_p;          // rows of a principal minor ≤ 0, when p is no and one is known
  Index rank = -1;                   // −1: not decided
  double smallest = 0, largest = 0;  // |A_ij|, zeros left out
  // Estimate of ‖A‖₁ ‖A⁻¹‖₁; kInf: singular, or to working precision where no rank is known; NaN: not estimated.
  double condition = kInf;
};

/// `stop` is polled; once it says true, what is open stays so (condition: NaN). No factorization is begun that
/// would go on for longer than `time_limit` [s] after the call.
/// Throws std::invalid_argument when A is not square or not finite.
Analysis analyse(const Matrix& A, const std::function<bool()>& stop = {}, double time_limit = kInf);

}  // namespace orthant
