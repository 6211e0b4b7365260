// Linear relations between coordinates: gears, rack and pinion, rolling, a rope over pulleys; in C++ and from TOML.
#include <orthant/core/mechanics/planar/relation.h>
#include <orthant/core/mechanics/scene/derivatives.h>

#include "tests/support/mechanics.h"
#include "tests/support/runs.h"
#include "tests/support/scene_texts.h"

#include <cmath>

using namespace orthant;
using orthant::scene_texts::contains, orthant::scene_texts::error_of;

namespace {

constexpr const char* kAllIntegrators[] = {"moreau-jean", "stewart-trinkle",   "anitescu-potra",     "paoli-schatzman",
                                           "rattle",      "generalized-alpha", "adaptive:rtol=1e-9", "event-driven"};

double error_allowed(std::string_view integrator) {
  return integrator.starts_with("adaptive") || integrator == "event-driven" ? 1e-8 : 5e-3;
}

const std::string kWheels =
    "duration = 1\nstep = 1e-3\n"
    "[[body]]\nname = 'a'\nmass = 1\ninertia = 0.5\n[[body]]\nname = 'b'\nmass = 1\ninertia = 2\nposition = [3, 0]\n"
    "[[joint]]\ntype = 'revolute'\nname = 'pin'\nbodies = ['ground', 'a']\n"
    "[[joint]]\ntype = 'revolute'\nbodies = ['ground', 'b']\npoint_a = [3, 0]\n"
    "[[load]]\nbody = 'a'\ntorque = 3\n";

const std::string kAtwood =
    "gravity = [0, -10]\nduration = 0.5\nstep = 1e-3\n"
    "[[body]]\nname = 'a'\nmass = 1\ninertia = 1\nposition = [-1, -2]\n"
    "[[body]]\nname = 'b'\nmass = 3\ninertia = 1\nposition = [1, -1]\n"
    "[[contact]]\nname = 'rope'\ntype = 'pulley'\nbodies = ['a', 'b']\npulley_a = [-1, 0]\npulley_b = [1, 0]\n";

}  // namespace

TEST_CASE("gears: two wheels under a torque turn as one, by every integrator") {
  for (const char* text : {"[[joint]]\nname = 'teeth'\ntype = 'gear'\nbodies = ['a', 'b']\nratio = -0.5\n",
                           "[[joint]]\ntype = 'relation'\nterms = [{joint = 'pin', factor = 0.5}, "
                           "{of = 'angle', bodies = ['ground', 'b']}]\n"})
    for (const char* integrator : kAllIntegrators) {
      CAPTURE(integrator);
      const Run r = run(parse_scene(kWheels + text), integrator, 1e-3);
      REQUIRE(r.status == Status::solved);
      const double angle = 3 / (0.5 + 0.25 * 2) / 2;  // τ t² / 2 / (J_a + ratio² J_b)
      CHECK(std::abs(r.final.q[2] - angle) < error_allowed(integrator));
      CHECK(std::abs(r.final.q[5] + 0.5 * r.final.q[2]) < 1e-9);
    }
}

TEST_CASE("rack and pinion, and a disc that rolls down a slope") {
  const std::string scene =
      "gravity = [0, -10]\nduration = 1\nstep = 1e-3\n[[body]]\nname = 'disc'\nmass = 2\ninertia = 0.01\n"
      "[[joint]]\ntype = 'relation'\nterms = [{of = 'slide', bodies = ['ground', 'disc'], axis = [0.6, -0.8]}, "
      "{of = 'angle', bodies = ['ground', 'disc'], factor = 0.1}]\n"
      "[[joint]]\ntype = 'relation'\nterms = [{of = 'slide', bodies = ['ground', 'disc'], axis = [0.8, 0.6]}]\n";
  for (const char* integrator : kAllIntegrators) {
    CAPTURE(integrator);
    const Run r = run(parse_scene(scene), integrator, 1e-3);
    REQUIRE(r.status == Status::solved);
    const double way = 0.8 * 10 / (1 + 0.01 / (2 * 0.1 * 0.1)) / 2;  // g sin(α) t² / 2 / (1 + J / (m r²))
    CHECK(std::abs(0.6 * r.final.q[0] - 0.8 * r.final.q[1] - way) < error_allowed(integrator));
    CHECK(std::abs(r.final.q[2] + 10 * way) < 20 * error_allowed(integrator));
  }
}

TEST_CASE("a rope over two pulleys: Atwood's machine while it is taut, free fall while it is slack") {
  for (const char* integrator : kAllIntegrators) {
    CAPTURE(integrator);
    const Run taut = run(parse_scene(kAtwood + "length = 3\n"), integrator, 1e-3);
    REQUIRE(taut.status == Status::solved);
    const double way = (3 - 1) * 10.0 / (3 + 1) * 0.125;
    CHECK(std::abs(taut.final.q[4] + 1 + way) < error_allowed(integrator));
    CHECK(std::abs(taut.final.q[1] + 2 - way) < error_allowed(integrator));
    // Both fall 1.25 m: a rope longer by that is slack to the end, and one of 4 m is pulled taut with an impact.
    const Run slack = run(parse_scene(kAtwood + "length = 5.6\n"), integrator, 1e-3);
    CHECK(std::abs(slack.final.q[1] + 2 + 1.25) < error_allowed(integrator));
    const Run pulled = run(parse_scene(kAtwood + "length = 4\n"), integrator, 1e-3);
    REQUIRE(pulled.status == Status::solved);
    // At t = sqrt(0.1) both have v = −sqrt(10); the impulse p makes v_a + v_b = 0: p (1 + 1/3) = 2 sqrt(10).
    const double t = std::sqrt(0.1), v = -std::sqrt(10.0) + 1.5 * std::sqrt(10.0), rest = 0.5 - t;
    CHECK(std::abs(pulled.final.q[1] - (-2 - 0.5 + v * rest + 5 * rest * rest / 2)) < 2 * error_allowed(integrator));
  }
}

TEST_CASE("rows and biases of relations are derivatives, wherever the bodies are and however small") {
  testing::Draws draws(3);
  for (int trial = 0; trial < 100; ++trial) {
    const double unit = trial % 2 == 0 ? 1 : 1e-6;  // [m]
    Kinematics k;
    for (int body = 0; body < 2; ++body) {
      const double angle = draws(-3, 3);
      k.pose.push_back({unit * draws.point(2), angle, std::cos(angle), std::sin(angle)});
    }
    k.pose.emplace_back();
    const std::vector<CoordinateTerm> terms{
        {draws(0.1, 2), Span{0, 1, unit * draws.point(), unit * draws.point()}},
        {-1, Slide{1, 0, unit * draws.point(), unit * draws.point(), draws.direction()}},
        {1, Span{kGround, 1, unit * draws.point(9), unit * draws.point()}},
        {unit * draws(0.1, 2), Angle{0, kGround}}};
    CHECK(wrong_derivative(Joint(CustomJoint(Relation("r", terms))), k).empty());
    for (const auto side : {Limit::Side::lower, Limit::Side::upper})
      CHECK(wrong_derivative(Contact(CustomContact(RelationLimit("r", terms, side, unit))), k).empty());
  }
}

TEST_CASE("a rack and pinion far from the origin: their rows are not asked for differences, which are rounding there") {
  const auto scene = [](double far) {
    const std::string x = "[" + std::to_string(far) + ", ";
    return parse_scene(
        "duration = 0.5\n[[body]]\nname = 'a'\nmass = 1\ninertia = 0.02\nposition = " + x +
        "0]\n[[body]]\nname = 'b'\nmass = 2\ninertia = 0.02\nposition = " + x +
        "-0.1]\n[[joint]]\ntype = 'revolute'\nname = 'j'\nbodies = ['ground', 'a']\npoint_a = " + x +
        "0]\n[[joint]]\ntype = 'prismatic'\nname = 'k'\nbodies = ['ground', 'b']\npoint_a = [0, -0.1]\n"
        "[[joint]]\ntype = 'relation'\nname = 'r'\nterms = [{joint = 'k'}, {joint = 'j', factor = -0.1}]\n"
        "[[load]]\nbody = 'b'\nforce = [1, 0]\n");
  };
  for (const double far : {0.0, 1e6, 1e7}) {
    CAPTURE(far);
    const Run r = run(scene(far), "moreau-jean", 1e-3);
    REQUIRE(r.status == Status::solved);
    CHECK(std::abs(r.final.q[3] - far - 0.125 / (2 + 0.02 / 0.01)) < 1e-3 + 1e-14 * far);
  }
}

TEST_CASE("an invalid relation is refused with its place") {
  const auto joint = [&](const std::string& keys) { return error_of(kWheels + "[[joint]]\nname = 'r'\n" + keys); };
  CHECK(contains(joint("type = 'relation'"), "joint \"r\": missing key \"terms\""));
  CHECK(contains(joint("type = 'relation'\nterms = [{joint = 'pin', factor = 0}]"),
                 "factor = 0: must be finite and not 0"));
  CHECK(contains(joint("type = 'relation'\nterms = [{of = 'angle', bodies = ['ground', 'c']}]"),
                 "must be the name of a body: ground, a, b"));
  CHECK(contains(joint("type = 'relation'\nterms = [{of = 'distance', bodies = ['ground', 'a']}]"),
                 "a distance starts as 0: must be > 0"));
  CHECK(contains(joint("type = 'gear'\nbodies = ['ground', 'a']\nratio = 2"), "neither the ground"));
  CHECK(contains(joint("type = 'gear'\nbodies = ['b', 'a']\nratio = 0"), "ratio = 0: must be not 0"));
  CHECK(contains(error_of(kAtwood), "missing key \"length\""));
  CHECK(contains(error_of(kAtwood + "length = 0\n"), "length = 0: must be > 0"));
  CHECK(contains(error_of(kAtwood + "length = 1e300\n"), "length = 1e+300: must be > 0, at most 1e100"));
  CHECK(contains(error_of(kAtwood + "length = 3\nratio = 1e300\n"), "ratio = 1e+300: must be > 0, from 1e-100"));
  CHECK(contains(joint("type = 'relation'\noffset = 1e300\nterms = [{joint = 'pin'}]"),
                 "offset = 1e+300: must be between -1e100 and 1e100"));
  CHECK(contains(joint("type = 'relation'\nterms = [{joint = 'pin', factor = 1e300}]"), "factor = 1e+300: must be"));
  CHECK(contains(joint("type = 'gear'\nbodies = ['a', 'b']\nratio = 1e300"), "ratio = 1e+300: must be not 0"));
  const std::string third = "[[body]]\nname = 'c'\nmass = 1\ninertia = 1\n";
  CHECK(contains(joint("type = 'relation'\nterms = [{joint = 'pin'}, {of = 'angle', bodies = ['b', 'c']}]\n" + third),
                 "act on three bodies: must act on two at the most besides the ground"));
}
