// Springs, loads and energy; and that run time grows only with the features that a scene uses.
#include <doctest/doctest.h>
#include <orthant/core/scenes/slider_crank.h>

#include "tests/support/mechanics.h"

namespace orthant {
namespace {

using testing::central_difference;
using testing::dense;
using testing::Draws;
using testing::mismatch;
using testing::VectorXd;

constexpr double kFine = 1e-7;  // of a central difference at h = 1e-5, with room

constexpr std::pair<BodyId, BodyId> kPairs[] = {{0, 1}, {1, 0}, {kGround, 1}, {0, kGround}};

std::vector<Spring> springs(BodyId a, BodyId b, Draws& r) {
  return {PointSpring{"", a, b, r.point(), r.point(), r(1, 9), r(1, 9), r(0, 1)},
          TorsionSpring{"", a, b, r(1, 9), r(1, 9), r(-1, 1)}, JointSpring{"", Angle{a, b}, r(1, 9), r(1, 9), r(-1, 1)},
          JointSpring{"", Slide{a, b, r.point(), r.point(), r.direction()}, r(1, 9), r(1, 9), r(-1, 1)}};
}

Spring without_damping(Spring spring) {
  std::visit([](auto& s) { s.damping = 0; }, spring);
  return spring;
}
Spring without_stiffness(Spring spring) {
  std::visit([](auto& s) { s.stiffness = 0; }, spring);
  return spring;
}

System two_bodies(const std::vector<Spring>& with, const Vector2d& gravity = {0, 0}) {
  Scene s{.gravity = gravity};
  s.body({.mass = 2, .inertia = 0.3}), s.body({.mass = 3, .inertia = 0.7});
  for (const Spring& spring : with) s.spring(spring);
  return System(s);
}

VectorXd force(const System& system, const VectorXd& q, const VectorXd& v, double t = 0) {
  return testing::all_terms(system, q, v, t).f;
}

template <class Claim> void for_all_springs(Claim&& claim) {
  for (const auto& pair : kPairs) {
    const BodyId a = pair.first, b = pair.second;  // names that a lambda may capture
    for (std::size_t kind = 0; kind < 2; ++kind)
      for (int seed = 0; seed < 20; ++seed) {
        CAPTURE(a);
        CAPTURE(b);
        CAPTURE(kind);
        CAPTURE(seed);
        Draws random(static_cast<std::uint64_t>(seed));
        claim(springs(a, b, random)[kind], random);
      }
  }
}

}  // namespace

TEST_CASE("a spring's force and gravity are minus the gradient of the energy") {
  for_all_springs([](const Spring& spring, Draws& random) {
    const System system = two_bodies({without_damping(spring)}, {0.3, -9.81});
    const VectorXd q = random.vector(6, 3), rest = VectorXd::Zero(6);
    VectorXd gradient(6);
    for (int k = 0; k < 6; ++k)
      gradient[k] = central_difference(
          [&](double s) { return energy(system, {.t = 0, .q = q + s * VectorXd::Unit(6, k), .v = rest}); });
    CHECK(mismatch(force(system, q, rest), -gradient) < kFine);
  });
}

TEST_CASE("energy is kinetic, plus weight times height, plus springs") {
  const System system =
      two_bodies({PointSpring{"", 0, 1, {0, 0}, {0, 0}, 8, 0, 1}, TorsionSpring{"", 1, kGround, 6, 0, 0.5}}, {0, -10});
  VectorXd q(6), v(6);
  q << 0, 1, 0, 3, 5, 2.5;
  v << 1, 2, 3, 4, 5, 6;
  // ½ (2·5 + 0.3·9 + 3·41 + 0.7·36) + 10 (2·1 + 3·5) + ½ 8 (5 − 1)² + ½ 6 (2.5 − 0.5)²
  CHECK(energy(system, {0, q, v}) == doctest::Approx(80.45 + 170 + 64 + 12).epsilon(1e-14));
}

TEST_CASE("a damper takes energy at the rate c times the squared rate of its length, and never gives any") {
  for_all_springs([](const Spring& spring, Draws& random) {
    const System system = two_bodies({without_stiffness(spring)});
    const VectorXd q = random.vector(6, 3), v = random.vector(6, 3);
    const Terms terms = testing::all_terms(system, q, v);
    const double rate = apply(terms.springs[0].row, v.data());
    const double damping = std::visit([](const auto& s) { return s.damping; }, spring);
    CHECK(mismatch(terms.f.dot(v), -damping * rate * rate) < 1e-13);
    CHECK(terms.f.dot(v) <= 0);
  });
}

TEST_CASE("a spring's row carries all that its tension changes with") {
  for_all_springs([](const Spring& spring, Draws& random) {
    const System system = two_bodies({spring});
    const VectorXd q = random.vector(6, 3), v = random.vector(6, 3), rest = VectorXd::Zero(6);
    const SpringState now = testing::all_terms(system, q, v).springs[0];
    const auto tension = [&](const VectorXd& q_, const VectorXd& v_) {
      return testing::all_terms(system, q_, v_).springs[0].tension;
    };
    const auto [k, c] = std::visit([](const auto& s) { return std::pair(s.stiffness, s.damping); }, spring);
    VectorXd by_position(6), by_velocity(6);
    for (int i = 0; i < 6; ++i) {
      const VectorXd e = VectorXd::Unit(6, i);
      by_position[i] = central_difference([&](double s) { return tension(q + s * e, rest); });
      by_velocity[i] = central_difference([&](double s) { return tension(q, v + s * e); });
    }
    const VectorXd row = dense(now.row, 6);
    CHECK(mismatch(by_position, k * row) < kFine);
    CHECK(mismatch(by_velocity, c * row) < kFine);
    CHECK(mismatch(testing::all_terms(system, q, v).f, -now.tension * row) < 1e-14);
  });
}

TEST_CASE("a spring of length zero pushes with a finite force") {
  const System system = two_bodies({PointSpring{"", 0, 1, {0, 0}, {0, 0}, 4, 1, 0.5}});
  const VectorXd f = force(system, VectorXd::Zero(6), VectorXd::Zero(6));
  CHECK(f.allFinite());
  CHECK(f.norm() == doctest::Approx(2 * std::sqrt(2.0)));  // 4 · 0.5 on either body
}

TEST_CASE(
    "a load's power is force times the velocity of its point plus torque times angular velocity, times factor(t)") {
  for (int seed = 0; seed < 20; ++seed) {
    Draws random(static_cast<std::uint64_t>(seed));
    const Load load{"", 1, random.point(), random.point(), random(-1, 1), [](double t) { return 2 * t; }};
    Scene scene;
    scene.body({}), scene.body({});
    scene.load(load);
    const System system(scene);
    const VectorXd q = random.vector(6, 3), v = random.vector(6, 3);
    const Vector2d point_velocity = central_difference([&](double s) -> Vector2d {
      return q.segment<2>(3) + s * v.segment<2>(3) + Eigen::Rotation2Dd(q[5] + s * v[5]) * load.point;
    });
    const double power = load.force.dot(point_velocity) + load.torque * v[5];
    CHECK(mismatch(force(system, q, v, 0.5).dot(v), power) < kFine);
    CHECK(mismatch(force(system, q, v, 3).dot(v), 6 * power) < kFine);
    CHECK(force(system, q, v, 3).head<3>().isZero(0));

    scene.loads[0].factor = nullptr;  // none: 1
    CHECK(mismatch(force(System(scene), q, v, 3).dot(v), power) < kFine);
  }
}

TEST_CASE("run time grows only with the features that a scene uses") {
  Scene ball;
  ball.gravity = {0, -9.81};
  ball.body({.position = {0, 3}});
  ball.contact(DiscWall{"floor", 0, {0, 0}, 1, kGround, {0, 0}, {0, 1}, {}});

  SUBCASE("no joints, no joint rows; no springs, no spring states; open gaps, no contact rows") {
    const System system(ball);
    Terms terms = testing::all_terms(system, system.initial_state().q, system.initial_state().v);
    evaluate_closed(system, 0, terms);
    evaluate_biases(system, terms);
    CHECK(system.joint_rows() == 0);
    CHECK(terms.G.empty());
    CHECK(terms.phi.size() == 0);
    CHECK(terms.joint_bias.size() == 0);
    CHECK(terms.springs.empty());
    CHECK(terms.gap[0] == 2);
    CHECK(terms.closed.empty());
    CHECK(terms.contact_bias.empty());
    CHECK(BasicSystem(system).joint_rows() == 0);
  }
  SUBCASE("of many contacts the closed ones get rows, in the scene's order") {
    for (int i = 1; i < 10; ++i) {
      ball.body({.position = {3.0 * i, i % 3 == 0 ? 1.0 : 2.0}});
      ball.contact(DiscWall{"", i, {0, 0}, 1, kGround, {0, 0}, {0, 1}, {}});
    }
    const System system(ball);
    Terms terms = testing::all_terms(system, system.initial_state().q, system.initial_state().v);
    evaluate_closed(system, 0, terms);
    evaluate_biases(system, terms);
    std::vector<int> closed;
    for (const ClosedContact& c : terms.closed) closed.push_back(c.contact);
    CHECK(closed == std::vector<int>{3, 6, 9});
    CHECK(terms.contact_bias.size() == 3);
    evaluate_closed(system, 1.0, terms);  // the threshold itself is closed
    CHECK(terms.closed.size() == 9);
  }
  SUBCASE("the slider-crank in the middle of its guide: six joint rows and nothing else") {
    const System system(slider_crank());
    Terms terms = testing::all_terms(system, system.initial_state().q, system.initial_state().v);
    evaluate_closed(system, 0, terms);
    CHECK(terms.G.size() == 6);
    CHECK(terms.closed.empty());
    CHECK(BasicSystem(system, false).joint_rows() == 0);
  }
}

TEST_CASE("bodies without contacts and springs between them do not change each other's terms") {
  const System alone(slider_crank());
  Scene scene = slider_crank();
  scene.body({.name = "moon", .mass = 7e22, .inertia = 9e34, .position = {3.8e8, 0}, .velocity = {0, 1e3}});
  const System crowded(scene);
  const State x = alone.initial_state(), y = crowded.initial_state();
  const Terms one = testing::all_terms(alone, x.q, x.v), other = testing::all_terms(crowded, y.q, y.v);
  CHECK(other.f.head(alone.dof()) == one.f);
  CHECK(other.phi == one.phi);
  CHECK(other.gap == one.gap);
  CHECK(testing::accelerations(crowded, y.q, y.v).x.head(alone.dof()) == testing::accelerations(alone, x.q, x.v).x);
}

}  // namespace orthant
