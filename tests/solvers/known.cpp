#include <orthant/core/lcp/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <map>
#include <optional>

#include "tests/support/judge.h"

using namespace orthant;

namespace {

/// A as W M⁻¹ Wᵀ + R without rounding, where it is symmetric and diagonally dominant: one column of W for each A_ij ≠ 0.
std::optional<Lcp> as_delassus(const Lcp& problem) {
  const auto& A = std::get<DenseMatrix>(problem.A);
  const Index n = problem.size();
  if (A != A.transpose()) return {};
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> inverse_mass;
  Delassus d;
  d.regularization.resize(n);
  for (Index i = 0; i < n; ++i) {
    double rest = A(i, i);
    for (Index j = 0; j < n; ++j)
      if (j != i) rest -= std::abs(A(i, j));
    if (rest < 0) return {};
    d.regularization[i] = rest;
    for (Index j = 0; j < i; ++j) {
      if (A(i, j) == 0) continue;
      const auto column = static_cast<int>(inverse_mass.size());
      entries.emplace_back(static_cast<int>(i), column, 1.0);
      entries.emplace_back(static_cast<int>(j), column, A(i, j) > 0 ? 1.0 : -1.0);
      inverse_mass.push_back(std::abs(A(i, j)));
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> W(n, static_cast<Index>(inverse_mass.size()));
  W.setFromTriplets(entries.begin(), entries.end());
  d.W = RowSparse::from(W);
  d.inverse_mass.resize(W.cols());
  std::copy(inverse_mass.begin(), inverse_mass.end(), d.inverse_mass.data());
  Lcp result = problem;
  result.A = d;
  return result;
}

std::vector<std::pair<std::string, Lcp>> storages(const Lcp& problem) {
  std::vector<std::pair<std::string, Lcp>> all{{"dense", problem}, {"sparse", as_sparse(problem)}};
  if (auto delassus = as_delassus(problem)) all.emplace_back("delassus", *delassus);
  return all;
}

}  // namespace

TEST_CASE("every solver finds the known solution, or is honest") {
  int delassus = 0;
  for (const SolverEntry& entry : solvers())
    for (const Known& k : known_problems())
      for (const auto& [storage, problem] : storages(k.problem)) {
        INFO(entry.name, " on ", k.name, ", ", storage);
        delassus += storage == "delassus";
        const auto solver = entry.make("");
        Solution s;
        solver->solve(problem, s);
        CHECK((s.status == Status::unsupported) == !solver->why_not(problem).empty());
        if (s.status == Status::unsupported) continue;
        INFO("status ", name(s.status), ", residual ", s.residual, ", z ", s.z.transpose());
        CHECK((s.status == Status::solved || s.status == Status::infeasible || s.status == Status::ray ||
               s.status == Status::iteration_limit || s.status == Status::stalled ||
               s.status == Status::numerical_error));
        if (s.status == Status::infeasible) CHECK(k.answer == Answer::infeasible);
        if (s.status != Status::solved) continue;
        REQUIRE(k.z.size() > 0);  // there is a solution to find
        CHECK(independent_residual(problem, s.z) < 1e-9);
        const double size = k.z.lpNorm<Eigen::Infinity>();
        const double solver_accuracy = entry.name == "pgs" ? 1e-6
                                       : entry.name == "lemke" || entry.name == "dantzig" || entry.name == "enumerate"
                                           ? 4e-16
                                           : 1e-10;
        if (k.answer == Answer::unique && (entry.name != "pgs" || k.accuracy < 1e-9))
          CHECK((s.z - k.z).lpNorm<Eigen::Infinity>() <= std::max(k.accuracy, solver_accuracy) * size);
        if (k.unique_w) {
          Vector w, scratch;
          multiply(problem.A, k.z, w, scratch);
          CHECK((s.w - w - problem.b).lpNorm<Eigen::Infinity>() <= 1e-8 * problem.b.lpNorm<Eigen::Infinity>());
        }
      }
  CHECK(delassus > 40);
}

TEST_CASE("who solves what: the table of exceptions is pinned") {
  // Problems a solver neither solves nor proves infeasible, and what it says instead. Plain Lemke's three: rays of the
  // method with the covering vector e, on problems for which no theorem promises anything.
  const auto unsupported = Status::unsupported, limit = Status::iteration_limit, ray = Status::ray;
  std::map<std::string, std::map<std::string, Status>> expected;
  expected["lemke"] = {{"feasible_without_solution", ray}};
  expected["lemke:rescue=false"] = {{"ray_though_solvable", ray},
                                    {"bimatrix", ray},
                                    {"rock_paper_scissors", ray},
                                    {"pang_perturbed", ray},
                                    {"feasible_without_solution", ray}};
  expected["path"] = {{"feasible_without_solution", ray}};
  expected["enumerate"] = {{"feasible_without_solution", ray}};
  for (const char* name : {"k_matrix", "wilkinson_30", "wilkinson_54", "wilkinson_60"})
    expected["enumerate"][name] = unsupported;  // more than 20 rows
  for (const char* name : {"circulant", "circulant_scaled", "wilkinson_30", "wilkinson_54", "wilkinson_60"})
    expected["pgs"][name] = limit;  // diverges
  for (const char* name : {"bimatrix",
                           "box_indefinite",
                           "contact_infeasible",
                           "cps_4_4_7",
                           "feasible_without_solution",
                           "four_corners",
                           "kkt",
                           "kkt_active",
                           "kkt_contradiction",
                           "kkt_infeasible",
                           "kkt_redundant",
                           "pang",
                           "pang_perturbed",
                           "qp",
                           "qp_scaled",
                           "ray_though_solvable",
                           "rock_paper_scissors",
                           "scalar_-+",
                           "scalar_--",
                           "scalar_0-",
                           "scalar_00",
                           "scalar_tiny--",
                           "upper_infeasible"})
    expected["pgs"][name] = unsupported;  // A_ii ≤ 0

  for (const auto& [spec, exceptions] : expected) {
    for (const Known& k : known_problems()) {
      const auto solver = make_solver(spec);
      Solution s;
      solver->solve(k.problem, s);
      INFO(spec, " on ", k.name, ": ", name(s.status));
      const auto exception = exceptions.find(k.name);
      if (exception != exceptions.end())
        CHECK(s.status == exception->second);
      else
        CHECK(s.status == (k.answer == Answer::infeasible ? Status::infeasible : Status::solved));
    }
  }
}
