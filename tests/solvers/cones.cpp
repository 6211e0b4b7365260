// Coulomb's cone solved: single contacts in closed form, planted problems, metamorphic relations, a storm of claims
// that independent code checks in long double, facets.
#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/contact_solve.h>
#include <orthant/solvers/cones/facets.h>
#include <orthant/solvers/registry.h>

#include "tests/support/allocations.h"
#include "tests/support/judge.h"
#include "tests/support/sanitized.h"

#include <doctest/doctest.h>
#include <Eigen/Dense>

using namespace orthant;

namespace {

const char* const kConeSolvers[] = {"auto",
                                    "prox",
                                    "newton-ac",
                                    "newton-min",
                                    "newton-fb",
                                    "admm",
                                    "apgd",
                                    "pgs",
                                    "psor",
                                    "sgs",
                                    "prox:path=true",
                                    "interior-point",
                                    "newton-ac:map=jean-moreau"};

/// A point mass m on a plane, pushed by (q_t1, q_t2) and pressed by q_n: A = I/m.
Lcp point_mass(double m, double mu, const Eigen::Vector3d& q) {
  Lcp p;
  p.A = DenseMatrix(Eigen::Matrix3d::Identity() / m), p.b = Eigen::VectorXd(q);
  p.lo = {0, -kInf, -kInf}, p.hi = {kInf, kInf, kInf};
  p.friction = {{.normal = 0, .first = 1, .rows = 2, .mu = mu}};
  return p;
}

Solution disc_solution(const Lcp& p, const std::string& solver) {
  Solution s;
  make_solver(solver)->solve(p, s);
  return s;
}

/// Returns the given z, one after another, until the judge accepts one.
class ScriptedSolver final : public ConeSolver {
 public:
  explicit ScriptedSolver(std::vector<Eigen::VectorXd> all) : all_(std::move(all)) {}
  std::size_t used = 0;

 private:
  Claim iterate(Vector&, int&) override {
    while (used < all_.size())
      if (finished(Vector(all_[used++]))) return Claim::time_limit;
    return Claim::stalled;
  }
  double tolerance() const override { return 1e-6; }
  std::vector<Eigen::VectorXd> all_;
};

}  // namespace

TEST_CASE("cones: a point mass opens, sticks or slides as in closed form, by every solver") {
  struct Single {
    Eigen::Vector3d q, z;
  };
  // mass 2: z = −m q_n normally; friction takes all of q_T up to μ z_n, else μ z_n against it.
  const Single cases[] = {{{1, 3, 4}, {0, 0, 0}},        {{0, 1, 0}, {0, 0, 0}},
                          {{-1, 0, 0}, {2, 0, 0}},       {{-1, 0.3, -0.4}, {2, -0.6, 0.8}},
                          {{-1, 3, 4}, {2, -0.6, -0.8}}, {{-1, 0, -7}, {2, 0, 1}}};
  for (const char* solver : kConeSolvers)
    for (const auto& [q, z] : cases) {
      CAPTURE(solver);
      CAPTURE(q.transpose());
      const Solution s = disc_solution(point_mass(2, 0.5, q), solver);
      CHECK(s.status == Status::solved);
      CHECK((s.z - z).norm() <= 1e-8);
    }
}

TEST_CASE(
    "cones: the methods of linear problems answer for the disc by facets that turn, or say that it is not solved") {
  const Lcp sliding = point_mass(2, 0.5, {-1, 3, 1.7}), sticking = point_mass(2, 0.5, {-1, 0.1, 0.02});
  const double speed = std::hypot(3.0, 1.7);
  for (const char* solver : {"lemke", "path", "dantzig"}) {
    CAPTURE(solver);
    const Solution slides = disc_solution(sliding, solver), sticks = disc_solution(sticking, solver);
    if (slides.status != Status::unsupported) {
      CHECK(slides.status == Status::solved);
      CHECK(std::hypot(slides.z[1] + 3 / speed, slides.z[2] + 1.7 / speed) <= 1e-7);
    }
    if (sticks.status != Status::unsupported) CHECK(sticks.status == Status::solved);
  }
  const auto lemke = make_solver("lemke");
  Facets pyramid(*lemke, 4, 0);  // without turning: between two corners of four, friction is weak
  Solution s;
  pyramid.solve(sliding, s);
  CHECK(pyramid.pyramid_status() == Status::solved);
  CHECK(s.status != Status::solved);
  CHECK(cone_residuals(sliding, s.z).scale_free > 0.01);
}

TEST_CASE("cones: one contact with any matrix: the exact solve finds a solution where the cases have one") {
  Random random(11);
  for (int trial = 0; trial < 2000; ++trial) {
    Eigen::Matrix3d B, skew = Eigen::Matrix3d::Zero();
    for (double& value : B.reshaped()) value = random.normal();
    Eigen::Matrix3d A = B * B.transpose() + 0.05 * Eigen::Matrix3d::Identity();
    if (trial % 3 == 0)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j) skew(i, j) = 0.1 * random.normal(), skew(j, i) = -skew(i, j);
    A += skew;
    Lcp p = point_mass(1, random.uniform(0, 1.5), Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    p.A = DenseMatrix(A);
    cones::Blocks blocks;
    blocks.load(p);
    Eigen::Vector3d z = Eigen::Vector3d::Zero();
    const double e = solve_contact(blocks, blocks[0], A.data(), p.b.data(), z.data());
    CHECK(e <= 1e-10 * p.b.norm());
  }
}

TEST_CASE("cones: auto solves planted problems of every kind") {
  Random random(21);
  for (int trial = 0; trial < share_of(60); ++trial) {
    const DiscContacts kind{.contacts = 3 + trial % 8,
                            .freedoms = trial % 3 == 0 ? 10 : 40,
                            .mu = trial % 7 == 0 ? 1.2 : 0.4,
                            .rolling = trial % 4 == 1,
                            .unsymmetric = trial % 5 == 2,
                            .degenerate = trial % 6 == 3,
                            .jammed = trial % 10 == 9,
                            .spread = trial % 9 == 4 ? 1e8 : 10};
    const Known known = disc_contacts(kind, random);
    CAPTURE(trial);
    const Solution s = disc_solution(known.problem, "auto");
    CHECK(s.status == Status::solved);
    CHECK(independent_scale_free(known.problem, s.z) <= 1e-9);
  }
}

TEST_CASE("cones: a storm: no claim of any solver is false") {
  Random random(31);
  int solved = 0, asked = 0;
  for (int trial = 0; trial < share_of(40); ++trial) {
    Known known = disc_contacts({.contacts = 1 + trial % 5,
                                 .freedoms = 2 + trial % 12,
                                 .mu = 0.3 * (trial % 5),
                                 .unsymmetric = trial % 3 == 0,
                                 .degenerate = trial % 2 == 0,
                                 .spread = trial % 4 == 0 ? 1e6 : 1},
                                random);
    if (trial % 4 == 1)  // no solution planted
      for (double& value : known.problem.b) value = random.normal();
    for (const SolverEntry& entry : solvers()) {
      if (entry.name == "enumerate" || entry.name == "lemke-howson") continue;
      CAPTURE(entry.name);
      CAPTURE(trial);
      const auto solver = entry.make("");
      solver->set_time_limit(1);
      Solution s;
      solver->solve(known.problem, s);
      ++asked;
      solved += s.status == Status::solved;
      if (has_answer(s.status)) CHECK(independent_scale_free(known.problem, s.z) <= 1e-7);
      if (s.status == Status::infeasible && s.cells.empty()) CHECK(independent_proof(known.problem, s.certificate));
    }
  }
  CHECK(solved > asked / 2);
}

TEST_CASE("cones: planar friction as discs of one row, and LCPs, are the same problems to prox and newton-ac") {
  Random random(41);
  for (int trial = 0; trial < 20; ++trial) {
    const Lcp p = random_contact_problem(4, 12, 0.4, random), q = random_spd_problem(9, random);
    for (const char* solver : {"prox", "newton-ac"}) {
      CAPTURE(solver);
      CHECK((disc_solution(q, solver).z - disc_solution(q, "lemke").z).norm() <= 1e-7);
      const Solution s = disc_solution(p, solver);
      CHECK(s.status == Status::solved);
    }
  }
}

TEST_CASE("cones: the answer turns with the tangent plane, and moves with units, order and a twin") {
  Random random(51);
  for (int trial = 0; trial < 12; ++trial) {
    const Known known = disc_contacts({.contacts = 5, .freedoms = 40}, random);
    const Lcp& p = known.problem;
    const Index n = p.size();
    const Vector w = disc_solution(p, "auto").w;
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(n, n);  // w_q = T w; contact k becomes contact (k + 2) mod 5
    for (Index k = 0; k < 5; ++k) {
      const Index to = 3 * ((k + 2) % 5);
      Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
      turn.bottomRightCorner(2, 2) = Eigen::Rotation2Dd(random.uniform(0, 7)).toRotationMatrix();
      T.block(to, 3 * k, 3, 3) = std::exp2(random.integer(-12, 12)) * turn;
    }
    Lcp q = p;
    q.A = DenseMatrix(T * std::get<DenseMatrix>(p.A) * T.transpose()), q.b = T * p.b;
    for (Friction& f : q.friction) f.normal = 3 * ((f.normal / 3 + 2) % 5), f.first = f.normal + 1;
    std::sort(q.friction.begin(), q.friction.end(), [](auto& a, auto& b) { return a.first < b.first; });
    const Solution turned = disc_solution(q, "auto");
    CHECK(turned.status == Status::solved);
    const Vector expected = Eigen::VectorXd(T * w);
    for (Index i = 0; i < n; ++i) CHECK(std::abs(turned.w[i] - expected[i]) <= 1e-7 * T.row(i).norm());
    // The same contact twice: the two share the impulse, the motion stays.
    Eigen::MatrixXd twice = Eigen::MatrixXd::Zero(n + 3, n);
    twice.topRows(n).setIdentity(), twice.bottomRows(3) = twice.topRows(3);
    Lcp r = p;
    r.A = DenseMatrix(twice * std::get<DenseMatrix>(p.A) * twice.transpose()), r.b = twice * p.b;
    r.lo = twice.cwiseAbs() * Eigen::VectorXd::Zero(n), r.hi = Eigen::VectorXd::Constant(n + 3, kInf);
    for (Index i = 0; i < n + 3; ++i) r.lo[i] = i % 3 == 0 ? 0 : -kInf;
    r.friction.push_back({.normal = n, .first = n + 1, .rows = 2, .mu = p.friction[0].mu});
    const Solution doubled = disc_solution(r, "auto");
    CHECK(doubled.status == Status::solved);
    CHECK((doubled.w.head(n) - w).norm() <= 1e-7 * (1 + w.norm()));
  }
}

TEST_CASE("cones: piles with discs, whose forces are not unique, are solved as operators") {
  for (const int boxes : {2, 5, 10}) {
    const Lcp p = box_column(boxes, {.mu = 0.4, .slope = 0.1, .spatial = true, .discs = true});
    CHECK(p.discs());
    const Solution s = disc_solution(p, "auto");
    CHECK(s.status == Status::solved);
    CHECK(independent_scale_free(p, s.z) <= 1e-9);
  }
}

TEST_CASE("cones: what cannot be solved is proved: a body pushed into a wedge of its own friction") {
  // w_n = −2 z_n + z_t − 1 with |z_T| ≤ z_n: never ≥ 0.
  Lcp p = point_mass(1, 1, {-1, 0, 0});
  p.A = DenseMatrix((Eigen::Matrix3d() << -2, 1, 0, 0, 1, 0, 0, 0, 1).finished());
  const Solution s = disc_solution(p, "auto");
  CHECK(s.status == Status::infeasible);
  CHECK(independent_proof(p, s.certificate));
}

TEST_CASE("cones: iterations allocate nothing: twice as many of them cost no allocation more") {
  Random random(61);
  std::vector<Lcp> problems{box_column(6, {.mu = 0.4, .slope = 0.1, .spatial = true, .discs = true})};
  for (const bool skew : {false, true})
    problems.push_back(disc_contacts({.contacts = 30, .freedoms = 60, .unsymmetric = skew}, random).problem);
  problems.push_back(disc_contacts({.contacts = 6, .freedoms = 20, .rolling = true}, random).problem);
  const auto count = [](const std::string& spec, const Lcp& p) {
    const auto solver = make_solver(spec);
    solver->set_proof_search(false);
    Solution s;
    std::size_t before = 0;
    for (int round = 0; round < 3; ++round) before = AllocationCount::now(), solver->solve(p, s);
    CHECK(s.iterations > 0);
    return AllocationCount::now() - before;
  };
  for (const char* spec :
       {"pgs:max_sweeps", "psor:max_sweeps", "sgs:max_sweeps", "nncg:max_sweeps", "admm:max_iterations",
        "apgd:max_iterations", "prox:max_outer", "newton-ac:max_steps", "newton-min:max_iterations"})
    for (const Lcp& p : problems) {
      if (std::string_view(spec).starts_with("apgd") && &p == &problems[2]) continue;  // symmetric ones only
      // One contact with two discs: Eigen's LU of a size known at run time.
      if (std::string_view(spec).find("sweeps") != std::string_view::npos && &p == &problems[3]) continue;
      CAPTURE(std::string(spec));
      CAPTURE(p.size());
      const std::string options = "tolerance=1e-30,";  // so that none is the last
      const auto at = [&](const char* many) {
        std::string whole(spec);
        return count(whole.insert(whole.find(':') + 1, options) + '=' + many, p);
      };
      CHECK(at("20") == at("40"));
    }
}

TEST_CASE("cones: admm's factors are of the symmetric part where little is missing, else of all") {
  Random random(71);
  for (const double skew : {0.0, 1e-13, 1e-3, 0.3}) {
    CAPTURE(skew);
    Known known = disc_contacts({.contacts = 8, .freedoms = 60}, random);
    auto& A = std::get<DenseMatrix>(known.problem.A);
    const Eigen::MatrixXd before = A;
    for (Index i = 0; i < A.rows(); ++i)
      for (Index j = 0; j < i; ++j) {
        const double s = skew * random.normal() * std::sqrt(A(i, i) * A(j, j) / static_cast<double>(A.rows()));
        A(i, j) += s, A(j, i) -= s;
      }
    known.problem.b = Eigen::VectorXd(known.problem.b + (before - A) * known.z);  // the same solution
    const Solution s = disc_solution(known.problem, "admm:tolerance=1e-11");
    CHECK(s.status == Status::solved);
    CHECK(independent_scale_free(known.problem, s.z) <= 1e-10);
  }
}

TEST_CASE("cones: one disc opens, sticks or slides at once: what the closed form gives is exact") {
  Random random(81);
  for (int trial = 0; trial < 3000; ++trial) {
    Eigen::Matrix3d B;
    for (double& value : B.reshaped()) value = random.normal();
    const Eigen::Matrix3d A = B * B.transpose() + (trial % 2 == 0 ? 1e-8 : 0.1) * Eigen::Matrix3d::Identity();
    Lcp p = point_mass(1, trial % 5 == 0 ? 0 : random.uniform(0, 2),
                       Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    p.A = DenseMatrix(A);
    cones::Blocks blocks;
    blocks.load(p);
    Eigen::Vector3d z(random.uniform(), random.normal(), random.normal());  // a start as of the last sweep
    solve_contact(blocks, blocks[0], A.data(), p.b.data(), z.data());
    CHECK(independent_scale_free(p, Vector(z)) <= 1e-9);
  }
}

TEST_CASE("cones: after a z that the judge refuses, one with a third of its residual is judged, too") {
  Lcp p;  // two bodies; the second has a thousandth of the data, and may miss by as much less
  p.A = DenseMatrix(Eigen::MatrixXd::Identity(6, 6)), p.b = {-1, 0, 0, -1e-3, 0, 0};
  p.lo = {0, -kInf, -kInf, 0, -kInf, -kInf}, p.hi = Eigen::VectorXd::Constant(6, kInf);
  p.friction = {{.normal = 0, .first = 1, .rows = 2, .mu = 0.5}, {.normal = 3, .first = 4, .rows = 2, .mu = 0.5}};
  const Eigen::VectorXd solution = -p.b, first = Eigen::VectorXd::Unit(6, 0), second = Eigen::VectorXd::Unit(6, 3);
  ScriptedSolver scripted({solution + 4e-7 * second, solution + 1.3e-7 * first, solution});
  Solution s;
  scripted.solve(p, s);
  CHECK(s.status == Status::solved);
  CHECK(scripted.used == 2);
}

TEST_CASE("cones: a negative normal impulse is no answer, whatever signs cancel in the diagonal") {
  Lcp p = point_mass(1, 1.25, {-6, 1, -3});
  p.A = DenseMatrix(Eigen::Matrix3d(Eigen::Vector3d(-100, 24.5, std::nextafter(75.5, 76)).asDiagonal()));
  Solution s;
  s.z = {-0.1, 0, 0}, s.w.resize(3);
  ConeJudge judge;
  CHECK(!judge.passes(p, 1e-10, s));
}

TEST_CASE("cones: auto leaves proximal steps that crawl for interior-point") {
  for (const std::uint64_t seed : {9U, 22U}) {  // proximal steps, then other starts: 228 factors and more than 600
    CAPTURE(seed);
    Random random(seed);
    const Lcp p =
        disc_contacts({.contacts = 40, .freedoms = 60, .mu = 0.8, .degenerate = true, .spread = 10}, random).problem;
    const auto solver = make_solver("auto");
    IterationLog log;
    solver->set_log(&log);
    Solution s;
    CHECK(solver->solve(p, s).status == Status::solved);
    CHECK(independent_scale_free(p, s.z) <= 1e-9);
    CHECK(log.back().event == "interior");
    CHECK(s.factorizations < 150);
  }
}

TEST_CASE("cones: a time limit and a flag end a run") {
  const Lcp p = box_column(40, {.mu = 0.4, .spatial = true, .discs = true});
  const auto solver = make_solver("admm");
  solver->set_time_limit(1e-6);
  Solution s;
  CHECK(solver->solve(p, s).status == Status::time_limit);
  const std::atomic<bool> flag = true;
  const auto prox = make_solver("auto");
  prox->set_cancel(&flag);
  CHECK(prox->solve(p, s).status == Status::cancelled);
}

TEST_CASE("a method that takes no pyramid refuses a disc by the caller's rows, not by the pyramid's") {
  const Lcp puck = point_mass(1, 0.2, {-10, 3, 4});
  Lcp without_diagonal = puck;
  std::get<DenseMatrix>(without_diagonal.A)(2, 2) = 0;
  int refusals = 0;
  for (const char* name : {"jacobi", "nncg", "mprgp"}) {
    CAPTURE(name);
    const auto solver = make_solver(name);
    Solution s;
    if (solver->solve(puck, s).status != Status::unsupported) continue;
    ++refusals;
    CHECK(solver->refusal(puck).find("rows 1 and 2 are a friction disc: must be") == 0);
    const std::string own = solver->refusal(without_diagonal);
    CHECK((own.find("(2, 2)") != std::string::npos || own.find("rows 1 and 2") == 0));
  }
  CHECK(refusals > 0);
}

TEST_CASE("pyramids that are turned find the slip of a puck for every friction, to the solver's own tolerance") {
  for (double mu = 0.025; mu < 0.49; mu += 0.025) {
    const Lcp p = point_mass(1, mu, {-10, 3, 4});
    for (const std::string spec : {"lemke", "path", "lemke:tolerance=1e-13"}) {
      CAPTURE(mu);
      CAPTURE(spec);
      Solution s;
      make_solver(spec)->solve(p, s);
      REQUIRE(s.status == Status::solved);
      CHECK(cone_residuals(p, s.z).scale_free < (spec == "lemke:tolerance=1e-13" ? 1e-12 : 1e-9));
      CHECK((s.z - Vector(Eigen::Vector3d(10, -6 * mu, -8 * mu))).lpNorm<Eigen::Infinity>() < 1e-8);
    }
  }
}
