// First-order methods: invariances, starts, options, limits, allocations.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/pivoting/lemke.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>

#include <chrono>
#include <cmath>
#include <numeric>

#include "tests/solvers/first_order/first_order_runs.h"
#include "tests/support/allocations.h"
#include "tests/support/judge.h"

using namespace orthant;

TEST_CASE("a permuted problem has the permuted answer") {
  Random random(57);
  for (int trial = 0; trial < 10; ++trial) {
    const Lcp p = random_spd_problem(20, random);
    std::vector<Index> order(20);
    std::iota(order.begin(), order.end(), Index(0));
    for (std::size_t i = 19; i > 0; --i)
      std::swap(order[i], order[static_cast<std::size_t>(random.integer(0, static_cast<int>(i)))]);
    Lcp q = p;
    auto& A = std::get<DenseMatrix>(q.A);
    for (Index i = 0; i < 20; ++i) {
      q.b[i] = p.b[order[static_cast<std::size_t>(i)]];
      for (Index j = 0; j < 20; ++j)
        A(i, j) = std::get<DenseMatrix>(p.A)(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(j)]);
    }
    for (const std::string& spec : std::vector<std::string>{"jacobi", "apgd", "mprgp", "admm"}) {
      const std::string few = spec + ":tolerance=0,max_iterations=12";
      const Solution s = solve(few, p), t = solve(few, q);
      double difference = 0;
      for (Index i = 0; i < 20; ++i)
        difference = std::max(difference, std::abs(t.z[i] - s.z[order[static_cast<std::size_t>(i)]]));
      INFO(spec);
      CHECK(difference <= 1e-12 * (1 + s.z.lpNorm<Eigen::Infinity>()));  // the same steps, not only the same end
    }
  }
}

TEST_CASE("scaling rows and columns by powers of 2 scales the answer, bit by bit, step by step") {
  Random random(58);
  for (int trial = 0; trial < 10; ++trial) {
    const Index n = 15;
    const Lcp p = random_spd_problem(n, random);
    Vector d(Eigen::VectorXd::Zero(n));
    for (double& value : d) value = std::ldexp(1.0, random.integer(-3, 3));
    Lcp q = p;
    q.A = DenseMatrix(d.asDiagonal() * std::get<DenseMatrix>(p.A) * d.asDiagonal());
    q.b = d.cwiseProduct(p.b);
    for (const std::string& spec : kAll) {
      const bool sweeps = spec == "pgs" || spec == "psor" || spec == "sgs" || spec == "nncg";
      const std::string few = spec + ":tolerance=0,max_" + (sweeps ? "sweeps" : "iterations") + "=8";
      const Solution s = solve(few, p), t = solve(few, q);
      INFO(spec);
      if (spec == "admm")  // its factorization scales otherwise
        CHECK((t.z.cwiseProduct(d) - s.z).lpNorm<Eigen::Infinity>() <= 1e-9 * s.z.lpNorm<Eigen::Infinity>());
      else
        CHECK(t.z.cwiseProduct(d) == s.z);
    }
  }
}

TEST_CASE("a Delassus operator too large to be formed: 20000 contacts, no matter") {
  Random random(59);
  const int n = 20000, bodies = 5000;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) entries.emplace_back(i, (i / 4 + k * k * 7) % bodies, random.normal());
  Eigen::SparseMatrix<double, Eigen::RowMajor> W(n, bodies);
  W.setFromTriplets(entries.begin(), entries.end());
  Delassus A;  // formed it would take 3 GB
  A.W = RowSparse::from(W);
  A.inverse_mass = Vector(Eigen::VectorXd::Ones(bodies));
  A.regularization = Vector(Eigen::VectorXd::Constant(n, 1));
  Vector b(Eigen::VectorXd::Zero(n));
  for (double& value : b) value = random.normal();
  const Lcp p = Lcp::standard(A, b);
  Vector w;
  for (const std::string& spec : kAll) {
    const Solution s = solve(spec + ":tolerance=1e-6", p);
    INFO(spec, ": ", s.iterations);
    CHECK(s.status == Status::solved);
    if (w.size() == 0) w = s.w;
    CHECK((s.w - w).lpNorm<Eigen::Infinity>() <= 1e-3 * b.lpNorm<Eigen::Infinity>());
  }
}

TEST_CASE("a start at the solution takes no iteration, a bad one is forgotten") {
  Random random(60);
  const Lcp p = random_contact_problem(4, 20, 0.4, random);
  for (const std::string& spec : kAll) {
    const auto solver = make_solver(spec);
    Solution s;
    solver->solve(p, s);
    INFO(spec);
    REQUIRE(s.status == Status::solved);
    CHECK(s.iterations > 3);
    const Vector z = s.z;
    solver->solve(p, s, Start::warm);
    CHECK(s.iterations == 0);
    for (const double value : {-1e3, 1e3}) {
      s.z.setConstant(value);
      solver->solve(p, s, Start::warm);
      REQUIRE(s.status == Status::solved);
      CHECK((s.z - z).lpNorm<Eigen::Infinity>() < 1e-7 * z.lpNorm<Eigen::Infinity>());
    }
  }
}

TEST_CASE("every option is read") {
  Random random(61);
  Lcp p = random_spd_problem(25, random);
  for (Index i = 0; i < 25; i += 2) p.hi[i] = 0.05;
  const std::pair<std::string, std::vector<std::string>> cases[] = {
      {"pgs", {"omega=1.3", "tolerance=1e-4", "max_sweeps=3"}},
      {"psor", {"omega=0.7", "tolerance=1e-4", "max_sweeps=3"}},
      {"sgs", {"omega=1.3", "tolerance=1e-4", "max_sweeps=3"}},
      {"jacobi", {"omega=0.5", "scaling=diagonal", "scaling=spectral", "tolerance=1e-4", "max_iterations=3"}},
      {"nncg", {"tolerance=1e-4", "max_sweeps=3"}},
      {"apgd", {"shrink=0.5", "restart=false", "tolerance=1e-4", "max_iterations=3"}},
      {"mprgp", {"gamma=100", "step=0.1", "tolerance=1e-4", "max_iterations=3"}},
      {"admm", {"rho=3"}},
      {"admm:rho=100", {"adapt=false", "alpha=1", "tolerance=1e-4", "max_iterations=3"}}};
  for (const auto& [name, options] : cases) {
    IterationLog usual, other;
    solve(name, p, &usual);
    for (const std::string& option : options) {
      solve(name + (name.find(':') == std::string::npos ? ":" : ",") + option, p, &other);
      INFO(name, " ", option);
      bool differs = usual.size() != other.size();
      for (std::size_t k = 0; k < std::min(usual.size(), other.size()) && !differs; ++k)
        differs = usual[k].merit != other[k].merit;
      CHECK(differs);
    }
  }
}

TEST_CASE("first-order methods end by time, by flag, and where there is nothing to converge to") {
  const Lcp slow = journal_bearing(60, 60);
  Eigen::Matrix2d none;
  none << 1, -1, -1, 1;
  const Lcp infeasible = Lcp::standard(DenseMatrix(none), Vector{-1, -1});
  for (const std::string& spec : kAll) {
    INFO(spec);
    const auto solver = make_solver(spec + ":tolerance=0");
    solver->set_proof_search(false);
    Solution s;
    solver->set_time_limit(0.005);
    const auto begin = std::chrono::steady_clock::now();
    solver->solve(slow, s);
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(1));
    CHECK((s.status == Status::time_limit || (s.status == Status::solved && spec == "mprgp")));
    solver->set_time_limit(kInf);
    const std::atomic<bool> cancel{true};
    solver->set_cancel(&cancel);
    CHECK(solver->solve(slow, s).status == Status::cancelled);
    solver->set_cancel(nullptr);
    solver->solve(infeasible, s);
    // apgd runs away along the ray, ever faster, to where last digits of z are more than w; nobody looks for a proof.
    // mprgp knows a ray when it meets one.
    CHECK(s.status == (spec == "mprgp" ? Status::infeasible : spec == "apgd" ? Status::rounded : Status::stalled));
    CHECK(s.iterations <= 16384);
  }
}

TEST_CASE("why a method will not take a problem is said in words") {
  const Lcp skew = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, 1}, {-1, 1}}), Vector{-1, -1});
  const Lcp saddle = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, 1}, {1, 0}}), Vector{-1, -1});
  for (const std::string& spec : std::vector<std::string>{"apgd", "mprgp"})
    for (const bool sparse : {false, true}) {
      CHECK(make_solver(spec)->why_not(sparse ? as_sparse(skew) : skew).find("must be equal") != std::string::npos);
      CHECK(make_solver(spec)->why_not(sparse ? as_sparse(saddle) : saddle).find("not positive semidefinite") !=
            std::string::npos);
    }
  for (const std::string& spec : std::vector<std::string>{"psor", "sgs", "jacobi", "nncg"})
    CHECK(make_solver(spec)->why_not(saddle).find("entry (1, 1) = 0: must be > 0") != std::string::npos);
  CHECK(make_solver("admm")->why_not(skew).empty());
}

TEST_CASE("first-order methods allocate nothing from the second problem of a size on") {
  Random random(62);
  std::vector<Lcp> problems;
  for (int k = 0; k < 4; ++k) problems.push_back(random_contact_problem(1 + k % 3, 12, 0.5, random));
  problems.push_back(as_sparse(problems.back()));
  problems.push_back(random_spd_problem(5, random));
  for (const std::string& spec : kAll) {
    INFO(spec);
    const auto solver = make_solver(spec);
    Solution s;
    const auto all = [&] {
      for (const Lcp& p : problems)
        if (spec != "admm" || std::holds_alternative<DenseMatrix>(p.A)) solver->solve(p, s);
    };
    all();
    const std::size_t before = AllocationCount::now();
    all();
    CHECK(AllocationCount::now() == before);
  }
}
