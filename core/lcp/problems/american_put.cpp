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

double AmericanBasket::price(Index i) const {
  const double half = reach * std::max(volatility_1, volatility_2) * std::sqrt(maturity);
  return strike * std::exp(half * (2 * static_cast<double>(i + 1) / static_cast<double>(nodes + 1) - 1));
}

double AmericanBasket::payoff(Index i, Index j) const {
  return std::max(strike - weight * price(i) - (1 - weight) * price(j), 0.0);
}

Vector AmericanBasket::payoff() const {
  Vector psi;
  psi.resize(nodes * nodes);
  for (Index j = 0; j < nodes; ++j)
    for (Index i = 0; i < nodes; ++i) psi[j * nodes + i] = payoff(i, j);
  return psi;
}

double AmericanBasket::at_spot(const Vector& V) const { return V[nodes / 2 * nodes + nodes / 2]; }

Lcp american_basket_step(const AmericanBasket& basket, const Vector& V, double h) {
  const Index n = basket.nodes;
  const double width = std::log(basket.price(1) / basket.price(0));
  const double s1 = basket.volatility_1, s2 = basket.volatility_2, cross = basket.correlation * s1 * s2;
  const double diagonal = std::abs(cross) / (2 * width * width);  // of each of the two diagonal neighbours
  // Of the neighbours on an axis; V_xy takes its share of each.
  const auto axis = [&](double sigma) { return 0.5 * sigma * sigma / (width * width) - diagonal; };
  const auto drift = [&](double sigma) { return (basket.rate - 0.5 * sigma * sigma) / (2 * width); };
  const auto weights = [](double spread, double towards) {  // before, after
    const bool central = std::abs(towards) <= spread;
    return central ? std::pair(spread - towards, spread + towards)
                   : std::pair(spread + std::max(-2 * towards, 0.0), spread + std::max(2 * towards, 0.0));
  };
  const auto [west, east] = weights(axis(s1), drift(s1));
  const auto [south, north] = weights(axis(s2), drift(s2));
  const Index slant = cross >= 0 ? 1 : -1;
  const double here = west + east + south + north + 2 * diagonal + basket.rate;
  const struct {
    Index i, j;
    double weight;
  } around[] = {{-slant, -1, diagonal}, {0, -1, south}, {-1, 0, west},       {0, 0, 0},
                {1, 0, east},           {0, 1, north},  {slant, 1, diagonal}};
  std::vector<Eigen::Triplet<double>> entries;
  Vector q;
  q.resize(n * n);
  int row = 0;
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i, ++row) {
      q[row] = (1 + h * here) * basket.payoff(i, j) - V[row];
      for (const auto& [di, dj, weight] : around) {
        const Index k = i + di, l = j + dj;
        if (di == 0 && dj == 0) {
          entries.emplace_back(row, row, 1 + h * here);
          continue;
        }
        q[row] -= h * weight * basket.payoff(k, l);
        const bool inner = k >= 0 && k < n && l >= 0 && l < n;
        if (inner && weight != 0) entries.emplace_back(row, static_cast<int>(l * n + k), -h * weight);
      }
    }
  Eigen::SparseMatrix<double, Eigen::RowMajor> M(n * n, n * n);
  M.setFromTriplets(entries.begin(), entries.end());
  return Lcp::standard(RowSparse::from(M), q);
}

}  // namespace orthant
