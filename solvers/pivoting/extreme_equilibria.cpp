#include <orthant/core/lcp/judge/exact.h>
#include <orthant/core/support/disjoint_sets.h>
#include <orthant/solvers/pivoting/extreme_equilibria.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>

namespace orthant {
namespace {

using exact::Rational, exact::Row, exact::Table;
using Labels = std::uint64_t;

constexpr Index kMostLabels = 64;  // bits of a word; vertices are too many long before that

void check_bimatrix(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  const auto shape = [](const Eigen::MatrixXd& M) {
    return std::to_string(M.rows()) + " x " + std::to_string(M.cols());
  };
  if (A.size() == 0 || A.rows() != B.rows() || A.cols() != B.cols())
    throw std::invalid_argument("extreme_equilibria: A is " + shape(A) + " and B is " + shape(B) +
                                ": must be of the same shape, with one row and one column at least");
  if (!A.allFinite() || !B.allFinite()) throw std::invalid_argument("extreme_equilibria: A and B: must be finite");
  if (A.rows() + A.cols() > kMostLabels)
    throw std::invalid_argument("extreme_equilibria: " + std::to_string(A.rows() + A.cols()) +
                                " strategies: must be at most " + std::to_string(kMostLabels));
}

/// Costs as they are, moved to be 1 at the least.
Table positive_costs(const Eigen::MatrixXd& costs) {
  const Rational up = Rational(1) - Rational(costs.minCoeff());
  Table table(static_cast<std::size_t>(costs.rows()));
  for (std::size_t i = 0; i < table.size(); ++i)
    for (Index j = 0; j < costs.cols(); ++j) table[i].push_back(Rational(costs(static_cast<Index>(i), j)) + up);
  return table;
}

struct Vertex {
  Row strategy;  // sums to 1
  Labels labels = 0;
};

/// Vertices of { x ≥ 0, C x ≥ e }: extreme rays (x, t) of the cone x ≥ 0, C x ≥ t e, t ≥ 0 with t > 0.
/// own: the label of x_0 = 0;  other: the label of the first row of C.
std::vector<Vertex> vertices_of(const Table& C, std::size_t own, std::size_t other, const std::function<bool()>& stop) {
  const std::size_t n = C.front().size();
  Table G;
  for (std::size_t i = 0; i <= n; ++i) G.emplace_back(n + 1, Rational(0)), G.back()[i] = 1;
  for (const Row& row : C) G.push_back(row), G.back().push_back(Rational(-1));
  std::vector<Vertex> vertices;
  for (const Row& ray : exact::cone(G, n + 1, stop).rays) {
    if (ray[n].is_zero()) continue;
    Vertex v;
    Rational sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += ray[i];
    for (std::size_t i = 0; i < n; ++i) {
      v.strategy.push_back(ray[i] / sum);
      if (ray[i].is_zero()) v.labels |= Labels{1} << (own + i);
    }
    for (std::size_t j = 0; j < C.size(); ++j) {
      Rational slack = -ray[n];
      for (std::size_t i = 0; i < n; ++i) slack += C[j][i] * ray[i];
      if (slack.is_zero()) v.labels |= Labels{1} << (other + j);
    }
    vertices.push_back(std::move(v));
  }
  return vertices;
}

Eigen::VectorXd rounded_strategy(const Row& row) {
  Eigen::VectorXd x(static_cast<Index>(row.size()));
  for (std::size_t i = 0; i < row.size(); ++i) x[static_cast<Index>(i)] = exact::nearest(row[i]);
  return x;
}

/// Costs of each pure strategy of the player whose costs are C's rows, against y.
Row costs_against(const Eigen::MatrixXd& C, const Row& y) {
  Row costs(static_cast<std::size_t>(C.rows()), Rational(0));
  for (Index i = 0; i < C.rows(); ++i)
    for (Index j = 0; j < C.cols(); ++j)
      costs[static_cast<std::size_t>(i)] += Rational(C(i, j)) * y[static_cast<std::size_t>(j)];
  return costs;
}

Rational expected(const Row& x, const Row& costs) {
  return std::inner_product(x.begin(), x.end(), costs.begin(), Rational(0));
}

/// Judged by the definition, in exact arithmetic: no pure strategy costs a player less.
Equilibrium judged(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Row& x, const Row& y) {
  const Row by_row = costs_against(A, y), by_column = costs_against(B.transpose(), x);
  const Rational cost_1 = expected(x, by_row), cost_2 = expected(y, by_column);
  const Rational regret = std::max(Rational(cost_1 - *std::min_element(by_row.begin(), by_row.end())),
                                   Rational(cost_2 - *std::min_element(by_column.begin(), by_column.end())));
  return {rounded_strategy(x),    rounded_strategy(y),    exact::nearest(cost_1),
          exact::nearest(cost_2), exact::nearest(regret), 0};
}

}  // namespace

ExtremeEquilibria extreme_equilibria(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                     const std::function<bool()>& stop) {
  check_bimatrix(A, B);
  const auto m = static_cast<std::size_t>(A.rows()), k = static_cast<std::size_t>(A.cols());
  const auto X = vertices_of(positive_costs(B.transpose()), 0, m, stop);
  const auto Y = vertices_of(positive_costs(A), m, 0, stop);
  ExtremeEquilibria found;
  const Labels every = m + k == kMostLabels ? ~Labels{0} : (Labels{1} << (m + k)) - 1;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  DisjointSets components(X.size() + Y.size());  // vertices that equilibria connect
  const auto row = [](std::size_t i) { return static_cast<int>(i); };
  for (std::size_t i = 0; i < X.size(); ++i)
    for (std::size_t j = 0; j < Y.size(); ++j)
      if ((X[i].labels | Y[j].labels) == every) pairs.emplace_back(i, j), components.join(row(i), row(X.size() + j));
  if (stop && stop()) return {{}, 0, false};
  std::vector<int> roots;
  for (const auto& [i, j] : pairs) {
    Equilibrium e = judged(A, B, X[i].strategy, Y[j].strategy);
    const int root = components.find(row(i));
    const auto at = std::find(roots.begin(), roots.end(), root);
    e.label = static_cast<int>(at - roots.begin());
    if (at == roots.end()) roots.push_back(root);
    found.all.push_back(std::move(e));
  }
  found.components = static_cast<int>(roots.size());
  return found;
}

}  // namespace orthant
