// Coulomb's cone: projections against brute force, derivatives against differences, the law against its cases; verdicts
// that no unit changes.
#include <orthant/core/lcp/cones/contact.h>
#include <orthant/core/lcp/cones/disc.h>
#include <orthant/core/lcp/cones/interval.h>
#include <orthant/core/lcp/files/io.h>
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/lcp/problems/disc_contacts.h>

#include "tests/support/judge.h"

#include <doctest/doctest.h>
#include <Eigen/Dense>

using namespace orthant;

namespace {

/// One contact: rows of these discs and intervals behind one normal row [lo, hi].
Lcp one_contact(const std::vector<std::pair<int, double>>& parts, double lo = 0, double hi = kInf) {
  Index n = 1;
  Lcp p;
  for (const auto& [rows, mu] : parts)
    p.friction.push_back({.normal = 0, .first = n, .rows = rows, .mu = mu}), n += rows;
  p.A = DenseMatrix(Eigen::MatrixXd::Identity(n, n)), p.b = Eigen::VectorXd::Zero(n);
  p.lo = Eigen::VectorXd::Constant(n, -kInf), p.hi = Eigen::VectorXd::Constant(n, kInf);
  p.lo[0] = lo, p.hi[0] = hi;
  return p;
}

Eigen::VectorXd normal_numbers(Index n, Random& random) {
  Eigen::VectorXd x(n);
  for (double& value : x) value = random.normal();
  return x;
}

/// A point of the cone.
Eigen::VectorXd inside(const cones::Blocks& blocks, Random& random) {
  const cones::Block& b = blocks[0];
  Eigen::VectorXd z = normal_numbers(b.rows, random);
  z[0] = std::min(b.hi, b.lo + 3 * random.uniform());
  for (const cones::Part& part : blocks.parts(b)) {
    auto t = z.segment(part.place, part.rows);
    t *= random.uniform() * part.mu * z[0] / t.norm();
  }
  return z;
}

const std::vector<std::vector<std::pair<int, double>>> kShapes{
    {}, {{1, 0.5}}, {{2, 0.7}}, {{2, 0.3}, {2, 0.05}}, {{2, 1.5}, {2, 0.2}, {1, 0.4}}, {{2, 0.0}}};

}  // namespace

TEST_CASE("cones: the projection is the nearest point, of discs and of several frictions of one normal") {
  Random random(1);
  for (const auto& shape : kShapes)
    for (const auto& [lo, hi] : {std::pair{0.0, kInf}, std::pair{0.5, 2.0}})
      for (int trial = 0; trial < 50; ++trial) {
        cones::Blocks blocks;
        blocks.load(one_contact(shape, lo, hi));
        const auto& b = blocks[0];
        const Eigen::VectorXd x = 2 * normal_numbers(b.rows, random);
        Eigen::VectorXd z(b.rows), again(b.rows);
        blocks.project(b, x.data(), z.data());
        blocks.project(b, z.data(), again.data());
        CHECK((again - z).norm() <= 1e-15 * (1 + z.norm()));
        CHECK(z[0] >= lo);
        CHECK(z[0] <= hi);
        for (const auto& part : blocks.parts(b))
          CHECK(z.segment(part.place, part.rows).norm() <= part.mu * z[0] * (1 + 1e-15));
        for (int other = 0; other < 50; ++other)  // (x − z)ᵀ(y − z) ≤ 0 for all y of the cone
          CHECK((x - z).dot(inside(blocks, random) - z) <= 1e-12);
      }
}

TEST_CASE("cones: the derivative of the projection is that of differences") {
  Random random(2);
  for (const auto& shape : kShapes)
    for (int trial = 0; trial < 40; ++trial) {
      cones::Blocks blocks;
      blocks.load(one_contact(shape));
      const auto& b = blocks[0];
      const Eigen::VectorXd x = 2 * normal_numbers(b.rows, random), dx = normal_numbers(b.rows, random);
      Eigen::VectorXd z(b.rows), more(b.rows), less(b.rows);
      Eigen::MatrixXd D(b.rows, b.rows);
      blocks.project(b, x.data(), z.data(), D.data());
      constexpr double kStep = 1e-6;
      const Eigen::VectorXd plus = x + kStep * dx, minus = x - kStep * dx;
      blocks.project(b, plus.data(), more.data());
      blocks.project(b, minus.data(), less.data());
      CHECK((D * dx - (more - less) / (2 * kStep)).norm() <= 1e-5 * dx.norm());
    }
}

TEST_CASE("cones: interval and disc, in numbers") {
  CHECK(interval::project(0.5, 2) == 0.5);
  CHECK(interval::residual(0.5, 0.5, -3) == 0);  // against its slip, at the bound
  CHECK(interval::residual(0.5, 0.5, 3) == 1);
  CHECK(interval::support(0.5, -4) == 2);
  CHECK((disc::project(5, {6, 8}) - Eigen::Vector2d(3, 4)).norm() < 1e-15);
  CHECK(disc::residual(5, {3, 4}, {-6, -8}) < 1e-15);
  CHECK(disc::residual(5, {3, 4}, {0, 0}) == 0);
  CHECK(disc::residual(5, {3, 4}, {6, 8}) == doctest::Approx(10));
  CHECK(disc::support(2, {3, 4}) == 10);
}

TEST_CASE("cones: a planted z is solved, and one next to it is not, in whatever units") {
  Random random(3);
  Judge judge;
  for (int trial = 0; trial < 60; ++trial) {
    const DiscContacts kind{.contacts = 6,
                            .freedoms = trial % 3 == 0 ? 9 : 30,
                            .rolling = trial % 4 == 1,
                            .unsymmetric = trial % 5 == 2,
                            .spread = trial % 2 == 0 ? 1 : 1e8};
    Known known = disc_contacts(kind, random);
    const double z_unit = std::exp2(random.integer(-30, 30)), w_unit = std::exp2(random.integer(-30, 30));
    Lcp& p = known.problem;
    std::get<DenseMatrix>(p.A) *= w_unit / z_unit;
    p.b *= w_unit, known.z *= z_unit;
    Solution s;
    s.z = known.z;
    judge.certify(p, 1e-10, Claim::candidate, s);
    CHECK(s.status == Status::solved);
    CHECK(cone_residuals(p, s.z).scale_free <= 1e-12);
    CHECK(independent_scale_free(p, s.z) <= 1e-12);
    Index largest = 0;  // of the contacts
    known.z.cwiseAbs().maxCoeff(&largest);
    if (!(known.z[largest] != 0)) continue;
    s.z[largest] *= 1 + 1e-6;
    judge.certify(p, 1e-10, Claim::candidate, s);
    CHECK(s.status == Status::stalled);
    CHECK(cone_residuals(p, s.z).scale_free == doctest::Approx(independent_scale_free(p, s.z)).epsilon(1e-6).scale(0));
  }
}

TEST_CASE("cones: units of one contact or one body, and the tangent plane turned, change no verdict and no residual") {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Known known = disc_contacts({.contacts = 4, .rolling = trial % 2 == 1}, random);
    const Lcp& p = known.problem;
    const Index n = p.size(), d = trial % 2 == 1 ? 5 : 3;
    Vector z = known.z;
    for (double& value : z) value *= 1 + 1e-5 * random.normal();
    const double residual = cone_residuals(p, z).scale_free;
    Lcp q = p;
    Eigen::MatrixXd T = Eigen::MatrixXd::Identity(n, n);  // w_q = T w, z_q = T⁻ᵀ z
    for (Index k = 0; k < n; k += d) {
      const double unit = std::exp2(random.integer(-20, 20)), angle = random.uniform(0, 7);
      T.block(k + 1, k + 1, 2, 2) = Eigen::Rotation2Dd(angle).toRotationMatrix();
      T.middleRows(k, d) *= unit;
    }
    q.A = DenseMatrix(T * std::get<DenseMatrix>(p.A) * T.transpose());
    q.b = T * p.b;
    const Vector z_q = Eigen::VectorXd(T.transpose().inverse() * z);
    CHECK(cone_residuals(q, z_q).scale_free == doctest::Approx(residual).epsilon(1e-6).scale(0));
  }
}

TEST_CASE("cones: a small residual of a large contact excuses no other contact") {
  // Two bodies that never meet, one 1e12 times heavier and faster loaded: the light one's error counts.
  Lcp p = one_contact({{2, 0.5}});
  const Lcp one = p;
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(6, 6);
  A.bottomRightCorner(3, 3) *= 1;
  p.A = DenseMatrix(A);
  p.b = {-1e12, 0, 0, -1, 0, 0};
  p.lo = {0, -kInf, -kInf, 0, -kInf, -kInf}, p.hi = Eigen::VectorXd::Constant(6, kInf);
  p.friction.push_back({.normal = 3, .first = 4, .rows = 2, .mu = 0.5});
  Judge judge;
  Solution s;
  s.z = {1e12, 0, 0, 1, 0, 0};
  judge.certify(p, 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::solved);
  s.z[3] = 1.1;
  judge.certify(p, 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::stalled);
}

TEST_CASE("cones: a runaway z is no answer, nor is one that is not finite") {
  Lcp p = one_contact({{2, 0.5}});
  p.A = DenseMatrix(Eigen::MatrixXd::Zero(3, 3));
  p.b = {-1, 0, 0};
  std::get<DenseMatrix>(p.A)(0, 0) = 1e-17;
  p.A = DenseMatrix((Eigen::MatrixXd(3, 3) << 1, 0, 1e3, 0, 1, 0, -1e3, 0, 1).finished());
  Judge judge;
  Solution s;
  s.z = {1e16, 0, 0};
  judge.certify(p, 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::numerical_error);
  s.z = {std::nan(""), 0, 0};
  judge.certify(p, 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::numerical_error);
}

TEST_CASE("cones: a proof of infeasibility holds over the disc, not over the square around it") {
  // w_n = z_n (g_n) + g_T z_T − 1 with ‖z_T‖ ≤ z_n: w_n < 0 for all z where g_n + ‖g_T‖ ≤ 0.
  const auto problem = [](double g_n) {
    Lcp p = one_contact({{2, 1.0}});
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3, 3);
    A(0, 0) = g_n, A(0, 1) = 3, A(0, 2) = 4;
    p.A = DenseMatrix(A), p.b = {-1, 0, 0};
    return p;
  };
  Judge judge;
  CHECK(judge.proves_infeasible(problem(-5.001), {1, 0, 0}));
  CHECK_FALSE(judge.proves_infeasible(problem(-4.999), {1, 0, 0}));
  CHECK_FALSE(judge.proves_infeasible(problem(-5.001), {1, 1e-3, 0}));  // friction rows' w has any sign
  CHECK(independent_proof(problem(-5.001), {1, 0, 0}));
  CHECK_FALSE(independent_proof(problem(-4.999), {1, 0, 0}));
}

TEST_CASE("cones: an answer that misses Coulomb's law says which contact, by how much and against which limit") {
  Lcp p;
  p.A = DenseMatrix(Eigen::Matrix3d::Identity()), p.b = Vector(Eigen::Vector3d(-10, 3, 4));
  p.lo = {0, -kInf, -kInf}, p.hi = {kInf, kInf, kInf};
  p.friction.push_back({.normal = 0, .first = 1, .rows = 2, .mu = 0.2});
  Judge judge;
  Solution s;
  s.z = Vector(Eigen::Vector3d(10, 0, 0));  // sticks, and should slide
  judge.certify(p, 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::stalled);
  CHECK(why(s).starts_with("the contact of row 0 misses Coulomb's law by "));
  s.z[1] = std::numeric_limits<double>::quiet_NaN();
  judge.certify(p, 1e-10, Claim::candidate, s);
  CHECK(why(s) == "row 1 is not finite");
}

TEST_CASE("problem files: friction sets the bounds of its rows where the file gives none") {
  const Lcp p = parse_problem(R"({"format": "orthant-lcp", "version": 1, "b": [-1, 3, 4],
    "A": {"storage": "dense", "n": 3, "rows": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
    "friction": [{"first": 1, "rows": 2, "normal": 0, "mu": 0.3}]})");
  CHECK((p.lo[0] == 0 && p.lo[1] == -kInf && p.lo[2] == -kInf));
  CHECK((p.hi[0] == kInf && p.hi[1] == kInf && p.hi[2] == kInf));
}

TEST_CASE("cones: discs that do not fit say so, and survive JSON") {
  Lcp p = one_contact({{2, 0.5}, {1, 0.1}});
  const Lcp back = parse_problem(to_json(p));
  REQUIRE(back.friction.size() == 2);
  CHECK(back.friction[0].rows == 2);
  CHECK(back.friction[0].first == 1);
  CHECK(back.friction[1].rows == 1);
  const auto broken = [&](auto change) {
    Lcp q = p;
    change(q);
    try {
      check(q);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(broken([](Lcp& q) { q.friction[0].rows = 3; }).find("rows = 3: must be 1 (interval) or 2 (disc)") !=
        std::string::npos);
  CHECK(broken([](Lcp& q) { q.friction[0].first = 3; }).find("first = 3: must be in [0, 2]") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.friction[1].first = 2; }).find("row 2: must not occur twice") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.friction[0].normal = 2; }).find("normal = 2") != std::string::npos);
  CHECK(broken([](Lcp& q) { q.hi[2] = 1; }).find("friction row 2 has bounds") != std::string::npos);
}
