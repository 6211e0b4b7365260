// Derivatives of solutions against finite differences in 256 bits.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/derivatives/sensitivity.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/solvers/derivatives/differences_256.h"

using namespace orthant;

namespace {

// SolutionTangent against differences, adjoint against tangent.
void compare_tangents(const Lcp& p, const Solution& s, Random& random, double tolerance) {
  const Sensitivity of = sensitivity(p, s);
  REQUIRE(of.report().differentiable());
  REQUIRE(!of.report().redundant);
  const Perturbation change = random_change(p, random);
  const SolutionTangent t = of.jvp(change);
  const Difference256 d = difference_256(p, s.z, change);
  REQUIRE(d.found);
  const double size_z = 1 + d.z.lpNorm<Eigen::Infinity>(), size_w = 1 + d.w.lpNorm<Eigen::Infinity>();
  CHECK((t.z - d.z).lpNorm<Eigen::Infinity>() <= tolerance * size_z);
  CHECK((t.w - d.w).lpNorm<Eigen::Infinity>() <= tolerance * size_w * size_z);

  const Vector g = normal_vector(random, p.size()), h = normal_vector(random, p.size());
  const DataGradient back = of.vjp(g, h);
  double along = back.b.dot(change.b) + back.lo.dot(change.lo) + back.hi.dot(change.hi) + back.mu.dot(change.mu);
  const Matrix by_A = gradient_of_matrix(of, back);
  if (const auto* dense = std::get_if<DenseMatrix>(&by_A)) {
    along += dense->cwiseProduct(std::get<DenseMatrix>(*change.A)).sum();
  } else if (const auto* sparse = std::get_if<RowSparse>(&by_A)) {
    const auto& A = std::get<RowSparse>(*change.A);
    for (std::size_t k = 0; k < A.value.size(); ++k) along += sparse->value[k] * A.value[k];
  } else {
    const auto& parts = std::get<Delassus>(by_A);
    const auto& A = std::get<Delassus>(*change.A);
    for (std::size_t k = 0; k < A.W.value.size(); ++k) along += parts.W.value[k] * A.W.value[k];
    along += parts.inverse_mass.dot(A.inverse_mass) + parts.regularization.dot(A.regularization);
  }
  const double expected = g.dot(t.z) + h.dot(t.w);
  const double size = g.cwiseAbs().dot(t.z.cwiseAbs()) + h.cwiseAbs().dot(t.w.cwiseAbs());
  CHECK(std::abs(along - expected) <= tolerance * (1 + size));
}

}  // namespace

TEST_CASE("sensitivity: boxes and free rows, dense and sparse, symmetric or not, as differences in 256 bits") {
  Random random(41);
  for (int trial = 0; trial < 40; ++trial) {
    INFO("trial ", trial);
    const Index n = random.integer(1, 14);
    Lcp p = random_spd_problem(static_cast<int>(n), random);
    DenseMatrix& A = std::get<DenseMatrix>(p.A);
    if (trial % 4 >= 2)  // a skew part: a P-matrix still
      for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < j; ++i) {
          const double skew = random.normal();
          A(i, j) += skew, A(j, i) -= skew;
        }
    for (Index i = 0; i < n; ++i) {
      const int kind = random.integer(0, 4);
      if (kind == 1) p.hi[i] = random.uniform(0.0, 0.5);
      if (kind == 2) p.lo[i] = -kInf;
      if (kind == 3) p.lo[i] = -0.3, p.hi[i] = 0.1;
      if (kind == 4 && trial % 5 == 0) p.lo[i] = p.hi[i] = 0.2;
    }
    if (trial % 2 == 1) {
      const Eigen::SparseMatrix<double, Eigen::RowMajor> rows = A.sparseView();
      p.A = RowSparse::from(rows);
    }
    Solution s;
    REQUIRE(has_answer(make_solver("auto")->solve(p, s).status));
    compare_tangents(p, s, random, 1e-9);
  }
}

TEST_CASE("sensitivity: friction discs that stick, slide on the cone and are open, rolling too") {
  Random random(42);
  int sliding = 0, sticking = 0, open = 0;
  for (int trial = 0; trial < 24; ++trial) {
    INFO("trial ", trial);
    DiscContacts kind;
    kind.contacts = random.integer(1, 4), kind.freedoms = 30;
    kind.rolling = trial % 3 == 2, kind.unsymmetric = trial % 4 == 3;
    const Known known = disc_contacts(kind, random);
    Solution s;
    if (!has_answer(make_solver("auto")->solve(known.problem, s).status)) continue;
    for (const Friction& f : known.problem.friction) {
      const double slip = s.w.segment(f.first, f.rows).norm();
      ++(s.z[f.normal] == 0 ? open : slip > 1e-8 ? sliding : sticking);
    }
    compare_tangents(known.problem, s, random, 1e-8);
  }
  CHECK((sliding > 10 && sticking > 10 && open > 10));
}

TEST_CASE("sensitivity: planar friction, dense and as an operator that is not formed, by its parts W, 1/m, R") {
  Random random(43);
  for (int trial = 0; trial < 24; ++trial) {
    INFO("trial ", trial);
    const Index contacts = random.integer(1, 5), n = 2 * contacts, freedoms = n + 3;
    Eigen::MatrixXd W(n, freedoms);
    for (Index j = 0; j < freedoms; ++j)
      for (Index i = 0; i < n; ++i) W(i, j) = random.integer(0, 2) == 0 ? 0.0 : random.normal();
    Delassus parts;
    parts.W = RowSparse::from(Eigen::SparseMatrix<double, Eigen::RowMajor>(W.sparseView()));
    parts.inverse_mass = Eigen::VectorXd::Constant(freedoms, 1.0);
    for (Index j = 0; j < freedoms; ++j) parts.inverse_mass[j] = random.uniform(0.1, 2.0);
    parts.regularization = Eigen::VectorXd::Constant(n, 0.05);
    Lcp p = Lcp::standard(parts, normal_vector(random, n));
    for (Index k = 0; k < contacts; ++k) {
      p.friction.push_back({2 * k, 2 * k + 1, 1, random.uniform(0.1, 0.6)});
      p.lo[2 * k + 1] = -kInf;
    }
    if (trial % 2 == 0) {
      DenseMatrix dense;
      to_dense(p.A, dense);
      p.A = dense;
    }
    Solution s;
    if (!has_answer(make_solver("auto")->solve(p, s).status)) continue;
    compare_tangents(p, s, random, 1e-8);
  }
}

TEST_CASE("sensitivity: a sparse obstacle problem of 2000 rows, by its rows and by a difference of solves") {
  const Lcp p = string_on_obstacle(2001);
  Solution s, moved;
  REQUIRE(has_answer(make_solver("auto")->solve(p, s).status));
  const Sensitivity of = sensitivity(p, s);
  Perturbation change;
  change.b = p.b;
  const SolutionTangent t = of.directional(change);
  double out = 0;  // the rows of the tangent's own problem
  for (Index i = 0; i < p.size(); ++i)
    if (of.report().margin[i] > of.report().threshold)
      out = std::max(out, std::min(std::abs(t.z[i]), std::abs(t.w[i])));
  CHECK(out <= 1e-9 * t.w.lpNorm<Eigen::Infinity>());
  Lcp stronger = p;
  stronger.b *= 1 + 1e-6;  // scaled data: the same contact set, the tangent is exact but for rounding
  REQUIRE(has_answer(make_solver("auto")->solve(stronger, moved).status));
  CHECK(((moved.z - s.z) / 1e-6 - t.z).lpNorm<Eigen::Infinity>() <= 1e-5 * (1 + t.z.lpNorm<Eigen::Infinity>()));
}
