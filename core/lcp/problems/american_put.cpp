#include <orthant/core/lcp/problems/american_put.h>

#include <algorithm>
#include <cmath>

namespace orthant {

Vector AmericanPut::payoff() const {
  Vector psi;
  psi.resize(nodes);
  for (Index i = 0; i < nodes; ++i) psi[i] = std::max(strike - price(i), 0.0);
  return psi;
}

double AmericanPut::value(const Vector& V, double S) const {
  const double width = largest / static_cast<double>(nodes + 1);
  const Index first = std::clamp(static_cast<Index>(S / width) - 2, Index{0}, nodes - 4);
  double sum = 0;
  for (Index i = first; i < first + 4; ++i) {
    double weight = V[i];
    for (Index j = first; j < first + 4; ++j)
      if (j != i) weight *= (S - price(j)) / (price(i) - price(j));
    sum += weight;
  }
  return sum;
}

Lcp american_put_step(const AmericanPut& put, const Vector& V, double h, double theta) {
  const Index n = put.nodes;
  const double width = put.largest / static_cast<double>(n + 1);
  const Vector psi = put.payoff();
  std::vector<Eigen::Triplet<double>> entries;
  Vector q;
  q.resize(n);
  for (Index i = 0; i < n; ++i) {
    const double S = put.price(i);
    const double spread = 0.5 * put.volatility * put.volatility * S * S / (width * width);
    const double drift = put.rate * S / (2 * width);
    const bool central = drift <= spread;
    const double down = central ? spread - drift : spread, up = central ? spread + drift : spread + 2 * drift;
    const double here = down + up + put.rate;  // B = (−down, here, −up)
    const auto at = [&](const Vector& values, Index k) { return k < 0 ? put.strike : k >= n ? 0.0 : values[k]; };
    const auto B = [&](const Vector& values) {
      return here * values[i] - down * at(values, i - 1) - up * at(values, i + 1);
    };
    const auto row = static_cast<int>(i);
    entries.emplace_back(row, row, 1 + theta * h * here);
    if (i > 0) entries.emplace_back(row, row - 1, -theta * h * down);
    if (i + 1 < n) entries.emplace_back(row, row + 1, -theta * h * up);
    q[i] = psi[i] + theta * h * B(psi) - (V[i] - (1 - theta) * h * B(V));
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  return Lcp::standard(RowSparse::from(M), q);
}

}  // namespace orthant
