// Proofs that there is no solution, on problems too large for a dense tableau.
#include <orthant/core/lcp/judge/exact.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/pivoting/lemke.h>
#include <orthant/solvers/proof/farkas.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <chrono>
#include <limits>

using namespace orthant;

namespace {

Eigen::SparseMatrix<double, Eigen::RowMajor> laplace(Index n) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2.0);
    if (i > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

bool proved(const Lcp& p) {
  Vector u;
  const auto begin = std::chrono::steady_clock::now();
  const bool found = Farkas().propose(p, u);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (p.size() >= 600) MESSAGE("n = ", p.size(), ": ", (found ? "a proof" : "none"), " in ", seconds, " s");
  return found && Judge().proves_infeasible(p, u);
}

/// Of the doubles in u as they are, in rationals: u ≥ 0, Aᵀu ≤ 0, bᵀu < 0.
bool proves_as_it_is(const Lcp& p, const Vector& u) {
  using exact::Rational;
  if (u.size() != p.size() || (u.array() < 0).any()) return false;
  const exact::Table A = exact::table(p.A);
  Rational low = 0;
  for (Index j = 0; j < p.size(); ++j) {
    Rational sum = 0;
    for (Index i = 0; i < p.size(); ++i) sum += A[at(i)][at(j)] * Rational(u[i]);
    if (sum > 0) return false;
    low += Rational(p.b[j]) * Rational(u[j]);
  }
  return low < 0;
}

}  // namespace

TEST_CASE("sparse grids of 2000 rows: proved where one row contradicts the rest, and only there") {
  const Index n = 2000;
  Eigen::SparseMatrix<double, Eigen::RowMajor> A = laplace(n);
  Vector b(-Eigen::VectorXd::Ones(n));
  CHECK_FALSE(proved(Lcp::standard(RowSparse::from(A), b)));
  // A middle row that says the opposite of what its neighbours' sums force: −(sum of rows 900 … 1100)ᵀz ≥ 5.
  for (Index j = 0; j < n; ++j) {
    double sum = 0;
    for (Index i = 900; i <= 1100; ++i)
      if (i != 1000) sum += A.coeff(i, j);
    if (sum != 0 || A.coeff(1000, j) != 0) A.coeffRef(1000, j) = -sum;
  }
  A.prune(0.0);
  b[1000] = -5;
  const Lcp contradiction = Lcp::standard(RowSparse::from(A), b);
  CHECK(proved(contradiction));

  Eigen::SparseMatrix<double, Eigen::RowMajor> neumann = laplace(n);  // singular: constants in the kernel
  neumann.coeffRef(0, 0) = neumann.coeffRef(n - 1, n - 1) = 1;
  CHECK(proved(Lcp::standard(RowSparse::from(neumann), b)));
  CHECK_FALSE(proved(Lcp::standard(RowSparse::from(neumann), Vector(Eigen::VectorXd::Ones(n)))));
}

TEST_CASE("a dense semidefinite matrix of 600 rows, rank 300: Lemke says infeasible with a proof") {
  Random random(5);
  const Index n = 600;
  Eigen::MatrixXd B(n, n / 2);
  for (double& entry : B.reshaped()) entry = random.integer(-2, 2);
  const Eigen::MatrixXd M = B * B.transpose();
  CHECK_FALSE(proved(Lcp::standard(DenseMatrix(M), Vector(M * Eigen::VectorXd::Ones(n)))));
  // u ≥ 0 in the kernel of Bᵀ: the last row is minus the sum of the others.
  B.row(n - 1) = -B.topRows(n - 1).colwise().sum();
  Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd(B * B.transpose())), Vector(-Eigen::VectorXd::Ones(n)));
  for (double& b : p.b) b = random.integer(-1000, 900);
  CHECK(proved(p));
  Solution s;
  CHECK(Lemke().solve(p, s).status == Status::infeasible);
  CHECK(Judge().proves_infeasible(p, s.certificate));
}

TEST_CASE(
    "boxes, free rows, friction and upper bounds in a large problem: the proof leaves out what may have any sign") {
  const Index n = 400;
  Eigen::SparseMatrix<double, Eigen::RowMajor> A = laplace(n);
  Vector b(Eigen::VectorXd::Ones(n));
  Lcp p = Lcp::standard(RowSparse::from(A), b);
  for (Index i = 0; i < n; i += 7) p.hi[i] = 1;
  for (Index i = 1; i < n; i += 7) p.lo[i] = -kInf;
  for (Index i = 2; i < n; i += 7) p.lo[i] = -kInf, p.hi[i] = 0;
  for (Index i = 3; i < n; i += 7) p.lo[i] = -kInf, p.friction.push_back({.normal = i + 1, .first = i, .mu = 0.5});
  CHECK_FALSE(proved(p));
  Lcp q = p;
  for (Index j = 0; j < n; ++j) A.coeffRef(204, j) = 0;  // row 204, complementary: w = −1 whatever z
  A.prune(0.0);
  q.A = RowSparse::from(A);
  q.b[204] = -1;
  CHECK(proved(q));
}

TEST_CASE("small and large path agree on random problems of 101 rows made of small ones") {
  Random random(6);
  int infeasible = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Kinds kinds{.free = trial % 4 == 1, .box = trial % 4 == 2, .friction = trial % 4 == 3};
    const Lcp block = random_integer_problem(random.integer(2, 5), kinds, random);
    const Index m = block.size(), n = 101 + m;
    Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(n, n)), Vector(Eigen::VectorXd::Ones(n)));
    std::get<DenseMatrix>(p.A).topLeftCorner(m, m) = std::get<DenseMatrix>(block.A);
    p.b.head(m) = block.b;
    p.lo.head(m) = block.lo;
    p.hi.head(m) = block.hi;
    p.friction = block.friction;
    INFO("trial ", trial);
    CHECK(proved(p) == proved(block));
    infeasible += proved(block);
  }
  CHECK(infeasible > 5);
}

TEST_CASE("a certificate proves as it is, where doubles have room for one") {
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  constexpr double kMost = std::numeric_limits<double>::max();
  const std::vector<std::pair<Matrix5, Vector>> known = {
      {Matrix5{{1.0614966008118139, -2, -0.24798508183318987, 0.03217755634889952, -0.02169726274844605},
               {-2, 4, 0, -0.06435511269779905, -0.45257563816948765},
               {-0.24798508183318987, 0, 1, 0, 1},
               {0.03217755634889952, -0.06435511269779905, 0, 0.001035395132586604, 0.007281389049668925},
               {-0.02169726274844605, -0.45257563816948765, 1, 0.007281389049668925, 1.0512061770661298}},
       Vector{-2.0, -0.6789370615069135, -0.5289779458097268, 0.45920949732617694, 1.0}},
      {Matrix5{{-1, 0.5803175419703273, 2, 2, 0.5768503184613557},
               {0.3833778733621376, 1.2441013902386493, 1.8605945348536554, -1.8374580071670394, 1},
               {-0.540487990940211, -1, -2, -3, 1},
               {-1, 2, 2.1605604654794948, -0.9748746258583101, 0.5140773995580075},
               {0.7855804259546312, -0.7455396129139585, -0.2740437839756212, -0.08051876287728263, -2}},
       Vector{2.0, -3.0, -0.21757744962053793, -3.0, -2.0}},
      {Matrix5{{0, -20000000000, -1537355.6674177574, 1000000000, 30},
               {-2.9198576085803748e+16, 1e+16, 747379151276.9729, 1458438236182300.2, 11875463.432108322},
               {-9.287158856148485e+16, 1.6093335319752852e+16, -57863131619.33742, -1360561216691061.5, 0},
               {-35021123.17614699, 1914944.807584616, -230.30715924838165, 0, -0.003743640149126702},
               {-2490416.51915708, 0, -91.35510986213792, -100000, -0.001}},
       Vector{33.91876885465982, -39689231.904015236, -200000000.0, 0.04822534314521822, -0.01}},
      // Sums of two entries overflow.
      {Matrix5{{0, 0, 0, -0x1p997, -kMost},
               {kMost, 0, 0, kMost, 0},
               {-kMost, 0x1p997, -kMost, kMost, 0},
               {0x1p996, -kMost, kMost, -kMost, kMost},
               {kMost, kMost, 1, 0x1p996, 0}},
       Vector{0.0, -kMost, 0.0, 0.0, -kMost}},
      {Matrix5{{0, 0, kMost, -kMost, -1},
               {-0x1p997, 0, -1, 0, kMost},
               {0, -kMost, 0, 0, 0x1p996},
               {0, kMost, -kMost, kMost, -kMost},
               {-kMost, 0, 0, 0, 0}},
       Vector{0.0, -1.0, 0.0, 0.0, 0.0}},
  };
  int proved = 0;
  for (const auto& [A, b] : known) {
    const Lcp p = Lcp::standard(DenseMatrix(A), b);
    Solution s;
    REQUIRE(make_solver("auto")->solve(p, s).status == Status::infeasible);
    CAPTURE(proved);
    CHECK(proves_as_it_is(p, s.certificate));
    ++proved;
  }
  // Sums of decimals cancel by round numbers only: u = (2, 0, 1).
  Lcp decimals = Lcp::standard(DenseMatrix(Eigen::Matrix3d{{-0.3, 0.2, 0.2}, {0.1, 0.2, 0}, {0.3, -0.4, -0.8}}),
                               Vector{0.2, 0.2, -1});
  decimals.lo[1] = -kInf;
  for (const char* solver : {"auto", "lemke", "murty"}) {
    Solution s;
    CAPTURE(solver);
    REQUIRE(make_solver(solver)->solve(decimals, s).status == Status::infeasible);
    CHECK(proves_as_it_is(decimals, s.certificate));
  }
  // Random ones: u of the first three rows has Aᵀu < 0 in some columns only.
  Random random(34);
  int infeasible = 0, as_it_is = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Index n = random.integer(2, 6);
    DenseMatrix A(Eigen::MatrixXd::Zero(n, n));
    Vector b(Eigen::VectorXd::Zero(n));
    for (double& entry : A.reshaped())
      entry = random.integer(0, 1) == 0 ? random.integer(-3, 3) : random.uniform(-1, 1);
    for (double& entry : b) entry = random.integer(0, 1) == 0 ? random.integer(-3, 3) : random.uniform(-1, 1);
    const Lcp p = Lcp::standard(A, b);
    Solution s;
    if (make_solver("auto")->solve(p, s).status != Status::infeasible || s.certificate.size() == 0) continue;
    ++infeasible;
    CAPTURE(trial);
    CHECK(Judge().proves_infeasible(p, s.certificate));
    as_it_is += proves_as_it_is(p, s.certificate);
  }
  MESSAGE(as_it_is, " of ", infeasible, " certificates prove as they are");
  CHECK(infeasible > 50);
  CHECK(as_it_is == infeasible);
}

TEST_CASE("a proof search that is switched off, or out of time, is not made") {
  const Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Constant(1, 1, -1)), Vector{-1});
  Solution s;
  Lemke lemke;
  CHECK(lemke.solve(p, s).status == Status::infeasible);
  lemke.set_proof_search(false);
  CHECK(lemke.solve(p, s).status == Status::infeasible);  // its own ray proves it
  const auto newton = make_solver("newton-fb");
  CHECK(newton->solve(p, s).status == Status::infeasible);
  newton->set_proof_search(false);
  CHECK(newton->solve(p, s).status == Status::stalled);
}

TEST_CASE("no solver calls a z solved by rounding alone where a proof of infeasibility exists") {
  // The second row is three times the first, but for b; bounds of 1e5 and 1e8 make misses of 13 and 2000 small beside
  // the data.
  for (const double bound : {10.0, 1e5, 1e8}) {
    Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix3d{{4, -1, -3}, {12, -3, -9}, {-2, 13, -1}}), Vector{-2, 4, 2});
    p.lo = Vector{-kInf, -kInf, 0}, p.hi = Vector{kInf, kInf, bound};
    for (const SolverEntry& entry : solvers()) {
      CAPTURE(bound);
      CAPTURE(entry.name);
      const auto solver = make_solver(std::string(entry.name));
      if (!solver->why_not(p).empty()) continue;
      solver->set_time_limit(5);
      Solution s;
      CHECK(solver->solve(p, s).status != Status::solved);
      if (entry.name == "auto" || entry.name == "lemke") CHECK(s.status == Status::infeasible);
    }
  }
}

TEST_CASE("up to 12 rows no solver calls infeasible what has a solution, however large: cells decide, exactly") {
  const double e = 0x1p-52;
  const Vector b{0, -1};
  for (const auto& entry : solvers()) {
    CAPTURE(entry.name);
    const auto solver = make_solver(std::string(entry.name));
    solver->set_time_limit(5);
    Solution s;
    const auto status = [&](double last) {
      const Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, -1}, {-1, last}}), b);
      return solver->why_not(p).empty() ? solver->solve(p, s).status : Status::unsupported;
    };
    CHECK(status(1 + e) != Status::infeasible);
    if (has_answer(s.status)) CHECK((s.z - Vector{0x1p52, 0x1p52}).norm() <= 1e-3 * 0x1p52);
    if (entry.name == "auto" || entry.name == "lemke") CHECK(s.status == Status::solved);
    status(1 - e);
    if (entry.name == "auto" || entry.name == "lemke") CHECK(s.status == Status::infeasible);
  }
}
