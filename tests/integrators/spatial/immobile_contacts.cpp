// Contacts in space that joints immobilise: the motion is the one without them, in every frame, by every integrator.
#include "tests/support/mechanics.h"
#include "tests/support/spatial.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

using namespace orthant;
using orthant::testing::Draws;

namespace {

using Turn = Eigen::Quaterniond;

const std::vector<std::string> kIntegratorsInSpace = {"moreau-jean",        "stewart-trinkle",   "anitescu-potra",
                                                      "paoli-schatzman",    "generalized-alpha", "rattle",
                                                      "adaptive:rtol=1e-9", "event-driven"};
const ContactLaw kRoughInSpace{.mu = 0.5, .e = 0.3};

Turn random_turn(Draws& draws) {
  const auto one = [&] { return draws(-1, 1); };
  Turn Q(one(), one(), one(), one());
  return Q.normalized();
}

spatial::Scene pulled(const Turn& Q) {
  spatial::Scene s;
  s.gravity = Q * Vector3d(0, 0, -9.81);
  return s;
}

/// On a guide along x, its centre on a wall across it: the weight presses it onto guide and wall alike.
spatial::Scene on_guide(const Turn& Q) {
  spatial::Scene s = pulled(Q);
  s.body({.name = "b", .velocity = Q * Vector3d(1, 0, 0)});
  s.joint(spatial::Prismatic{"guide", kGround, 0, {0, 0, 0}, {0, 0, 0}, Q * Vector3d(1, 0, 0)});
  s.contact(spatial::SpherePlane{"wall", 0, {0, 0, 0}, 0, kGround, {0, 0, 0}, Q * Vector3d(0, 0, 1), kRoughInSpace});
  return s;
}

/// Four corners of a block on that guide.
spatial::Scene block_on_guide(const Turn& Q) {
  spatial::Scene s = on_guide(Q);
  s.contacts.clear();
  for (const double x : {-0.1, 0.1})
    for (const double y : {-0.1, 0.1})
      s.contact(spatial::SpherePlane{x < 0 ? (y < 0 ? "a" : "b") : (y < 0 ? "c" : "d"), 0, Q * Vector3d(x, y, -0.1), 0,
                                     kGround, Q * Vector3d(0, 0, -0.1), Q * Vector3d(0, 0, 1), kRoughInSpace});
  return s;
}

/// A flywheel with a brake on its face; its hinge takes all of the weight.
spatial::Scene flywheel(const Turn& Q) {
  spatial::Scene s = pulled(Q);
  const Vector3d axis = Q * Vector3d(0, 0, 1);
  s.body({.name = "b", .omega = 3 * axis});
  s.joint(spatial::Revolute{"hinge", kGround, 0, {0, 0, 0}, {0, 0, 0}, axis, axis});
  s.contact(spatial::SpherePlane{"brake", 0, {0, 0, 0}, 0.2, kGround, -0.2 * axis, axis, kRoughInSpace});
  return s;
}

/// A ball on the floor, held at its height by a planar joint.
spatial::Scene at_its_height(const Turn& Q) {
  spatial::Scene s = pulled(Q);
  const Vector3d axis = Q * Vector3d(0, 0, 1);
  s.body({.name = "b", .velocity = Q * Vector3d(1, 0.5, 0)});
  s.joint(spatial::PlaneJoint{"plane", kGround, 0, {0, 0, 0}, {0, 0, 0}, axis, axis});
  s.contact(spatial::SpherePlane{"floor", 0, {0, 0, 0}, 0.3, kGround, -0.3 * axis, axis, kRoughInSpace});
  return s;
}

/// By a drive, which lifts it at `rate`.
spatial::Scene driven_height(const Turn& Q, double rate, double gap = 0) {
  spatial::Scene s = pulled(Q);
  const Vector3d axis = Q * Vector3d(0, 0, 1);
  s.body({.name = "b", .velocity = Q * Vector3d(1, 0.5, rate)});
  s.joint(spatial::Drive{"height", spatial::Slide{kGround, 0, {0, 0, 0}, {0, 0, 0}, axis}, {.rate_of_change = rate}});
  s.contact(spatial::SpherePlane{"floor", 0, {0, 0, 0}, 0, kGround, -gap * axis, axis, kRoughInSpace});
  return s;
}

/// Two sliders on parallel guides, with a wall of the one on the other.
spatial::Scene side_by_side(const Turn& Q) {
  spatial::Scene s = on_guide(Q);
  s.contacts.clear();
  s.body({.name = "c", .mass = 3, .position = Q * Vector3d(0, 0, -0.4)});
  s.joint(spatial::Prismatic{"other", kGround, 1, Q * Vector3d(0, 0, -0.4), {0, 0, 0}, Q * Vector3d(1, 0, 0)});
  s.contact(spatial::SpherePlane{
      "between", 0, {0, 0, 0}, 0.2, 1, Q * Vector3d(0, 0, 0.2), Q * Vector3d(0, 0, 1), kRoughInSpace});
  return s;
}

}  // namespace

TEST_CASE("in space: contacts that joints immobilise leave the motion as it is without them, however it is turned") {
  const std::vector<std::pair<const char*, std::function<spatial::Scene(const Turn&)>>> scenes = {
      {"guide", on_guide},
      {"block", block_on_guide},
      {"flywheel", flywheel},
      {"planar", at_its_height},
      {"drive", [](const Turn& Q) { return driven_height(Q, 0); }},
      {"lifted", [](const Turn& Q) { return driven_height(Q, 0.2); }},
      {"side by side", side_by_side}};
  Draws draws(71);
  for (int k = 0; k < 12; ++k) {
    const Turn Q = k == 0 ? Turn::Identity() : random_turn(draws);
    for (const auto& [name, scene] : scenes) {
      INFO("scene ", std::string(name));
      CAPTURE(k);
      const SpatialSystem system(scene(Q));
      const State start = system.initial_state();
      for (const std::string& integrator : kIntegratorsInSpace) {
        CAPTURE(integrator);
        const Run run = run_in_space(system, integrator, 0.05, 1);
        CHECK((run.final.v - start.v).lpNorm<Eigen::Infinity>() < 1e-9);  // bodies go on as they started
        for (Index b = 0; b < system.bodies(); ++b)
          CHECK((place_of<Spatial>(run.final.q, b) - place_of<Spatial>(start.q, b) - translation<Spatial>(start.v, b))
                    .norm() < 1e-9);
      }
    }
  }
}

TEST_CASE("in space: a drive that presses an immobile contact shut is reported as a jam by every integrator") {
  constexpr double kSpeed = 0.2, kGap = 0.0123, kStep = 0.01, kDue = kGap / kSpeed;
  Draws draws(72);
  for (int k = 0; k < 4; ++k) {
    const Turn Q = k == 0 ? Turn::Identity() : random_turn(draws);
    const SpatialSystem system(driven_height(Q, -kSpeed, kGap));
    for (const std::string& integrator : kIntegratorsInSpace) {
      CAPTURE(k);
      CAPTURE(integrator);
      const auto scheme = make_integrator(integrator, system);
      const Run run = simulate(*scheme, *make_solver("auto"), {.step = kStep, .duration = 0.5}, {});
      CHECK(run.status == Status::infeasible);
      CHECK(run.why.starts_with("jammed: drive \"height\", contact \"floor\" leave no motion; since t = 0.06"));
      CHECK(std::abs(run.final.t - kDue) < 1.5 * kStep);
    }
  }
}

TEST_CASE("in space: a drive that swings a little way through an immobile contact is reported as a jam, too") {
  constexpr double kSwing = 0.01, kOmega = 10, kGap = 0.99 * kSwing;  // a tenth of a millimetre: far from any length
  const double due = std::acos(-kGap / kSwing) / kOmega;
  Draws draws(73);
  for (int k = 0; k < 3; ++k) {
    const Turn Q = k == 0 ? Turn::Identity() : random_turn(draws);
    spatial::Scene scene = driven_height(Q, 0, kGap);
    scene.joints.clear();
    scene.bodies[0].position = Q * Vector3d(0, 0, kSwing), scene.bodies[0].velocity = {0, 0, 0};
    const Vector3d axis = Q * Vector3d(0, 0, 1);
    scene.joint(spatial::Drive{"height",
                               spatial::Slide{kGround, 0, {0, 0, 0}, {0, 0, 0}, axis},
                               {.amplitude = kSwing, .omega = kOmega, .phase = M_PI / 2}});
    const SpatialSystem system(scene);
    for (const std::string& integrator : kIntegratorsInSpace) {
      CAPTURE(k);
      CAPTURE(integrator);
      const auto scheme = make_integrator(integrator, system);
      const Run run = simulate(*scheme, *make_solver("auto"), {.step = 1e-3, .duration = 0.5}, {});
      CHECK(run.status == Status::infeasible);
      CHECK(run.why.starts_with("jammed: drive \"height\", contact \"floor\" leave no motion"));
      CHECK(std::abs(run.final.t - due) < 2e-3);
    }
  }
}

TEST_CASE("in space: relaxed cones that a drive contradicts only through slip stall; a jam stays one") {
  // A jaw comes down on a ball in a wedge: without friction the ball goes out along x.
  const auto wedge = [](double angle, double mu) {
    spatial::Scene s;
    const BodyId jaw = s.body({.name = "jaw", .velocity = {0, 0, -1}}), ball = s.body({.name = "ball", .mass = 2});
    s.joint(spatial::Prismatic{"rail", kGround, jaw, {0, 0, 0}, {0, 0, 0}, {0, 0, 1}});
    s.joint(
        spatial::Drive{"ram", spatial::Slide{kGround, jaw, {0, 0, 0}, {0, 0, 0}, {0, 0, 1}}, {.rate_of_change = -1}});
    const Vector3d up(std::sin(angle), 0, std::cos(angle)), down(up.x(), 0, -up.z());
    s.contact(spatial::SpherePlane{"wall", ball, {0, 0, 0}, 0.1, kGround, -0.1 * up, up, {.mu = mu}});
    s.contact(spatial::SpherePlane{"face", ball, {0, 0, 0}, 0.1, jaw, -0.1 * down, down, {.mu = mu}});
    return s;
  };
  const auto step_of = [](const spatial::Scene& scene) {
    const SpatialSystem system(scene);
    const auto scheme = make_integrator("anitescu-potra", system);
    return simulate(*scheme, *make_solver("auto"), {.step = 1e-3, .duration = 1e-3}, {});
  };
  CHECK(step_of(wedge(0.2, 0.1)).status == Status::solved);  // 0.2 rad = atan 0.203
  const Run slips = step_of(wedge(0.2, 0.3));
  CHECK(slips.status == Status::stalled);
  // By name where a proof is exact; these rounded rows are solved by impulses of 1e16, which are no motion.
  CHECK((slips.why.starts_with("the relaxed friction cones of contacts \"wall\", \"face\"") ||
         slips.why.find("as stalled") != std::string::npos));
  const Run shut = step_of(wedge(0, 0.3));
  CHECK(shut.status == Status::infeasible);
  CHECK(shut.why == "jammed: drive \"ram\", contacts \"wall\" and \"face\" leave no motion; since t = 0");
}
