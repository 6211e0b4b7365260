// The verdict storm: its judge detects faults, its shrinker keeps what matters, a share of it finds no fault.
#include "experiments/studies/verdict_storm/cone_judge.h"
#include "experiments/studies/verdict_storm/disc_problems.h"
#include "experiments/studies/verdict_storm/exact_judge.h"
#include "experiments/studies/verdict_storm/shrink.h"
#include "experiments/studies/verdict_storm/verdicts.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <ctime>
#include <map>
#include <numeric>
#include <set>

#include "tests/support/sanitized.h"

using namespace orthant;

TEST_CASE("the exact judge takes exact answers and proofs, and none that is off by more than its tolerance") {
  const auto lemke = make_solver("lemke");
  Solution s;
  int solutions = 0, proofs = 0;
  for (const Known& known : known_problems()) {
    INFO(known.name);
    const Lcp& p = known.problem;
    if (known.z.size() > 0) CHECK(examine_solution(p, known.z, 1e-10).holds);
    lemke->solve(p, s);
    if (has_answer(s.status)) {
      ++solutions;
      CHECK(examine_solution(p, s.z, 1e-10, s.status).holds);
      if (known.answer != Answer::unique || known.accuracy > 0) continue;
      const double size = std::max(1.0, s.z.lpNorm<Eigen::Infinity>());
      for (Index i = 0; i < p.size(); ++i) {
        if (p.lo[i] == p.hi[i]) continue;
        Vector z = s.z;
        z[i] += 1e-3 * size;
        CHECK(!examine_solution(p, z, 1e-10).holds);
      }
    }
    if (s.status == Status::infeasible && s.cells.empty()) {
      ++proofs;
      CHECK(examine_proof(p, s.certificate).holds);
      Vector u = -s.certificate;
      CHECK(!examine_proof(p, u).holds);
      u.setZero();
      CHECK(!examine_proof(p, u).holds);
    }
  }
  CHECK(solutions > 30);
  CHECK(proofs >= 5);
}

TEST_CASE("the exact judge: a runaway z, a negative z, friction beyond its bound, a small part beside a large one") {
  const Lcp ray = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, -1}, {-1, 1}}), Vector{-1, -1});
  CHECK(!examine_solution(ray, Vector{1e16, 1e16}, 1e-10).holds);  // w is lost in rounding
  const Lcp one = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(1, 1)), Vector{1});
  CHECK(examine_solution(one, Vector{0}, 1e-10).holds);
  CHECK(!examine_solution(one, Vector{-1e-3}, 1e-10).holds);
  Lcp contact = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, 0}, {0, 1}}), Vector{-1, -0.75});
  contact.lo[1] = -kInf;
  contact.friction = {{.normal = 0, .first = 1, .mu = 0.5}};
  CHECK(examine_solution(contact, Vector{1, 0.5}, 1e-10).holds);
  CHECK(!examine_solution(contact, Vector{1, 0.75}, 1e-10).holds);
  const Lcp apart = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(2, 2)), Vector{-1e12, -1});
  CHECK(examine_solution(apart, Vector{1e12, 1}, 1e-10).holds);
  CHECK(!examine_solution(apart, Vector{1e12, 0}, 1e-10).holds);  // 1 is 1e-12 of the other part's scale
  const Lcp coupled =                                             // and a small row in a large part: w₁ = −1
      Lcp::standard(DenseMatrix(Eigen::Matrix3d{{0, 2, 1e-30}, {0, 1, 0}, {0, 0, 1}}), Vector{-1, 1e11, -1e11});
  CHECK(!examine_solution(coupled, Vector{0, 0, 1e11}, 1e-10).holds);
  Lcp narrow = one;  // a z outside its bounds is excused by no smallness
  narrow.lo[0] = -1e-160, narrow.hi[0] = -1e-200;
  CHECK(!examine_solution(narrow, Vector{0}, 1e-10).holds);
  CHECK(examine_solution(narrow, Vector{-1e-160}, 1e-10).holds);
}

TEST_CASE("the exact judge: the tolerance is met to the last digit, whatever the terms that cancel") {
  const Index n = 40;
  DenseMatrix rows(Eigen::MatrixXd::Identity(n, n));
  rows.row(0).setOnes(), rows(1, 1) = rows(2, 2) = 0;  // of which 100 and -100 are free to cancel
  Lcp sums = Lcp::standard(rows, Vector(Eigen::VectorXd::Zero(n)));
  sums.lo.setConstant(-kInf);
  sums.b[0] = 1;
  Vector z(Eigen::VectorXd::Zero(n));
  z[1] = 100, z[2] = -100;
  z[0] = -1 - 0.999e-10;
  CHECK(examine_solution(sums, z, 1e-10).holds);
  z[0] = -1 - 1.001e-10;
  CHECK(!examine_solution(sums, z, 1e-10).holds);
}

TEST_CASE("the exact judge: a ray that misses a sign by rounding of a friction coefficient proves nothing") {
  Eigen::Matrix4d A{{0, 0, 1, 0},  // row 2: friction of row 1
                    {0.012402629111974966, 0.00038105007248822654, 0, 0},
                    {0, 0, 0, 0},
                    {-0.8036162073904574, -0.02468976628376224, -1.1786697458468798, 0}};
  Lcp p = Lcp::standard(DenseMatrix(A), Vector{0, -1, -1, 0});
  p.lo[2] = -kInf;
  p.friction = {{.normal = 1, .first = 2, .mu = 1.8522721359487426}};
  Solution s;
  REQUIRE(make_solver("lemke")->solve(p, s).status == Status::infeasible);
  REQUIRE(s.ray.size() == 4);
  const Finding finding = examine_proof(p, s.ray);
  CHECK(!finding.holds);
  CHECK(finding.why.find("misses its sign") != std::string::npos);
  // What proves it is exact: all cells, or a certificate.
  CHECK((!s.cells.empty() || (s.certificate.size() == 4 && examine_proof(p, s.certificate).holds)));
}

TEST_CASE("Lemke's last resort, every basis in rationals of thousands of digits, ends in time") {
  const Lcp p = storm_problem(3, 10).problem;  // 1e-160 to 1e300
  for (const char* spec : {"auto", "lemke"}) {
    const auto solver = make_solver(spec);
    solver->set_time_limit(2);
    Solution s;
    const std::clock_t begin = std::clock();
    solver->solve(p, s);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    CHECK(seconds < (kSanitized ? 30 : 3));
  }
}

TEST_CASE("a fault is shrunk to the rows and the entries that it needs") {
  Random random(5);
  Lcp p = random_contact_problem(6, 5, 0.5, random);
  p.b[7] = -123.456;
  const auto shows = [](const Lcp& q) {
    for (Index i = 0; i < q.size(); ++i)
      if (q.b[i] < -100) return true;
    return false;
  };
  const Lcp least = shrink(p, shows);
  CHECK(shows(least));
  CHECK(least.size() == 1);
  CHECK(least.friction.empty());
  CHECK(std::get<DenseMatrix>(least.A)(0, 0) == 0);
  check(least);
}

TEST_CASE("a storm's problem is the same each time, and all kinds come") {
  std::set<std::string_view> kinds;
  for (std::uint64_t k = 0; k < 400; ++k) {
    const StormProblem a = storm_problem(3, k), b = storm_problem(3, k);
    check(a.problem);
    CHECK(to_json(a.problem) == to_json(b.problem));
    CHECK(a.problem.size() >= 1);
    CHECK(a.problem.size() <= 64);
    kinds.insert(a.kind);
  }
  CHECK(kinds.size() == storm_kinds().size());
}

TEST_CASE("a share of the storm: no wrong verdict, no crash, nothing late") {
  StormChoice choice;
  choice.grace = 30;  // sanitizers, a busy machine
  const StormTally tally = storm(choice, 0, kSanitized ? 20 : 100);
  std::array<long, kStormResults.size()> sum{};
  for (const auto& [key, row] : tally.rows)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += row.count[i];
  for (const StormFault& f : tally.faults) FAIL_CHECK(f.k, " ", f.kind, ", ", f.solver, ": ", f.what, ": ", f.why);
  MESSAGE("solved ", sum[0], ", rounded ", sum[1], ", infeasible ", sum[2], ", refused ", sum[3], ", failed ", sum[4]);
  CHECK(sum[0] > (kSanitized ? 80 : 400));
  CHECK(sum[2] > (kSanitized ? 20 : 100));
  CHECK(storm_tally_from_text(to_text(tally)).rows.size() == tally.rows.size());
}

TEST_CASE("a few solvers to each problem: every one meets every kind, auto all problems, by the seed alone") {
  for (const bool discs : {false, true})
    for (const std::size_t each : {1U, 3U, 50U}) {
      StormChoice choice;
      choice.discs = discs, choice.solvers = discs ? disc_solvers() : storm_solvers(), choice.solvers_each = each;
      for (StormSolver& solver : choice.solvers) solver.every = 1;
      CAPTURE(discs);
      CAPTURE(each);
      const std::size_t kinds = discs ? disc_kinds().size() : storm_kinds().size(), others = choice.solvers.size() - 1;
      const std::size_t turns = (others + each - 1) / each;
      std::map<std::pair<std::size_t, std::size_t>, std::size_t> met;  // by kind and solver
      std::set<std::vector<std::size_t>> hands;
      for (std::uint64_t k = 3 * turns * kinds; k < 4 * turns * kinds; ++k) {
        const auto hand = solvers_of(choice, k);
        CHECK(hand.size() <= 1 + each);
        CHECK(std::set(hand.begin(), hand.end()).size() == hand.size());
        for (const std::size_t i : hand) ++met[{k % kinds, i}];
        hands.insert(hand);
        CHECK(solvers_of(choice, k) == hand);
      }
      CHECK(met.size() == kinds * choice.solvers.size());
      for (const auto& [key, count] : met) CHECK(count == (choice.solvers[key.second].spec == "auto" ? turns : 1));
      if (each == 3) CHECK(hands.size() > turns);  // not the same for all kinds
    }
}

TEST_CASE("a share of the storm, a few solvers to each problem: no wrong verdict, no crash, nothing late") {
  StormChoice choice;
  choice.seed = 11, choice.grace = 30, choice.solvers_each = 2;
  const std::uint64_t problems = kSanitized ? 44 : 880;
  const StormTally tally = storm(choice, 0, problems);
  std::uint64_t by_auto = 0;
  for (const auto& [key, row] : tally.rows)
    if (key.second == "auto") by_auto = std::accumulate(row.count.begin(), row.count.end(), by_auto);
  for (const StormFault& f : tally.faults) FAIL_CHECK(f.k, " ", f.kind, ", ", f.solver, ": ", f.what, ": ", f.why);
  CHECK(by_auto == problems);
}

TEST_CASE("the certificate handed out is a proof itself; data that contradict each other in the last digits are none") {
  StormChoice choice;
  choice.seed = 2026, choice.grace = 30;
  // almost-singular: the doubles nearest to the exact proof stood for another vector, which is none.
  // family: a planted solution of singular rows, with b rounded.
  long proofs = 0;  // of a problem in some runs only: within the solvers' time
  for (const std::uint64_t k : {10575U, 98333U, 5738U, 41620U}) {
    const StormTally tally = storm(choice, k, 1);
    for (const StormFault& f : tally.faults) FAIL_CHECK(f.k, " ", f.kind, ", ", f.solver, ": ", f.what, ": ", f.why);
    for (const auto& [key, row] : tally.rows) proofs += row.exact + row.rounded;
  }
  CHECK(proofs > 10);
  const Lcp apart = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, -1}, {-1, 1}}), Vector{-1, 1 - 0x1p-50});
  const Finding finding = examine_proof(apart, Vector{1, 1});
  CHECK(finding.holds);
  CHECK(finding.margin == 0x1p-50 / (2 - 0x1p-50));
}

TEST_CASE("a tally goes through a file with an error that is infinite") {
  StormTally tally;
  tally.rows[{"extremes", "admm"}].error = kInf;
  CHECK(storm_tally_from_text(to_text(tally)).rows.at({"extremes", "admm"}).error > 1e308);
}

TEST_CASE("infeasible contact problems with discs: auto proves each one, and each proof holds exactly") {
  const auto solver = make_solver("auto");
  Solution s;
  int tried = 0;
  for (std::uint64_t k = 0; tried < 20; ++k) {
    const StormProblem p = disc_problem(5, k);
    if (p.kind != "discs-infeasible") continue;
    ++tried;
    CAPTURE(k);
    CHECK(solver->solve(p.problem, s).status == Status::infeasible);
    CHECK(examine_proof(p.problem, s.certificate).holds);
  }
}

TEST_CASE("a share of the storm: numbers from the least to the largest, solvers new for each problem") {
  StormChoice choice;
  choice.seed = 424242, choice.grace = 30;
  int tried = 0;
  for (std::uint64_t k = 0; tried < (kSanitized ? 10 : 60); ++k) {
    if (storm_problem(choice.seed, k).kind != "extremes") continue;
    ++tried;
    for (const StormFault& f : storm(choice, k, 1).faults) FAIL_CHECK(f.k, " ", f.solver, ": ", f.what, ": ", f.why);
  }
}

TEST_CASE("the judge of cones takes planted solutions of 1e-12 and none that is off by 1e-6, in any units") {
  Random random(7);
  for (int trial = 0; trial < 40; ++trial) {
    const Known known = disc_contacts({.contacts = 1 + trial % 6,
                                       .freedoms = 30,
                                       .mu = 0.1 + 0.1 * (trial % 9),
                                       .rolling = trial % 3 == 0,
                                       .unsymmetric = trial % 4 == 1,
                                       .spread = trial % 2 == 0 ? 1 : 1e10},
                                      random);
    CAPTURE(trial);
    CHECK_MESSAGE(examine_solution(known.problem, known.z, 1e-10).holds,
                  examine_solution(known.problem, known.z, 1e-10).why);
    const Vector z = 1.000001 * known.z;
    if (known.z.norm() > 0) CHECK(!examine_solution(known.problem, z, 1e-10).holds);
  }
}

TEST_CASE("a contact problem restated has the image of its solution; the image of another z does not solve it") {
  Random random(9);
  for (int trial = 0; trial < 30; ++trial) {
    const Known known =
        disc_contacts({.contacts = 1 + trial % 8, .freedoms = 40, .degenerate = trial % 2 == 0}, random);
    REQUIRE(can_be_restated(known.problem));
    const Restatement restated = restate(known.problem, random);
    check(restated.problem);
    CHECK(restated.problem.size() == known.problem.size() + 3);
    Vector image = restated.of_z * known.z;
    CHECK(examine_solution(restated.problem, image, 1e-9).holds);
    image[0] += 1e-3 * (1 + std::abs(image[0]));
    CHECK(!examine_solution(restated.problem, image, 1e-9).holds);
  }
}

TEST_CASE("problems of discs are the same each time, and all kinds come; those made infeasible are proved to be") {
  std::set<std::string_view> kinds;
  int proved = 0;
  for (std::uint64_t k = 0; k < 300; ++k) {
    const StormProblem a = disc_problem(3, k), b = disc_problem(3, k);
    check(a.problem);
    CHECK(to_json(a.problem) == to_json(b.problem));
    kinds.insert(a.kind);
    if (a.kind != "discs-infeasible") continue;
    Index row = -1;
    for (Index i = 0; i < a.problem.size(); i += 3) {
      Vector u(Eigen::VectorXd::Zero(a.problem.size()));
      u[i] = 1;
      if (examine_proof(a.problem, u).holds) row = i;
    }
    CHECK(row >= 0);
    ++proved;
  }
  CHECK(kinds.size() == disc_kinds().size());
  CHECK(proved == 20);
}

TEST_CASE("a share of the storm of discs: no wrong verdict, no crash, nothing late") {
  StormChoice choice;
  choice.discs = true, choice.solvers = disc_solvers(), choice.grace = 30;
  const StormTally tally = storm(choice, 0, kSanitized ? 15 : 75);
  std::array<long, kStormResults.size()> sum{};
  for (const auto& [key, row] : tally.rows)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += row.count[i];
  for (const StormFault& f : tally.faults) FAIL_CHECK(f.k, " ", f.kind, ", ", f.solver, ": ", f.what, ": ", f.why);
  CHECK(sum[0] > (kSanitized ? 80 : 400));
  CHECK(sum[2] > (kSanitized ? 2 : 10));
}

TEST_CASE("a fault of discs is shrunk contact by contact") {
  Random random(5);
  Lcp p = disc_contacts({.contacts = 5, .freedoms = 20}, random).problem;
  p.b[0] = -123.456;
  const Lcp least = shrink(p, [](const Lcp& q) {
    check(q);
    return q.discs() && q.b.minCoeff() < -100;
  });
  CHECK(least.size() == 3);
  CHECK(least.friction.size() == 1);
}
