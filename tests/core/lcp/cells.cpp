// All cells searched, as a proof: right lists hold, and no list does with a cell missing, or of another problem.
#include <orthant/core/lcp/judge/cells.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/support/sanitized.h"

using namespace orthant;

namespace {

/// Hotelling's problem with two entries swapped: six rows, no solution, and no vector that proves it.
Lcp hotelling_swapped() {
  const Eigen::MatrixXd A{{0.1, 0, 0, 0, 1, 0}, {0, 0.1, 0, 0, 0, 1},   {-1, 0, -1, 0, 0, 0},
                          {0, -1, 1, -1, 0, 0}, {0, 0, 0, 0, 1.05, -1}, {0, 0, 0, 0, 0, 1.05}};
  return Lcp::standard(DenseMatrix(A), Vector{-50, -50, 0.5, 0, 0, -52.5});
}

}  // namespace

TEST_CASE("six rows without a solution, and without a vector that proves it, are infeasible by all their cells") {
  const Lcp p = hotelling_swapped();
  CHECK(count_cells(p) == 64);
  for (const char* spec : {"enumerate", "lemke", "auto"}) {
    CAPTURE(spec);
    Solution s;
    make_solver(spec)->solve(p, s);
    CHECK(s.status == Status::infeasible);
    CHECK(s.certificate.size() == 0);
    CHECK(no_cell_has_a_solution(p, s.cells));
    for (std::size_t k = 0; k < s.cells.size(); ++k) {
      auto fewer = s.cells;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
      CHECK_FALSE(no_cell_has_a_solution(p, fewer));
      auto twice = s.cells;
      twice.push_back(s.cells[k]);
      CHECK_FALSE(no_cell_has_a_solution(p, twice));
    }
    Lcp solvable = p;
    solvable.b = Vector{50, 50, 0.5, 1, 1, 52.5};  // z = 0
    CHECK_FALSE(no_cell_has_a_solution(solvable, s.cells));
  }
}

TEST_CASE("random problems of all kinds without a solution: the cells prove it, and nothing where there is one") {
  Random random(40);
  Enumerate solver;
  solver.set_proof_search(false);
  Solution s;
  int proved = 0, solved = 0;
  for (int k = 0; k < share_of(1500); ++k) {
    const Kinds kinds{.free = k % 3 == 0, .box = k % 2 == 0, .friction = k % 5 == 0};
    const Lcp p = random_integer_problem(random.integer(1, 5), kinds, random);
    if (!solver.why_not(p).empty()) continue;
    solver.solve(p, s);
    INFO("problem ", k, ", ", name(s.status));
    const SolutionSet set = enumerate_solutions(p);
    const bool none = set.isolated.empty() && set.faces.empty();
    CHECK((s.status == Status::infeasible) == none);
    if (none) {
      ++proved;
      CHECK(no_cell_has_a_solution(p, s.cells));
      if (s.cells.size() > 1) {
        s.cells.pop_back();
        CHECK_FALSE(no_cell_has_a_solution(p, s.cells));
      }
    } else {
      ++solved;
      CHECK(has_answer(s.status));
      CHECK(s.cells.empty());
    }
  }
  MESSAGE("proved ", proved, ", solved ", solved);
  CHECK(proved > share_of(200));
  CHECK(solved > share_of(200));
}
