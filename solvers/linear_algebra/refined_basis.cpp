#include <orthant/solvers/linear_algebra/refined_basis.h>

#include <algorithm>
#include <cmath>

namespace orthant::detail {

namespace {

// a + b = sum + error, exactly (Knuth).
struct Sum {
  double sum, error;
  Sum(double a, double b) : sum(a + b) {
    const double c = sum - a;
    error = (a - (sum - c)) + (b - c);
  }
};

// a · b = product + error, exactly (Dekker, Veltkamp's split; no fused multiply-add is needed).
struct Product {
  double product, error;
  Product(double a, double b) : product(a * b) {
    constexpr double split = 134217729;  // 2²⁷ + 1
    const double as = split * a, ah = as - (as - a), al = a - ah;
    const double bs = split * b, bh = bs - (bs - b), bl = b - bh;
    error = ((ah * bh - product) + ah * bl + al * bh) + al * bl;
  }
};

}  // namespace

void RefinedBasis::refine(const DenseMatrix& A, const Vector& b, const Vector& col, Vector& z) {
  const auto m = static_cast<Index>(unknown.size());
  if (m == 0) return;
  high_.resize(m);
  low_.resize(m);
  low_.setZero();
  residual_.resize(4 * m);
  double* const sum = residual_.data();
  double* const error = sum + m;
  double* const known = error + m;  // b + A_EK z_K, the same at every step
  double* const known_error = known + m;
  for (Index i = 0; i < m; ++i) {
    high_[i] = z[unknown[at(i)]];
    z[unknown[at(i)]] = 0;
    known[i] = b[equation[at(i)]], known_error[i] = 0;
  }
  const auto add_column = [&](Index j, double zh, double zl, double* s, double* e) {
    const double* const entries = A.data() + j * A.rows();
    for (Index i = 0; i < m; ++i) {
      const double entry = entries[equation[at(i)]];
      const Product p(entry, zh);
      const Sum total(s[i], p.product);
      s[i] = total.sum;
      e[i] += total.error + (p.error + entry * zl);
    }
  };
  for (Index j = 0; j < z.size(); ++j)
    if (z[j] != 0) add_column(j, z[j], 0, known, known_error);
  for (int step = 0; step < 4; ++step) {
    std::copy(known, known + 2 * m, sum);
    for (Index i = 0; i < m; ++i) add_column(unknown[at(i)], high_[i], low_[i], sum, error);
    for (Index j = 0; j < m; ++j) sum[j] += error[j];
    bool precise = true;
    for (Index i = 0; i < m; ++i) {
      double change = 0;
      for (Index j = 0; j < m; ++j) change -= inverse_[j * m + i] * sum[j];
      const Sum next(high_[i], change + low_[i]);
      high_[i] = next.sum;
      low_[i] = next.error;
      precise = precise && std::abs(change) <= 0x1p-38 * std::abs(next.sum);
    }
    if (precise) break;
  }
  double largest = 0;
  for (Index i = 0; i < m; ++i) largest = std::max(largest, std::abs(high_[i]) / col[unknown[at(i)]]);
  for (Index i = 0; i < m; ++i) {
    const Index row = unknown[at(i)];
    z[row] = std::abs(high_[i]) / col[row] <= 0x1p-80 * largest ? 0.0 : high_[i];
  }
}

}  // namespace orthant::detail
