// BasicSystem: its ways of solving against the saddle matrix written out and solved in 80-bit arithmetic.
#include <doctest/doctest.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/spherical_chain.h>

#include <array>

#include "tests/support/mechanics.h"

namespace orthant {
namespace {

using testing::dense;
using testing::Draws;
using testing::MatrixXd;
using testing::mismatch;
using testing::SaddleSolution;
using testing::solve;
using testing::VectorXd;

constexpr double kExact = 1e-12;

Body random_body(Draws& random) {
  return {"", random(0.5, 2), random(0.5, 2), random.point(3), random(-3, 3), random.point(), random(-1, 1)};
}

/// One joint of every kind in a row of bodies: 8 rows.
Scene one_of_each(Draws& r) {
  Scene s{.gravity = {0, -9.81}};
  for (int i = 0; i < 4; ++i) s.body(random_body(r));
  s.joint(Revolute{"", kGround, 0, r.point(), r.point()});
  s.joint(Prismatic{"", 0, 1, r.point(), r.point(), r.direction(), r(-1, 1)});
  s.joint(Distance{"", 1, 2, r.point(), r.point(), r(0.1, 2)});
  s.joint(Fixed{"", 2, 3, r.point(), r.point(), r(-1, 1)});
  return s;
}

Scene with_springs(Scene s, Draws& r) {
  s.spring(PointSpring{"", 0, 3, r.point(), r.point(), r(1, 9), r(1, 9), r(0, 1)});
  s.spring(PointSpring{"", kGround, 1, r.point(), r.point(), r(1, 9), r(1, 9), r(0, 1)});
  s.spring(TorsionSpring{"", 3, 0, r(1, 9), r(1, 9), r(-1, 1)});
  return s;
}

/// A spring without strength: with a weight nothing moves otherwise, but the saddle matrix is factorized.
Scene by_klu(Scene s) {
  s.spring(TorsionSpring{"weightless", 0, kGround, 0, 0, 0});
  return s;
}

/// n links hanging in a row, each pinned to the one before.
Scene chain(int n, Draws& r) {
  Scene s{.gravity = {0, -9.81}};
  for (int i = 0; i < n; ++i) {
    s.body(random_body(r));
    s.joint(Revolute{"", i - 1, i, i == 0 ? Vector2d(0, 0) : Vector2d(0.5, 0), {-0.5, 0}});
  }
  return s;
}

/// Two bodies and four bars a bay: as many bars as coordinates.
Scene cantilever(int bays) {
  Scene s{.gravity = {0, -9.81}};
  const auto at = [](int bay, int level) { return bay == 0 ? kGround : BodyId{2 * (bay - 1) + level}; };
  for (int bay = 1; bay <= bays; ++bay)
    for (int level = 0; level < 2; ++level) s.body({.mass = 1, .inertia = 0.1, .position = {1.0 * bay, 1.0 * level}});
  const auto bar = [&](int bay, int level, int other, int other_level) {
    const Vector2d from = bay == 0 ? Vector2d(0, level) : Vector2d(0, 0);
    s.joint(Distance{
        "", at(bay, level), at(other, other_level), from, {0, 0}, std::hypot(other - bay, other_level - level)});
  };
  for (int bay = 0; bay < bays; ++bay) {
    bar(bay, 0, bay + 1, 0), bar(bay, 1, bay + 1, 1), bar(bay, 0, bay + 1, 1), bar(bay + 1, 0, bay + 1, 1);
  }
  return s;
}

/// A table on three cranks of one length: two of them would do.
Scene parallelogram() {
  Scene s{.gravity = {0, -9.81}};
  const auto table = s.body({.mass = 2, .inertia = 1, .position = {1, 1}});
  for (int i = 0; i < 3; ++i) {
    const auto crank = s.body({.mass = 0.5, .inertia = 0.1, .position = {1.0 * i, 0.5}, .angle = std::acos(-1.0) / 2});
    s.joint(Revolute{"", kGround, crank, {1.0 * i, 0}, {-0.5, 0}});
    s.joint(Revolute{"", crank, table, {0.5, 0}, {1.0 * i - 1, 0}});
  }
  return s;
}

SaddleSolution reference(const System& system, const Terms& terms, const VectorXd& f, const VectorXd& c,
                         double k_weight = 0, double c_weight = 0) {
  VectorXd rhs(f.size() + c.size());
  rhs << f, c;
  const VectorXd y = testing::solve_precisely(testing::saddle_matrix(system, terms, k_weight, c_weight), rhs);
  return {y.head(f.size()), y.tail(c.size())};
}

/// BasicSystem against the reference, at a random state, with a random right-hand side.
void compare(const Scene& scene, Draws& random, double k_weight = 0, double c_weight = 0) {
  const System system(scene);
  BasicSystem basic(system);
  for (int repeat = 0; repeat < 3; ++repeat) {  // factorizations after the first take another way through KLU
    const VectorXd q = random.vector(system.dof(), 3), v = random.vector(system.dof());
    const Terms terms = testing::all_terms(system, q, v);
    const VectorXd f = random.vector(system.dof()), c = random.vector(system.joint_rows());
    REQUIRE(basic.factorize(system, terms, k_weight, c_weight));
    CHECK_FALSE(basic.redundant());
    const SaddleSolution expected = reference(system, terms, f, c, k_weight, c_weight), s = solve(basic, f, c);
    CHECK(mismatch(s.x, expected.x) < kExact);
    CHECK(mismatch(s.lambda, expected.lambda) < kExact);
    const auto last = system.bodies() - 1;
    for (const auto& [a, b] : {std::pair{0, last}, {kGround, last}, {1, kGround}, {last, last}}) {
      const Row row = pair_row(a, b, random.direction(), random.point(), random.point());
      VectorXd x(system.dof());
      basic.solve_row(row, x.data());
      CHECK(mismatch(x, reference(system, terms, dense(row, system.dof()), 0 * c, k_weight, c_weight).x) < kExact);
    }
  }
}

}  // namespace

TEST_CASE(
    "the saddle system is solved as its definition says: no joints, dense, KLU, springs with and without weight") {
  for (int seed = 0; seed < 10; ++seed) {
    CAPTURE(seed);
    Draws random(static_cast<std::uint64_t>(seed));
    const Scene joints = one_of_each(random);
    Scene free = joints;
    free.joints.clear();
    compare(free, random);
    compare(joints, random);
    compare(by_klu(joints), random, 1);
    compare(with_springs(joints, random), random);
    compare(with_springs(joints, random), random, 0.3, 0.7);
    compare(with_springs(free, random), random, 0.3, 0.7);
  }
}

TEST_CASE("a chain of 50 pendulums: Cholesky factors and KLU agree with the dense solution") {
  Draws random(50);
  compare(chain(50, random), random);
  compare(by_klu(chain(50, random)), random, 1);
}

TEST_CASE(
    "a chain of 450 pendulums: Cholesky factors and KLU give the same motion, and equal joints share their force") {
  Draws random(51);
  Scene scene = by_klu(chain(450, random));  // KLU only with a weight, though the spring has no stiffness
  const System system(scene);
  const Terms terms = testing::all_terms(system, random.vector(system.dof(), 3), random.vector(system.dof()));
  BasicSystem basic(system);
  REQUIRE(basic.factorize(system, terms));
  const SaddleSolution cholesky = solve(basic, terms.f, -terms.joint_bias);
  CHECK(basic.independence() > 0);
  REQUIRE(basic.factorize(system, terms, 1));
  const SaddleSolution klu = solve(basic, terms.f, -terms.joint_bias);
  CHECK(mismatch(cholesky.x, klu.x) < 1e-10);
  CHECK(mismatch(cholesky.lambda, klu.lambda) < 1e-10);
  Terms broken = terms;
  broken.G[500].ja[0] = std::nan("");
  CHECK_FALSE(basic.factorize(system, broken));
  REQUIRE(basic.factorize(system, terms));
  CHECK(solve(basic, terms.f, -terms.joint_bias).x == cholesky.x);

  scene.joint(scene.joints.front());
  std::visit([](auto& joint) { joint.name = "copy"; }, scene.joints.back());
  const System doubled(scene);
  const Terms both = testing::all_terms(doubled, system.initial_state().q, system.initial_state().v);
  BasicSystem redundant(doubled);
  REQUIRE(redundant.factorize(doubled, both));
  CHECK(redundant.redundant());
  const SaddleSolution shared = solve(redundant, both.f, -both.joint_bias);
  CHECK(mismatch(VectorXd(shared.lambda.head<2>()), shared.lambda.tail<2>()) < 1e-8);
}

TEST_CASE("long cantilevers stand though their ends are nearly free to go on, with and without a second lower rod") {
  // The least eigenvalue of S falls like the fourth power of the length.
  Draws random(8);
  for (const int bays : {200, 1400, 3000})
    for (const bool doubled : {false, true}) {
      CAPTURE(bays);
      CAPTURE(doubled);
      Scene scene = cantilever(bays);
      for (std::size_t i = 0, n = scene.joints.size(); doubled && i < n; i += 4) {
        scene.joint(scene.joints[i]);
        std::visit([&](auto& joint) { joint.name = "copy" + std::to_string(i); }, scene.joints.back());
      }
      const System system(scene);
      const State x = system.initial_state();
      const Terms terms = testing::all_terms(system, x.q, x.v);
      BasicSystem basic(system);
      REQUIRE(basic.factorize(system, terms));
      CHECK(basic.rank() == 4 * bays);
      CHECK(basic.redundant() == doubled);
      const SaddleSolution solution = solve(basic, terms.f, -terms.joint_bias);
      double fastest = 0;
      for (Index i = 0; i < system.dof(); ++i) fastest = std::max(fastest, i % 3 == 2 ? 0 : std::abs(solution.x[i]));
      CHECK(fastest < 1e-6);
      const double largest = solution.lambda.lpNorm<Eigen::Infinity>();
      // Moments about the upper end of the first bay, where its two other bars meet.
      const double lowest = std::abs(solution.lambda[0] + (doubled ? solution.lambda[4 * bays] : 0));
      CHECK(lowest == doctest::Approx(9.81 * bays * (bays - 1.0)).epsilon(1e-7));
      // Rates of the size of rounding that contradict each other.
      for (int trial = 0; trial < 5; ++trial)
        CHECK(solve(basic, 0 * terms.f, 1e-19 * random.vector(system.joint_rows())).x.allFinite());
      for (Index i = 0; doubled && i < bays; ++i)
        CHECK(std::abs(solution.lambda[4 * i] - solution.lambda[4 * bays + i]) < 1e-7 * largest);
    }
}

TEST_CASE("dense and KLU give the same motion") {
  Draws random(3);
  const Scene scene = one_of_each(random);
  const System few(scene), sparse(by_klu(scene));
  const VectorXd q = random.vector(few.dof(), 3), v = random.vector(few.dof());
  const SaddleSolution a = testing::accelerations(few, q, v), b = testing::accelerations(sparse, q, v, 1);
  CHECK(mismatch(a.x, b.x) < kExact);
  CHECK(mismatch(a.lambda, b.lambda) < kExact);
}

TEST_CASE("without its joints the basic system is the masses and the springs") {
  Draws random(4);
  const System system(one_of_each(random));
  const Terms terms = testing::all_terms(system, random.vector(system.dof()), random.vector(system.dof()));
  BasicSystem basic(system, false);
  REQUIRE(basic.factorize(system, terms));
  const VectorXd f = random.vector(system.dof());
  CHECK(solve(basic, f, VectorXd(0)).x == VectorXd(system.inverse_mass().cwiseProduct(f)));
}

TEST_CASE("a pin given twice or three times moves as if given once, and the pins share its force") {
  for (const bool klu : {false, true})
    for (int copies = 2; copies <= 3; ++copies) {
      CAPTURE(klu);
      CAPTURE(copies);
      Draws random(5);
      Scene scene = one_of_each(random);
      if (klu) scene = by_klu(scene);
      const System once(scene);
      for (int i = 1; i < copies; ++i) {
        scene.joint(scene.joints[0]);
        std::visit([&](auto& j) { j.name = "copy" + std::to_string(i); }, scene.joints.back());
      }
      const System system(scene);
      const VectorXd q = random.vector(once.dof(), 3), v = random.vector(once.dof());
      const SaddleSolution expected = testing::accelerations(once, q, v);
      const Terms terms = testing::all_terms(system, q, v);
      BasicSystem basic(system);
      REQUIRE(basic.factorize(system, terms, klu ? 1 : 0));
      CHECK(basic.redundant());
      const SaddleSolution s = solve(basic, terms.f, -terms.joint_bias);
      CHECK(mismatch(s.x, expected.x) < kExact);
      CHECK(mismatch(VectorXd(s.lambda.head<2>()), expected.lambda.head<2>() / copies) < kExact);
      for (int i = 0; i + 1 < copies; ++i)
        CHECK(mismatch(VectorXd(s.lambda.segment<2>(8 + 2 * i)), expected.lambda.head<2>() / copies) < kExact);
      CHECK(mismatch(VectorXd(s.lambda.segment(2, 6)), expected.lambda.tail(6)) < kExact);
    }
}

TEST_CASE("two pins between the same two bodies hold them as a weld does") {
  // Four rows of rank three, and not two equal ones: only rounding tells that they are dependent.
  for (const bool klu : {false, true})
    for (int seed = 0; seed < 30; ++seed) {
      CAPTURE(klu);
      CAPTURE(seed);
      Draws r(static_cast<std::uint64_t>(seed));
      Scene scene{.gravity = {0, -9.81}};
      scene.body(random_body(r)), scene.body(random_body(r));
      scene.bodies[1].position = scene.bodies[0].position, scene.bodies[1].angle = scene.bodies[0].angle;
      if (klu) scene = by_klu(scene);
      Scene weld = scene;
      for (int pin = 0; pin < 2; ++pin) {
        const Vector2d at = r.point();
        scene.joint(Revolute{"", 0, 1, at, at});
        if (pin == 0) weld.joint(Fixed{"", 0, 1, at, at, 0});
      }
      scene.joint(Revolute{"", kGround, 0, {0, 0}, {0.5, 0}});
      weld.joint(Revolute{"", kGround, 0, {0, 0}, {0.5, 0}});
      const System system(scene), welded(weld);
      State x = system.initial_state();
      x.v.tail(3) = x.v.head(3);  // the two move as one
      const Terms terms = testing::all_terms(system, x.q, x.v);
      BasicSystem basic(system);
      REQUIRE(basic.factorize(system, terms, klu ? 1 : 0));
      CHECK(basic.redundant());
      const SaddleSolution s = solve(basic, terms.f, -terms.joint_bias);
      CHECK(mismatch(s.x, testing::accelerations(welded, x.q, x.v).x) < kExact);
      // Least Σ S_ii λ_i²: in that metric, no part of λ is in the null space of Gᵀ.
      const MatrixXd G = dense(terms.G, system.dof());
      const VectorXd S_ii = (G * system.inverse_mass().asDiagonal() * G.transpose()).diagonal();
      const VectorXd null = Eigen::FullPivLU<MatrixXd>(G.transpose()).setThreshold(1e-10).kernel().col(0);
      CHECK(std::abs(null.normalized().dot(S_ii.cwiseProduct(s.lambda))) < 1e-9 * (1 + s.lambda.norm()));
    }
}

TEST_CASE("redundant joints are found and solved at every size and mass ratio") {
  for (const bool klu : {false, true})
    for (const double size : {1e-3, 1.0, 100.0})
      for (const double ratio : {1.0, 1e3, 1e6})
        for (int seed = 0; seed < 50; ++seed) {
          CAPTURE(klu);
          CAPTURE(size);
          CAPTURE(ratio);
          CAPTURE(seed);
          Draws r(static_cast<std::uint64_t>(seed));
          Scene weld{.gravity = {0, -9.81}};
          for (int i = 0; i < 3; ++i) {
            const double mass = r(0.5, 2) * (i == 1 ? ratio : 1);
            weld.body({"", mass, mass * size * size * r(0.1, 1), r.point(size), r(-3, 3)});
          }
          weld.bodies[1].position = weld.bodies[0].position, weld.bodies[1].angle = weld.bodies[0].angle;
          weld.joint(Revolute{"", kGround, 0, {0, 0}, r.point(size)});
          weld.joint(Revolute{"", 1, 2, r.point(size), r.point(size)});
          Scene scene = klu ? by_klu(weld) : weld;
          const Vector2d pin = r.point(size), other_pin = pin + size * r.direction();
          scene.joint(Revolute{"", 0, 1, pin, pin}), scene.joint(Revolute{"", 0, 1, other_pin, other_pin});
          weld.joint(Fixed{"", 0, 1, pin, pin, 0});
          const System system(scene), welded(weld);
          const State x = system.initial_state();
          const Terms terms = testing::all_terms(welded, x.q, x.v);
          const VectorXd expected = reference(welded, terms, terms.f, -terms.joint_bias).x;
          const VectorXd a = testing::accelerations(system, x.q, x.v, klu ? 1 : 0).x;
          REQUIRE(a.size() == expected.size());
          CHECK((a - expected).lpNorm<Eigen::Infinity>() <
                1e-12 * std::pow(ratio, 0.8) * expected.lpNorm<Eigen::Infinity>());
        }
}

TEST_CASE("a table on three cranks swings as on two, also through the pose where all cranks lie in one line") {
  for (const bool klu : {false, true})
    for (const double angle : {0.3, 1.5707963267948966, 3.0, 0.0}) {
      CAPTURE(klu);
      CAPTURE(angle);
      Scene scene = klu ? by_klu(parallelogram()) : parallelogram();
      const System system(scene);
      const Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
      const double omega = 2;
      VectorXd q = system.initial_state().q, v(system.dof());
      q.head<3>() << 1 + along.x(), along.y(), 0;
      v.head<3>() << omega * across, 0;
      for (int i = 0; i < 3; ++i) {
        q.segment<3>(3 + 3 * i) << i + along.x() / 2, along.y() / 2, angle;
        v.segment<3>(3 + 3 * i) << omega / 2 * across, omega;
      }
      const SaddleSolution s = testing::accelerations(system, q, v, klu ? 1 : 0);
      REQUIRE(s.x.size() == system.dof());
      // Lagrange: (2 · 1² + 3 (0.1 + 0.5 · 0.5²)) φ̈ = −g cos φ (2 · 1 + 3 · 0.5 · 0.5).
      const double expected = -9.81 * along.x() * 2.75 / 2.675;
      if (angle == 0.0) continue;  // a branch point: the accelerations need not be those, but they are finite
      CHECK(s.x[5] == doctest::Approx(expected).epsilon(1e-11));
      CHECK(std::abs(s.x[2]) < 1e-11);  // the table stays level
    }
}

TEST_CASE("joints that drifted apart by less than anyone sees do not lock a redundant mechanism") {
  for (const bool klu : {false, true})
    for (const double drift : {1e-13, 1e-11, 1e-9, 1e-8, 3e-8})
      for (int seed = 0; seed < 10; ++seed) {
        CAPTURE(klu);
        CAPTURE(drift);
        CAPTURE(seed);
        Draws random(static_cast<std::uint64_t>(seed));
        const System system(klu ? by_klu(parallelogram()) : parallelogram());
        const VectorXd q = system.initial_state().q + random.vector(system.dof(), drift);
        VectorXd v = VectorXd::Zero(system.dof());
        const VectorXd a = testing::accelerations(system, q, v, klu ? 1 : 0).x;
        REQUIRE(a.size() == system.dof());
        CHECK(std::abs(a[5]) < 1e3 * drift + 1e-12);  // upright: nothing turns the cranks
        const VectorXd pushed = [&] {
          Scene scene = system.scene();
          scene.load({.name = "push", .body = 0, .force = {-1, 0}});
          return testing::accelerations(System(scene), q, v, klu ? 1 : 0).x;
        }();
        CHECK(pushed[5] == doctest::Approx(1 / 2.675).epsilon(1e3 * drift + 1e-12));
      }
}

TEST_CASE("after a redundant pose the next one is solved as ever") {
  Draws random(6);
  Scene scene = one_of_each(random);
  const System system(scene);
  BasicSystem basic(system);
  const VectorXd q = random.vector(system.dof(), 3), v = random.vector(system.dof());
  const Terms good = testing::all_terms(system, q, v);
  Terms degenerate = good;
  degenerate.G[1] = degenerate.G[0];
  REQUIRE(basic.factorize(system, degenerate));
  CHECK(basic.redundant());
  REQUIRE(basic.factorize(system, good));
  CHECK_FALSE(basic.redundant());
  const VectorXd c = -good.joint_bias;
  CHECK(mismatch(solve(basic, good.f, c).x, reference(system, good, good.f, c).x) < kExact);
}

TEST_CASE("heavy and light bodies, large and small units: independent joints are not called redundant") {
  for (const bool klu : {false, true})
    for (const double ratio : {1e-6, 1e-3, 1e3, 1e6}) {
      CAPTURE(klu);
      CAPTURE(ratio);
      Draws random(8);
      Scene scene = one_of_each(random);
      scene.bodies[1].mass *= ratio, scene.bodies[1].inertia *= ratio;
      scene.bodies[3].mass /= ratio, scene.bodies[3].inertia /= ratio;
      if (klu) scene = by_klu(scene);
      const System system(scene);
      const VectorXd q = random.vector(system.dof(), 3), v = random.vector(system.dof());
      const Terms terms = testing::all_terms(system, q, v);
      BasicSystem basic(system);
      REQUIRE(basic.factorize(system, terms, klu ? 1 : 0));
      CHECK_FALSE(basic.redundant());
      const VectorXd c = -terms.joint_bias;
      const SaddleSolution s = solve(basic, terms.f, c), expected = reference(system, terms, terms.f, c);
      CHECK(mismatch(s.x, expected.x) < 1e-9);
      CHECK((dense(terms.G, system.dof()) * s.x - c).lpNorm<Eigen::Infinity>() < 1e-9);
    }
}

TEST_CASE("numbers that are none are refused, and the object is good again afterwards") {
  for (const bool klu : {false, true}) {
    Draws random(9);
    const System system(klu ? by_klu(one_of_each(random)) : one_of_each(random));
    const Terms good = testing::all_terms(system, random.vector(system.dof()), random.vector(system.dof()));
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      Terms broken = good;
      broken.G[2].ja[0] = bad;
      BasicSystem basic(system);
      CHECK_FALSE(basic.factorize(system, broken, klu ? 1 : 0));
      CHECK(basic.factorize(system, good, klu ? 1 : 0));
      CHECK_FALSE(basic.factorize(system, broken, klu ? 1 : 0));
      REQUIRE(basic.factorize(system, good, klu ? 1 : 0));
      CHECK(mismatch(solve(basic, good.f, -good.joint_bias).x, reference(system, good, good.f, -good.joint_bias).x) <
            kExact);
    }
  }
}

TEST_CASE("a mechanism and its gravity turned together accelerate turned") {
  Draws random(10);
  for (int i = 0; i < 5; ++i) {
    Scene scene = with_springs(one_of_each(random), random);
    const double angle = random(-3, 3);
    const Eigen::Rotation2Dd turn(angle);
    Scene turned = scene;
    turned.gravity = turn * scene.gravity;
    std::get<Revolute>(turned.joints[0]).point_a = turn * std::get<Revolute>(scene.joints[0]).point_a;
    std::get<PointSpring>(turned.springs[1]).point_a = turn * std::get<PointSpring>(scene.springs[1]).point_a;
    for (Body& b : turned.bodies) b.position = turn * b.position, b.velocity = turn * b.velocity, b.angle += angle;
    const System one(scene), other(turned);
    const State x = one.initial_state(), y = other.initial_state();
    const VectorXd a = testing::accelerations(one, x.q, x.v).x, b = testing::accelerations(other, y.q, y.v).x;
    for (Index k = 0; k < a.size(); k += 3) {
      CHECK(mismatch(VectorXd(turn * Vector2d(a.segment<2>(k))), b.segment<2>(k)) < 1e-11);
      CHECK(mismatch(a[k + 2], b[k + 2]) < 1e-11);
    }
    CHECK(energy(one, {0, x.q, x.v}) == doctest::Approx(energy(other, {0, y.q, y.v})).epsilon(1e-12));
  }
}

template <class Space> int rank_of(const SystemOf<Space>& system) {
  TermsOf<Space> terms(system);
  const State x = system.initial_state();
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_rows(system, terms);
  BasicSystemOf<Space> basic(system);
  return basic.factorize(system, terms) ? basic.rank() : 0;
}

TEST_CASE("the joints of a chain of 1e5 links are independent, in the plane and in space") {
  CHECK(rank_of(System(chain({.links = 100000}))) == 100000);
  CHECK(rank_of(SystemOf<Spatial>(spherical_chain({.links = 100000}))) == 300000);
}

}  // namespace orthant
