// Chains with mass ratios up to 1e6: every integrator runs them at an ordinary step, and comes near the right place.
#include "tests/support/runs.h"

#include <orthant/core/mechanics/dynamics/geometric_stiffness.h>

using namespace orthant;

namespace {

constexpr const char* kAllSchemes[] = {"moreau-jean",     "moreau-jean:form=full", "stewart-trinkle", "anitescu-potra",
                                       "paoli-schatzman", "generalized-alpha",     "rattle",          "adaptive",
                                       "event-driven"};
constexpr const char* kFixedStepSchemes[] = {"moreau-jean",    "moreau-jean:form=full", "stewart-trinkle",
                                             "anitescu-potra", "paoli-schatzman",       "generalized-alpha",
                                             "rattle"};

struct LinkChain {
  std::vector<double> masses;  // [kg] of the links
  double length = 0.1;         // [m] of a link
  Vector2d pivot{0, 0};
};

/// Uniform links, each pinned to the one before it, level and at rest.
Scene chain(const LinkChain& c) {
  Scene s;
  s.gravity = {0, -98.1 * c.length};
  BodyId last = kGround;
  for (std::size_t i = 0; i < c.masses.size(); ++i) {
    const double m = c.masses[i], x = (static_cast<double>(i) + 0.5) * c.length;
    const BodyId link =
        s.body({.mass = m, .inertia = m * c.length * c.length / 12, .position = c.pivot + Vector2d(x, 0)});
    s.joint(Revolute{"", last, link, last < 0 ? c.pivot : Vector2d(c.length / 2, 0), {-c.length / 2, 0}});
    last = link;
  }
  return s;
}

/// 20 links of 0.1 kg with a ball of `ball` [kg] at the end, after a public bug report, godot#50002.
Scene with_ball(double ball) {
  Scene s = chain({.masses = std::vector<double>(20, 0.1)});
  const BodyId b = s.body({.mass = ball, .inertia = ball / 100, .position = {2, 0}});
  s.joint(Revolute{"", 19, b, {0.05, 0}, {0, 0}});
  s.duration = 2;
  return s;
}

Eigen::Index last_x(const Scene& s) { return 3 * static_cast<Eigen::Index>(s.bodies.size()) - 3; }

}  // namespace

TEST_CASE("20 light links with 1000 kg at their end: all integrators at 1 ms") {
  const Scene s = with_ball(1000);
  for (const char* integrator : kAllSchemes) {
    CAPTURE(integrator);
    const Run r = run(s, integrator, 1e-3);
    CAPTURE(r.why);
    REQUIRE(r.status == Status::solved);
    CHECK(std::abs(r.final.q[last_x(s)] + 1.93274) < 0.005);
    CHECK(r.max_joint_residual < 1e-9);
    CHECK(std::abs(r.energy_final - r.energy_initial) < 0.01 * 1000 * 9.81 * 2);
  }
}

TEST_CASE("chains of 100 links with mass ratios of 1e6: heavy end, heavy start, heavy ones between") {
  for (const int kind : {0, 1, 2}) {
    LinkChain c{.masses = std::vector<double>(100, 0.1)};
    if (kind == 0) c.masses.back() = 1e5;
    if (kind == 1) c.masses.front() = 1e5;
    if (kind == 2)
      for (std::size_t i = 0; i < c.masses.size(); i += 10) c.masses[i] = 1e5;
    Scene s = chain(c);
    s.duration = 0.1;
    const Run fine = run(s, "moreau-jean", 1e-4);
    REQUIRE(fine.status == Status::solved);
    for (const char* integrator : kFixedStepSchemes) {
      CAPTURE(kind);
      CAPTURE(integrator);
      const Run r = run(s, integrator, 1e-3);
      CAPTURE(r.why);
      REQUIRE(r.status == Status::solved);
      CHECK((r.final.q - fine.final.q).lpNorm<Eigen::Infinity>() < 0.2);
      CHECK(std::abs(r.final.q[last_x(s) + 1] - fine.final.q[last_x(s) + 1]) < 0.02);
    }
  }
}

TEST_CASE("generalized-alpha: an ordinary four-bar at steps in which its bars turn by up to 0.3 rad") {
  // Crank, coupler and rocker, a torque on the crank; from a new user's first mechanism.
  Scene s;
  s.gravity = {0, -9.81};
  s.body({.mass = 0.5, .inertia = 5e-4, .position = {0, 0.05}, .angle = std::acos(-1.0) / 2, .omega = 20});
  s.body({.mass = 1, .inertia = 7.5e-3, .position = {0.141547, 0.149642}, .angle = 0.337307});
  s.body({.mass = 0.8, .inertia = 3e-3, .position = {0.291547, 0.099642}, .angle = 1.655424});
  s.joint(Revolute{"", kGround, 0, {0, 0}, {-0.05, 0}});
  s.joint(Revolute{"", 0, 1, {0.05, 0}, {-0.15, 0}});
  s.joint(Revolute{"", kGround, 2, {0.3, 0}, {-0.1, 0}});
  s.joint(Revolute{"", 1, 2, {0.15, 0}, {0.1, 0}});
  s.load({.name = "", .body = 0, .torque = 0.6});
  s.duration = 1.5;
  const Run coarse = run(s, "generalized-alpha", 5e-3);
  CAPTURE(coarse.why);
  CHECK(coarse.status == Status::solved);  // once: its last pass moved q by 1.5e-11 m
  s.duration = 0.3;
  const Run right = run(s, "adaptive:rtol=1e-9", 1e-2);
  const Run here = run(s, "generalized-alpha", 5e-3);
  CHECK((here.final.q - right.final.q).lpNorm<Eigen::Infinity>() < 0.05);
}
