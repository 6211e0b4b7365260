// Rolling and spinning friction, moving surfaces and orthotropic friction in space, against closed forms.
#include "experiments/support/fit_order.h"
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

namespace {

const Eigen::Quaterniond kTilted(Eigen::AngleAxisd(0.7, Vector3d(-1, 0.4, 2).normalized()));

/// A ball of 2 kg and 0.1 m on a floor, all turned.
spatial::Scene ball_on(const Eigen::Quaterniond& R, const Vector3d& x, const Vector3d& v, const Vector3d& omega,
                       ContactLaw law) {
  spatial::Scene s;
  s.gravity = R * Vector3d(0, 0, -10);
  const auto ball = s.body({.name = "ball",
                            .mass = 2,
                            .inertia = Vector3d::Constant(0.4 * 2 * 0.01).asDiagonal(),
                            .position = R * (x + Vector3d(0, 0, 0.1)),
                            .velocity = R * v,
                            .omega = R * omega});
  for (Vector3d* each : {&law.surface.velocity, &law.surface.omega, &law.surface.centre, &law.surface.direction})
    *each = R * *each;
  s.contact(spatial::SpherePlane{"floor", ball, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, R * Vector3d(0, 0, 1), law});
  return s;
}

Vector3d place_in(const Eigen::Quaterniond& R, const Run& run) {
  return R.inverse() * Vector3d(place_of<Spatial>(run.final.q, 0)) - Vector3d(0, 0, 0.1);
}

spatial::Scene box_on(const Eigen::Quaterniond& R, const Vector3d& v, const ContactLaw& law) {
  spatial::Scene s = ball_on(R, {0, 0, 0}, v, {0, 0, 0}, law);
  const ContactLaw turned = std::get<spatial::SpherePlane>(s.contacts[0]).law;
  s.contacts.clear();
  s.bodies[0].orientation = {R.w(), R.x(), R.y(), R.z()};
  s.contact_set(spatial::corners_plane({.name = "floor", .a = 0, .normal = R * Vector3d(0, 0, 1), .law = turned},
                                       spatial::box_corners({0.4, 0.3, 0.1})));
  return s;
}

}  // namespace

TEST_CASE("rolling friction stops a ball that rolls where it should, in any direction") {
  // m R² (1 + 2/5) ω̇ = −ρ m g:  a = ρ g R / (1.4 R²); it stops after v²/2a.
  const double rho = 2e-3, a = rho * 10 / (1.4 * 0.1);
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle", "paoli-schatzman"})
    for (const Eigen::Quaterniond& R : {Eigen::Quaterniond::Identity(), kTilted}) {
      CAPTURE(scheme);
      const SpatialSystem system(
          ball_on(R, {0, 0, 0}, {0.3, 0.4, 0}, {-4, 3, 0}, {.mu = 0.5, .surface = {.rolling = rho}}));
      const auto error = [&](double h) {
        const Run run = run_in_space(system, scheme, h, 4);
        CHECK(run.final.v.lpNorm<Eigen::Infinity>() < 1e-9);
        return (place_in(R, run) - Vector3d(0.6, 0.8, 0) * 0.25 / (2 * a)).norm();
      };
      const double coarse = error(1e-2), fine = error(1e-3);
      MESSAGE(scheme << ": errors " << coarse << ", " << fine);
      CHECK(fine < (scheme == "moreau-jean" ? 1e-6 : 1e-3));
    }
  // A ball that is pushed along by less than that stays: F R < ρ m g.
  spatial::Scene held = ball_on(kTilted, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {.mu = 0.5, .surface = {.rolling = rho}});
  held.load({.name = "push", .body = 0, .force = kTilted * Vector3d(0.2, 0.3, 0)});
  const SpatialSystem system(held);
  CHECK(place_in(kTilted, run_in_space(system, "moreau-jean", 1e-3, 1)).norm() < 1e-12);
  held.loads[0].force *= 1.2;
  const SpatialSystem moves(held);
  CHECK(place_in(kTilted, run_in_space(moves, "moreau-jean", 1e-3, 1)).norm() > 1e-3);
}

TEST_CASE("spinning friction stops a ball that spins on the spot") {
  // J ω̇ = −σ m g: it stops after J ω² / (2 σ m g).
  const double sigma = 1e-3, J = 0.4 * 2 * 0.01, alpha = sigma * 2 * 10 / J;
  const SpatialSystem system(
      ball_on(kTilted, {0, 0, 0}, {0, 0, 0}, {0, 0, 2}, {.mu = 0.5, .surface = {.spinning = sigma}}));
  const Run run = run_in_space(system, "moreau-jean", 1e-3, 2);
  const State start = system.initial_state();
  const Vector3d turn = quaternions::turn_between(quaternion(start.q, 0), quaternion(run.final.q, 0));
  CHECK(std::abs(turn.norm() - 4 / (2 * alpha)) < 1e-6);
  CHECK(run.final.v.lpNorm<Eigen::Infinity>() < 1e-10);
  CHECK(place_in(kTilted, run).norm() < 1e-12);
  const Run free = run_in_space(SpatialSystem(ball_on(kTilted, {0, 0, 0}, {0, 0, 0}, {0, 0, 2}, {.mu = 0.5})),
                                "moreau-jean", 1e-3, 2);
  CHECK(std::abs(rotation<Spatial>(free.final.v, 0).norm() - 2) < 1e-12);
}

TEST_CASE("a belt takes a box along at μ g until it moves with it, and its work is told") {
  const Vector3d V(0.6, -0.8, 0);
  const ContactLaw law{.mu = 0.25, .surface = {.velocity = V}};
  const SpatialSystem system(box_on(kTilted, {0, 0, 0}, law));
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle", "rattle", "generalized-alpha"}) {
    CAPTURE(scheme);
    const Run run = run_in_space(system, scheme, 1e-3, 1);  // 0.4 s to 1 m/s, 0.2 m
    CHECK((place_in(kTilted, run) - 0.8 * V).norm() < (scheme == "moreau-jean" || scheme == "rattle" ? 1e-5 : 2e-3));
    CHECK((kTilted.inverse() * Vector3d(translation<Spatial>(run.final.v, 0)) - V).norm() < 1e-9);
    CHECK(run.motion.work == doctest::Approx(2).epsilon(0.01));  // m V² = 2 J: half of it heats the belt
  }
}

TEST_CASE("a ball on a turntable rolls on a circle, two sevenths as fast") {
  // n × v: its centre's velocity turns at 2/7 Ω, wherever the table's axis is.
  const double Omega = 3.5, R = 0.1, w = 2.0 / 7 * Omega;
  const Vector3d n(0, 0, 1), centre(0.2, -0.1, 0), v(0.3, 0.1, 0), r = -centre;
  const Vector3d surface = Omega * n.cross(r), omega = n.cross(v - surface) / R;
  const ContactLaw law{.mu = 1, .surface = {.omega = Omega * n, .centre = centre}};
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle"}) {
    CAPTURE(scheme);
    const SpatialSystem system(ball_on(kTilted, {0, 0, 0}, v, omega, law));
    const double duration = 2;
    const Vector3d to = v.cross(n) / w;  // from the circle's middle to the start: x = −n × v / w …
    const Vector3d exact = -Eigen::AngleAxisd(w * duration, n).toRotationMatrix() * (-to) - to;
    const auto error = [&](double h) {
      return (place_in(kTilted, run_in_space(system, scheme, h, duration)) - exact).norm();
    };
    const Fit fit = fit_order({.coarsest = 0.02, .octaves = 4, .steps_per_octave = 3, .duration = duration}, error);
    MESSAGE(scheme << ": order " << fit.order << ", scatter " << fit.scatter << ", error " << fit.worst.back().error);
    CHECK(std::abs(fit.order - 1) < 0.1);
    CHECK(fit.worst.back().error < 5e-3);
  }
}

TEST_CASE("orthotropic friction: a box that slides obliquely curves as the ellipse says, order 1") {
  // γ̇_i = −g μ_i² γ_i / (Σ μ_j² γ_j²)^½: γ₁/γ₁(0) = (γ₂/γ₂(0))^k, k = (μ₁/μ₂)² = 2; and it stops along t2.
  const double mu = 0.3, across = mu / std::sqrt(2.0);
  const Vector3d d(std::cos(0.4), std::sin(0.4), 0), t(-d.y(), d.x(), 0);
  const SpatialSystem system(
      box_on(kTilted, 2 * d + 1 * t, {.mu = mu, .surface = {.mu_across = across, .direction = d}}));
  const auto off = [&](std::string_view scheme, double h) {
    const Run run = run_in_space(system, scheme, h, 0.4);
    const Vector3d v = kTilted.inverse() * Vector3d(translation<Spatial>(run.final.v, 0));
    const double one = v.dot(d), other = v.dot(t);
    CHECK(one > 0.2);
    CHECK(other < 0.8);
    CHECK(std::abs(v.z()) < 1e-6);
    return std::abs(one / 2 - other * other);
  };
  const Fit fit = fit_order({.coarsest = 0.02, .octaves = 4, .steps_per_octave = 3, .duration = 0.4},
                            [&](double h) { return off("moreau-jean", h); });
  MESSAGE("order " << fit.order << ", scatter " << fit.scatter << ", error " << fit.worst.back().error);
  CHECK(std::abs(fit.order - 1) < 0.1);
  CHECK(fit.worst.back().error < 3e-3);
  CHECK(off("stewart-trinkle", 1e-3) < 3e-3);
  CHECK(off("rattle", 1e-3) < 3e-3);
  // The isotropic law with the same μ does not curve.
  const SpatialSystem straight(
      box_on(kTilted, 2 * d + 1 * t, {.mu = mu, .surface = {.mu_across = mu, .direction = d}}));
  const Run run = run_in_space(straight, "moreau-jean", 1e-3, 0.4);
  const Vector3d v = kTilted.inverse() * Vector3d(translation<Spatial>(run.final.v, 0));
  CHECK((v.normalized() - (2 * d + t).normalized()).norm() < 1e-9);
}

TEST_CASE("a box rests on a slope whose friction suffices along it, and slides where it does not") {
  const double slope = 0.3;
  for (const bool along : {true, false}) {
    spatial::Scene s = box_on(Eigen::Quaterniond::Identity(), {0, 0, 0},
                              {.mu = 0.5, .surface = {.mu_across = 0.2, .direction = {1, 0, 0}}});
    s.gravity = along ? Vector3d(10 * std::sin(slope), 0, -10 * std::cos(slope))
                      : Vector3d(0, 10 * std::sin(slope), -10 * std::cos(slope));
    const SpatialSystem system(s);
    const Run run = run_in_space(system, "moreau-jean", 1e-3, 1);
    const double a = along ? 0 : 10 * (std::sin(slope) - 0.2 * std::cos(slope));
    CHECK(std::abs(place_in(Eigen::Quaterniond::Identity(), run).norm() - a / 2) < 1e-9);
  }
}

TEST_CASE("surfaces' laws are read from TOML, and mistakes in them are named") {
  const std::string text = R"(dimension = 3
gravity = [0, 0, -10]
[[body]]
name = "ball"
mass = 1
inertia = 0.004
[[contact]]
name = "floor"
type = "sphere-wall"
body = "ball"
radius = 0.1
wall = {normal = [0, 0, 1]}
mu = 0.3
mu_across = 0.2
direction = [0, 3, 0]
rolling = 0.001
spinning = 0.002
surface = {velocity = [1, 0, 0], omega = [0, 0, 2], centre = [0.5, 0, 0]}
)";
  const auto scene = [&](std::vector<std::string> overrides) {
    return std::get<spatial::Scene>(parse_any_scene(text, overrides, "floor.toml"));
  };
  const ContactLaw law = std::get<spatial::SpherePlane>(scene({}).contacts.at(0)).law;
  CHECK(law.surface.mu_across == 0.2);
  CHECK(law.surface.direction == Vector3d(0, 1, 0));
  CHECK(law.surface.rolling == 0.001);
  CHECK(law.surface.spinning == 0.002);
  CHECK(law.surface.velocity == Vector3d(1, 0, 0));
  CHECK(law.surface.omega == Vector3d(0, 0, 2));
  CHECK(law.surface.centre == Vector3d(0.5, 0, 0));
  const auto refusal = [&](const std::string& one) -> std::string {
    try {
      scene({one});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  CHECK(refusal("contact.floor.rolling=-1").find("rolling = -1: must be >= 0") != std::string::npos);
  CHECK(refusal("contact.floor.mu=0").find("mu = 0: must be > 0 where mu_across is") != std::string::npos);
  CHECK(refusal("contact.floor.surface.speed=1").find("unknown key \"surface.speed\"") != std::string::npos);
  CHECK(refusal("restitution=\"poisson\"").find("rolling = 0.001: must be 0 where restitution is not newton") !=
        std::string::npos);
  const SpatialSystem system(scene({}));
  for (const std::string scheme : {"rattle", "generalized-alpha", "anitescu-potra"})
    CHECK_THROWS_WITH_AS(static_cast<void>(make_integrator(scheme, system)),
                         doctest::Contains(("integrator " + scheme +
                                            ": contact \"floor\" has rolling = 0.001: must be "
                                            "0, or the integrator one of moreau-jean")
                                               .c_str()),
                         std::invalid_argument);
}

TEST_CASE("orthotropic friction: an impact that slides square to `direction` reports mu_across times its impulse") {
  const ContactLaw law{.mu = 0.1, .surface = {.mu_across = 0.2, .direction = {1, 0, 0}}};
  const SpatialSystem system(ball_on(kTilted, {0, 0, 0.1}, {0, 5, -1}, {0, 0, 0}, law));
  int impacts = 0;
  run_in_space(system, "event-driven", 1e-2, 0.2, [&](const RunSampleOf<Spatial>& moment) {
    for (const Event& e : moment.events)
      if (e.kind == EventKind::impact && e.normal > 1) {
        ++impacts;
        CHECK(std::abs(e.tangent - 0.2 * e.normal) < 1e-9 * e.normal);
      }
  });
  CHECK(impacts == 1);
}
