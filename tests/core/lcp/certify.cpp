#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/collection.h>

#include <doctest/doctest.h>
#include <Eigen/LU>

#include <cmath>
#include <ctime>
#include <numeric>

#include "tests/core/lcp/judged.h"
#include "tests/support/judge.h"
#include "tests/support/sanitized.h"

using namespace orthant;

TEST_CASE("the judge accepts every known solution, in dense and in sparse storage") {
  for (const Known& k : known_problems()) {
    if (k.z.size() == 0) continue;
    INFO(k.name);
    CHECK(verdict(k.problem, k.z) == Status::solved);
    CHECK(verdict(as_sparse(k.problem), k.z) == Status::solved);
    CHECK(independent_residual(k.problem, k.z) < 1e-15);
  }
}

TEST_CASE("underflow: what misses data of a few smallest numbers is rounded only, larger ones must be met") {
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  const double A = 5.250037499883902, b = -5.857e-319;  // of a step of a mechanism at rest: w = ±kLeast at the best z
  CHECK(verdict(scalar(A, b), Vector{-b / A}) == Status::rounded);
  CHECK(verdict(pair({1, 0, 0, A}, Vector{-1, b}), Vector{1 + 1e-12, -b / A}) == Status::rounded);
  CHECK(verdict(scalar(1, -10 * kLeast), Vector{0.0}) == Status::rounded);
  CHECK(verdict(scalar(1, -1e-318), Vector{1e-318}) == Status::solved);  // w = 0
  for (const double size : {1e-318, 1e-307, 1e-300}) CHECK(verdict(scalar(1, -size), Vector{0.0}) == Status::stalled);
}

TEST_CASE("the judge rejects a known unique solution with one entry moved by a millionth") {
  for (const Known& k : known_problems()) {
    // Hilbert's matrix: a millionth is within its conditioning. Scaled problems: rows with tiny units hide it.
    if (k.answer != Answer::unique || k.accuracy > 1e-9 || k.name.find("scaled") != std::string::npos) continue;
    if (k.problem.b.lpNorm<Eigen::Infinity>() == 0) continue;
    for (Index i = 0; i < k.z.size(); ++i) {
      Vector z = k.z;
      z[i] += 1e-6 * (k.z.lpNorm<Eigen::Infinity>() + 1);
      INFO(k.name, ", entry ", i);
      CHECK(verdict(k.problem, z) != Status::solved);
      CHECK(verdict(k.problem, z) != Status::rounded);
    }
  }
}

TEST_CASE("the residual is a backward error: a tiny z_i off its bound counts by what it moves") {
  // z = 1e-12 (2, ½): min(z, w) is 2e-12 only, yet w₁ = ½, w₂ = 1 where the solution 1e-12 (1, 1) has w = 0.
  const Lcp p = pair({0, -1e12, 1e12, 0}, Vector{1, -1});
  CHECK(verdict(p, Vector{1e-12, 1e-12}) == Status::solved);
  CHECK(verdict(p, Vector{2e-12, 0.5e-12}) == Status::stalled);
  CHECK(verdict(as_sparse(p), Vector{2e-12, 0.5e-12}) == Status::stalled);
}

TEST_CASE("a z off its bound does not pass because w over the column's largest entry is below z's rounding") {
  Lcp box = pair({0, 2e17, 3, -2}, Vector{-1e17, 2});
  box.lo = Vector{1, -1}, box.hi = Vector{kInf, 1};
  CHECK(verdict(box, Vector{1, 0.5}) == Status::stalled);  // w₂ = 4 strictly inside the box
  CHECK(verdict(as_sparse(box), Vector{1, 0.5}) == Status::stalled);
  Lcp wrong_side = pair({-3, 2, 1e20, 1e20}, Vector{2, -3e20});
  wrong_side.lo = Vector{-1, 1}, wrong_side.hi = Vector{1, kInf};
  CHECK(verdict(wrong_side, Vector{1, 2}) == Status::stalled);  // w₁ = 3 at the upper bound
  CHECK(verdict(wrong_side, Vector{-1, 4}) == Status::solved);
}

TEST_CASE("a row of small numbers is not met because others have large ones") {
  const Lcp z_free = pair({0, 2, 0, 1}, Vector{-1, 1e11});  // w₁ ≥ 0 needs z₂ ≥ ½, and then w₂ > 0
  CHECK(verdict(z_free, Vector{8e14, 4e-16}) != Status::solved);
  CHECK(verdict(as_sparse(z_free), Vector{8e14, 4e-16}) != Status::solved);
  Lcp box = pair({0, -2, 0, 0}, Vector{-1, -1e11});
  box.lo = Vector{1, -1}, box.hi = Vector{1e308, 1};
  CHECK(verdict(box, Vector{1, 1}) != Status::solved);  // w₁ = −3 at its lower bound
  CHECK(verdict(box, Vector{1e12, 1}) != Status::solved);
  // w₁ = −1 beside a z₃ of 1e11 that hardly enters it
  Lcp coupled =
      Lcp::standard(DenseMatrix(Eigen::Matrix3d{{0, 2, 1e-30}, {0, 1, 0}, {0, 0, 1}}), Vector{-1, 1e11, -1e11});
  CHECK(verdict(coupled, Vector{0, 0, 1e11}) != Status::solved);
  auto& A = std::get<DenseMatrix>(coupled.A);
  A(1, 1) = 0, A(1, 2) = -2;  // and the like with an answer: w = 0 at z₂ = ½, or w₁ > 0 above
  CHECK(verdict(coupled, Vector{0, 0.5, 1e11}) != Status::solved);
  coupled.b[1] = 2e11;
  CHECK(verdict(coupled, Vector{0, 0.5, 1e11}) == Status::solved);
  CHECK(verdict(coupled, Vector{0, 0.49, 1e11}) != Status::solved);
  // w₁ = −1 next to z₂ and z₃ that cancel; the large data of z₄ hardly enter row 1
  const Eigen::Matrix4d B{{0, 1, -1, 1e-30}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 1}};
  const Lcp cancelled = Lcp::standard(DenseMatrix(B), Vector{-1, 0, 0, -1e11});
  CHECK(verdict(cancelled, Vector{0, 1e15, 1e15, 1e11}) != Status::solved);
  CHECK(verdict(as_sparse(cancelled), Vector{0, 1e15, 1e15, 1e11}) != Status::solved);
}

TEST_CASE("a runaway z is not a solution next to a row of large numbers either") {
  // Rows 1 and 2 sum to −1: no solution, whatever the third says, coupled weakly, one way or both, resting or pushed.
  for (const double back : {0.0, 1e-10})
    for (const double large : {1e3, 1e6, 1e9, 1e12, -1e9}) {
      const Lcp p =
          Lcp::standard(DenseMatrix(Eigen::Matrix3d{{1, -1, 0}, {-1, 1, back}, {-1e-7, 0, 1}}), Vector{1, -2, large});
      INFO("coupled back by ", back, ", beside ", large);
      for (const double far : {1e8, 1e10, 1e12, 1.2e14}) {
        const Vector z{far, far + 1.5, std::max(0.0, -large + 1e-7 * far)};
        CHECK(verdict(p, z) != Status::solved);
        CHECK(verdict(as_sparse(p), z) != Status::solved);
      }
    }
  Lcp box = Lcp::standard(DenseMatrix(Eigen::Matrix3d{{1, -1, 0}, {-1, 1, 0}, {-1e-7, 0, 1}}), Vector{1, -2, -1e12});
  box.hi[2] = 1e9;
  CHECK(verdict(box, Vector{1e14, 1e14 + 1.5, 1e9}) != Status::solved);
}

TEST_CASE("a runaway z excuses no row that it does not enter") {
  // Row 1 says z₂ ≥ s / a, row 2 z₂ ≤ 0: no solution, though z₁ may be as large as row 3 lets it.
  for (const double a : {1.0, 20.0})
    for (const double s : {1.0, 1e-3, 1e-6})
      for (const double other : {1.0, 1e3, 1e5}) {
        const Lcp p =
            Lcp::standard(DenseMatrix(Eigen::Matrix3d{{0, a, 0}, {0, -1, 0}, {1, 0, 0}}), Vector{-s, 0, other});
        INFO("z₂ ≥ ", s / a, ", beside ", other);
        for (const double far : {1e6, 1e9, 1e11, 1e12, 3.3e12, 3e14})
          for (const double share : {0.0, 0.5, 0.99, 1.0}) {
            CHECK(verdict(p, Vector{far, share * s / a, 0}) != Status::solved);
            CHECK(verdict(as_sparse(p), Vector{far, share * s / a, 0}) != Status::solved);
          }
      }
  const Lcp wide =
      Lcp::standard(DenseMatrix(Eigen::Matrix4d{{0, 400, 0, 0}, {0, -1, 0, 0}, {0, 0, 0, 0}, {1, 0, 100, 0}}),
                    Vector{-1e-4, 0, 0, 1000});
  CHECK(verdict(wide, Vector{0, 0, 1e10, 0}) != Status::solved);
}

TEST_CASE("a runaway z excuses no row whose own z were not computed from it") {
  // w₁ = −2 z₂ − 4 has to be 0, and misses by 2e-8: z₂ is at the upper bound of its box, where z₁ ≥ 5 puts it …
  Lcp box = Lcp::standard(DenseMatrix(Eigen::Matrix3d{{0, -2, 0}, {-1, 0, 0}, {1, 0, 0}}), Vector{-4, 3, -5});
  box.lo = Vector{-kInf, -2, 0}, box.hi = Vector{kInf, -2 + 1e-8, kInf};
  // … or row 2 alone says what it is: z₁ is tied to both by row 3.
  Lcp tied = Lcp::standard(DenseMatrix(Eigen::Matrix3d{{0, -2, 0}, {0, 1, 0}, {1, 1, 1}}), Vector{-4, 2 - 1e-8, 0});
  tied.lo = Vector{-kInf, -kInf, 0};
  for (const double far : {1e1, 1e5, 1e7, 1e9, 1e11})
    for (const Lcp& p : {box, tied}) {
      CAPTURE(far);
      CHECK(verdict(p, Vector{far, -2 + 1e-8, 0}) != Status::solved);
      CHECK(verdict(as_sparse(p), Vector{far, -2 + 1e-8, 0}) != Status::solved);
    }
}

TEST_CASE("z = 0 does not pass because the numbers are small") {
  CHECK(verdict(scalar(-1e-12, -1e-12), Vector{0}) == Status::stalled);
  CHECK(verdict(scalar(1e-300, -1e-300), Vector{0}) == Status::stalled);
  CHECK(verdict(scalar(1e-300, -1e-300), Vector{1}) == Status::solved);
}

TEST_CASE("a runaway z is rounded at most, coarsely, and never where a proof is found") {
  const Lcp p = pair({1, -1, -1, 1}, Vector{-1, -1});  // infeasible: the rows sum to −2
  Judge judge;
  Solution s;
  for (const double far : {1e10, 1e14, 1e17}) {
    s.z = Vector{far, far}, s.certificate = {};
    judge.certify(p, 1e-10, Claim::candidate, s);
    CHECK(s.status == (far < 1e15 ? Status::stalled : Status::rounded));
    CHECK(judge.coarse() == (far > 1e15));
    s.certificate = Vector{1, 1};
    judge.certify(p, 1e-10, Claim::candidate, s);
    CHECK(s.status == Status::infeasible);
  }
  // The double nearest to the only solution, three blocks whose masses grow by 1e7: w_1 misses by all of the data.
  const double a = 1e-7;
  const Eigen::Matrix3d A{{1, -1, 0}, {-1, 1 + a, -a}, {0, -a, a + a * a}};
  const Eigen::Vector3d b(-0.0766, 0, 0);
  const Eigen::Vector3d nearest = A.cast<long double>().fullPivLu().solve(-b.cast<long double>()).cast<double>();
  const Lcp tower = Lcp::standard(DenseMatrix(A), Vector(b));
  s.z = Vector(nearest), s.certificate = {};
  judge.certify(tower, 1e-10, Claim::candidate, s);
  CHECK(has_answer(s.status));
  for (const double unit : {1.0, 1e-150, 1e-300, 1e-310, 0x1p-1074}) {  // down to where ε s is no number any more
    const Lcp q = pair({unit, -unit, -unit, unit}, Vector{-unit, unit});
    INFO("unit ", unit);
    CHECK(has_answer(verdict(q, Vector{2, 1})));
    if (unit > 1e-290) CHECK(verdict(q, Vector{2, 1}) == Status::solved);
    CHECK(has_answer(verdict(q, Vector{1e12 + 1, 1e12})));                  // w = 0: as good a solution
    if (unit > 1e-320) CHECK(!has_answer(verdict(q, Vector{1e12, 1e12})));  // below it w = unit is a last digit
  }
}

TEST_CASE("a long chain whose rows are in no order is judged as quickly as any") {
  constexpr int n = 100000;
  std::vector<int> row(at(n));
  std::iota(row.begin(), row.end(), 0);
  Random random(7);
  for (int k = n - 1; k > 0; --k) std::swap(row[at(k)], row[at(random.integer(0, k))]);
  std::vector<Eigen::Triplet<double>> entries{{row[0], row[0], 1.0}};
  for (int k = 1; k < n; ++k) {
    entries.emplace_back(row[at(k)], row[at(k)], 1.0);
    entries.emplace_back(row[at(k)], row[at(k - 1)], -1.0);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  Vector b, z;
  b.resize(n), z.resize(n);
  b.setZero();
  b[row[0]] = -1;
  z.setConstant(1);
  z[row[n / 2]] += 1e-12;  // above rounding: the rows are looked at
  const Lcp p = Lcp::standard(RowSparse::from(A), b);
  const std::clock_t begin = std::clock();
  CHECK(verdict(p, z) == Status::solved);
  CHECK(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC < (kSanitized ? 20 : 2));
  z[row[n / 2]] += 1e-9;
  CHECK(verdict(p, z) != Status::solved);
}

TEST_CASE("a z or w that is not finite is never a solution") {
  CHECK(verdict(scalar(2, -1), Vector{kNaN}) == Status::numerical_error);
  CHECK(verdict(scalar(2, -1), Vector{kInf}) == Status::numerical_error);
  CHECK(verdict(scalar(kNaN, 1), Vector{0}) == Status::numerical_error);  // 0 · NaN
  CHECK(verdict(scalar(2, kNaN), Vector{0}) == Status::numerical_error);
  CHECK(verdict(scalar(2, -1), Vector()) == Status::numerical_error);  // a solver that left no z
}

TEST_CASE("bounds far from zero set the scale where b = 0") {
  CHECK(verdict(scalar(1, 0, 1, 2), Vector{1}) == Status::solved);
  CHECK(verdict(scalar(1, 0, 1, 2), Vector{1.5}) == Status::stalled);
  CHECK(verdict(scalar(-1, 0, -1e6, 1e6), Vector{1e6}) == Status::solved);
  CHECK(verdict(scalar(1, 0, -3, kInf), Vector{0}) == Status::solved);
}

TEST_CASE("friction rows are judged against the bounds of the given z") {
  Lcp p = pair({2, 0, 0, 1}, Vector{-2, -2});
  p.lo[1] = -kInf;
  p.friction = {{.normal = 0, .first = 1, .mu = 0.5}};
  CHECK(verdict(p, Vector{1, 0.5}) == Status::solved);
  CHECK(verdict(p, Vector{1, 2}) == Status::stalled);     // w_t = 0 but outside the cone
  CHECK(verdict(p, Vector{1, -0.5}) == Status::stalled);  // pushes with the motion
  p.b[0] = 1;                                             // open contact, wrong z_t
  CHECK(verdict(p, Vector{0, 0}) == Status::solved);
  CHECK(verdict(p, Vector{0, 0.1}) == Status::stalled);
}

TEST_CASE("solved is judged whatever the claim; other claims stand when z fails") {
  CHECK(verdict(scalar(2, -1), Vector{0.5}, Claim::iteration_limit) == Status::solved);
  CHECK(verdict(scalar(2, -1), Vector{0.4}, Claim::iteration_limit) == Status::iteration_limit);
  CHECK(verdict(scalar(2, -1), Vector{0.4}, Claim::ray) == Status::ray);
  CHECK(verdict(scalar(2, -1), Vector{0.4}, Claim::exhausted) == Status::ray);  // no cells, no proof
}

TEST_CASE("numbers of one part of a problem excuse nothing in another") {
  for (const double far : {1e9, 3e13, 1e20}) {  // a far bound, reached: beside it −1 + 2 z ≥ 0 is still not met by 0
    Lcp p = pair({-1, 0, 0, 2}, Vector{-1, -1});
    p.hi[0] = far;
    CHECK(verdict(p, Vector{far, 0}) != Status::solved);
    CHECK(verdict(p, Vector{far, 0.5}) == Status::solved);
  }
  const Eigen::Matrix3d A{{1, -1, 0}, {-1, 1, 0}, {0, 0, 1}};
  for (const double far : {1e3, 1e9, 1e12}) {  // rows 1 and 2 sum to −2, whatever row 3 is about
    const Lcp p = Lcp::standard(DenseMatrix(A), Vector{-1, -1, -far});
    for (const double z : {1e10, 1.1e15, 1e18}) CHECK(verdict(p, Vector{z, z, far}) != Status::solved);
    CHECK(verdict_on_proof(p, Vector{1, 1, 0}) == Status::infeasible);
  }
}

TEST_CASE("a row is judged in its own unit") {
  for (const double unit : {1.0, 0x1p-40, 0x1p-80}) {
    const Lcp p = pair({2, 1, unit, 2 * unit}, Vector{-1, -unit});
    CHECK(verdict(p, Vector{1 / 3.0, 1 / 3.0}) == Status::solved);
    CHECK(verdict(p, Vector{0.5, 0}) != Status::solved);
  }
}

TEST_CASE("a row is not solved that is off by less than any double, where the rule allows nothing") {
  Lcp p = pair({1, -5e-324, 0, 0}, Vector{0, 0});  // w_0 = z_0 + 2^-2148 at z_1 = -2^-1074, which is fixed
  p.lo = Vector{-kInf, -5e-324}, p.hi = Vector{kInf, -5e-324};
  CHECK(verdict(p, Vector{0, -5e-324}) == Status::rounded);
}

TEST_CASE("data that overflow are never solved") {
  CHECK(verdict(scalar(1e307, -1, 50), Vector{0}) != Status::solved);
  CHECK(verdict(scalar(1e308, -1, 100), Vector{100}) != Status::solved);
}

TEST_CASE("a Delassus operator is judged as its dense form is") {
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const Lcp p = random_contact_problem(3, 9, 0.4, random);
    Lcp dense = p;
    DenseMatrix A;
    to_dense(p.A, A);
    dense.A = A;
    Judge judge;
    Solution s, t;
    s.z.resize(6);
    for (double& value : s.z) value = std::abs(random.normal());
    t.z = s.z;
    judge.certify(p, 1e-10, Claim::candidate, s);
    judge.certify(dense, 1e-10, Claim::candidate, t);
    CHECK((s.w - t.w).lpNorm<Eigen::Infinity>() < 1e-13);
    CHECK(s.residual >= t.residual * (1 - 1e-9));  // its weights are bounds of the dense ones
    CHECK(s.rounding >= t.rounding / 2);
  }
}

TEST_CASE("check() names field, value and rule") {
  const auto why = [](const Lcp& p) -> std::string {
    try {
      check(p);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  Lcp p = pair({2, 0, 0, 1}, Vector{-2, -2});
  CHECK(why(p) == "");
  const auto broken = [&](auto&& change) {
    Lcp copy = p;
    change(copy);
    return why(copy);
  };
  CHECK(broken([](Lcp& q) { q.b = Vector{1}; }).find("b has 1 entries: must be 2") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.lo[1] = kNaN; }).find("row 1 has bounds [nan, inf]") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.lo[1] = 2, q.hi[1] = 1; }).find("lower <= upper") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.lo[1] = kInf; }).find("lower < inf") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.A = DenseMatrix(Eigen::MatrixXd(2, 3)); }).find("2 x 3: must be square") !=
        std::string::npos);
  CHECK(broken([](Lcp& q) { q.friction = {{0, 1, 1, 0.5}}; }).find("must be -inf and inf") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.lo[1] = -kInf, q.friction = {{0, 1, 1, -0.5}}; }).find("mu = -0.5") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.lo[1] = -kInf, q.friction = {{1, 1, 1, 0.5}}; }).find("normal = 1") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.lo[1] = -kInf, q.friction = {{2, 1, 1, 0.5}}; }).find("normal = 2") != std::string::npos);
  CHECK(broken([](Lcp& q) {
          q.lo[1] = -kInf, q.friction = {{0, 1, 1, 0.5}, {0, 1, 1, 0.5}};
        }).find("twice") != std::string::npos);
  CHECK(broken([](Lcp& q) {
          q.lo[0] = -kInf, q.lo[1] = -kInf, q.friction = {{0, 1, 1, 0.5}};
        }).find("lower bound -inf") != std::string::npos);
  Lcp sparse = as_sparse(p);
  std::get<RowSparse>(sparse.A).column[0] = 5;
  CHECK(why(sparse).find("column 5") != std::string::npos);
  CHECK_FALSE(finite(pair({2, 0, kInf, 1}, Vector{0, 0})));
  CHECK(finite(p));
}

TEST_CASE("no distance from a bound is excused, however large b is") {
  // A body slides at 1e10 times the speed with which its contact closes: z_t = −µ z_n, not 0.
  Lcp slides = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, 0.1}, {0.1, 1}}), Vector{-1e-9, 100});
  slides.lo[1] = -kInf;
  slides.friction = {{.normal = 0, .first = 1, .mu = 0.5}};
  const double normal = 1e-9 / 0.95;
  CHECK(verdict(slides, Vector{normal, -0.5 * normal}) == Status::solved);
  CHECK(verdict(slides, Vector{1e-9, 0}) == Status::stalled);
  CHECK(verdict(slides, Vector{normal, -0.5 * normal * (1 - 1e-15)}) == Status::stalled);

  Lcp box = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{3, 1}, {1, 2}}), Vector{0.5, 4.85e13});
  box.lo[1] = -1, box.hi[1] = 1;
  CHECK(verdict(box, Vector{1 / 6.0, -1}) == Status::solved);
  CHECK(verdict(box, Vector{0, 0}) == Status::stalled);
  CHECK(verdict(box, Vector{1 / 6.0, -1 + 1e-15}) == Status::stalled);
}

TEST_CASE("solved, rounded, stalled: each clause at its limit, from both sides") {
  // w = 2 z − 1: v = 2 δ at z = 0.5 + δ; s = 2, β = 1.
  CHECK(verdict(scalar(2, -1), Vector{0.5 + 4.9e-11}) == Status::solved);
  CHECK(verdict(scalar(2, -1), Vector{0.5 + 5.1e-11}) == Status::stalled);
  CHECK(verdict(scalar(2, -1), Vector{0.5 + 5.1e-7}, Claim::candidate, 1e-6) == Status::stalled);
  CHECK(verdict(scalar(2, -1), Vector{0.5 + 4.9e-7}, Claim::candidate, 1e-6) == Status::solved);
  // z = (1e9, 1e9): s = 2e9 in both rows; 20 ε s = 8.9e-6, β = 1.
  const auto near = [](double off) { return pair({1, -1, -1, 1}, Vector{-off, off}); };
  CHECK(verdict(near(8e-6), Vector{1e9, 1e9}) == Status::rounded);
  CHECK(verdict(near(9e-6), Vector{1e9, 1e9}) == Status::stalled);
  // Row 0 has 1 of row 1's data, by way of z_1: limits of 1e-10 and, s = 2e9 + v, of 8.9e-6.
  const auto beside = [](double v) {
    return Lcp::standard(DenseMatrix(Eigen::Matrix3d{{1, -1, 0}, {-1, 1, 1}, {0, 1e-9, 0}}), Vector{v, -1, -1});
  };
  CHECK(verdict(beside(9.9e-11), Vector{1e9, 1e9, 1}) == Status::solved);  // less than a rounding of the sum
  CHECK(verdict(beside(1.1e-10), Vector{1e9, 1e9, 1}) == Status::rounded);
  CHECK(verdict(beside(8.8e-6), Vector{1e9, 1e9, 1}) == Status::rounded);
  CHECK(verdict(beside(9e-6), Vector{1e9, 1e9, 1}) == Status::stalled);
}

TEST_CASE("rounded is coarse above 1e-4 of the part's data, also among the smallest and the largest numbers") {
  Judge judge;
  const auto status = [&](double a, double b, double z0, double z1) {
    const Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{a, -a}, {-a, a}}), Vector{b, -b});
    Solution s;
    s.z = Vector{z0, z1};
    judge.certify(p, 1e-10, Claim::candidate, s);
    return s.status;
  };
  CHECK(status(1, -0.7, 0x1p50 + 1, 0x1p50) == Status::rounded);  // w = ±0.3: 20 ε s = 10, but β_P = 0.7
  CHECK(judge.coarse());
  CHECK(status(1, -0.7, 0x1p36 + 0.7, 0x1p36) == Status::rounded);  // w = 2e-6
  CHECK(!judge.coarse());
  CHECK(status(1e-200, -7e-201, 0x1p50 + 1, 0x1p50) == Status::rounded);  // the same in other units
  CHECK(judge.coarse());
  CHECK(status(1, -0.7, 0.7, 0) == Status::solved);
  CHECK(!judge.coarse());
  // s = 3e308 is no double; the violation 1e299 is far above 20 ε s = 1e294, though not above 1e-4 β_P = 1e300.
  CHECK(status(1e308, -1e304, 1.5, 1.5 - 1e-4 * (1 - 1e-5)) == Status::stalled);
}
