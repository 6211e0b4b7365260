// tests/core/lcp/judged.h — verdicts of the judge on given answers and proofs.
#pragma once

#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/collection.h>

#include "tests/support/judge.h"
#include "tests/support/sanitized.h"

namespace orthant {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

inline Lcp scalar(double A, double b, double lo = 0, double hi = kInf) {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Constant(1, 1, A)), Vector{b});
  p.lo[0] = lo;
  p.hi[0] = hi;
  return p;
}

inline Lcp pair(std::initializer_list<double> A, const Vector& b) {  // row by row
  const Vector entries(A);
  return Lcp::standard(DenseMatrix(entries.reshaped<Eigen::RowMajor>(2, 2)), b);
}

inline Status verdict(const Lcp& problem, const Vector& z, Claim claim = Claim::candidate, double tolerance = 1e-10) {
  Judge judge;
  Solution s;
  s.z = z;
  judge.certify(problem, tolerance, claim, s);
  return s.status;
}

inline Status verdict_on_proof(const Lcp& problem, const Vector& u) {
  Judge judge;
  Solution s;
  s.z = Vector(Eigen::VectorXd::Zero(problem.size()));
  s.certificate = u;
  judge.certify(problem, 1e-10, Claim::ray, s);
  return s.status;
}

}  // namespace orthant
