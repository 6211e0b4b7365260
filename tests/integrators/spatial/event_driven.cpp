// event-driven in space against closed forms to 1e-10, and the slider-crank's golden events in space to 1e-9.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/masse.h>
#include <orthant/core/scenes/slider_crank_space.h>
#include <orthant/core/scenes/top.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

using namespace orthant;

namespace {

constexpr double kClosed = 1e-10;
const Vector3d kUpward(0, 0, 1);
const Eigen::Quaterniond kSkew(Eigen::AngleAxisd(0.9, Vector3d(1, -0.4, 0.7).normalized()));

struct SpatialEventRecord {
  Run run;
  std::vector<Event> events;
  std::vector<Event> of(EventKind kind) const {
    std::vector<Event> some;
    std::copy_if(events.begin(), events.end(), std::back_inserter(some),
                 [&](const Event& e) { return e.kind == kind; });
    return some;
  }
};

SpatialEventRecord record_in_space(const SpatialSystem& system, double duration, double step,
                                   std::string_view integrator = "event-driven") {
  SpatialEventRecord record;
  record.run = run_in_space(system, integrator, step, duration, [&](const SpatialSample& m) {
    record.events.insert(record.events.end(), m.events.begin(), m.events.end());
  });
  CHECK(record.run.crossings == 0);
  return record;
}

Vector3d centre_in(const Run& run, BodyId body = 0) { return place_of<Spatial>(run.final.q, body); }
Vector3d velocity_in(const Run& run, BodyId body = 0) { return translation<Spatial>(run.final.v, body); }

/// A ball of 2 kg and 0.1 m on a floor, all turned by R; x: where it touches, or would.
spatial::Scene ball_above(const Eigen::Quaterniond& R, const Vector3d& x, const Vector3d& v, const Vector3d& omega,
                          const Vector3d& gravity, ContactLaw law) {
  spatial::Scene s;
  s.gravity = R * gravity;
  s.body({.name = "ball",
          .mass = 2,
          .inertia = Vector3d::Constant(0.4 * 2 * 0.01).asDiagonal(),
          .position = R * (x + 0.1 * kUpward),
          .velocity = R * v,
          .omega = R * omega});
  for (Vector3d* each : {&law.surface.velocity, &law.surface.omega, &law.surface.centre, &law.surface.direction})
    *each = R * *each;
  s.contact(spatial::SpherePlane{"floor", 0, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, R * kUpward, law});
  return s;
}

}  // namespace

TEST_CASE("event-driven in space: a ball with oblique spin slides on a parabola, then rolls: closed form to 1e-10") {
  for (const double turned : {0.0, 1.0}) {
    const Eigen::Quaterniond R = Eigen::Quaterniond::Identity().slerp(turned, kSkew);
    const double mu = 0.2, g = 9.81, radius = 0.1, duration = 1.5;
    const Vector3d v(1, 0.3, 0), omega(-17, -29, 40), slip = v - radius * omega.cross(kUpward);
    const Vector3d along = slip.normalized();
    const double rolls = 2 * slip.norm() / (7 * mu * g);
    REQUIRE(rolls < duration);
    const Vector3d roll = v - mu * g * rolls * along;
    const Vector3d end = v * rolls - mu * g / 2 * rolls * rolls * along + (duration - rolls) * roll;
    const SpatialSystem system(ball_above(R, {0, 0, 0}, v, omega, {0, 0, -g}, {.mu = mu}));
    for (const double step : {1.5, 0.01}) {
      CAPTURE(turned);
      CAPTURE(step);
      const SpatialEventRecord record = record_in_space(system, duration, step);
      REQUIRE(record.events.size() == 1);
      CHECK(record.events[0].kind == EventKind::stick);
      CHECK(std::abs(record.events[0].t - rolls) < kClosed);
      CHECK((R.inverse() * centre_in(record.run) - 0.1 * kUpward - end).norm() < kClosed);
      CHECK((R.inverse() * velocity_in(record.run) - roll).norm() < kClosed);
      CHECK((R.inverse() * world_omega(system, record.run.final, 0) - (kUpward.cross(roll) / radius + 40 * kUpward))
                .norm() < 10 * kClosed);
      CHECK(record.run.max_penetration < 1e-13);
    }
  }
}

TEST_CASE("event-driven in space: a block thrown across a slope turns downhill, exact time and place") {
  const double alpha = std::numbers::pi / 6;
  spatial::Scene s;
  s.gravity = {9.81 * std::sin(alpha), 0, -9.81 * std::cos(alpha)};
  s.body({.name = "block", .velocity = {0, 2, 0}});
  s.contact(spatial::SpherePlane{"slope", 0, {0, 0, 0}, 0, kGround, {0, 0, 0}, kUpward, {.mu = 2 * std::tan(alpha)}});
  const SpatialEventRecord record = record_in_space(SpatialSystem(s), 0.4, 0.4);
  REQUIRE(record.events.size() == 1);
  CHECK(record.events[0].kind == EventKind::stick);
  CHECK(std::abs(record.events[0].t - 0.271831464492014951) < kClosed);
  CHECK((centre_in(record.run) - Vector3d(0.0679578661230037377, 0.217465171593611961, 0)).norm() < kClosed);
  CHECK(record.run.final.v.lpNorm<Eigen::Infinity>() < 1e-13);
}

TEST_CASE("event-driven in space: a ball on a turntable rolls on a circle of the exact radius and period") {
  const double Omega = 3.5, rate = 2.0 / 7 * Omega;
  const Vector3d centre(0.2, -0.1, 0), v(0.3, 0.1, 0), surface = Omega * kUpward.cross(-centre);
  const Vector3d omega = kUpward.cross(v - surface) / 0.1;
  const SpatialSystem system(ball_above(kSkew, {0, 0, 0}, v, omega, {0, 0, -10},
                                        {.mu = 1, .surface = {.omega = Omega * kUpward, .centre = centre}}));
  const Vector3d middle = kUpward.cross(v) / rate;
  const double period = 2 * std::numbers::pi / rate;
  double off = 0;
  const Run run = run_in_space(system, "event-driven", period / 16, period, [&](const SpatialSample& m) {
    const Vector3d x = kSkew.inverse() * Vector3d(place_of<Spatial>(m.state.q, 0)) - 0.1 * kUpward;
    off = std::max(off, std::abs((x - middle).norm() - v.norm() / rate));
  });
  CHECK(off < kClosed);
  CHECK((kSkew.inverse() * centre_in(run) - 0.1 * kUpward).norm() < kClosed);
  CHECK((kSkew.inverse() * velocity_in(run) - v).norm() < kClosed);
}

TEST_CASE("event-driven in space: belts, and orthotropic friction along a curve") {
  const Vector3d V(0.6, -0.8, 0);
  const SpatialSystem belt(
      ball_above(kSkew, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, -10}, {.mu = 0.25, .surface = {.velocity = V}}));
  // The slip −V stops after 2/7 |V| / (μ g), when the ball moves at 2/7 V.
  const double rolls = 2.0 / 7 / 2.5;
  const SpatialEventRecord record = record_in_space(belt, 1, 0.25);
  REQUIRE(record.events.size() == 1);
  CHECK(std::abs(record.events[0].t - rolls) < kClosed);
  CHECK((kSkew.inverse() * velocity_in(record.run) - 2.0 / 7 * V).norm() < kClosed);
  CHECK((kSkew.inverse() * centre_in(record.run) - 0.1 * kUpward - 2.0 / 7 * (1 - rolls / 2) * V).norm() < kClosed);
  CHECK(std::abs(record.run.motion.work - 2 * 2.0 / 7) < 1e-9);  // m V · 2/7 V: twice the kinetic energy, and heat
  // γ̇_i = −g μ_i² γ_i / (Σ μ_j² γ_j²)^½: γ₁/γ₁(0) = (γ₂/γ₂(0))^k, k = (μ₁/μ₂)² = 2.
  const double mu = 0.3, across = mu / std::sqrt(2.0);
  const Vector3d d(std::cos(0.4), std::sin(0.4), 0), t(-d.y(), d.x(), 0);
  spatial::Scene s = ball_above(kSkew, {0, 0, 0}, 2 * d + t, {0, 0, 0}, {0, 0, -10},
                                {.mu = mu, .surface = {.mu_across = across, .direction = d}});
  s.bodies[0].inertia *= 1e9;  // it does not begin to roll
  const Run run = run_in_space(SpatialSystem(s), "event-driven", 0.4, 0.4);
  const Vector3d v = kSkew.inverse() * velocity_in(run);
  CHECK(v.dot(d) < 1.2);
  CHECK(std::abs(v.dot(d) / 2 - v.dot(t) * v.dot(t)) < 1e-8);  // a billionth of it rolls
}

TEST_CASE("event-driven in space: a belt does its work in an impact, too") {
  // The ball slips throughout: the belt's impulse is mu m (1 + e) 3 along its velocity of 10 m/s.
  const SpatialSystem system(ball_above(kSkew, {0, 0, 0.05}, {0, 0, -3}, {0, 0, 0}, {0, 0, 0},
                                        {.mu = 0.25, .e = 0.5, .surface = {.velocity = {6, -8, 0}}}));
  const Run run = run_in_space(system, "event-driven", 0.1, 0.1);
  CHECK(std::abs(run.motion.work - 0.25 * 9 * 10) < 1e-9);
}

TEST_CASE("event-driven in space: impulses of a contact that lasts add up to the change of momentum, tangents too") {
  const SpatialSystem system(ball_above(kSkew, {0, 0, 0}, {1, 2, 0}, {0, 0, 0}, {0, 0, -10}, {.mu = 0.25}));
  ImpulseOf<Spatial> sum;
  const Run run = run_in_space(system, "event-driven", 0.05, 0.2, [&](const SpatialSample& m) {
    sum.normal += m.impulses[0].normal, sum.tangent += m.impulses[0].tangent;
  });
  TermsOf<Spatial> terms(system);
  const State start = system.initial_state();
  set_poses(system, 0, start.q, terms.at);
  add_closed(system, 0, terms);
  Eigen::VectorXd push = Eigen::VectorXd::Zero(system.dof());
  apply_transposed(terms.closed[0].rows.normal, sum.normal, push.data());
  for (std::size_t k = 0; k < 2; ++k)
    apply_transposed(row_of_tangent(terms.closed[0].rows, k), tangent_part(sum.tangent, k), push.data());
  const Vector3d weight = 0.2 * 2 * Vector3d(system.scene().gravity);
  const Vector3d moved = 2 * (velocity_in(run) - Vector3d(translation<Spatial>(start.v, 0)));
  CHECK((Vector3d(push.head<3>()) + weight - moved).norm() < 1e-9);
}

TEST_CASE("event-driven in space: impacts that slip, and one that sticks and returns its slip by e_t") {
  const SpatialSystem slips(
      ball_above(kSkew, {0, 0, 0.05}, {2, 1, -3}, {10, -20, 5}, {0, 0, 0}, {.mu = 0.1, .e = 0.5}));
  const SpatialEventRecord one = record_in_space(slips, 0.1, 0.1);
  REQUIRE(one.events.size() == 1);
  CHECK(one.events[0].kind == EventKind::impact);
  CHECK(std::abs(one.events[0].t - 0.05 / 3) < 1e-15);
  CHECK(std::abs(one.events[0].normal - 9) < 1e-12);  // m (1 + e) 3
  CHECK(std::abs(one.events[0].tangent - 0.9) < 1e-12);
  CHECK((kSkew.inverse() * velocity_in(one.run) - Vector3d(1.597507764050, 0.798753882025, 1.5)).norm() < 1e-11);
  const Vector3d v(0.4, -0.3, -3), omega(3, 2, 5), r(0, 0, -0.1);
  const SpatialSystem sticks(ball_above(kSkew, {0, 0, 0.05}, v, omega, {0, 0, 0}, {.mu = 10, .e = 1, .e_t = 1}));
  const SpatialEventRecord two = record_in_space(sticks, 0.1, 0.03);
  Vector3d slip = v + omega.cross(r);
  slip.z() = 0;
  const Vector3d impulse = -4.0 / 7 * 2 * slip;
  CHECK((kSkew.inverse() * velocity_in(two.run) - (Vector3d(v.x(), v.y(), 3) + impulse / 2)).norm() < kClosed);
  CHECK((kSkew.inverse() * world_omega(sticks, two.run.final, 0) - (omega + r.cross(impulse) / 0.008)).norm() <
        kClosed);
  CHECK(std::abs(two.run.energy_final - two.run.energy_initial) < kClosed);
}

TEST_CASE("event-driven in space: a ball bounces to its rest, whose time is the exact Zeno point") {
  for (const double e : {0.2, 0.5, 0.8}) {
    CAPTURE(e);
    const double g = 9.81;
    const SpatialSystem system(ball_above(kSkew, {0, 0, 1}, {0.2, 0, 0}, {3, 2, 1}, {0, 0, -g}, {.e = e}));
    const double first = std::sqrt(2 / g), rest = first * (1 + e) / (1 - e);
    const SpatialEventRecord record = record_in_space(system, rest + 0.5, 0.5);
    const auto impacts = record.of(EventKind::impact), end = record.of(EventKind::accumulation);
    REQUIRE(impacts.size() >= 10);
    REQUIRE(end.size() == 1);
    for (std::size_t n = 0; n < impacts.size(); ++n)
      CHECK(std::abs(impacts[n].t - first * (1 + 2 * e * (1 - std::pow(e, n)) / (1 - e))) < kClosed);
    CHECK(std::abs(end[0].t - rest) < kClosed);
    CHECK((kSkew.inverse() * centre_in(record.run) - Vector3d(0.2 * (rest + 0.5), 0, 0.1)).norm() < kClosed);
    CHECK(std::abs(kUpward.dot(kSkew.inverse() * velocity_in(record.run))) < 1e-14);
  }
}

TEST_CASE("event-driven in space: a ball rolls in a bowl as a pendulum of 7/5 of the length") {
  // Jacobi: half a swing takes 2 K(sin(θ0/2)) / ω, ω² = g / (7/5 (R − r)); K by the arithmetic-geometric mean.
  const double outer = 0.5, inner_radius = 0.1, play = outer - inner_radius, tilt = 0.6, g = 9.81;
  double a = 1, b = std::cos(tilt / 2);
  for (int i = 0; i < 8; ++i) std::tie(a, b) = std::pair{(a + b) / 2, std::sqrt(a * b)};
  const double half = 2 * std::numbers::pi / (2 * a) * std::sqrt(1.4 * play / g);
  const Vector3d side(0.6, 0.8, 0);
  spatial::Scene s;
  s.gravity = {0, 0, -g};
  s.body({.name = "ball",
          .mass = 2,
          .inertia = Vector3d::Constant(0.4 * 2 * 0.01).asDiagonal(),
          .position = play * (std::sin(tilt) * side - std::cos(tilt) * kUpward)});
  s.contact(spatial::Socket{"bowl", 0, {0, 0, 0}, inner_radius, kGround, {0, 0, 0}, outer, {.mu = 0.5}});
  const Run run = run_in_space(SpatialSystem(s), "event-driven", half, half);
  const Vector3d there = play * (-std::sin(tilt) * side - std::cos(tilt) * kUpward);
  CHECK((centre_in(run) - there).norm() < kClosed);
  CHECK(run.events == 0);
}

TEST_CASE("event-driven in space: a ball rolls in a vertical cylinder, and its height oscillates") {
  // z = −5 g / (2 Ω²) (1 − cos(√(2/7) Ω t)), never lower than 5 g / Ω² below the start; the cylinder oblique in space.
  const double path = 0.3, R = 0.05, Omega = 9, g = 9.81, period = 2 * std::numbers::pi / (std::sqrt(2.0 / 7) * Omega);
  spatial::Scene s;
  s.gravity = kSkew * Vector3d(0, 0, -g);
  s.body({.name = "ball",
          .mass = 2,
          .inertia = Vector3d::Constant(0.4 * 2 * R * R).asDiagonal(),
          .position = kSkew * Vector3d(path, 0, 0),
          .velocity = kSkew * Vector3d(0, Omega * path, 0),
          .omega = kSkew * Vector3d(0, 0, -Omega * path / R)});
  s.contact(spatial::SphereBush{
      "wall", 0, {0, 0, 0}, R, kGround, kSkew * Vector3d(0, 0, 3), kSkew * Vector3d(0, 0, 1), path + R, {.mu = 1}});
  for (const double share : {0.3, 0.5, 1.0}) {
    const double t = share * period;
    const Run run = run_in_space(SpatialSystem(s), "event-driven", t, t);
    const double z = -5 * g / (2 * Omega * Omega) * (1 - std::cos(std::sqrt(2.0 / 7) * Omega * t));
    const Vector3d there(path * std::cos(Omega * t), path * std::sin(Omega * t), z);
    CHECK((kSkew.inverse() * centre_in(run) - there).norm() < kClosed);
    if (share == 0.5) CHECK(z == doctest::Approx(-5 * g / (Omega * Omega)).epsilon(1e-12));
    CHECK(run.events == 0);
  }
}

TEST_CASE("event-driven in space: Lagrange's top to 1e-10, and a body that tumbles keeps its energy") {
  const SpatialSystem lagrange(top());
  const Run run = run_in_space(lagrange, "event-driven", 0.10996771481, 0.10996771481);
  const Vector3d axis = quaternions::matrix_of(quaternion(run.final.q, 0)).col(2);
  CHECK(run.max_joint_residual < 1e-14);
  CHECK(std::abs(std::atan2(axis.y(), axis.x()) - 0.18417249693) < kClosed);
  const SpatialSystem book(tumbling());
  const Run free = run_in_space(book, "event-driven", 20, 20);
  CHECK(std::abs(free.energy_final / free.energy_initial - 1) < 1e-11);
}

TEST_CASE("event-driven in space: a held block breaks away at the edge of its disc; a lifted one opens") {
  spatial::Scene s;
  s.gravity = {0, 0, -8};
  s.body({.name = "block"});
  s.contact(spatial::SpherePlane{"floor", 0, {0, 0, 0}, 0, kGround, {0, 0, 0}, kUpward, {.mu = 0.5}});
  const auto ramp = [](double t) { return t; };
  s.load({.name = "pull", .body = 0, .force = {2.4, 3.2, 0}, .factor = ramp});
  const SpatialEventRecord slides = record_in_space(SpatialSystem(s), 2, 2);
  REQUIRE(slides.events.size() == 1);
  CHECK(slides.events[0].kind == EventKind::slip);
  CHECK(std::abs(slides.events[0].t - 1) < kClosed);
  CHECK((centre_in(slides.run) - 4.0 / 6 * Vector3d(0.6, 0.8, 0)).norm() < kClosed);
  s.loads.clear();
  s.load({.name = "pull", .body = 0, .force = {0, 0, 4}, .factor = ramp});
  const SpatialEventRecord opens = record_in_space(SpatialSystem(s), 3, 3);
  REQUIRE(opens.events.size() == 1);
  CHECK(opens.events[0].kind == EventKind::release);
  CHECK(std::abs(opens.events[0].t - 2) < kClosed);
  CHECK((centre_in(opens.run) - Vector3d(0, 0, 4.0 / 6)).norm() < kClosed);
}

TEST_CASE("event-driven in space: a box falls flat, its four corners strike at once in any orientation") {
  for (const double e : {0.0, 0.4, 0.7}) {
    CAPTURE(e);
    const double g = 9.81, first = std::sqrt(2 * 0.2 / g), rest = first * (1 + e) / (1 - e);
    spatial::Scene s;
    s.gravity = kSkew * Vector3d(0, 0, -g);
    s.body({.name = "box",
            .inertia = Vector3d(0.02, 0.03, 0.04).asDiagonal(),
            .position = kSkew * Vector3d(0.3, -0.2, 0.4),
            .orientation = {kSkew.w(), kSkew.x(), kSkew.y(), kSkew.z()},
            .velocity = kSkew * Vector3d(0.4, 0.3, 0)});
    s.contact_set(spatial::corners_plane({.name = "floor", .a = 0, .normal = kSkew * kUpward, .law = {.e = e}},
                                         spatial::box_corners({0.4, 0.3, 0.2})));
    const SpatialSystem system(s);
    const SpatialEventRecord record = record_in_space(system, 1.5, 0.5);
    const auto impacts = record.of(EventKind::impact), end = record.of(EventKind::accumulation);
    std::vector<double> times;  // those of several corners are the same
    for (const Event& each : impacts)
      if (times.empty() || each.t != times.back()) times.push_back(each.t);
    CHECK(impacts.size() >= 2 * times.size());
    for (std::size_t n = 0; n < times.size(); ++n)
      CHECK(std::abs(times[n] - first * (1 + 2 * e * (1 - std::pow(e, n)) / (1 - e))) < kClosed);
    if (e > 0) {
      REQUIRE(end.size() >= 2);
      CHECK(times.size() > 10);
      for (const Event& each : end) CHECK(std::abs(each.t - rest) < kClosed);
    }
    CHECK((kSkew.inverse() * centre_in(record.run) - Vector3d(0.9, 0.25, 0.2)).norm() < kClosed);
    CHECK(rotation<Spatial>(record.run.final.v, 0).norm() < 1e-12);
  }
}

TEST_CASE("event-driven in space goes on from a checkpoint bit for bit, in flight and in contact") {
  for (const bool slides : {true, false}) {
    const SpatialSystem system(slides ? masse() : slider_crank_space());
    const double step = slides ? 0.05 : 1e-3;
    const auto run = [&](const Restart& restart) {
      const auto scheme = make_integrator("event-driven", system);
      const auto solver = make_solver("auto");
      return simulate(*scheme, *solver, {.step = step, .duration = 16 * step}, {}, restart);
    };
    std::vector<std::string> kept;
    const Run whole = run({.every = 5, .save = [&](const std::string& bytes) { kept.push_back(bytes); }, .from = ""});
    REQUIRE(kept.size() == 3);
    for (const std::string& from : std::vector<std::string>(kept)) {
      const Run rest = run({.every = 5, .save = [](const std::string&) {}, .from = from});
      CHECK(rest.final.q == whole.final.q);
      CHECK(rest.final.v == whole.final.v);
      CHECK(rest.accepted == whole.accepted);
    }
  }
}

TEST_CASE("event-driven in space refuses what it does not follow") {
  spatial::Scene s = masse();
  s.friction({.name = "brake", .of = spatial::Slide{kGround, 0}, .bound = 0.4});
  const SpatialSystem system(s);
  CHECK_THROWS_WITH_AS(static_cast<void>(make_integrator("event-driven", system)),
                       "integrator event-driven: takes no dry friction in joints in space: must be moreau-jean or "
                       "another integrator of fixed step",
                       std::invalid_argument);
}

TEST_CASE("adaptive in space refuses dry friction in joints") {
  spatial::Scene s = masse();
  s.friction({.name = "brake", .of = spatial::Slide{kGround, 0}, .bound = 0.4});
  const SpatialSystem system(s);
  CHECK_THROWS_WITH_AS(static_cast<void>(make_integrator("adaptive", system)),
                       "integrator adaptive: takes no dry friction in joints in space: must be moreau-jean or another "
                       "integrator of fixed step",
                       std::invalid_argument);
}

TEST_CASE("a sphere squeezed out of a wedge: no bounce is passed over, whatever the output step") {
  const auto scene = std::get<spatial::Scene>(read_any_scene(ORTHANT_TEST_DATA "/sphere_in_wedge.toml"));
  const SpatialSystem system(scene);
  State ends[3];
  long events[3];
  const double steps[] = {scene.step, 0.01, scene.duration / 4};
  for (int k = 0; k < 3; ++k) {
    const Run r = run_in_space(system, "event-driven", steps[k], scene.duration);
    REQUIRE(r.status == Status::solved);
    ends[k] = r.final, events[k] = r.events;
  }
  for (int k = 1; k < 3; ++k) {
    CHECK(events[k] == events[0]);
    CHECK((ends[k].q - ends[0].q).lpNorm<Eigen::Infinity>() < 1e-8);
  }
}
