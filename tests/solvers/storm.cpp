#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/support/judge.h"
#include "tests/support/sanitized.h"

using namespace orthant;

namespace {

struct Counts {
  int solved = 0, rounded = 0, infeasible = 0, honest = 0, missed = 0;
};

/// Thousands of small degenerate problems, the oracle beside the solver.
Counts storm(const std::string& spec, Kinds kinds, int problems, std::uint64_t seed) {
  Random random(seed);
  const auto solver = make_solver(spec);
  Enumerate oracle;
  Solution s, truth;
  Counts tally;
  for (int k = 0; k < share_of(problems); ++k) {
    const Lcp p = random_integer_problem(random.integer(1, 6), kinds, random);
    if (!oracle.why_not(p).empty()) continue;
    solver->solve(p, s);
    if (s.status == Status::unsupported) continue;
    INFO(spec, ", seed ", seed, ", problem ", k, ": ", name(s.status));
    if (s.status == Status::solved) {
      ++tally.solved;
      REQUIRE(independent_residual(p, s.z) < 1e-9);
    } else if (s.status == Status::rounded) {
      ++tally.rounded;
      REQUIRE(independent_residual(p, s.z) < 1e-14);
      oracle.solve(p, truth);
      REQUIRE(truth.status != Status::infeasible);
    } else if (s.status == Status::infeasible) {
      ++tally.infeasible;
      oracle.solve(p, truth);
      REQUIRE(truth.status == Status::infeasible);
    } else {
      ++tally.honest;
      REQUIRE((s.status == Status::ray || s.status == Status::iteration_limit || s.status == Status::stalled ||
               s.status == Status::numerical_error));
      oracle.solve(p, truth);
      if (spec == "lemke") REQUIRE(truth.status != Status::infeasible);  // it looks for proofs itself
      tally.missed += truth.status == Status::solved;
    }
    REQUIRE(s.residual == s.residual);
  }
  return tally;
}

}  // namespace

TEST_CASE("random integer problems: Lemke's answers stand, its proofs agree with the oracle") {
  const struct {
    Kinds kinds;
    std::string what;
  } cases[] = {{{}, "complementary rows"},
               {{.free = true}, "free rows"},
               {{.box = true}, "boxes"},
               {{.friction = true}, "friction"},
               {{.free = true, .box = true, .friction = true}, "all"}};
  std::uint64_t seed = 100;
  for (const auto& [kinds, what] : cases) {
    const Counts tally = storm("lemke", kinds, 2000, ++seed);
    MESSAGE(what, ": solved ", tally.solved, ", infeasible ", tally.infeasible, ", honest ", tally.honest,
            " of which solvable ", tally.missed);
    CHECK(tally.missed == 0);
    CHECK(tally.solved > share_of(400));
    CHECK(tally.infeasible > share_of(100));
  }
}

TEST_CASE("random integer problems of no promised class: dantzig's answers and proofs stand") {
  std::uint64_t seed = 150;
  for (const Kinds kinds : {Kinds{}, Kinds{.free = true, .box = true}, Kinds{.friction = true}}) {
    const Counts tally = storm("dantzig", kinds, 2000, ++seed);
    MESSAGE("solved ", tally.solved, ", infeasible ", tally.infeasible, ", honest ", tally.honest,
            " of which solvable ", tally.missed);
    CHECK(tally.solved > share_of(400));
    CHECK(tally.infeasible > share_of(100));
  }
}

TEST_CASE("random integer problems: path's answers and proofs stand, and few of the solvable ones are missed") {
  std::uint64_t seed = 170;
  for (const Kinds kinds : {Kinds{}, Kinds{.free = true}, Kinds{.box = true}, Kinds{.friction = true},
                            Kinds{.free = true, .box = true, .friction = true}}) {
    const Counts tally = storm("path", kinds, 500, ++seed);
    MESSAGE("solved ", tally.solved, ", infeasible ", tally.infeasible, ", honest ", tally.honest,
            " of which solvable ", tally.missed);
    // Its restarts are no search of all bases; of few problems the share scatters.
    CHECK(tally.missed <= (kSanitized ? 2 : 1) + 0.03 * tally.solved);
    CHECK(tally.solved > share_of(100));
    CHECK(tally.infeasible > share_of(25));
  }
}

TEST_CASE("random integer problems: the minimizers' answers and proofs stand") {
  for (const auto& [spec, problems] : {std::pair{"ipopt:restarts=0", 40}, {"nlopt:max_evaluations=1000", 400}})
    for (const Kinds kinds : {Kinds{}, Kinds{.free = true, .box = true}, Kinds{.friction = true}}) {
      const Counts tally = storm(spec, kinds, problems, 190);
      MESSAGE(std::string(spec), ": solved ", tally.solved, ", infeasible ", tally.infeasible, ", honest ",
              tally.honest, " of which solvable ", tally.missed);
      CHECK(tally.missed <= 1 + (kinds.friction ? 0.5 : 0.1) * tally.solved);  // friction's merit is not convex
    }
}

TEST_CASE("random integer problems: projected Gauss-Seidel's claims are right") {
  const Counts tally = storm("pgs:max_sweeps=1000", {.box = true, .friction = true}, 3000, 200);
  MESSAGE("solved ", tally.solved, ", honest ", tally.honest, " of which solvable ", tally.missed);
  CHECK(tally.solved > share_of(100));
}

TEST_CASE("monotone problems, degenerate and rank deficient: Lemke and path solve all") {
  for (const char* spec : {"lemke", "path"}) {
    Random random(300);
    const auto solver = make_solver(spec);
    Solution s;
    for (int k = 0; k < share_of(2000); ++k) {
      const Index n = random.integer(1, 12), rank = random.integer(0, static_cast<int>(n));
      const Known known = planted_problem(n, rank, random.integer(0, static_cast<int>(n)), random);
      solver->solve(known.problem, s);
      INFO(spec, ", problem ", k, ", n = ", n, ": ", name(s.status));
      REQUIRE(s.status == Status::solved);
      REQUIRE(independent_residual(known.problem, s.z) < 1e-12);
    }
  }
}

TEST_CASE("contacts with strong friction, sparse bodies: Lemke finds a solution wherever there is one") {
  // Few degrees of freedom and μ up to 3: no theorem promises a solution, the shifted form can end on a ray, and A is
  // singular but for rounding, so that a |z| ~ 1e16 may seem to solve.
  Random random(350);
  Enumerate oracle;
  const auto solver = make_solver("lemke");
  Solution s, truth;
  int solved = 0, none = 0;
  for (int k = 0; k < share_of(5000); ++k) {
    const Lcp p = random_contact_problem(random.integer(1, 3), random.integer(1, 6), random.uniform(0, 3), random);
    solver->solve(p, s);
    INFO("problem ", k, ": ", name(s.status));
    if (s.status == Status::solved) {
      ++solved;
      REQUIRE(independent_residual(p, s.z) < 1e-12);
      continue;
    }
    ++none;
    oracle.solve(p, truth);
    INFO("truth: ", name(truth.status));
    REQUIRE(truth.status != Status::solved);
  }
  MESSAGE("solved ", solved, ", without a solution ", none);
  CHECK(solved > share_of(3000));
}
