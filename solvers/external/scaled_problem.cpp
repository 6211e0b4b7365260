#include <orthant/solvers/external/scaled_problem.h>

#include <algorithm>
#include <cmath>

namespace orthant {

void ScaledProblem::load(const Lcp& p) {
  const Index n = p.size();
  A.load(p.A);
  symmetric = A.symmetric();
  row_ = Eigen::VectorXd::Ones(n);
  diagonal(p.A, start_);
  if (symmetric && n > 0 && start_.minCoeff() > 0) {
    row_ = start_.cwiseSqrt().cwiseInverse();
    column_ = row_;
  } else {
    scaling_.fit(n, [this](const auto& use) {
      for (Index j = 0; j < A.size(); ++j) A.each(j, [&](int i, double v) { use(i, j, v); });
    });
    row_ = scaling_.row, column_ = scaling_.col;
    symmetric = symmetric && row_ == column_;
  }
  double largest = 0;
  for (Index j = 0; j < n; ++j) {
    const auto end = static_cast<std::size_t>(A.start[static_cast<std::size_t>(j) + 1]);
    for (auto e = static_cast<std::size_t>(A.start[static_cast<std::size_t>(j)]); e < end; ++e) {
      A.value[e] *= row_[A.row[e]] * column_[j];
      largest = std::max(largest, std::abs(A.value[e]));
    }
  }
  b = p.b.cwiseProduct(row_);
  start_ = Eigen::VectorXd::Zero(n).cwiseMax(p.lo).cwiseMin(p.hi).cwiseQuotient(column_);
  multiply(start_, w_);
  w_ += b;
  const double force = n > 0 ? w_.lpNorm<Eigen::Infinity>() : 0;
  // A' ← A'/α, w' ← w'/β, so z' ← z' α/β.
  const double alpha = largest > 0 ? largest : 1, beta = force > 0 ? force : 1;
  for (double& v : A.value) v /= alpha;
  b /= beta;
  column_ *= beta / alpha;
  lo = p.lo.cwiseQuotient(column_);
  hi = p.hi.cwiseQuotient(column_);
}

}  // namespace orthant
