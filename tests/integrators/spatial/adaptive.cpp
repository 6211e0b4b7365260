// adaptive in space against exact solutions: errors within 100 rtol at every tolerance, events, dense output.
#include "tests/support/runs.h"
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/bennett.h>
#include <orthant/core/scenes/masse.h>
#include <orthant/core/scenes/slider_crank_space.h>
#include <orthant/core/scenes/spatial_slider_crank.h>
#include <orthant/core/scenes/top.h>

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

namespace {

constexpr double kPi = std::numbers::pi, kTolerances[] = {1e-4, 1e-6, 1e-8};

std::string adaptive_at(double rtol) {
  std::ostringstream spec;
  spec << "adaptive:rtol=" << rtol << ",atol=" << rtol / 1000;
  return spec.str();
}

/// error(rtol) of a run must be at most 100 rtol at every tolerance.
template <class Error> void keeps_tolerances(Error&& error) {
  for (const double rtol : kTolerances) {
    CAPTURE(rtol);
    const double off = error(rtol);
    MESSAGE("rtol " << rtol << ": error " << off);
    CHECK(off <= 100 * rtol);
  }
}

Run run_adaptive(const SpatialSystem& system, double rtol, double duration, double step = 0.01,
                 const RecorderOf<Spatial>& record = {}) {
  return run_in_space(system, adaptive_at(rtol), step, duration, record);
}

Vector3d centre_of(const Run& run, BodyId body) { return place_of<Spatial>(run.final.q, body); }
Vector3d velocity_of(const Run& run, BodyId body) { return translation<Spatial>(run.final.v, body); }

/// Jacobi's sn, cn, dn of u by the arithmetic-geometric mean (Abramowitz & Stegun 16.4).
Vector3d jacobi(double u, double m) {
  double a[16] = {1}, c[16] = {std::sqrt(m)}, b = std::sqrt(1 - m);
  int n = 0;
  for (; n < 15 && std::abs(c[n]) > 1e-17; ++n) {
    a[n + 1] = (a[n] + b) / 2, c[n + 1] = (a[n] - b) / 2;
    b = std::sqrt(a[n] * b);
  }
  double phi = std::ldexp(a[n] * u, n), before = phi;
  for (; n > 0; --n) before = phi, phi = (phi + std::asin(c[n] / a[n] * std::sin(phi))) / 2;
  return {std::sin(phi), std::cos(phi), std::cos(phi) / std::cos(before - phi)};
}

spatial::Scene ball(const Vector3d& x, const Vector3d& v, const Vector3d& omega, const Vector3d& gravity,
                    const ContactLaw& law) {
  spatial::Scene s;
  s.gravity = gravity;
  s.body({.name = "ball",
          .mass = 2,
          .inertia = Vector3d::Constant(0.4 * 2 * 0.01).asDiagonal(),
          .position = x,
          .velocity = v,
          .omega = omega});
  s.contact(spatial::SpherePlane{"floor", 0, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, {0, 0, 1}, law});
  return s;
}

std::vector<Event> events_of(const SpatialSystem& system, double rtol, double duration) {
  std::vector<Event> all;
  run_adaptive(system, rtol, duration, 0.01,
               [&](const SpatialSample& m) { all.insert(all.end(), m.events.begin(), m.events.end()); });
  return all;
}

}  // namespace

TEST_CASE("adaptive in space: a free asymmetric body is Jacobi's elliptic functions") {
  // J = (3, 2, 1): ω = (a cn, b sn, c dn)(λ t), from ω2 = 0; the sign of λ is that of −a b c (J3 − J2) …
  const Vector3d J(3, 2, 1), start(0.5, 0, 2);
  const double T2 = J.dot(start.cwiseAbs2()), L2 = J.cwiseProduct(start).squaredNorm();
  REQUIRE(L2 < J[1] * T2);  // about the third axis: dn belongs to ω3
  const double lambda = std::sqrt((J[0] * T2 - L2) * (J[1] - J[2]) / (J[0] * J[1] * J[2]));
  const double m = (J[0] - J[1]) * (L2 - J[2] * T2) / ((J[1] - J[2]) * (J[0] * T2 - L2));
  const double b = std::sqrt((L2 - J[2] * T2) / (J[1] * (J[1] - J[2])));
  // J2 ω2' = (J3 − J1) ω3 ω1 < 0 at first.
  const auto omega = [&](double t) {
    const Vector3d e = jacobi(lambda * t, m);
    return Vector3d(start[0] * e[1], -b * e[0], start[2] * e[2]);
  };
  REQUIRE((J.cwiseProduct((omega(1e-5) - omega(-1e-5)) / 2e-5) - J.cwiseProduct(start).cross(start)).norm() < 1e-8);
  // Orientation: the third axis by the momentum, which stays; about the momentum by a quadrature.
  const Eigen::Quaterniond R0(Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()));
  spatial::Scene s;
  s.body({.name = "stone",
          .inertia = J.asDiagonal(),
          .position = {1, 2, 3},
          .orientation = {R0.w(), R0.x(), R0.y(), R0.z()},
          .velocity = {0.3, -0.2, 0.1},
          .omega = R0 * start});
  const SpatialSystem system(s);
  const double duration = 7, L = std::sqrt(L2);
  const auto precession_rate = [&](double t) {
    const Vector3d l = J.cwiseProduct(omega(t));
    return L * (l[0] * l[0] / J[0] + l[1] * l[1] / J[1]) / (l[0] * l[0] + l[1] * l[1]);
  };
  double precession = 0;
  constexpr int kPanels = 20000;
  for (int k = 0; k < kPanels; ++k) {
    const double h = duration / kPanels, t = k * h;
    precession += h / 6 * (precession_rate(t) + 4 * precession_rate(t + h / 2) + precession_rate(t + h));
  }
  const Vector3d n = (R0 * J.cwiseProduct(start)).normalized();
  // Seen along n, the third axis of the body turns by the precession.
  const Vector3d axis0 = R0 * Vector3d::UnitZ(), across = (axis0 - n.dot(axis0) * n).normalized();
  const double up = J[2] * omega(duration)[2] / L;
  const Vector3d axis =
      up * n + std::sqrt(1 - up * up) * (std::cos(precession) * across + std::sin(precession) * n.cross(across));
  keeps_tolerances([&](double rtol) {
    const Run run = run_adaptive(system, rtol, duration);
    const Vector3d rates = run_adaptive(system, rtol, duration).final.v.segment<3>(3);
    const auto k = poses_of(system, run.final);
    // System orders principal axes as it likes: compare in the body's own frame.
    const Vector3d own = system.scene().bodies[0].to_axes.transpose() * rates;
    CHECK((own - omega(duration)).norm() <= 100 * rtol);
    CHECK((centre_of(run, 0) - Vector3d(3.1, 0.6, 3.7)).norm() < 1e-13);
    return (k.at(0).turn(Vector3d::UnitZ()) - axis).norm();
  });
}

TEST_CASE("adaptive in space: Lagrange's top and a spherical pendulum, joints to rounding") {
  const SpatialSystem lagrange(top());
  keeps_tolerances([&](double rtol) {
    const Run run = run_adaptive(lagrange, rtol, 0.10996771481);
    const Vector3d axis = quaternions::matrix_of(quaternion(run.final.q, 0)).col(2);
    CHECK(run.max_joint_residual < 1e-14);
    return std::abs(std::atan2(axis.y(), axis.x()) - 0.18417249693);
  });
  // Length and gravity 1, started sideways at z1 = −.9 with azimuthal speed: z' ² = 2 (E − z)(1 − z²) − l², z between
  // two of its roots; half a period and the turn in it by the trapezoidal rule in z = z1 + (z2 − z1) sin² φ.
  const double z1 = -0.9, speed = 1.1, r = std::sqrt(1 - z1 * z1), l = r * speed, E = speed * speed / 2 + z1;
  // The roots sum to E, and products of pairs sum to −1.
  const double rest = E - z1, product = -1 - z1 * rest, z2 = (rest - std::sqrt(rest * rest - 4 * product)) / 2;
  const double z3 = rest - z2;
  double half = 0, turn = 0;
  constexpr int kPoints = 200;
  for (int k = 0; k < kPoints; ++k) {
    const double sine = std::sin((k + 0.5) * kPi / 2 / kPoints), z = z1 + (z2 - z1) * sine * sine;
    const double dt = std::sqrt(2 / (z3 - z)) * kPi / 2 / kPoints;
    half += dt, turn += dt * l / (1 - z * z);
  }
  spatial::Scene s;
  s.gravity = {0, 0, -1};
  s.body({.name = "bob", .position = {r, 0, z1}, .velocity = {0, speed, 0}, .omega = {3, 4, 5}});
  s.joint(spatial::Distance{"rod", kGround, 0, {0, 0, 0}, {0, 0, 0}, 1});
  const SpatialSystem pendulum(s);
  const double out = std::sqrt(1 - z2 * z2);
  keeps_tolerances([&](double rtol) {
    const Run run = run_adaptive(pendulum, rtol, half, half / 3);
    CHECK(run.max_joint_residual < 1e-14);
    return (centre_of(run, 0) - Vector3d(out * std::cos(turn), out * std::sin(turn), z2)).norm();
  });
}

TEST_CASE("adaptive in space: two masses on rods, against the equations in multipliers by another method") {
  using Pair = Eigen::Matrix<double, 6, 1>;
  const Vector3d g(0, 0, -9.81);
  const auto acceleration = [&](const Pair& x, const Pair& v) {
    const Vector3d a = x.head<3>(), d = x.tail<3>() - a, va = v.head<3>(), vd = v.tail<3>() - va;
    // r1'' = g + λ1 a − λ2 d, r2'' = g + λ2 d; a · a'' = −|va|², d · d'' = −|vd|².
    Eigen::Matrix2d A;
    A << a.dot(a), -a.dot(d), -a.dot(d), 2 * d.dot(d);
    const Eigen::Vector2d lambda = A.inverse() * Eigen::Vector2d(-va.dot(va) - a.dot(g), -vd.dot(vd));
    Pair result;
    result << g + lambda[0] * a - lambda[1] * d, g + lambda[1] * d;
    return result;
  };
  Pair x, v;
  x << 0.6, 0, -0.8, 0.6, 1, -0.8;
  v << 0, 1, 0, 0.5, 1, 0.3;
  spatial::Scene s;
  s.gravity = g;
  for (Index i = 0; i < 2; ++i)
    s.body({.name = i == 0 ? "one" : "two", .position = x.segment<3>(3 * i), .velocity = v.segment<3>(3 * i)});
  s.joint(spatial::Distance{"upper", kGround, 0, {0, 0, 0}, {0, 0, 0}, 1});
  s.joint(spatial::Distance{"lower", 0, 1, {0, 0, 0}, {0, 0, 0}, 1});
  constexpr int kSteps = 20000;
  const double h = 2.0 / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const Pair a1 = acceleration(x, v), v2 = v + h / 2 * a1, a2 = acceleration(x + h / 2 * v, v2);
    const Pair v3 = v + h / 2 * a2, a3 = acceleration(x + h / 2 * v2, v3), v4 = v + h * a3;
    const Pair a4 = acceleration(x + h * v3, v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4), v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  const SpatialSystem system(s);
  keeps_tolerances([&](double rtol) {
    const Run run = run_adaptive(system, rtol, 2);
    CHECK(run.max_joint_residual < 1e-14);
    return std::max((centre_of(run, 0) - x.head<3>()).norm(), (centre_of(run, 1) - x.tail<3>()).norm());
  });
}

TEST_CASE("adaptive in space: a ball bounces to its rest, and a slipping impact has the exact velocities") {
  const double g = 9.81, e = 0.5;
  const SpatialSystem system(ball({0, 0, 1.1}, {0.2, 0, 0}, {3, 2, 1}, {0, 0, -g}, {.e = e}));
  const double first = std::sqrt(2 / g), all = first * (1 + e) / (1 - e);
  const auto exact = [&](double t) {
    if (t < first) return 1 - g / 2 * t * t;
    double since = t - first, v = e * g * first;
    while (v > 1e-12 && since > 2 * v / g) since -= 2 * v / g, v *= e;
    return v > 1e-12 ? v * since - g / 2 * since * since : 0.0;
  };
  keeps_tolerances([&](double rtol) {
    double off = 0;
    std::vector<Event> events;
    const Run run = run_adaptive(system, rtol, 1.5, 0.037, [&](const SpatialSample& m) {
      events.insert(events.end(), m.events.begin(), m.events.end());
      off = std::max(off, std::abs(m.state.q[2] - 0.1 - exact(m.state.t)));
    });
    REQUIRE(events.size() > 10);
    CHECK(std::abs(events[0].t - first) < 1e-13);
    CHECK(std::abs(events[1].t - (first + 2 * e * first)) < 1e-12);
    CHECK(events.back().kind == EventKind::accumulation);
    CHECK(std::abs(events.back().t - all) < 1e-9);
    CHECK(run.crossings == 0);
    CHECK(std::abs(run.final.q[0] - 0.3) < 1e-13);
    return off;
  });
  const SpatialSystem slips(ball({0, 0, 0.15}, {2, 1, -3}, {10, -20, 5}, {0, 0, 0}, {.mu = 0.1, .e = 0.5}));
  const Run run = run_adaptive(slips, 1e-6, 0.1);
  CHECK((velocity_of(run, 0) - Vector3d(1.597507764050, 0.798753882025, 1.5)).norm() < 1e-11);
  CHECK((world_omega(slips, run.final, 0) - Vector3d(4.968847050625, -9.937694101251, 5)).norm() < 1e-10);
}

TEST_CASE("adaptive in space: a massé shot slides on a parabola until it rolls, located to the tolerance") {
  const SpatialSystem system(masse());
  constexpr double kRolls = 0.6147302241381;
  const Vector3d roll(-0.102142857142857, 0.489857142857143, 0);
  const Vector3d exact = Vector3d(0.275969961, 0.150564996, 0.028575) + (1 - kRolls) * roll;
  keeps_tolerances([&](double rtol) {
    const std::vector<Event> events = events_of(system, rtol, 1);
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == EventKind::stick);
    CHECK(std::abs(events[0].t - kRolls) <= 100 * rtol);
    const Run run = run_adaptive(system, rtol, 1);
    CHECK((velocity_of(run, 0) - roll).norm() <= 100 * rtol);
    return (centre_of(run, 0) - exact).norm();
  });
}

TEST_CASE("adaptive in space: a block thrown across a slope turns downhill and stops at the exact place") {
  const double alpha = kPi / 6;
  spatial::Scene s;
  s.gravity = {9.81 * std::sin(alpha), 0, -9.81 * std::cos(alpha)};
  s.body({.name = "block", .velocity = {0, 2, 0}});
  s.contact(spatial::SpherePlane{"slope", 0, {0, 0, 0}, 0, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = 2 * std::tan(alpha)}});
  const SpatialSystem system(s);
  keeps_tolerances([&](double rtol) {
    const std::vector<Event> events = events_of(system, rtol, 0.4);
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == EventKind::stick);
    CHECK(std::abs(events[0].t - 0.271831464492014951) <= 100 * rtol);
    const Run run = run_adaptive(system, rtol, 0.4);
    CHECK(run.final.v.lpNorm<Eigen::Infinity>() < 1e-12);
    return (centre_of(run, 0) - Vector3d(0.0679578661230037377, 0.217465171593611961, 0)).norm();
  });
}

TEST_CASE("adaptive in space: a held block breaks away where the pull leaves its disc of friction, and is lifted off") {
  // Pull 4 t along (3, 4)/5 on 1 kg, μ m g = 4: it slides from t = 1 on, with x'' = 4 (t − 1); no turn, no spin.
  spatial::Scene s;
  s.gravity = {0, 0, -8};
  s.body({.name = "block"});
  s.contact(spatial::SpherePlane{"floor", 0, {0, 0, 0}, 0, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = 0.5}});
  const auto ramp = [](double t) { return t; };
  s.load({.name = "pull", .body = 0, .force = {2.4, 3.2, 0}, .factor = ramp});
  const SpatialSystem system(s);
  keeps_tolerances([&](double rtol) {
    const std::vector<Event> events = events_of(system, rtol, 2);
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == EventKind::slip);
    CHECK(std::abs(events[0].t - 1) <= 100 * rtol);
    const Run run = run_adaptive(system, rtol, 2);
    return (centre_of(run, 0) - 4.0 / 6 * Vector3d(0.6, 0.8, 0)).norm();
  });
  spatial::Scene lift = s;
  lift.loads.clear();
  lift.load({.name = "pull", .body = 0, .force = {0, 0, 4}, .factor = ramp});
  const SpatialSystem lifted(lift);
  keeps_tolerances([&](double rtol) {  // z'' = 4 (t − 2) from t = 2 on
    const std::vector<Event> events = events_of(lifted, rtol, 3);
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == EventKind::release);
    const Run run = run_adaptive(lifted, rtol, 3);
    return (centre_of(run, 0) - Vector3d(0, 0, 4.0 / 6)).norm();
  });
}

TEST_CASE(
    "adaptive in space: the spatial slider-crank to its published values, Bennett's linkage to its computed one") {
  const SpatialSystem system(spatial_slider_crank());
  keeps_tolerances([&](double rtol) {
    const Run one = run_adaptive(system, rtol, 1), five = run_adaptive(system, rtol, 5);
    CHECK(five.max_joint_residual < 1e-14);
    CHECK(std::abs(one.final.q[14] - 0.21172166) <= 100 * rtol + 5e-9);
    return std::abs(five.final.q[14] - 0.24071957373);
  });
  const SpatialSystem redundant(bennett());
  keeps_tolerances([&](double rtol) {
    const spatial::Angle angle = std::get<spatial::Revolute>(redundant.scene().joints[0]).angle();
    spatial::Unwrapped turns;
    double value = 0;
    run_adaptive(redundant, rtol, 5, 0.05, [&](const SpatialSample& m) {
      const auto k = poses_of(redundant, m.state);
      value = turns.add(m.state.t, angle.value(k), apply(angle.row(k), m.state.v.data()));
    });
    return std::abs(value - 3.01649731398);
  });
}

TEST_CASE("adaptive in space: the planar slider-crank with clearance, turned at will, is that of the plane") {
  constexpr double kDuration = 0.05;
  const Run planar = run_for(slider_crank(), kDuration, "adaptive:rtol=1e-10,atol=1e-12", 1e-3);
  REQUIRE(planar.status == Status::solved);
  for (const double turn : {0.0, 1.0})
    for (const double width : {0.0, 0.03}) {
      CAPTURE(turn);
      CAPTURE(width);
      SliderCrankSpace p;
      p.turn_x = turn, p.turn_y = 0.5 * turn, p.turn_z = -0.7 * turn, p.width = width;
      const SpatialSystem system(slider_crank_space(p));
      const Eigen::Quaterniond R = Eigen::AngleAxisd(p.turn_z, Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(p.turn_y, Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(p.turn_x, Vector3d::UnitX());
      keeps_tolerances([&](double rtol) {
        const Run run = run_adaptive(system, rtol, kDuration, 1e-3);
        CHECK(run.events > 40);
        CHECK(run.max_joint_residual < 1e-14);
        double off = 0;
        for (Index b = 0; b < 3; ++b) {
          const Vector3d x = R.inverse() * centre_of(run, static_cast<BodyId>(b));
          off = std::max(off, (x - Vector3d(planar.final.q[3 * b], planar.final.q[3 * b + 1], 0)).norm());
        }
        return off;
      });
    }
}

TEST_CASE("adaptive in space: states within inner steps, impulses and work do not depend on the output step") {
  spatial::Scene s = ball({0, 0, 0.5}, {1, 2, 0}, {4, -3, 9}, {0, 0, -9.81}, {.mu = 0.3, .e = 0.4});
  s.load({.name = "wind", .body = 0, .force = {0.5, 0, 0.2}, .moment = {0, 0.01, 0}});
  const SpatialSystem system(s);
  State fine, coarse;
  double sums[2] = {0, 0}, works[2] = {0, 0};
  for (const int i : {0, 1}) {
    const Run run = run_in_space(system, "adaptive:rtol=1e-8", i == 0 ? 0.3 : 0.001, 1.5, [&](const SpatialSample& m) {
      if (std::abs(m.state.t - 0.9) < 1e-9) (i == 0 ? coarse : fine) = m.state;
      for (const auto& impulse : m.impulses) sums[i] += impulse.normal;
    });
    works[i] = run.motion.work;
    CHECK(std::abs(run.motion.work + run.energy_initial - run.energy_final) > 1);  // impacts and friction took it
  }
  CHECK((fine.q - coarse.q).norm() < 1e-9);
  CHECK((fine.v - coarse.v).norm() < 1e-8);
  CHECK(sums[0] > 25);  // m g t, at least
  CHECK(std::abs(sums[0] - sums[1]) < 1e-7 * sums[0]);
  CHECK(std::abs(works[0] - works[1]) < 1e-7);
}

TEST_CASE("adaptive in space goes on from a checkpoint bit for bit, in flight and in contact") {
  for (const bool slides : {true, false}) {
    const SpatialSystem system(slides ? masse() : slider_crank_space());
    const double step = slides ? 0.05 : 1e-3;
    const auto run = [&](const Restart& restart) {
      const auto scheme = make_integrator("adaptive", system);
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
