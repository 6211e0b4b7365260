// The bold first try of `auto`: what it claims holds, and it claims what it is there for.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/families.h>
#include <orthant/solvers/active_set/small_active_set.h>
#include <orthant/solvers/at_bounds.h>
#include <orthant/solvers/linear_algebra/dense_lu.h>
#include <orthant/solvers/linear_algebra/kernels.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/allocations.h"

using namespace orthant;

namespace {

struct Tried {
  bool claimed = false;
  int factorizations = 0;
  Solution s;
};

/// Judged by certify() near rounding level: its claim, and whether that holds.
Tried attempt(const Lcp& problem) {
  Lcp dense = problem;
  dense.A = DenseMatrix();
  to_dense(problem.A, std::get<DenseMatrix>(dense.A));
  Tried t;
  t.s.z = Vector(Eigen::VectorXd::Zero(problem.size()));
  SmallActiveSet bold;
  t.claimed = bold.solve(dense, t.s.z, t.factorizations);
  Judge().certify(problem, 1e-13, Claim::candidate, t.s);
  Solution put;  // as the solvers that use it do
  if (!has_answer(t.s.status) && AtBounds().put(problem, t.s, put.z)) {
    Judge().certify(problem, 1e-13, Claim::candidate, put);
    t.s = put;
  }
  return t;
}

}  // namespace

TEST_CASE("small active set: its claims are solved to the rounding of the problem") {
  Random random(91);
  int claimed = 0, tried = 0;
  const auto check = [&](const Lcp& problem, const std::string& name) {
    const Tried t = attempt(problem);
    ++tried;
    if (!t.claimed) return;
    ++claimed;
    CHECK_MESSAGE(has_answer(t.s.status), name, ": residual ", t.s.residual, ", rounding ", t.s.rounding);
  };
  for (const Known& k : known_problems())
    if (k.answer != Answer::infeasible && k.answer != Answer::none) check(k.problem, k.name);
  for (int k = 0; k < 200; ++k) {
    const Index n = random.integer(1, 30);
    Lcp box = random_spd_problem(n, random);
    for (Index i = 0; i + 1 < n; i += 4) box.lo[i] = -kInf, box.lo[i + 1] = -0.1, box.hi[i + 1] = 0.2;
    check(box, "box " + std::to_string(k));
    check(random_contact_problem(1 + k % 4, 8, 0.5, random), "contacts " + std::to_string(k));
  }
  CHECK(claimed > 0.85 * tried);
}

TEST_CASE(
    "small active set: towers of boxes, their redundant corners and masses included, rest after one factorization") {
  for (const Index rows : {20, 80, 320})
    for (const double ratio : {1.0, 1e4, 1e10}) {
      INFO(rows, " rows, ratio of masses ", ratio);
      Solution s;
      make_solver("auto")->solve(find_family("tower")->make(rows, ratio, 1).problem, s);
      CHECK(has_answer(s.status));
      CHECK(s.factorizations == 1);
    }
}

TEST_CASE("small active set: a factorization or two where pivoting is exponential; none claimed without a solution") {
  for (const bool transposed : {false, true}) {
    const Lcp problem = murty_problem(30, transposed);
    const Tried t = attempt(problem);
    CHECK(t.claimed);
    CHECK(t.factorizations <= 3);
    CHECK(has_answer(t.s.status));
  }
  for (const Known& k : known_problems())
    if (k.answer == Answer::infeasible || k.answer == Answer::none) {
      const Tried t = attempt(k.problem);
      CHECK_MESSAGE((!t.claimed || t.s.status != Status::solved), k.name);
    }
}

TEST_CASE(
    "small active set: where all wrong rows at once go in circles, one at a time ends for P-matrices of few rows") {
  int met = 0;
  for (const Known& k : known_problems()) {
    if (!k.name.starts_with("circulant")) continue;
    const Tried t = attempt(k.problem);
    CHECK_MESSAGE(t.claimed, k.name);
    CHECK(t.factorizations > 4);  // it has gone round
    CHECK(has_answer(t.s.status));
    ++met;
  }
  CHECK(met == 2);
}

TEST_CASE("small active set: keeps its budget") {
  const Index n = 200;  // a string: each choice frees one row more
  DenseMatrix M(Eigen::MatrixXd::Zero(n, n));
  for (Index i = 0; i < n; ++i) {
    M(i, i) = 1;
    if (i > 0) M(i, i - 1) = -1;
  }
  Vector q(Eigen::VectorXd::Constant(n, 1e-3));
  for (Index i = 0; i < n; i += 2) q[i] = -1e-3;
  q[0] = 1;
  const Lcp problem = Lcp::standard(M, q);
  SmallActiveSet bold;
  Vector z(Eigen::VectorXd::Zero(n));
  int factorizations = 0;
  bold.solve(problem, z, factorizations);
  CHECK(factorizations > 1);
  Budget over;
  over.start(0, nullptr);
  z.setZero();
  factorizations = 0;
  CHECK_FALSE(bold.solve(problem, z, factorizations, over));
  CHECK(factorizations <= 1);
}

TEST_CASE("dense_lu of at most N rows: bit for bit that of any size, dependent columns and all") {
  Random random(94);
  for (int k = 0; k < 200; ++k) {
    const Index m = 1 + k % 6;
    DenseLu<double> any;
    DenseLu<double, 6> few;
    double* const a = any.reset(m);
    double* const b = few.reset(m);
    for (Index i = 0; i < m * m; ++i) a[i] = b[i] = random.integer(0, 3) == 0 ? 0 : random.normal();
    const Index copied = random.integer(0, static_cast<int>(m) - 1);
    for (Index i = 0; i < m && k % 3 == 0; ++i) a[i] = b[i] = 2 * a[i + m * copied];
    const Index rank = any.factorize(1e-14);
    REQUIRE(few.factorize(1e-14) == rank);
    std::array<double, 6> x{}, y{};
    for (Index i = 0; i < m; ++i) x[at(i)] = y[at(i)] = random.normal();
    any.solve(x.data(), rank);
    few.solve(y.data(), rank);
    CHECK(x == y);
  }
}

TEST_CASE("auto: small problems are solved without an allocation, and by the active set where that works") {
  Random random(92);
  std::vector<Lcp> problems;
  for (const Index n : {1, 4, 20, 120}) problems.push_back(random_spd_problem(n, random));
  for (int k = 1; k < 4; ++k) problems.push_back(random_contact_problem(k, 6, 0.5, random));
  const auto solver = make_solver("auto");
  Solution s;
  std::size_t before = 0;
  for (int round = 0; round < 3; ++round) {
    before = AllocationCount::now();
    for (const Lcp& p : problems) solver->solve(p, s);
  }
  CHECK(AllocationCount::now() == before);
  IterationLog log;
  solver->set_log(&log);
  solver->solve(problems[2], s);
  REQUIRE(log.size() == 1);
  CHECK(std::string(log[0].event) == "active-set");
}

TEST_CASE("kernels: bit for bit the plain loops, whatever the width of the machine") {
  Random random(93);
  for (int n = 0; n < 40; ++n) {
    const auto numbers = [&](int size) {
      std::vector<double> x(static_cast<std::size_t>(size));
      for (double& each : x) each = random.integer(0, 9) == 0 ? 0 : random.normal();
      return x;
    };
    const auto start = numbers(n), f = numbers(4), columns = numbers(4 * (n + 3));
    const auto at = [&](int k, int i) { return columns[static_cast<std::size_t>(k * (n + 3) + i)]; };
    auto four = start, one = start, multiple = start, w = start, size = start;
    detail::subtract_four(four.data(), f.data(), columns.data(), n + 3, n);
    detail::subtract(one.data(), f[0], columns.data(), n);
    detail::add_multiple(multiple.data(), f[1], columns.data(), n, 0.5);
    detail::add_with_size(w.data(), size.data(), f[2], columns.data(), n);
    double most = 0;
    for (int i = 0; i < n; ++i) {
      const auto u = static_cast<std::size_t>(i);
      double x = start[u];
      for (int k = 0; k < 4; ++k) x -= f[static_cast<std::size_t>(k)] * at(k, i);
      CHECK(four[u] == x);
      CHECK(one[u] == start[u] - f[0] * at(0, i));
      const double sum = start[u] + f[1] * at(0, i);
      CHECK(multiple[u] == (std::abs(sum) <= 0.5 * std::abs(start[u]) ? 0 : sum));
      CHECK(w[u] == start[u] + f[2] * at(0, i));
      CHECK(size[u] == start[u] + std::abs(f[2] * at(0, i)));
      most = std::max(most, std::abs(start[u]));
    }
    CHECK(detail::largest(start.data(), n) == most);

    // Sums of several terms, for one row and for four; columns[…] as terms, some of which cancel to noise.
    const int count = 4;
    const double snap = n % 2 == 0 ? 0x1p-3 : 0x1p-40;  // most sums looked at, or hardly any
    std::array<const double*, 4> term;
    for (int q = 0; q < count; ++q) term[static_cast<std::size_t>(q)] = columns.data() + q * (n + 3);
    const auto factors = numbers(4 * count);
    std::array<std::vector<double>, 4> rows{numbers(n), numbers(n), start, numbers(n)};
    const auto before = rows;
    std::array<double*, 4> line;
    std::array<double, 4> reach{};
    for (std::size_t r = 0; r < 4; ++r) {
      line[r] = rows[r].data();
      for (std::size_t q = 0; q < 4; ++q) reach[r] += std::abs(factors[4 * q + r]) * detail::largest(term[q], n);
    }
    detail::add_multiples_to_four(line.data(), factors.data(), term.data(), count, n, snap, reach.data());
    for (std::size_t r = 0; r < 4; ++r) {
      std::array<double, 4> f_r;
      for (std::size_t q = 0; q < 4; ++q) f_r[q] = factors[4 * q + r];
      auto alone = before[r];
      detail::add_multiples(alone.data(), f_r.data(), term.data(), count, n, snap);
      for (int i = 0; i < n; ++i) {
        const auto u = static_cast<std::size_t>(i);
        double sum = before[r][u], largest = std::abs(sum);
        for (std::size_t q = 0; q < 4; ++q) sum += f_r[q] * term[q][u], largest = std::max(largest, std::abs(sum));
        CHECK(alone[u] == (std::abs(sum) <= snap * largest ? 0 : sum));
        CHECK(rows[r][u] == alone[u]);
      }
    }
  }
}
