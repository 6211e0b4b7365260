#include <orthant/core/lcp/problems/obstacles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace orthant {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

Lcp assemble(const Triplets& entries, const Vector& q) {
  Eigen::SparseMatrix<double, Eigen::RowMajor> M(q.size(), q.size());
  M.setFromTriplets(entries.begin(), entries.end());
  return Lcp::standard(RowSparse::from(M), q);
}

/// Rows one after the other, columns ascending: no triplets, for millions of rows.
struct RowWriter {
  RowSparse A;
  RowWriter(Index n, Index entries) {
    A.rows = A.cols = n;
    A.start.reserve(at(n) + 1), A.column.reserve(at(n * entries)), A.value.reserve(at(n * entries));
  }
  void add(Index column, double value) { A.column.push_back(static_cast<int>(column)), A.value.push_back(value); }
  void end_row() { A.start.push_back(static_cast<int>(A.column.size())); }
};

Vector zeros(Index n) { return Eigen::VectorXd::Zero(n); }

}  // namespace

Lcp string_on_obstacle(Index intervals, double gap) {
  const auto n = static_cast<int>(intervals) - 1;
  const double per_h2 = static_cast<double>(intervals) * static_cast<double>(intervals);
  Triplets entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2 * per_h2);
    if (i > 0) entries.emplace_back(i, i - 1, -per_h2);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -per_h2);
  }
  Vector q(Eigen::VectorXd::Constant(n, 8));
  q[0] -= gap * per_h2;  // z = gap at the ends
  q[n - 1] -= gap * per_h2;
  return assemble(entries, q);
}

Lcp beam_on_obstacle(Index elements, double gap) {
  const double h = 1 / static_cast<double>(elements), stiffness = 1 / (h * h * h), load = 384.0 / 5 * h;
  const Eigen::Matrix4d element{{12, 6, -12, 6}, {6, 4, -6, 2}, {-12, -6, 12, -6}, {6, 2, -6, 4}};
  const Eigen::Vector4d share(1.0 / 2, 1.0 / 12, 1.0 / 2, -1.0 / 12);
  const auto n = static_cast<int>(2 * elements), last = n + 1;
  const auto row = [&](int place) {  // of u, h u′ of node 0, 1, …; −1: u at an end
    return place == 0 || place == last - 1 ? -1 : place == last ? n - 1 : place - 1;
  };
  Triplets entries;
  Vector q = zeros(n);
  for (int e = 0; e < n; e += 2)
    for (int i = 0; i < 4; ++i) {
      if (row(e + i) < 0) continue;
      q[row(e + i)] += load * share[i];
      for (int j = 0; j < 4; ++j)
        if (row(e + j) >= 0)
          entries.emplace_back(row(e + i), row(e + j), stiffness * element(i, j));
        else  // z = gap at the ends
          q[row(e + i)] += gap * stiffness * element(i, j);
    }
  Lcp problem = assemble(entries, q);
  for (int place = 1; place <= last; ++place)
    if (place % 2 == 1) problem.lo[row(place)] = -kInf;
  return problem;
}

BallObstacle ball_obstacle(Index intervals) {
  constexpr double rim = 0.69796514822337356642;  // r*
  const double h = 4 / static_cast<double>(intervals);
  const auto m = static_cast<int>(intervals) - 1;
  const auto radius = [&](int i, int j) { return std::hypot(-2 + h * (i + 1), -2 + h * (j + 1)); };  // i, j = −1 … m
  const auto obstacle = [](double r) { return r <= 1 ? std::sqrt(1 - r * r) : -1.0; };
  const auto u = [&](double r) {
    return r <= rim ? obstacle(r) : -rim * rim * std::log(r / 2) / std::sqrt(1 - rim * rim);
  };
  Triplets entries;
  BallObstacle ball{{}, zeros(m * m)};
  Vector q = zeros(m * m);
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) {
      const int row = j * m + i;
      const double r = radius(i, j), psi = obstacle(r);
      entries.emplace_back(row, row, 4 / (h * h));
      q[row] = 4 / (h * h) * psi;
      ball.exact[row] = u(r) - psi;
      for (const auto& [k, l] : {std::array{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}}) {
        const bool inner = k >= 0 && k < m && l >= 0 && l < m;
        if (inner) entries.emplace_back(row, l * m + k, -1 / (h * h));
        q[row] -= (inner ? obstacle(radius(k, l)) : u(radius(k, l))) / (h * h);
      }
    }
  ball.problem = assemble(entries, q);
  return ball;
}

Lcp journal_bearing(Index nx, Index ny, double eccentricity, double b) {
  const double hx = 2 * std::numbers::pi / static_cast<double>(nx + 1), hy = 2 * b / static_cast<double>(ny + 1);
  const auto width = static_cast<int>(nx), height = static_cast<int>(ny);
  const auto cubed = [&](int i) { return std::pow(1 + eccentricity * std::cos(hx * (i + 1)), 3); };
  Triplets entries;
  const auto add = [&](int i, int j, int k, int l, double value) {  // value (v_ij − v_kl)²/2, v = 0 at the boundary
    const auto inner = [&](int x, int y) { return x >= 0 && x < width && y >= 0 && y < height; };
    const int row = j * width + i, column = l * width + k;
    if (inner(i, j)) entries.emplace_back(row, row, value);
    if (inner(k, l)) entries.emplace_back(column, column, value);
    if (!inner(i, j) || !inner(k, l)) return;
    entries.emplace_back(row, column, -value);
    entries.emplace_back(column, row, -value);
  };
  for (int j = -1; j < height; ++j)
    for (int i = -1; i < width; ++i) {  // the two triangles of a cell, the weight averaged over their corners
      const double lower = (2 * cubed(i) + cubed(i + 1)) / 6, upper = (cubed(i) + 2 * cubed(i + 1)) / 6;
      add(i, j, i + 1, j, lower * hy / hx);
      add(i, j, i, j + 1, lower * hx / hy);
      add(i + 1, j + 1, i, j + 1, upper * hy / hx);
      add(i + 1, j + 1, i + 1, j, upper * hx / hy);
    }
  Vector q = zeros(nx * ny);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) q[j * width + i] = -eccentricity * std::sin(hx * (i + 1)) * hx * hy;
  return assemble(entries, q);
}

SpaceObstacle space_obstacle(Index intervals) {
  // ψ² = 1 − r*² and ψ' = −r*/ψ: r* (1/r* − 1/2) r*² = 1 − r*², so ½ r*³ − 2 r*² + 1 = 0.
  double rim = 0.8;
  for (int k = 0; k < 20; ++k) rim -= (0.5 * rim * rim * rim - 2 * rim * rim + 1) / (1.5 * rim * rim - 4 * rim);
  const double alpha = rim * rim * rim / std::sqrt(1 - rim * rim);
  const double h = 4 / static_cast<double>(intervals), per_h2 = 1 / (h * h);
  const Index m = intervals - 1;
  const auto radius = [&](Index i, Index j, Index k) {  // −1 … m
    const auto x = [h](Index l) { return -2 + h * static_cast<double>(l + 1); };
    return std::sqrt(x(i) * x(i) + x(j) * x(j) + x(k) * x(k));
  };
  const auto obstacle = [](double r) { return r < 1 ? std::sqrt(1 - r * r) : -1.0; };
  const auto u = [&](double r) { return r <= rim ? obstacle(r) : alpha * (1 / r - 0.5); };
  SpaceObstacle result;
  result.rim = rim;
  RowWriter rows(m * m * m, 7);
  Vector q;
  q.resize(m * m * m), result.exact.resize(m * m * m);
  Index row = 0;
  for (Index k = 0; k < m; ++k)
    for (Index j = 0; j < m; ++j)
      for (Index i = 0; i < m; ++i, ++row) {
        const double r = radius(i, j, k), psi = obstacle(r);
        result.exact[row] = u(r) - psi;
        q[row] = 6 * psi * per_h2;
        const auto neighbour = [&](Index a, Index b, Index c) {
          const bool inner = std::min({a, b, c}) >= 0 && std::max({a, b, c}) < m;
          if (inner) rows.add((c * m + b) * m + a, -per_h2);
          q[row] -= (inner ? obstacle(radius(a, b, c)) : u(radius(a, b, c))) * per_h2;
        };
        neighbour(i, j, k - 1), neighbour(i, j - 1, k), neighbour(i - 1, j, k);
        rows.add(row, 6 * per_h2);
        neighbour(i + 1, j, k), neighbour(i, j + 1, k), neighbour(i, j, k + 1);
        rows.end_row();
      }
  result.problem = Lcp::standard(std::move(rows.A), q);
  return result;
}

Lcp elastic_plastic_torsion(Index nx, Index ny, double twist) {
  const double hx = 1 / static_cast<double>(nx + 1), hy = 1 / static_cast<double>(ny + 1);
  const double a = hy / hx, b = hx / hy;  // times the area of a cell, as the energy has it
  RowWriter rows(nx * ny, 5);
  Lcp problem;
  problem.b = Eigen::VectorXd::Constant(nx * ny, -twist * hx * hy);
  problem.lo.resize(nx * ny), problem.hi.resize(nx * ny);
  Index row = 0;
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i, ++row) {
      const double x = hx * static_cast<double>(i + 1), y = hy * static_cast<double>(j + 1);
      problem.hi[row] = std::min({x, 1 - x, y, 1 - y});
      problem.lo[row] = -problem.hi[row];
      if (j > 0) rows.add(row - nx, -b);
      if (i > 0) rows.add(row - 1, -a);
      rows.add(row, 2 * (a + b));
      if (i + 1 < nx) rows.add(row + 1, -a);
      if (j + 1 < ny) rows.add(row + nx, -b);
      rows.end_row();
    }
  problem.A = std::move(rows.A);
  return problem;
}

}  // namespace orthant
