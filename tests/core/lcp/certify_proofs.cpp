// Proofs of infeasibility: their conditions, their rounding, and the words where a claim does not hold.
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/collection.h>

#include <doctest/doctest.h>
#include <Eigen/LU>

#include "tests/core/lcp/judged.h"
#include "tests/support/judge.h"
#include "tests/support/sanitized.h"

using namespace orthant;

TEST_CASE("proofs of infeasibility: right ones hold, wrong ones do not") {
  const Lcp p = pair({1, -1, -1, 1}, Vector{-1, -1});
  CHECK(verdict_on_proof(p, Vector{1, 1}) == Status::infeasible);
  CHECK(verdict_on_proof(as_sparse(p), Vector{1, 1}) == Status::infeasible);
  CHECK(verdict_on_proof(p, Vector{1, 0.9}) == Status::ray);  // Aᵀu has a positive entry
  CHECK(verdict_on_proof(p, Vector{-1, -1}) == Status::ray);  // u ≥ 0 is demanded
  CHECK(verdict_on_proof(p, Vector{0, 0}) == Status::ray);
  CHECK(verdict_on_proof(p, Vector{kNaN, 1}) == Status::ray);
  CHECK(verdict_on_proof(p, Vector{1}) == Status::ray);                                       // wrong size
  CHECK(verdict_on_proof(pair({1, -1, -1, 1}, Vector{1, -1}), Vector{1, 1}) == Status::ray);  // solvable: bᵀu = 0
  CHECK(verdict_on_proof(scalar(-1, -1), Vector{1}) == Status::infeasible);
  CHECK(verdict_on_proof(scalar(-1e-12, -1e-12), Vector{1}) == Status::infeasible);
  CHECK(verdict_on_proof(scalar(1e-30, -1), Vector{1}) == Status::ray);                       // z = 1e30 solves
  CHECK(verdict_on_proof(pair({0, 1, 1, -1}, Vector{-1, -2}), Vector{0, 1}) == Status::ray);  // solvable by (3, 1)
  // Sums without any rounding leave no slack that a z could use, however large data beside them let it be.
  Lcp beside =
      Lcp::standard(DenseMatrix(Eigen::Matrix3d{{0.1, -0.7, 0}, {-0.1, 0.7, 0}, {-1e-7, 0, 1}}), Vector{1, -2, 1e9});
  CHECK(verdict_on_proof(beside, Vector{1, 1, 0}) == Status::infeasible);
  CHECK(verdict_on_proof(as_sparse(beside), Vector{1, 1, 0}) == Status::infeasible);
  // The slack of u'A may be used, but by how much is lost where bounds times entries are less than any number: z = 0
  // solves.
  Lcp lost = pair({0x1.5555555555556p-662, 0, 0x1p-660, 0}, Vector{0, 0});
  lost.lo = Vector{-kInf, 0}, lost.hi = Vector{1e-172, kInf};
  CHECK(!Judge().proves_infeasible(lost, Vector{-3, 1}));
  lost.hi[0] = 1e-72;
  CHECK(!Judge().proves_infeasible(lost, Vector{-3, 1}));
  std::get<DenseMatrix>(beside.A)(1, 1) += 1e-16;  // now z = (7e16, 1e16, …) has w ≥ 0
  CHECK(verdict_on_proof(beside, Vector{1, 1, 0}) == Status::ray);
}

TEST_CASE("a z excused by rounding alone is not a solution where a proof of infeasibility exists") {
  // The second row is three times the first, but for b; a bound of 1e5 makes a miss of 13 small beside the data.
  Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix3d{{4, -1, -3}, {12, -3, -9}, {-2, 13, -1}}), Vector{-2, 4, 2});
  p.lo = Vector{-kInf, -kInf, 0}, p.hi = Vector{kInf, kInf, 1e5};
  Judge judge;
  Solution s;
  s.z = Vector{-55996559999999.99, -223986240000000, 1e5};
  s.certificate = Vector{3, -1, 0};
  judge.certify(p, 1e-12, Claim::ray, s);
  CHECK(s.status == Status::infeasible);
}

TEST_CASE("proofs with free rows, boxes and friction") {
  CHECK(verdict_on_proof(scalar(0, 1, -kInf, kInf), Vector{-1}) == Status::infeasible);  // 0 z + 1 = 0
  CHECK(verdict_on_proof(scalar(1e-9, 1, -kInf, kInf), Vector{-1}) == Status::ray);
  CHECK(verdict_on_proof(scalar(0, 1, -kInf, 3), Vector{-1}) == Status::infeasible);  // w ≤ 0 demanded
  CHECK(verdict_on_proof(scalar(0, 1, -kInf, 3), Vector{1}) == Status::ray);
  CHECK(verdict_on_proof(scalar(-1, -1, 0, 2), Vector{1}) == Status::ray);           // a box row takes either sign of w
  CHECK(verdict_on_proof(scalar(-1, 2, 3, kInf), Vector{1}) == Status::infeasible);  // −z + 2 ≥ 0, z ≥ 3
  CHECK(verdict_on_proof(scalar(-1, 4, 3, kInf), Vector{1}) == Status::ray);

  Lcp box = pair({0, 1, 0, 1}, Vector{-3, 0});  // w₁ = z₂ − 3 ≥ 0 with z₂ ≤ 2
  box.hi[1] = 2;
  CHECK(verdict_on_proof(box, Vector{1, 0}) == Status::infeasible);
  box.hi[1] = 3;
  CHECK(verdict_on_proof(box, Vector{1, 0}) == Status::ray);

  Lcp contact = pair({-1, 1, 1, 1}, Vector{-1, 0});  // w_N = −z_N + z_T − 1 ≥ 0 needs z_T > z_N
  contact.lo[1] = -kInf;
  contact.friction = {{.normal = 0, .first = 1, .mu = 0.9}};
  CHECK(verdict_on_proof(contact, Vector{1, 0}) == Status::infeasible);
  contact.friction[0].mu = 1.1;
  CHECK(verdict_on_proof(contact, Vector{1, 0}) == Status::ray);
  contact.friction[0].mu = 0.9;
  // u = 0 on friction rows, whose w has either sign: (1, ½) slides and solves this, w_T < 0, whatever (0, 1) "proves".
  Lcp slides = pair({1, 0, -1, 1}, Vector{-1, -5});
  slides.lo[1] = -kInf;
  slides.friction = {{.normal = 0, .first = 1, .mu = 0.5}};
  CHECK(verdict(slides, Vector{1, 0.5}) == Status::solved);
  CHECK(verdict_on_proof(slides, Vector{0, 1}) == Status::ray);

  // u = (1, 0, 1): the friction column cancels, 1 − 1, which rounding could have moved: slack relative to its own
  // terms.
  const Eigen::Matrix3d A{{0, 1, -1}, {0, 0, 0}, {0, -1, -1}};
  Lcp cancels = Lcp::standard(DenseMatrix(A), Vector{-1, 0, 0});
  cancels.lo[1] = -kInf;
  cancels.friction = {{.normal = 0, .first = 1, .mu = 1}};
  CHECK(verdict_on_proof(cancels, Vector{1, 0, 1}) == Status::infeasible);
  CHECK(verdict_on_proof(cancels, Vector{1, 0, 0.5}) == Status::ray);
}

TEST_CASE("a proof cannot stand beside a solution: random u on solvable problems") {
  Random random(5);
  Judge judge;
  for (int trial = 0; trial < 2000; ++trial) {
    const Known k = planted_problem(4, 2, 3, random);
    Vector u;
    u.resize(4);
    for (double& value : u) value = random.integer(0, 2);
    CHECK_FALSE(judge.proves_infeasible(k.problem, u));
  }
}

TEST_CASE("contacts of a heavy body: its impulse of 1e15 exists, so nothing proves that there is none") {
  // z_0 − z_1 = −1000 and 1e-12 (z_0 + z_1) = 1000 stop both bodies, w = 0; u = (1, 1, 0) adds the two contacts'
  // velocities, in which the light body cancels and the heavy one is at the last digits.
  const Eigen::MatrixXd W{{1, 1e-3}, {-1, 1e-3}, {1, 0}};
  const Eigen::VectorXd v{{1000, -1000}};
  const Delassus A{RowSparse::from(W.sparseView()), Vector{1, 1e-9}, {}};
  const Lcp contacts = Lcp::standard(A, Vector(W * v));
  CHECK_FALSE(Judge{}.proves_infeasible(contacts, Vector{1, 1, 0}));
  CHECK_FALSE(Judge{}.proves_infeasible(Lcp::standard(A, Vector{-1e3, -1e3, 1e3}), Vector{1, 1, 0}));
  const auto beside_others = [&W](const Vector& b) {
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(13, 12);
    wide.topLeftCorner(3, 2) = W, wide.bottomRightCorner(10, 10).setIdentity();
    Vector inverse_mass = Vector::Ones(12), q = Vector::Zero(13);
    inverse_mass[1] = 1e-9, q.head(3) = b;
    return Lcp::standard(Delassus{RowSparse::from(wide.sparseView()), inverse_mass, {}}, q);
  };
  Vector u = Vector::Zero(13);
  u[0] = u[1] = 1;
  CHECK_FALSE(Judge{}.proves_infeasible(beside_others(Vector(W * v)), u));
  CHECK_FALSE(Judge{}.proves_infeasible(beside_others(Vector{-1e3, -1e3, 1e3}), u));
  Vector still = u;  // with walls for both that stand, no rounding is left
  Eigen::MatrixXd walls = Eigen::MatrixXd::Zero(13, 12);
  walls(0, 0) = 1, walls(1, 0) = -1;
  walls.bottomRightCorner(11, 11).setIdentity();
  Vector q = Vector::Zero(13);
  q[0] = q[1] = -1;
  CHECK(Judge{}.proves_infeasible(Lcp::standard(Delassus{RowSparse::from(walls.sparseView()), Vector::Ones(12), {}}, q),
                                  still));
}

TEST_CASE("a proof is exact: 2^52 (1, 1) solves what (1, 1) speaks against but for a last digit") {
  const double e = 0x1p-52;
  const Lcp p = pair({1, -1, -1, 1 + e}, Vector{0, -1});
  CHECK(verdict(p, Vector{0x1p52, 0x1p52}) == Status::solved);  // w = 0: long double has no digits for it
  CHECK(verdict_on_proof(p, Vector{1, 1}) == Status::ray);
  CHECK(verdict_on_proof(as_sparse(p), Vector{1, 1}) == Status::ray);
  CHECK(verdict_on_proof(pair({1, -1, -1, 1}, Vector{0, -1}), Vector{1, 1}) == Status::infeasible);
  // Sums that long double does not hold decide, too.
  CHECK(verdict_on_proof(pair({1 + e, 0, -1 - e, -1e-60}, Vector{0, -1}), Vector{1 + e, 1 + e}) == Status::infeasible);
  CHECK(verdict_on_proof(pair({1 + e, 0, -1 - e, 1e-60}, Vector{0, -1}), Vector{1 + e, 1 + e}) == Status::ray);
  Lcp contact = pair({-1, 1, 0, 1}, Vector{-1, 0});  // w_N = −z_N + z_T − 1, |z_T| ≤ μ z_N
  contact.lo[1] = -kInf;
  for (const double mu : {1.0, 1 + e}) {
    contact.friction = {{.normal = 0, .first = 1, .mu = mu}};
    CHECK(verdict_on_proof(contact, Vector{1, 0}) == (mu > 1 ? Status::ray : Status::infeasible));
  }
}

TEST_CASE("a proof is exact where its terms underflow or overflow") {
  // w_1 = 2^-1074 z_0 - 1 has its sign at z_0 = 2^1074, where w_0 = w_2 = 0 for z_1 - z_2 = 1.
  constexpr double least = 0x1p-1074;
  const Lcp tiny =
      Lcp::standard(DenseMatrix(Eigen::MatrixXd{{least, -1, 1}, {least, 0, 0}, {-least, 1, -1}}), Vector{0, -1, 0});
  CHECK_FALSE(Judge().proves_infeasible(tiny, Vector{0x1p-2, 0x1p-90, 0x1p-2}));

  // (1, 1) proves it; of the column sums' terms, 2^-30 is near to 0 in any unit.
  for (const double unit : {1.0, std::numeric_limits<double>::max()}) {
    const Lcp p = Lcp::standard(DenseMatrix(Eigen::MatrixXd{{unit, -unit}, {-unit, unit}}), Vector{-1, 0});
    CHECK(Judge().proves_infeasible(p, Vector{1, 1 + 1e-9}));
    CHECK_FALSE(Judge().proves_infeasible(p, Vector{1, 1 + 3e-9}));
  }
}

TEST_CASE("a proof is exact of many rows too: two rows with a solution near 2^51, beside others") {
  const double e = 0x1p-52;
  const auto beside = [](const Lcp& few, Index n) {
    DenseMatrix A(Eigen::MatrixXd::Identity(n, n));
    A.topLeftCorner(2, 2) = std::get<DenseMatrix>(few.A);
    Vector b = Vector::Ones(n);
    b.head(2) = few.b;
    return Lcp::standard(A, b);
  };
  for (const Index n : {2, 13, 200}) {
    CAPTURE(n);
    Vector u = Vector::Zero(n), z = u;
    u[0] = u[1] = 1;
    z[0] = 1 + 0x1p51, z[1] = 0x1p51;
    const Lcp p = beside(pair({1, -1, -1, 1 + e}, Vector{-1, 0.5}), n);
    for (const Lcp& q : {p, as_sparse(p)}) {
      CHECK(verdict(q, z) == Status::solved);
      CHECK(verdict_on_proof(q, u) == Status::ray);
    }
    CHECK(verdict_on_proof(beside(pair({1, -1, -1, 1}, Vector{-1, 0.5}), n), u) == Status::infeasible);
  }
}

TEST_CASE(
    "a proof that no doubles hold is the exact vector next to the certificate, or its multiple in whole numbers") {
  // The kernel of the first two columns is spanned by a vector of large fractions near (0.55, 0.02, 0.23).
  const Eigen::Matrix3d A{{0.1, 0.3, -1}, {0.7, -0.2, -1}, {-0.3, -0.7, -1}};
  const Lcp p = Lcp::standard(DenseMatrix(A), Vector{-1, 1, 1});
  Judge judge;
  for (const double off : {0.0, 1e-16, -3e-16}) {
    CAPTURE(off);
    CHECK(judge.proves_infeasible(p, Vector{0.55 + off, 0.02, 0.23}));
    CHECK((judge.proof() - Vector{0.55, 0.02, 0.23} * (judge.proof()[0] / 0.55)).norm() < 1e-12 * judge.proof()[0]);
    CHECK(judge.proves_infeasible(p, Vector(judge.proof())));
    CHECK((off != 0 || !judge.proof_in_doubles()));  // rounding may fall to the right side
  }
  CHECK(!judge.proves_infeasible(p, Vector{0.55, 0.02 + 1e-7, 0.23}));  // another vector
  CHECK(!judge.proves_infeasible(Lcp::standard(DenseMatrix(A), Vector{-0.23, 0, 0.55}), Vector{0.55, 0.02, 0.23}));
  // One more digit in A, and the three columns have no kernel.
  Lcp open = Lcp::standard(DenseMatrix(Eigen::Matrix3d{{0.1, 0.3, 0}, {0.7, -0.2, 0}, {-0.3, -0.7, 0x1p-60}}),
                           Vector{-1, 1, 1});
  CHECK(!judge.proves_infeasible(open, Vector{0.55, 0.02, 0.23}));
  std::get<DenseMatrix>(open.A)(2, 2) = -0x1p-60;
  CHECK(judge.proves_infeasible(open, Vector{0.55, 0.02, 0.23}));
  // Four walls around a body with three velocities: the velocities, not their products, are what must vanish.
  const Eigen::MatrixXd W{{0.1, 0.3, 0.7}, {0.7, -0.2, -0.1}, {-0.3, -0.7, 0.2}, {-0.5, 0.6, -0.8}};
  const Eigen::Vector4d kernel = W.transpose().fullPivLu().kernel().col(0);
  REQUIRE((kernel.array() > 0).all() != (kernel.array() < 0).all());
  const Vector u(kernel.cwiseAbs());
  const auto squeezed = [&](double free) {
    return Lcp::standard(Delassus{RowSparse::from(W.sparseView()), Vector{1, 1e-3, 7}, Vector{0, 0, 0, free}},
                         Vector{-1, -1, -1, -1});
  };
  CHECK(judge.proves_infeasible(squeezed(0), u));
  CHECK(!judge.proves_infeasible(squeezed(1e-18), u));
  // Whole numbers are found.
  CHECK(judge.proves_infeasible(pair({3, -3, -1, 1}, Vector{-1, -1}), Vector{1.0 / 3, 1}));
  CHECK(judge.proof() == Vector{1, 3});
  CHECK(judge.proof_in_doubles());
  // So are those of more digits than 53 where their last ones are zeros.
  const double far = 0x1p90;
  CHECK(judge.proves_infeasible(pair({3, -3, -1 / far, 1 / far}, Vector{-1, -1}), Vector{1 / 3.0 / far, 1}));
  CHECK(judge.proof()[1] == 3 * far * judge.proof()[0]);
  CHECK(judge.proof_in_doubles());
  // Friction at its bound: g_n + μ |g_t| = 0 for the exact u only.
  Lcp contact =
      Lcp::standard(DenseMatrix(Eigen::Matrix3d{{-0.1, 0.3, 0}, {0.1, 0, 0}, {0.3, 0.7, 0}}), Vector{-1, 0, 0});
  contact.lo[1] = -kInf;
  contact.friction = {{.normal = 0, .first = 1, .mu = 0.3}};
  const double share = (0.1 - 0.3 * 0.3) / (0.3 + 0.3 * 0.7);  // of row 2
  CHECK(judge.proves_infeasible(contact, Vector{1, 0, share}));
  CHECK(!judge.proves_infeasible(contact, Vector{1, 0, share * (1 + 1e-6)}));
}

TEST_CASE("certify: where the rounding of its own sums stands in the way, they are done with more digits") {
  // Row 0 in double: ten terms of less than half an ulp of 2^27 are lost one after the other, in long double none is.
  const Index n = 13;
  const double big = 0x1p27, small = 0x1.f8p-27, rest = 0x1p-10;
  DenseMatrix A = DenseMatrix::Zero(n, n);
  A(0, 0) = big, A(0, n - 2) = -big, A(0, n - 1) = rest;
  for (Index j = 1; j < n - 2; ++j) A(0, j) = small;
  Vector b = Vector::Zero(n);
  b[0] = -(rest + 10 * small);
  Lcp problem = Lcp::standard(A, b);
  Solution s;
  s.z = Vector::Ones(n);
  Judge judge;
  judge.certify(problem, 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::solved);
  CHECK(s.residual == 0);
  problem.b[0] += 10 * small;  // now it is off by that much
  judge.certify(problem, 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::rounded);
  // Terms of 2e12, the sum 1e-16: below a last digit of long double's.
  const double a = 1 + 1e-12, z = 2 / (a - 1);
  CHECK(verdict(pair({1, -1, -1, a}, Vector{-1, -1}), Vector{z + 1, z}) == Status::solved);
}

TEST_CASE("certify: an operator's numbers are those of its factors: where these cancel rationals decide") {
  const double big = 0x1p50;
  Eigen::MatrixXd W(2, 3);
  W << big, 1, big, 1, 1, -1;
  const Delassus A{RowSparse::from(W.sparseView()), Vector{1, 1, 1}, {}};
  const Lcp problem = Lcp::standard(A, Vector{-1.0625, -3});
  CHECK(verdict(problem, Vector{0, 1}) == Status::rounded);                 // w_0 = -1/16: 2^51 in its terms
  CHECK(verdict(problem, Vector{0.0625 * 0x1p-101, 1}) == Status::solved);  // w_0 = 2^-105
  CHECK(verdict(problem, Vector{0.0625 * 0x1p-101 * (1 + 1e-8), 1}) == Status::rounded);  // w_0 = 6e-10
}

TEST_CASE("certify: an overflow in its own measures excuses nothing") {
  for (const double least : {1e-280, 1e-300, 1e-307}) {
    CAPTURE(least);
    const Lcp problem =
        Lcp::standard(DenseMatrix(Eigen::Matrix3d{{1, 0, 0}, {0, least, least}, {1e20, 0, 1}}), Vector{-1, 0, -1e16});
    CHECK(verdict(problem, Vector{0, 0, 1e16}) != Status::solved);  // w_0 = -1
    CHECK(verdict(problem, Vector{1, 0, 0}) == Status::solved);
  }
}

TEST_CASE("a z that is not accepted is explained: the row, by how much it misses, against which bound") {
  Judge judge;
  Solution s;
  s.z = Vector{0.5, 0.25};
  judge.certify(pair({2, 0, 0, 2}, Vector{-1, -1}), 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::stalled);
  CHECK(why(s) == "row 1 misses by 0.5 inside its bounds; 1e-10 of its data is 1e-10");
  s.z = Vector{0.5, 0};
  judge.certify(pair({2, 0, 0, 2}, Vector{-1, -3}), 1e-10, Claim::candidate, s);
  CHECK(why(s) == "row 1 misses by 3 at its lower bound; 1e-10 of its data is 3e-10");
  s.z = Vector{0.5, -1};
  judge.certify(pair({2, 0, 0, 2}, Vector{-1, -3}), 1e-10, Claim::candidate, s);
  CHECK(why(s) == "row 1 is outside its bounds");
  s.z = Vector{0.5, 1.5};
  judge.certify(pair({2, 0, 0, 2}, Vector{-1, -3}), 1e-10, Claim::candidate, s);
  CHECK(why(s).empty());
  s.z = Vector{0, 1e288};
  judge.certify(pair({1, 1e300, 0, 1e-288}, Vector{0, -1}), 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::numerical_error);
  CHECK(why(s) == "row 0 is not finite");
  s.z = Vector{0, 1e300};
  Lcp large = pair({1, 0, 0, 1e300}, Vector{-1, 0});
  large.lo[1] = large.hi[1] = 1e300;
  judge.certify(large, 1e-10, Claim::candidate, s);
  CHECK(why(s) == "row 1 is not finite");
  // By a row's own terms, however large another part's data.
  const Lcp apart = Lcp::standard(DenseMatrix(Eigen::Matrix3d::Identity()), Vector{-1, -1e-3, -1e12});
  s.z = Vector{1, 0.5e-3, 1e12};
  judge.certify(apart, 1e-10, Claim::candidate, s);
  judge.explain(apart, 1e-10, s);
  CHECK(s.status == Status::stalled);
  CHECK(why(s) == "row 1 misses by 0.0005 inside its bounds; 1e-10 of its data is 1e-13");
}

TEST_CASE("a judge takes another judge's proof without a check, of the same problem and u only") {
  Lcp p = pair({1, -1, -1, 1}, Vector{-1, -1});
  const Lcp other = pair({1, -1, -1, 1.5}, Vector{-1, -1});
  Judge first;
  REQUIRE(first.proves_infeasible(p, Vector{1, 1}));
  const auto after_trust = [&](const Lcp& problem, const Vector& u, bool forget = false) {
    Judge second;
    second.trust(first);
    if (forget) second.forget();
    Solution s;
    s.z = Vector{0, 0}, s.certificate = u;
    second.certify(problem, 1e-10, Claim::stalled, s);
    return s.status;
  };
  CHECK(after_trust(p, Vector{1, 1}) == Status::infeasible);
  CHECK(after_trust(p, Vector{1, 0.9}) == Status::stalled);
  CHECK(after_trust(p, Vector{1}) == Status::stalled);
  CHECK(after_trust(other, Vector{1, 1}) == Status::stalled);
  CHECK(!first.proves_infeasible(p, Vector{1, 0.9}));  // and only of the last proof
  std::get<DenseMatrix>(p.A)(1, 1) = 1.5;
  CHECK(after_trust(p, Vector{1, 1}) == Status::stalled);
  std::get<DenseMatrix>(p.A)(1, 1) = 1;
  REQUIRE(first.proves_infeasible(p, Vector{1, 1}));
  std::get<DenseMatrix>(p.A)(1, 1) = 1.5;  // changed behind the judge's back: forget() is the caller's duty
  CHECK(after_trust(p, Vector{1, 1}, true) == Status::stalled);
}

TEST_CASE("only a proof stays in the certificate, and a claimed ray becomes one where it proves") {
  Judge judge;
  Solution s;
  s.z = Vector{0, 0}, s.certificate = Vector{1, 0.9};
  judge.certify(pair({1, -1, -1, 1}, Vector{-1, -1}), 1e-10, Claim::ray, s);
  CHECK(s.status == Status::ray);
  CHECK(s.certificate.size() == 0);
  s.ray = Vector{1, 1};
  judge.certify(pair({1, -1, -1, 1}, Vector{-1, -1}), 1e-10, Claim::ray, s);
  CHECK(s.status == Status::infeasible);
  CHECK(s.certificate.size() == 2);
  const Vector near_none{-1, 1 - 5e-11};  // (1, 1) proves by 5e-11 what the tolerance allows
  s.z = Vector{1, 0}, s.certificate = Vector{1, 1};
  judge.certify(pair({1, -1, -1, 1}, near_none), 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::solved);
  CHECK(s.certificate.size() == 0);
}
