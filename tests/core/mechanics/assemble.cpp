// Assembly of a scene: the least motion into joints and journals, checked by closed forms; words where there is none.
#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

namespace {

Vector2d place(const Scene& s, std::size_t body) { return s.bodies[body].position; }

double off(const Scene& scene) {
  Scene still = scene;
  still.assemble = false;
  const System system(still);
  const State x = system.initial_state();
  return off_most(system, x.t, x.q).off;
}

}  // namespace

TEST_CASE("assemble: two points that a pin of no lever joins meet at their common centre of mass") {
  Scene s;
  s.body({.mass = 1, .position = {0, 0}}), s.body({.mass = 3, .position = {4, 8}});
  s.joint(Revolute{"pin", 0, 1, {0, 0}, {0, 0}});
  const Scene there = assembled(s);
  for (const std::size_t body : {0U, 1U}) CHECK((place(there, body) - Vector2d(3, 6)).norm() < 1e-12);
}

TEST_CASE("assemble: a rod between two walls of pins, by the optimality condition of the least motion") {
  Scene s;
  const double m = 2, J = 0.3;
  s.body({.mass = m, .inertia = J, .position = {0.7, 0.4}, .angle = 0.3});
  s.joint(Revolute{"pin", kGround, 0, {0, 0}, {-0.5, 0}});
  const Scene there = assembled(s);
  CHECK(off(there) < 1e-12);
  // x = (cos θ, sin θ) / 2 by the pin: d/dθ of m |x − x₀|² + J (θ − θ₀)² is zero.
  const double theta = there.bodies[0].angle;
  const Vector2d x = place(there, 0), slope = 0.5 * Vector2d(-std::sin(theta), std::cos(theta));
  CHECK(std::abs(m * slope.dot(x - Vector2d(0.7, 0.4)) + J * (theta - 0.3)) < 1e-9);
}

TEST_CASE("assemble: a journal outside its bearing touches it, one inside stays where it is") {
  const auto pin = [](double x) {
    Scene s;
    s.body({.mass = 1, .position = {x, 0}});
    s.contact(Journal{"B", 0, {0, 0}, 0.010, kGround, {0, 0}, 0.012, {}});
    return s;
  };
  CHECK(std::abs(place(assembled(pin(0.011)), 0).x() - 0.002) < 1e-12);
  CHECK(place(assembled(pin(0.001)), 0).x() == 0.001);
  Scene far = pin(0.05);  // a pin out of its hole is refused, except where it is moved into it
  CHECK_THROWS_WITH_AS(check(far), doctest::Contains("the pin is out of its hole"), std::invalid_argument);
  far.assemble = true;
  CHECK(std::abs(System(far).initial_state().q[0] - 0.002) < 1e-12);
}

TEST_CASE("assemble = true in a scene file moves bodies; far-off loops close; a loop that cannot close is named") {
  const std::string loop = R"(
    assemble = true
    [[body]]
    name = "crank"
    mass = 1
    inertia = 0.01
    position = [0.2, 0.3]
    [[body]]
    name = "rod"
    mass = 1
    inertia = 0.05
    position = [0.9, 0.1]
    [[joint]]
    type = "revolute"
    name = "O"
    bodies = ["ground", "crank"]
    point_b = [-0.25, 0]
    [[joint]]
    type = "revolute"
    name = "A"
    bodies = ["crank", "rod"]
    point_a = [0.25, 0]
    point_b = [-0.5, 0]
    [[joint]]
    type = "revolute"
    name = "C"
    bodies = ["rod", "ground"]
    point_a = [0.5, 0]
    point_b = [1.2, 0]
  )";
  const Scene s = parse_scene(loop);
  CHECK(s.assemble);
  const System system(s);
  const State x = system.initial_state();
  CHECK(off_most(system, x.t, x.q).off < 1e-12);
  CHECK(off(s) > 0.05);
  const Scene far = parse_scene(loop, std::vector<std::string>{"joint.C.point_b=[5, 0]"});
  CHECK_THROWS_WITH_AS(assembled(far), doctest::Contains("is off by"), std::invalid_argument);
  CHECK_THROWS_AS(parse_scene("assemble = 1\n" + loop.substr(20)), std::invalid_argument);
}
