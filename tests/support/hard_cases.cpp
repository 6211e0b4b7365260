#include "hard_cases.h"

#include <orthant/core/lcp/problems/obstacles.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace orthant {

namespace {

double distance(const Vector& z, const Vector& solution) {
  const double size = solution.lpNorm<Eigen::Infinity>();
  return (z - solution).lpNorm<Eigen::Infinity>() / (size > 0 ? size : 1);
}

std::function<double(const Vector&)> distance_to(std::vector<Vector> solutions) {
  return [all = std::move(solutions)](const Vector& z) {
    double least = kInf;
    for (const Vector& solution : all) least = std::min(least, distance(z, solution));
    return least;
  };
}

/// Of the problems with several solutions: all of them.
std::map<std::string, std::function<double(const Vector&)>> solution_sets() {
  std::map<std::string, std::function<double(const Vector&)>> sets;
  sets["rank_one"] = [](const Vector& z) { return std::abs(z[0] + z[1] - 1); };
  sets["unbounded_segment"] = [](const Vector& z) { return std::abs(z[1] - z[0] - 1) / z[1]; };  // (t, 1 + t)
  sets["four_corners"] = distance_to({{0, 0}, {1, 0}, {0, 1}, {1, 1}});
  sets["bimatrix"] = distance_to({{0.1, 0, 0.1, 0}, {0, 1. / 15, 0, 1. / 15}, {1. / 30, 1. / 45, 1. / 90, 2. / 45}});
  sets["scalar_-+"] = distance_to({{0}, {0.5}});
  sets["scalar_00"] = [](const Vector& z) { return std::max(0.0, -z[0]); };
  sets["box_indefinite"] = distance_to({{0}, {0.5}, {1}});
  sets["contact_painleve_three"] = distance_to({{0, 0}, {1, -1}, {25, -17}});
  sets["kkt_redundant"] = [](const Vector& z) {
    return std::max({std::abs(z[0] - 1), std::abs(z[1] - 1), std::abs(z[2] + z[3] - 1)});
  };
  sets["contact_twice"] = [](const Vector& z) {
    return std::max(std::abs(z[0] + z[2] - 2), std::abs(z[1] + z[3] - 1)) / 2;
  };
  return sets;
}

/// Several z, all with the same w: the distance of w.
std::function<double(const Vector&)> distance_of_w(const Known& k) {
  return [problem = k.problem, solution = k.z](const Vector& z) {
    Vector change, scratch;
    multiply(problem.A, z - solution, change, scratch);
    return change.lpNorm<Eigen::Infinity>() / problem.b.lpNorm<Eigen::Infinity>();
  };
}

HardCase of(const Known& k) {
  static const auto sets = solution_sets();
  HardCase hard{k.name, k.problem, k.answer, k.accuracy, 5, {}};
  if (k.z.size() == 0) return hard;
  const auto set = sets.find(k.name);
  hard.error = set != sets.end() ? set->second : k.answer == Answer::unique ? distance_to({k.z}) : distance_of_w(k);
  return hard;
}

HardCase unique(std::string name, Lcp problem, const Vector& z, double accuracy) {
  return {std::move(name), std::move(problem), Answer::unique, accuracy, 5, distance_to({z})};
}

/// The string's contact set for a gap whose end is no node: the error of the grid, known to its digits.
HardCase string_off_node(Index intervals, double grid_error) {
  const double gap = 0.2, a = std::sqrt(gap) / 2;
  Vector exact(Eigen::VectorXd::Zero(intervals - 1));
  for (Index i = 0; i + 1 < intervals; ++i) {
    const double x = static_cast<double>(i + 1) / static_cast<double>(intervals);
    const double lift = std::max({a - x, x - 1 + a, 0.0});
    exact[i] = 4 * lift * lift;
  }
  const auto error = [=](const Vector& z) {
    return std::abs((z - exact).lpNorm<Eigen::Infinity>() - grid_error) / exact.maxCoeff();
  };
  return {"string_off_node_" + std::to_string(intervals),
          string_on_obstacle(intervals, gap),
          Answer::unique,
          1e-12,
          5,
          error};
}

double touching(const Vector& z) { return static_cast<double>((z.array() <= 1e-7 * z.maxCoeff()).count()); }

HardCase string_on_node(Index intervals) {
  Vector exact(Eigen::VectorXd::Zero(intervals - 1));
  for (Index i = 0; i + 1 < intervals; ++i) {
    const double x = static_cast<double>(i + 1) / static_cast<double>(intervals);
    const double lift = std::max({0.25 - x, x - 0.75, 0.0});
    exact[i] = 4 * lift * lift;
  }
  const auto n = static_cast<double>(intervals);
  return unique("string_" + std::to_string(intervals), string_on_obstacle(intervals), exact, 1e-13 * n);
}

/// Nodes in contact and the largest error of the grid; the latter to 1e-10 of the membrane's height.
HardCase ball(Index intervals, double contact_nodes, double grid_error) {
  BallObstacle b = ball_obstacle(intervals);
  const auto error = [=, exact = b.exact](const Vector& z) {
    return touching(z) == contact_nodes ? std::abs((z - exact).lpNorm<Eigen::Infinity>() - grid_error) : kInf;
  };
  return {"ball_" + std::to_string(intervals), b.problem, Answer::unique, 1e-12, 5, error};
}

HardCase journal(Index nx, Index ny, double minimum, double active_nodes) {
  Lcp p = journal_bearing(nx, ny);
  const auto error = [=](const Vector& z) {
    Vector Mz, scratch;
    multiply(p.A, z, Mz, scratch);
    return touching(z) == active_nodes ? std::abs((0.5 * z.dot(Mz) + z.dot(p.b)) / minimum - 1) : kInf;
  };
  return {"journal_" + std::to_string(nx) + "x" + std::to_string(ny), p, Answer::unique, 1e-12, 5, error};
}

HardCase planted(Index n, Index strict, Random& random) {
  HardCase hard = of(planted_problem(n, n / 2, strict, random));
  hard.name = "planted_" + std::to_string(strict) + "_of_" + std::to_string(n);
  return hard;
}

}  // namespace

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> all;
  for (const Known& k : known_problems()) all.push_back(of(k));
  for (const Index n : {40, 60}) {  // exponential for pivoting from e, easy for others
    const Lcp murty = murty_problem(n);
    const auto& L = std::get<DenseMatrix>(murty.A);
    all.push_back(unique("murty_" + std::to_string(n), murty, Eigen::VectorXd::Unit(n, 0), 1e-12));
    if (n == 40)
      all.push_back(unique("fathi_40", Lcp::standard(DenseMatrix(L * L.transpose()), murty.b),
                           Eigen::VectorXd::Unit(n, 0), 1e-10));
    else
      all.push_back(unique("murty_transposed_60", murty_problem(n, true), Eigen::VectorXd::Unit(n, n - 1), 1e-12));
  }
  for (std::size_t k = all.size() - 4; k < all.size(); ++k) all[k].seconds = 0.3;
  // Errors of the grid, contact nodes and minima: computed independently for the catalogue of hard cases, by an
  // active-set method in another language; the minimum of 8 x 12 is also what PETSc's example jbearing2 prints.
  for (const Index intervals : {64, 256}) all.push_back(string_on_node(intervals));
  all.push_back(string_off_node(16, 0.0020898033750315625));
  all.push_back(string_off_node(64, 9.435393753678967e-05));
  all.push_back(string_off_node(256, 3.6141640999687308e-06));
  all.push_back(journal(8, 12, -0.18343721961315979, 36));
  Random random(25);
  for (const Index strict : {60, 54, 30}) all.push_back(planted(60, strict, random));
  return all;
}

std::vector<HardCase> large_cases() {
  std::vector<HardCase> all;
  all.push_back(ball(32, 109, 0.005746855747640334));
  all.push_back(ball(64, 421, 0.0005991416656477844));
  all.push_back(journal(50, 50, -0.18048799500843138, 824));
  all.push_back(string_on_node(2048));
  Random random(26);
  all.push_back(planted(400, 200, random));
  all.back().accuracy = 1e-13;
  const Index n = 100000;  // tridiag(−1, 2, −1), q = −e: z_i = i (n + 1 − i) / 2
  Vector parabola(Eigen::VectorXd::Zero(n));
  for (Index i = 0; i < n; ++i) parabola[i] = static_cast<double>(i + 1) * static_cast<double>(n - i) / 2;
  Lcp k_matrix = string_on_obstacle(n + 1, 0);
  for (double& value : std::get<RowSparse>(k_matrix.A).value) value = value > 0 ? 2 : -1;
  k_matrix.b.setConstant(-1);
  all.push_back(unique("k_matrix_100000", k_matrix, parabola, 1e-6));  // condition 4e9
  return all;
}

}  // namespace orthant
