#include <orthant/solvers/pivoting/lemke.h>

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/pivoting/delayed_pivots.h>
#include <orthant/solvers/pivoting/enumerate.h>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

#include "tests/support/judge.h"

using namespace orthant;

namespace {

Lcp minus_ones(const Eigen::MatrixXd& M) {
  return Lcp::standard(DenseMatrix(M), Vector(Eigen::VectorXd::Constant(M.rows(), -1)));
}

int pivots(const Lcp& p) {
  Lemke lemke;
  Solution s;
  lemke.solve(p, s);
  REQUIRE(s.status == Status::solved);
  return s.iterations;
}

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() && std::equal(a.data(), a.data() + a.size(), b.data());
}

Vector solved(const Lcp& problem) {
  Lemke lemke;
  Solution s;
  lemke.solve(problem, s);
  REQUIRE(s.status == Status::solved);
  return s.z;
}

}  // namespace

TEST_CASE("Lemke takes 2^n pivots on Murty's and Fathi's problems and 2 on the transposed") {
  for (int n = 2; n <= 10; ++n) {
    INFO("n = ", n);
    const Lcp murty = murty_problem(n);
    const auto& L = std::get<DenseMatrix>(murty.A);
    CHECK(pivots(murty) == 1 << n);
    CHECK(pivots(minus_ones(L * L.transpose())) == 1 << n);
    CHECK(pivots(murty_problem(n, true)) == 2);
  }
}

TEST_CASE("Lemke takes 2^n pivots where pivots are delayed, too: Murty's rows among others that follow them") {
  Random random(17);
  for (const int n : {5, 6, 8, 9})
    for (const int rows : {48, 63, 100}) {
      INFO("n = ", n, ", rows = ", rows);
      Eigen::MatrixXd M = Eigen::MatrixXd::Identity(rows, rows);
      M.topLeftCorner(n, n) = std::get<DenseMatrix>(murty_problem(n).A);
      for (int i = n; i < rows; ++i)
        for (int j = 0; j < n; ++j) M(i, j) = random.integer(0, 2) == 0 ? 0 : random.normal();
      Vector q(Eigen::VectorXd::Constant(rows, 1e6));  // such rows never leave
      q.head(n).setConstant(-1);
      Lemke lemke(LemkeOptions{.rescue = false});
      Solution s;
      lemke.solve(Lcp::standard(DenseMatrix(M), q), s);
      CHECK(s.status == Status::solved);
      CHECK(s.iterations == 1 << n);
      CHECK(s.z[0] == 1);
      CHECK(s.z.tail(rows - 1).isZero(0));
    }
}

TEST_CASE("Delayed pivots: a column, a row and the whole equal those of immediate pivots") {
  Random random(29);
  const int rows = 21, columns = 38;
  const auto number = [&] { return static_cast<double>(random.integer(-3, 3)); };  // sums are exact
  Eigen::Matrix<double, -1, -1, Eigen::RowMajor> T(rows, columns);
  for (double& entry : T.reshaped()) entry = number();
  auto at_once = T;
  detail::DelayedPivots pending;
  pending.reset(rows, columns, T.data(), columns, 0x1p-46);
  Eigen::VectorXd f(rows), p(columns), column(rows);
  for (int k = 0; k < 3 * detail::DelayedPivots::kMost + 5; ++k) {
    for (double& each : f) each = random.integer(0, 2) == 0 ? 0 : number();
    for (double& each : p) each = number();
    const int s = random.integer(0, columns - 1), row = random.integer(0, rows - 1);
    at_once += f * p.transpose();
    at_once.col(s) = f;  // a column that the caller writes
    T.col(s) = f;
    pending.keep(f.data(), p.data(), s);
    const int asked = random.integer(0, columns - 1);
    pending.column(asked, column.data());
    CHECK(column == at_once.col(asked));
    pending.finish_row(row);
    CHECK(T.row(row) == at_once.row(row));
    if (k % 13 == 0) at_once /= 2, pending.finish(), T /= 2;  // so that numbers stay short
  }
  CHECK(pending.count() > 0);
  pending.finish();
  CHECK(T == at_once);
}

TEST_CASE("Lemke ends honestly at its pivot limit; its rescue takes other paths") {
  Lemke plain(LemkeOptions{.rescue = false}), lemke;
  Solution s;
  plain.solve(murty_problem(60), s);
  CHECK(s.status == Status::iteration_limit);
  CHECK(s.residual > 0.1);
  lemke.solve(murty_problem(60), s);
  CHECK(s.status == Status::solved);
  Lemke brief(LemkeOptions{.max_pivots = 3});
  brief.solve(murty_problem(4), s);
  CHECK(s.status == Status::iteration_limit);
}

TEST_CASE("Lemke: a friction force that is small compared with its bound is not lost in the shift") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{0.001, 0}, {0, 2}}), Vector{-0.001, -3e-14});
  p.lo[1] = -kInf;
  p.friction = {{.normal = 0, .first = 1, .mu = 0.5}};
  Lemke lemke;
  Solution s;
  CHECK(lemke.solve(p, s).status == Status::solved);
  CHECK(s.z[1] == doctest::Approx(1.5e-14).epsilon(1e-9));
}

TEST_CASE("Lemke: bounds that overflow when shifted end honestly, in every stage") {
  for (const double lo : {5.0, 50.0, 100.0}) {
    Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Constant(1, 1, 1e308)), Vector{-1});
    p.lo[0] = lo;
    Lemke lemke;
    Solution s;
    CHECK(lemke.solve(p, s).status == Status::numerical_error);
  }
}

TEST_CASE("Lemke solves the circulant problem, where all ratios tie, in 4 pivots") {
  Eigen::MatrixXd M(3, 3);
  M << 1, 2, 0, 0, 1, 2, 2, 0, 1;
  CHECK(pivots(minus_ones(M)) == 4);
}

TEST_CASE("Lemke solves the degenerate problems of the slider-crank, in double precision") {
  // Derived independently for this project's case catalogue, from an event-driven solution in quadruple precision.
  std::ifstream in(ORTHANT_TEST_DATA "/slider_crank_lcps.json");
  REQUIRE(in.good());
  for (const auto& entry : nlohmann::json::parse(in)) {
    const auto rows = entry["M"].get<std::vector<std::vector<double>>>();
    const auto q = entry["q"].get<std::vector<double>>(), z = entry["z"].get<std::vector<double>>();
    const auto n = static_cast<Index>(q.size());
    Eigen::MatrixXd M(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) M(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    const Lcp p = Lcp::standard(DenseMatrix(M), Vector(Eigen::Map<const Eigen::VectorXd>(q.data(), n)));
    for (const bool rescue : {false, true}) {
      Lemke lemke(LemkeOptions{.rescue = rescue});
      Solution s;
      lemke.solve(p, s);
      INFO(entry["name"].get<std::string>(), ", status ", name(s.status));
      CHECK(s.status == Status::solved);
      CHECK((s.z - Eigen::Map<const Eigen::VectorXd>(z.data(), n)).lpNorm<Eigen::Infinity>() < 1e-12);
    }
  }
}

TEST_CASE("Lemke is exact to the bit on Hilbert's matrix: refinement goes on until it has converged") {
  for (const Known& k : known_problems())
    if (k.name.rfind("hilbert", 0) == 0) CHECK(same_bits(solved(k.problem), k.z));
}

TEST_CASE("Lemke: joints that say the same twice, in numbers that do not cancel exactly") {
  // min ½|x − p|², G x = d, with dependent rows in G, some x ≥ 0 and some free.
  Random random(17);
  Lemke lemke, plain(LemkeOptions{.rescue = false});
  Solution s;
  int missed = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Index n = random.integer(3, 20), rank = random.integer(1, 6), rows = rank + random.integer(1, 8);
    Eigen::MatrixXd basis(rank, n), mix(rows, rank);
    for (double& value : basis.reshaped()) value = random.normal();
    for (double& value : mix.reshaped()) value = random.normal() * (random.integer(0, 3) == 0 ? 1e3 : 1);
    const Eigen::MatrixXd G = mix * basis;
    Eigen::VectorXd x(n), p(n);
    for (double& value : x) value = std::max(0.0, random.normal());
    for (double& value : p) value = random.normal();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + rows, n + rows);
    A.topLeftCorner(n, n).setIdentity();
    A.topRightCorner(n, rows) = -G.transpose();
    A.bottomLeftCorner(rows, n) = G;
    Eigen::VectorXd b(n + rows);
    b << -p, -G * x;
    Lcp problem = Lcp::standard(DenseMatrix(A), Vector(b));
    problem.lo.tail(rows).setConstant(-kInf);
    for (Index i = 0; i < n; ++i)
      if (random.integer(0, 1) == 1) problem.lo[i] = -kInf;
    lemke.solve(problem, s);
    INFO("trial ", trial, ", n ", n, ", rank ", rank, " of ", rows, ": ", name(s.status), ", residual ", s.residual);
    REQUIRE(s.status == Status::solved);
    REQUIRE(independent_residual(problem, s.z) < 1e-12);
    missed += plain.solve(problem, s).status != Status::solved;
  }
  CHECK(missed <= 4);  // noise taken for data: 2 in 4000 with dependent rows cleaned, 65 without
}

TEST_CASE("Lemke, revised: the tableau's pivots and its answers") {
  for (int n = 2; n <= 10; ++n) {
    Lemke revised(LemkeOptions{.form = LemkeForm::revised, .rescue = false});
    Solution s;
    Lcp problem = murty_problem(n);
    for (int i = 0; i < n; ++i) problem.b[i] += std::ldexp(1.0, -4 * i - 4);  // no ties
    revised.solve(problem, s);
    CHECK(s.status == Status::solved);
    CHECK(s.iterations == 1 << n);
    Lemke tableau(LemkeOptions{.form = LemkeForm::tableau, .rescue = false});
    CHECK(tableau.solve(problem, s).iterations == 1 << n);
  }
  Random random(5);
  for (int run = 0; run < 200; ++run) {
    const Index n = random.integer(1, 40);
    const Lcp problem = run % 2 == 0 ? random_spd_problem(n, random) : planted_problem(n, n / 2, n / 2, random).problem;
    for (const LemkeCover cover : {LemkeCover::ones, LemkeCover::rows}) {
      Lemke tableau(LemkeOptions{.form = LemkeForm::tableau, .cover = cover, .rescue = false});
      Lemke dense(LemkeOptions{.form = LemkeForm::revised, .cover = cover, .rescue = false});
      Lemke sparse(LemkeOptions{.form = LemkeForm::revised, .cover = cover, .rescue = false});
      Solution a, b, c;
      INFO("run ", run, ", n ", n);
      REQUIRE(tableau.solve(problem, a).status == Status::solved);
      REQUIRE(dense.solve(problem, b).status == Status::solved);
      REQUIRE(sparse.solve(as_sparse(problem), c).status == Status::solved);
      CHECK(b.iterations == c.iterations);
      CHECK((b.z - c.z).lpNorm<Eigen::Infinity>() <= 1e-10 * (1 + b.z.lpNorm<Eigen::Infinity>()));
      if (run % 2 == 0) {  // one solution, one path
        CHECK(a.iterations == b.iterations);
        CHECK((a.z - b.z).lpNorm<Eigen::Infinity>() <= 1e-12 * (1 + a.z.lpNorm<Eigen::Infinity>()));
      }
      CHECK((a.w - b.w).lpNorm<Eigen::Infinity>() <= 1e-9 * (1 + a.w.lpNorm<Eigen::Infinity>()));
    }
  }
}

TEST_CASE("Lemke, revised: ties in every pivot end in no circle") {
  Random random(8);
  Lemke revised(LemkeOptions{.form = LemkeForm::revised, .rescue = false});
  Solution s;
  int solved = 0, open = 0;
  for (int run = 0; run < 300; ++run) {  // whole numbers of rank r: PSD, so that the method ends at an answer
    const Index n = random.integer(5, 60), r = random.integer(1, static_cast<int>(n));
    const Eigen::MatrixXd B =
        Eigen::MatrixXd::NullaryExpr(n, r, [&] { return static_cast<double>(random.integer(-1, 1)); });
    Lcp problem = as_sparse(minus_ones(B * B.transpose()));
    for (Index i = 0; i < n; ++i) problem.b[i] = random.integer(-1, 0);
    INFO("run ", run, ", n ", n, ", rank ", r, ", pivots ", s.iterations);
    revised.solve(problem, s);
    open += s.status != Status::solved && s.status != Status::infeasible;
    CHECK(s.iterations <= 4 * n);
    solved += s.status == Status::solved;
  }
  CHECK(solved > 30);
  CHECK(solved < 270);
  CHECK(open <= 6);  // rays that rounding leaves without a proof: 4; of the plain tableau 41
}

TEST_CASE("Lemke, revised: free rows, a singular free block, and a ray that is a proof") {
  Solution s;
  Lemke revised(LemkeOptions{.form = LemkeForm::revised, .rescue = false});
  Lcp kkt = as_sparse(minus_ones(Eigen::MatrixXd{{2, 0, -1}, {0, 2, -1}, {1, 1, 0}}));
  kkt.lo[2] = -kInf;                     // min x² + y² − x − y with x + y given
  for (const double sum : {1.5, 0.5}) {  // the multiplier takes either sign
    kkt.b[2] = -sum;
    REQUIRE(revised.solve(kkt, s).status == Status::solved);
    CHECK(s.z[0] == doctest::Approx(sum / 2));
    CHECK(s.z[2] == doctest::Approx(sum - 1));
  }
  kkt.A = as_sparse(minus_ones(Eigen::MatrixXd{{2, 0, -1}, {0, 0, 0}, {1, 0, 1}})).A;
  kkt.lo[1] = -kInf;  // a row that says 0 = 1
  CHECK(revised.solve(kkt, s).status == Status::infeasible);
  CHECK(revised.solve(as_sparse(minus_ones(Eigen::MatrixXd{{1, -1}, {-1, 1}})), s).status == Status::infeasible);
}

TEST_CASE("Lemke, revised: a string on an obstacle with 3000 nodes, never stored densely") {
  const Index n = 3000;
  Eigen::SparseMatrix<double, Eigen::RowMajor> M(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2.0);
    if (i > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
  }
  M.setFromTriplets(entries.begin(), entries.end());
  Vector q;
  q.resize(n);
  for (Index i = 0; i < n; ++i) q[i] = i < 30 ? -1.0 : 0.5;
  Lemke lemke;
  Solution s;
  REQUIRE(lemke.solve(Lcp::standard(RowSparse::from(M), q), s).status == Status::solved);
  CHECK(s.residual < 1e-12);
  CHECK(s.z.maxCoeff() > 100);
  CHECK(s.iterations < 1000);
}

TEST_CASE("Lemke never fails on two planar contacts with friction, tied, doubled and nearly so") {
  // Two corners on one wall see the same tangent: G_TT has rank one, rows differ by rounding or not at all.
  Random random(15);
  Lemke lemke({.tolerance = 1e-12});
  Solution s;
  int sliding = 0, sticking = 0, open = 0, rounded = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const double arm = random.uniform(-0.05, 0.05), mass = std::ldexp(1.0, random.integer(-8, 3));
    const double noise = trial % 2 == 0 ? 0 : 1e-16 * std::pow(10.0, random.integer(0, 4));
    const double spin = trial % 3 == 0 ? 0 : std::pow(10.0, random.integer(-4, 4));  // arm² m / J
    Eigen::MatrixXd W(4, 3);  // N₁ T₁ N₂ T₂ against x, y, θ
    W << 0, 1, 1, 1, 0, 0.5 * arm, 0, 1, trial % 5 == 0 ? 1 : -1, 1, 0, 0.5 * arm;
    for (double& entry : W.reshaped()) entry *= 1 + noise * random.normal();
    Eigen::VectorXd inverse_mass(3);
    inverse_mass << 1, 1, spin;
    const Eigen::VectorXd v =
        Eigen::Vector3d(random.normal(), random.normal() - 0.5, trial % 7 == 0 ? 0 : random.normal());
    Lcp p;
    p.A = DenseMatrix(W * (inverse_mass / mass).asDiagonal() * W.transpose());
    p.b = Vector(W * v * (trial % 11 == 0 ? 0.0 : 1.0));
    p.lo = Vector{0, -kInf, 0, -kInf};
    p.hi = Vector(Eigen::VectorXd::Constant(4, kInf));
    const double mu = 0.25 * random.integer(0, 6);
    p.friction = {{.normal = 0, .first = 1, .mu = mu}, {.normal = 2, .first = 3, .mu = mu}};
    lemke.solve(p, s);
    INFO("trial ", trial, ", mu ", mu, ", status ", name(s.status), ", residual ", s.residual);
    REQUIRE(has_answer(s.status));
    rounded += s.status == Status::rounded;
    REQUIRE(independent_residual(p, s.z) < 1e-12);
    open += s.z[0] == 0;
    sliding += s.z[0] > 0 && std::abs(s.z[1]) == mu * s.z[0];
    sticking += s.z[0] > 0 && std::abs(s.z[1]) < mu * s.z[0];
  }
  CHECK(rounded <= 40);
  CHECK(open > 1000);
  CHECK(sliding > 1000);
  CHECK(sticking > 1000);
}
