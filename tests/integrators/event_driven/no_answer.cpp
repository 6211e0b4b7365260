// Instants without an answer, or with several: Painlevé, jamming, solvers that give up.
#include "tests/support/event_record.h"
#include "tests/support/runs.h"

#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/motion.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

namespace {

/// A rod's lower tip slides on the floor, in the sense in which friction presses it down.
Scene sliding_rod(double mu, double omega, double phi = std::atan(2.0)) {
  Scene s;
  s.gravity = {0, -kGravity};
  const auto rod = s.body({.name = "rod",
                           .mass = 1,
                           .inertia = 1.0 / 3,
                           .position = {std::cos(phi), std::sin(phi)},
                           .angle = phi,
                           .velocity = {-1 - omega * std::sin(phi), omega * std::cos(phi)},
                           .omega = omega});
  s.contact(CornerWall{"tip", rod, {-1, 0}, kGround, {0, 0}, {0, 1}, {.mu = mu}});
  return s;
}

}  // namespace

TEST_CASE("Painlevé: a rod's tip has one solution, none, or several, and the run says which") {
  for (const std::string_view solver : {"lemke", "pgs", "enumerate"}) {
    CAPTURE(solver);
    const double h = 1e-6;
    const EventRecord pressed = tell(sliding_rod(1, 0), h, h, solver);
    CHECK(pressed.sum[0].normal / h == doctest::Approx(24.525).epsilon(1e-5));
    const EventRecord lifted = tell(sliding_rod(1, 4), h, h, solver);
    CHECK(lifted.run.status == Status::solved);
    CHECK(lifted.sum[0].normal == 0);
    const EventRecord none = tell(sliding_rod(1.5, 0), h, h, solver);
    CHECK(none.run.status != Status::solved);
    CHECK(none.run.why.find("none") != std::string::npos);
    const EventRecord several = tell(sliding_rod(1.5, 4), h, h, solver);
    CHECK(several.run.status == Status::unsupported);
    CHECK(several.run.why.find("several") != std::string::npos);
    CHECK(several.run.why.find("22.50417527999") != std::string::npos);
    CHECK(several.run.final.t == 0);
  }
}

TEST_CASE(
    "a disc falls into a groove: friction that jams it and restitution that throws it out contradict each other") {
  const auto fall = [](double mu, double e) {
    Scene s{.gravity = {0, -kGravity}};
    const auto disc = s.body({.name = "disc", .mass = 1, .inertia = 0.005, .position = {0, 0.5}});
    const double steep = 0.35;  // [rad] from the vertical: friction holds what lies there from its tangent on
    for (const double side : {-1.0, 1.0}) {
      const Vector2d normal(side * std::cos(steep), std::sin(steep));
      s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, {0, 0}, normal, {.mu = mu, .e = e}});
    }
    return tell(s, 0.5, 0.01);
  };
  const double jams = std::tan(0.35);
  CHECK(fall(0.99 * jams, 0.5).run.status == Status::solved);
  CHECK(fall(1.01 * jams, 0).run.status == Status::solved);
  const EventRecord none = fall(1.01 * jams, 0.5);
  CHECK(none.run.status == Status::infeasible);
  CHECK(none.run.why.find("friction jams contacts") != std::string::npos);
  CHECK(none.run.final.t == doctest::Approx(std::sqrt(2 * (0.5 - 0.1 / std::sin(0.35)) / kGravity)).epsilon(1e-9));
}

TEST_CASE("a solver that gives up at an impact proves nothing, where walls without play contradict by rounding alone") {
  class GivesUp final : public Solver {
    Claim run(const Lcp&, Solution& s, Start) override {
      s.z.setZero();
      return Claim::stalled;
    }
    double tolerance() const override { return 1e-10; }
  } solver;
  int impacts = 0;
  for (int k = 1; k <= 40; ++k) {
    Scene s;
    const double angle = 0.1 * k;
    const Vector2d along(std::cos(angle), std::sin(angle)), across(-std::sin(angle), std::cos(angle));
    const auto disc = s.body({.name = "disc", .mass = 1, .inertia = 0.005, .velocity = 5 * along});
    const ContactLaw law{.mu = 0.1, .e = 0.5};
    s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, -0.1 * across, across, law});
    s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, 0.1 * across, (-(1 + 0.1 * k) * across).normalized(), law});
    s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, 1.1 * along, -along, law});
    const System system(s);
    const Run run = simulate(*make_integrator(kScheme, system), solver, {.step = 0.01, .duration = 0.5});
    CAPTURE(k);
    CHECK(run.status != Status::infeasible);
    impacts += run.why == "the impact was not solved";
  }
  CHECK(impacts > 20);
}

TEST_CASE("a hexagon that comes to rest wedged in a notch is held by forces within its cones: no paradox") {
  const Scene notch = parse_scene(R"(
    gravity = [0, -9.81]
    duration = 0.7
    step = 0.001

    [[body]]
    name = "b"
    mass = 1.0
    inertia = 0.001343254069575512
    position = [-0.14961728324966012, 0.6210599000403126]
    angle = 2.3996832414426263
    velocity = [0.23738485662146624, 0.0]
    omega = -0.3379038042224991

    [[contact]]
    type = "chain"
    name = "c"
    bodies = ["b", "ground"]
    points = [[-1.330460482618733, 2.688842670032951], [0.0, 0.0], [-0.03995383234344058, 2.99973393674857]]
    mu = 0.6
    e_n = 0.5
    corners = [
      [0.051831536145005616, 0.0],
      [0.025915768072502815, 0.044887427018746213],
      [-0.025915768072502798, 0.04488742701874622],
      [-0.051831536145005616, 6.3475324834871474e-18],
      [-0.025915768072502832, -0.0448874270187462],
      [0.025915768072502815, -0.044887427018746213]]
  )");
  for (const std::string scheme : {"event-driven", "adaptive"}) {
    CAPTURE(scheme);
    const Run r = run(notch, scheme, 1e-3);
    CHECK_MESSAGE(r.status == Status::solved, r.why);
    CHECK(r.final.v.norm() < 1e-8);
  }
}

TEST_CASE("a stop at a mechanism's singular pose: a run that fails ends at a state that keeps its joints") {
  const Scene flat = parse_scene(R"(
    duration = 0.5
    step = 0.001
    gravity = [0.0, -9.81]

    [[body]]
    name = "l"
    mass = 1.0
    inertia = 0.013333333333333336
    position = [0.10806046117362796, 0.16829419696157932]
    angle = 1.0

    [[body]]
    name = "r"
    mass = 1.0
    inertia = 0.013333333333333336
    position = [0.7080604611736279, 0.16829419696157932]
    angle = 1.0

    [[body]]
    name = "c"
    mass = 1.0
    inertia = 0.03
    position = [0.5161209223472559, 0.33658839392315865]
    angle = 0.0

    [[joint]]
    type = "revolute"
    name = "A"
    bodies = ["ground", "l"]
    point_b = [-0.2, 0.0]

    [[joint]]
    type = "revolute"
    name = "B"
    bodies = ["ground", "r"]
    point_a = [0.6, 0.0]
    point_b = [-0.2, 0.0]

    [[joint]]
    type = "revolute"
    name = "Cc"
    bodies = ["l", "c"]
    point_a = [0.2, 0.0]
    point_b = [-0.3, 0.0]

    [[joint]]
    type = "revolute"
    name = "Dd"
    bodies = ["r", "c"]
    point_a = [0.2, 0.0]
    point_b = [0.3, 0.0]

    [[contact]]
    type = "limit"
    name = "s"
    joint = "A"
    lower = -5.0
    e_n = 0.0

    [[contact]]
    type = "limit"
    name = "k"
    joint = "Dd"
    upper = 0.0
    e_n = 0.5
  )");
  const Run r = run(flat, "adaptive", 1e-3);
  CHECK(r.status != Status::solved);
  const System system(flat);
  CHECK(off_most(system, r.final.t, r.final.q).off < 1e-9);
  CHECK(std::abs(r.energy_final - r.energy_initial) < 1e-6);
}
