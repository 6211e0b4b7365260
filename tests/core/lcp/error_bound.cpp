// Bounds on the error, and where rows stand: against planted solutions and complete solution sets.
#include <orthant/core/lcp/judge/active_set.h>
#include <orthant/core/lcp/judge/analyse.h>
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/judge/error_bound.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/pivoting/enumerate.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace orthant;

namespace {

/// Integers only, boxes and free rows among them: z is the solution of z, A, b exactly.
Known planted(const Eigen::MatrixXd& M, Random& random) {
  const Index n = M.rows();
  Known k;
  k.z = Vector(Eigen::VectorXd::Zero(n));
  Vector w = k.z, lo = k.z, hi = k.z;
  for (Index i = 0; i < n; ++i) {
    const int kind = random.integer(0, 5);
    hi[i] = kind == 4 ? 7 : kInf;
    lo[i] = kind == 5 ? -kInf : 0;
    const bool inside = kind >= 2;
    k.z[i] = inside ? random.integer(1, 6) : 0;
    w[i] = kind == 0 ? random.integer(0, 5) : 0;
    if (kind == 4 && random.integer(0, 1) == 1) k.z[i] = 7, w[i] = -random.integer(0, 5);
  }
  k.problem = Lcp::standard(DenseMatrix(M), Vector(w - M * k.z));
  k.problem.lo = lo;
  k.problem.hi = hi;
  return k;
}

Eigen::MatrixXd integers(Index n, Random& random, int size) {
  Eigen::MatrixXd M(n, n);
  for (double& entry : M.reshaped()) entry = random.integer(-size, size);
  return M;
}

Eigen::MatrixXd definite(Index n, Random& random) {  // not symmetric
  const Eigen::MatrixXd B = integers(n, random, 3), S = integers(n, random, 3);
  return B * B.transpose() + Eigen::MatrixXd::Identity(n, n) + S - S.transpose();
}
Eigen::MatrixXd dominant(Index n, Random& random) {
  Eigen::MatrixXd M = integers(n, random, 3);
  M.diagonal() = Eigen::VectorXd(M.cwiseAbs().rowwise().sum()) + Eigen::VectorXd::Ones(n);
  return M;
}
Eigen::MatrixXd p_matrix(Index n, Random& random) {  // neither of the two, as a rule
  for (;;) {
    const Eigen::MatrixXd M = integers(n, random, 3) + Eigen::MatrixXd::Identity(n, n) * 2;
    const Analysis a = analyse(DenseMatrix(M));
    if (a.p == Verdict::yes && a.positive_definite == Verdict::no && a.h_plus == Verdict::no) return M;
  }
}

Solution judged(const Lcp& p, const Vector& z) {
  Solution s;
  s.z = z;
  Judge().certify(p, 1e-12, Claim::candidate, s);
  return s;
}

}  // namespace

TEST_CASE("the bound holds for every perturbation of a planted solution, and is finite for every kind it covers") {
  Random random(11);
  double worst = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const int kind = trial % 3;
    const Index n = kind == 2 ? random.integer(2, 4) : random.integer(1, 15);
    const Known k = planted(kind == 0   ? definite(n, random)
                            : kind == 1 ? dominant(n, random)
                                        : p_matrix(n, random),
                            random);
    INFO("trial ", trial, ", n = ", n);
    CHECK(error_bound(k.problem, k.z) < 1e-10);  // exact z: only rounding is left, times the condition
    for (const double size : {1e-14, 1e-9, 1e-3, 10.0}) {
      Vector z = k.z;
      for (Index i = 0; i < n; ++i) z[i] += size * random.uniform(-1, 1);
      const double bound = error_bound(k.problem, z), error = (z - k.z).lpNorm<Eigen::Infinity>();
      INFO("size ", size, ", bound ", bound, ", error ", error);
      CHECK(bound >= error);
      CHECK(bound < kInf);
      worst = std::max(worst, bound / error);
    }
  }
  MESSAGE("largest bound / error: ", worst);
}

TEST_CASE("well conditioned problems: the bound is within a modest factor of the error") {
  Random random(12);
  for (int trial = 0; trial < 100; ++trial) {
    const Index n = random.integer(2, 30);
    Eigen::MatrixXd M = integers(n, random, 1);
    M.diagonal().setConstant(static_cast<double>(3 * n));
    const Known k = planted(M, random);
    Vector z = k.z;
    for (Index i = 0; i < n; ++i) z[i] += 1e-6 * random.uniform(-1, 1);
    CHECK(error_bound(k.problem, z) <= 10 * (z - k.z).lpNorm<Eigen::Infinity>());
  }
}

TEST_CASE("the bound does not depend on the unit of w, where squares of its numbers are none") {
  for (const double unit : {1e-100, 1e-170, 1e-200, 1e200}) {
    CAPTURE(unit);
    const DenseMatrix A = unit * DenseMatrix(Eigen::Matrix2d{{2, 1}, {1, 2}});
    const Lcp p = Lcp::standard(A, unit * Vector{-1, -2});
    const double bound = error_bound(p, Vector{0.002, 0.999});  // the solution: (0, 1)
    CHECK(bound >= 0.002);
    CHECK(bound <= 0.02);
    CHECK(error_bound(Lcp::standard(DenseMatrix::Constant(1, 1, unit), Vector{3}), Vector{0.107}) >= 0.107);
  }
}

TEST_CASE("sparse and large: a string's K-matrix; none for friction, singular and indefinite matrices") {
  const Index n = 2000;
  std::vector<Eigen::Triplet<double>> entries;
  Vector exact(Eigen::VectorXd::Zero(n));
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2.0);
    if (i > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
    exact[i] = (i + 1.0) * (static_cast<double>(n) - i) / 2;
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  const Lcp p = Lcp::standard(RowSparse::from(A), Vector(-Eigen::VectorXd::Ones(n)));
  Vector z = exact;
  CHECK(error_bound(p, z) <= 1e-3);  // rounding of w, 1e-10, through ‖A⁻¹‖ = 5e5
  z[n / 2] += 1;
  CHECK(error_bound(p, z) >= 1);
  CHECK(error_bound(p, z) < kInf);

  Random random(13);
  const Lcp contact = random_contact_problem(2, 6, 0.5, random);
  CHECK(error_bound(contact, contact.b) == kInf);
  const auto scalar = [](double a) {
    return Lcp::standard(DenseMatrix(Eigen::MatrixXd::Constant(1, 1, a)), Vector{1});
  };
  CHECK(error_bound(scalar(0), Vector{0}) == kInf);
  CHECK(error_bound(scalar(-1), Vector{0}) == kInf);
  CHECK(error_bound(scalar(1), Vector{std::nan("")}) == kInf);
  CHECK_THROWS_AS(error_bound(scalar(1), Vector{1, 2}), std::invalid_argument);
}

TEST_CASE("active set: each row in its place, degenerate rows named") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(5, 5)), Vector{1, -1, 0, -3, -2});
  p.hi[3] = 2;
  p.hi[4] = 2;
  const ActiveSet a = active_set(p, judged(p, Vector{0, 1, 0, 2, 2}));
  CHECK(a.lower == std::vector<Index>{0});
  CHECK(a.inside == std::vector<Index>{1});
  CHECK(a.upper == std::vector<Index>{3});
  CHECK(a.degenerate == std::vector<Index>{2, 4});
  CHECK(a.isolation == Isolation::isolated);
  Solution empty;
  CHECK_THROWS_AS(active_set(p, empty), std::invalid_argument);
}

TEST_CASE("uniqueness nearby: isolated is never said of a point on a face; of a regular, nondegenerate one always") {
  Random random(14);
  int on_face = 0, isolated = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Kinds kinds{.free = trial % 4 == 1, .box = trial % 4 == 2, .friction = trial % 4 == 3};
    const Lcp p = random_integer_problem(random.integer(1, 4), kinds, random);
    const SolutionSet set = enumerate_solutions(p);
    INFO("trial ", trial);
    for (const SolutionFace& face : set.faces)
      for (const Vector& z : face.vertices) {
        const Solution s = judged(p, z);
        if (s.status != Status::solved) continue;
        ++on_face;
        CHECK(active_set(p, s).isolation != Isolation::isolated);
      }
    for (const Vector& z : set.isolated) {
      const Solution s = judged(p, z);
      const ActiveSet a = active_set(p, s);
      if (a.degenerate.empty()) CHECK(a.isolation == Isolation::isolated);
      isolated += a.isolation == Isolation::isolated;
    }
  }
  CHECK(on_face > 250);
  CHECK(isolated > 500);
}
