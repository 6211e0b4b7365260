// Painlevé's paradox in space: instants without a solution, or with several, and what adaptive makes of them.
#include "tests/support/spatial.h"

#include <orthant/core/scenes/painleve_rod.h>

#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

using namespace orthant;

namespace {

const Eigen::Quaterniond kOblique(Eigen::AngleAxisd(1.1, Vector3d(0.3, -1, 0.5).normalized()));

/// Painlevé's rod of painleve_rod.h in space, in a plane of any orientation.
spatial::Scene rod_in_space(const PainleveRod& p) {
  const double c = std::cos(p.angle), s = std::sin(p.angle);
  spatial::Scene scene;
  scene.gravity = kOblique * Vector3d(0, -p.g, 0);
  const Eigen::Quaterniond R = kOblique * Eigen::AngleAxisd(p.angle, Vector3d::UnitZ());
  scene.body({.name = "rod",
              .mass = 1,
              .inertia = Vector3d(0.01, 1.0 / 3, 1.0 / 3).asDiagonal(),
              .position = kOblique * Vector3d(c, s, 0),
              .orientation = {R.w(), R.x(), R.y(), R.z()},
              .velocity = kOblique * Vector3d(-p.slide - p.omega * s, p.omega * c, 0),
              .omega = kOblique * Vector3d(0, 0, p.omega)});
  scene.contact(
      spatial::SpherePlane{"tip", 0, {-1, 0, 0}, 0, kGround, {0, 0, 0}, kOblique * Vector3d(0, 1, 0), {.mu = p.mu}});
  return scene;
}

Run one_step(const spatial::Scene& scene, double h, std::string_view integrator = "event-driven",
             double* normal = nullptr) {
  const SpatialSystem system(scene);
  const auto scheme = make_integrator(integrator, system);
  const auto solver = make_solver("auto");
  return simulate(*scheme, *solver, {.step = h, .duration = h}, RecorderOf<Spatial>([&](const SpatialSample& m) {
    if (normal != nullptr) *normal += m.impulses[0].normal;
  }));
}

}  // namespace

TEST_CASE("Painlevé in space: a rod's tip has one solution, none, or several, and the run says which") {
  const double h = 1e-6;
  double pressed = 0, lifted = 0;
  CHECK(one_step(rod_in_space({.mu = 1}), h, "event-driven", &pressed).status == Status::solved);
  CHECK(pressed / h == doctest::Approx(PainleveRod{.mu = 1}.forces().at(0)).epsilon(1e-5));
  CHECK(one_step(rod_in_space({.mu = 1, .omega = 4}), h, "event-driven", &lifted).status == Status::solved);
  CHECK(lifted == 0);
  const Run none = one_step(rod_in_space({.mu = 1.5}), h);
  CHECK(none.status == Status::infeasible);
  CHECK(none.why ==
        "no acceleration-level solution (none: friction and contact are inconsistent here, Painleve), at t = 0");
  const Run several = one_step(rod_in_space({.mu = 1.5, .omega = 4}), h);
  CHECK(several.status == Status::unsupported);
  CHECK(several.why.find("several acceleration-level solutions (Painleve), normal forces [N]: (0) (22.5041752") == 0);
  CHECK(several.final.t == 0);
  for (const double omega : {0.0, 4.0}) {
    const Run crossed = one_step(rod_in_space({.mu = 1.5, .omega = omega}), 1e-3, "adaptive");
    CHECK(crossed.status == Status::solved);
    CHECK(crossed.crossings > 0);
  }
}

TEST_CASE("Painlevé in space: a tip at rest may open, stick or slide off, and all solutions are reported") {
  // With tan φ = 2 and ω = 4: A = (1.6, −1.2; −1.2, 3.4), b = (16 sin φ − g, −20). It opens. Friction that is great
  // enough can hold it as well, or be at its bound while the tip slides off backwards.
  const double phi = PainleveRod{}.angle, up = 16 * std::sin(phi) - PainleveRod{}.g;
  const double held = (20 * 1.2 - 3.4 * up) / 4, slid = up / (1.2 * 3.5 - 1.6);
  REQUIRE(held > 0);
  for (const double mu : {0.5, 2.5, 3.5}) {
    CAPTURE(mu);
    spatial::Scene s = rod_in_space({.mu = mu, .omega = 4});
    s.bodies[0].velocity = kOblique * Vector3d(-4 * std::sin(phi), 4 * std::cos(phi), 0);
    s.gravity = kOblique * Vector3d(-20 - 16 * std::cos(phi), -PainleveRod{}.g, 0);
    const Run run = one_step(s, 1e-6);
    if (mu < 3) {
      CHECK(run.status == Status::solved);
      continue;
    }
    CHECK(run.status == Status::unsupported);
    std::istringstream words(run.why.substr(run.why.find(':') + 1));
    std::vector<double> forces;
    for (char c = 0; words >> c && c == '(';) words >> forces.emplace_back() >> c;
    REQUIRE(forces.size() == 3);
    CHECK(forces[0] == 0);
    CHECK(forces[1] == doctest::Approx(held).epsilon(1e-12));
    CHECK(forces[2] == doctest::Approx(slid).epsilon(1e-12));
  }
}

TEST_CASE(
    "a ball falls into a groove in space: friction that jams it and restitution contradict each other as in the "
    "plane") {
  const double steep = 0.35;  // [rad] from the vertical: friction holds what lies there from its tangent on
  const auto fall = [&](double mu, double e, std::string_view integrator) {
    const double g = 9.81;
    spatial::Scene s;
    s.gravity = kOblique * Vector3d(0, -g, 0);
    const auto ball = s.body({.name = "ball",
                              .mass = 1,
                              .inertia = Vector3d::Constant(0.004).asDiagonal(),
                              .position = kOblique * Vector3d(0, 0.5, 0)});
    for (const double side : {-1.0, 1.0})
      s.contact(spatial::SpherePlane{side < 0 ? "left" : "right",
                                     ball,
                                     {0, 0, 0},
                                     0.1,
                                     kGround,
                                     {0, 0, 0},
                                     kOblique * Vector3d(side * std::cos(steep), std::sin(steep), 0),
                                     {.mu = mu, .e = e}});
    return one_step(s, 0.5, integrator);
  };
  const double jams = std::tan(steep);
  for (const char* integrator : {"event-driven", "adaptive"}) {
    CAPTURE(integrator);
    CHECK(fall(0.99 * jams, 0.5, integrator).status == Status::solved);
    CHECK(fall(1.01 * jams, 0, integrator).status == Status::solved);
    for (const double mu : {1.01 * jams, 0.8}) {
      CAPTURE(mu);
      const Run none = fall(mu, 0.2, integrator);
      CHECK(none.status == Status::infeasible);
      CHECK(
          none.why.starts_with("friction jams contacts \"left\", \"right\", which restitution throws apart: no "
                               "impulse satisfies Newton's law and Coulomb's there"));
    }
  }
}
