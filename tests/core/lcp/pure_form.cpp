#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/pure_form.h>
#include <orthant/solvers/pivoting/enumerate.h>

#include <doctest/doctest.h>

#include "tests/support/allocations.h"
#include "tests/support/judge.h"

using namespace orthant;

namespace {

Eigen::MatrixXd matrix(const Lcp& pure) { return std::get<DenseMatrix>(pure.A); }

Lcp two_contacts(const Eigen::MatrixXd& G, const Eigen::VectorXd& b, double mu) {  // rows N₁ N₂ T₁ T₂
  Lcp p = Lcp::standard(DenseMatrix(G), Vector(b));
  for (Index i = 0; i < 2; ++i) {
    p.lo[2 + i] = -kInf;
    p.friction.push_back({.normal = i, .first = 2 + i, .mu = mu});
  }
  return p;
}

}  // namespace

TEST_CASE("planar friction becomes Glocker's form, block by block") {
  Eigen::MatrixXd G(4, 4);
  G << 5, 1, 2, 0.5, 1, 6, -1, 3, 2, -1, 7, 0.25, 0.5, 3, 0.25, 8;
  const double mu = 0.3;
  const Eigen::Vector4d b(-1, -2, 0.5, 4);  // w_T ≥ 0 at Λ = 0: no row is turned
  Pyramid pyramid;
  const Lcp& pure = pyramid.pure(two_contacts(G, b, mu));
  const Eigen::MatrixXd M = matrix(pure), I = Eigen::MatrixXd::Identity(2, 2), zero = Eigen::MatrixXd::Zero(2, 2);
  const auto NN = G.topLeftCorner(2, 2), NT = G.topRightCorner(2, 2), TN = G.bottomLeftCorner(2, 2),
             TT = G.bottomRightCorner(2, 2);
  Eigen::MatrixXd expected(6, 6);
  expected << NN - mu * NT, NT, zero, TN - mu * TT, TT, I, 2 * mu * I, -I, zero;
  CHECK(M == expected);
  Eigen::VectorXd q(6);
  q << b, 0, 0;
  CHECK(pure.b == q);
  CHECK(pure.lo == Eigen::VectorXd::Zero(6));
  CHECK(pure.friction.empty());
}

TEST_CASE("a box becomes two rows: the shifted one and the room between the bounds") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Constant(1, 1, 3)), Eigen::VectorXd::Constant(1, -20));
  p.lo[0] = -1, p.hi[0] = 4;
  Pyramid pyramid;
  const Lcp& pure = pyramid.pure(p);
  REQUIRE(pure.size() == 2);
  const Eigen::MatrixXd M = std::get<DenseMatrix>(pure.A);
  CHECK(M(0, 0) == 3);
  CHECK(M(0, 1) == 1);
  CHECK(M(1, 0) == -1);
  CHECK(M(1, 1) == 0);
  CHECK(pure.b[0] == -23);  // b + A lo
  CHECK(pure.b[1] == 5);    // hi − lo
}

TEST_CASE("a friction row that wants to slide forward is turned: the mirrored problem has the same pure form") {
  Eigen::MatrixXd G(4, 4);
  G << 5, 1, 2, 0.5, 1, 6, -1, 3, 2, -1, 7, 0.25, 0.5, 3, 0.25, 8;
  const Eigen::Vector4d b(-1, -2, 0.5, -4), mirror(1, 1, -1, -1);
  Pyramid one, other;
  const Lcp& p = one.pure(two_contacts(G, b, 0.3));
  const Lcp& q = other.pure(two_contacts(mirror.asDiagonal() * G * mirror.asDiagonal(), mirror.cwiseProduct(b), 0.3));
  CHECK(matrix(p) == matrix(q));
  CHECK(p.b == q.b);
}

TEST_CASE("the copositive form is copositive for positive semidefinite A") {
  Random random(21);
  Pyramid pyramid;
  for (int trial = 0; trial < 200; ++trial) {
    const Lcp p = random_contact_problem(3, 4, random.uniform(0, 2), random);
    const Eigen::MatrixXd M = matrix(pyramid.pure(p, Pyramid::Form::stewart_trinkle));
    Eigen::VectorXd x(M.rows());
    for (double& value : x) value = random.integer(0, 3) * random.uniform();
    CHECK(x.dot(M * x) >= -1e-12 * x.squaredNorm());
  }
}

TEST_CASE("every solution of either pure form restores to a solution, of every known problem of at most 20 rows") {
  Enumerate enumerate;
  Judge judge;
  Pyramid pyramid;
  int restored = 0;
  for (const Known& k : known_problems()) {
    if (!enumerate.why_not(k.problem).empty()) continue;
    for (const auto form : {Pyramid::Form::shifted, Pyramid::Form::stewart_trinkle}) {
      const Lcp pure = pyramid.pure(k.problem, form);
      INFO(k.name, ", form ", static_cast<int>(form));
      check(pure);
      CHECK_FALSE(Pyramid::needed(pure));
      CHECK((pure.size() == k.problem.size() || Pyramid::needed(k.problem)));
      if (!enumerate.why_not(pure).empty()) continue;
      SolutionSet set = enumerate_solutions(pure);
      for (const SolutionFace& face : set.faces)
        set.isolated.insert(set.isolated.end(), face.vertices.begin(), face.vertices.end());
      for (const Vector& y : set.isolated) {
        Solution s;
        pyramid.restore(k.problem, y, s.z);
        judge.certify(k.problem, 1e-12, Claim::candidate, s);
        CHECK(s.status == Status::solved);
        ++restored;
      }
    }
  }
  CHECK(restored > 80);
}

TEST_CASE("at a bound, z is that bound to the bit") {
  Pyramid pyramid;
  Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(3, 3)), Vector{-7, -1, 9});
  p.lo = Vector{0.1, 0, -kInf};
  p.hi = Vector{0.7, kInf, kInf};
  p.friction = {{.normal = 1, .first = 2, .mu = 0.3}};
  pyramid.pure(p);
  Vector z;
  pyramid.restore(p, Vector{0.6, 0.1, 0.0, 1.5, 0}, z);  // box row at hi (ξ > 0), z_T at −μ z_n (y = 0)
  CHECK(z[0] == 0.7);
  CHECK(z[2] == -0.3 * 0.1);
  p.b[2] = -9;  // turned: the other bound
  pyramid.pure(p);
  pyramid.restore(p, Vector{0.6, 0.1, 0.0, 1.5, 0}, z);
  CHECK(z[2] == 0.3 * 0.1);
}

TEST_CASE("a proof for the pure form is one for the problem") {
  Pyramid pyramid;
  Judge judge;
  for (const Known& k : known_problems()) {
    if (k.answer != Answer::infeasible || !Pyramid::needed(k.problem)) continue;
    INFO(k.name);
    Farkas farkas;
    Vector u;
    REQUIRE(farkas.propose(k.problem, u));
    CHECK(judge.proves_infeasible(k.problem, u));
  }
}

TEST_CASE("the pyramid allocates nothing from the second problem of a size on") {
  Random random(22);
  Pyramid pyramid;
  std::vector<Lcp> problems;
  for (int k = 0; k < 6; ++k) problems.push_back(random_contact_problem(1 + k % 3, 6, 0.5, random));
  for (const Known& k : known_problems())
    if (k.name.rfind("box", 0) == 0) problems.push_back(k.problem);
  Vector z;
  const auto run = [&] {
    for (const Lcp& p : problems)
      for (const auto form : {Pyramid::Form::shifted, Pyramid::Form::stewart_trinkle})
        pyramid.restore(p, pyramid.pure(p, form).b, z);
  };
  run();
  const std::size_t before = AllocationCount::now();
  run();
  CHECK(AllocationCount::now() == before);
}

TEST_CASE("entries and rows of a matrix are those of its dense form, whatever its storage") {
  Random random(31);
  const Lcp dense = random_spd_problem(6, random), rows = as_sparse(dense);
  for (const Matrix* A : {&dense.A, &rows.A}) {
    DenseMatrix room;
    const DenseMatrix& known = dense_of(*A, room);
    DenseMatrix found = Eigen::MatrixXd::Zero(6, 6);
    CHECK(for_each_entry(*A, [&](Index i, Index j, double value) { found(i, j) = value; }));
    CHECK(found == known);
    int seen = 0;
    CHECK(for_each_entry(*A, [&](Index, Index, double) { return ++seen < 3; }));  // false ends it
    CHECK(seen == 3);
    RowSparse by_rows;
    const RowSparse* const stored = rows_of(*A, by_rows);
    REQUIRE(stored != nullptr);
    for (Index i = 0; i < 6; ++i)
      for (Index j = 0; j < 6; ++j) CHECK(stored->entry(i, j) == known(i, j));
    found.setZero();
    for (Index i = 0; i < 6; ++i) CHECK(for_each_in_row(*A, i, [&](Index j, double value) { found(i, j) = value; }));
    CHECK(found == known);
  }
  Delassus factors{.W = std::get<RowSparse>(rows.A), .inverse_mass = Vector(dense.b.cwiseAbs()), .regularization = {}};
  const Matrix applied = factors;
  CHECK_FALSE(for_each_entry(applied, [](Index, Index, double) {}));
  RowSparse formed;
  CHECK(rows_of(applied, formed, 1) == nullptr);  // more products than allowed
  DenseMatrix room;
  const DenseMatrix& known = dense_of(applied, room);
  const RowSparse& by_rows = *rows_of(applied, formed);
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j) CHECK(by_rows.entry(i, j) == doctest::Approx(known(i, j)));
  Matrix kept = dense.A;
  const double* const memory = std::get<DenseMatrix>(kept).data();
  CHECK(as<DenseMatrix>(kept).data() == memory);
  CHECK(as<RowSparse>(kept).rows == 0);
}
