// Moreau–Jean stepping on small scenes with exact answers, and the promises of one step.
#include "tests/support/runs.h"

#include <orthant/core/mechanics/planar/contact_sets.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/integrators/fixed_step/moreau_jean.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

TEST_CASE("free fall: theta > 1/2 loses (theta - 1/2) m g² h a second") {
  const double h = 1e-3, theta = 0.8;
  const Run r = run_for(bouncing_ball({.height = 1000}), 1, "moreau-jean:theta=0.8", h);
  CHECK(r.energy_final - r.energy_initial == doctest::Approx(-(theta - 0.5) * kGravity * kGravity * h).epsilon(1e-9));
}

TEST_CASE("oscillator: one step multiplies the energy by (1 + (1-theta)² w² h²) / (1 + theta² w² h²)") {
  Scene s;
  const auto b = s.body({.name = "mass", .mass = 1, .inertia = 1, .position = {0.3, 0}, .velocity = {-0.7, 0}});
  s.spring(PointSpring{"spring", b, kGround, {0, 0}, {-5, 0}, 4, 0, 5});
  const double h = 0.1, w2 = 4;
  for (const double theta : {0.5, 0.75, 1.0}) {
    const Run r = run_for(s, h, "moreau-jean:theta=" + std::to_string(theta), h);
    const double expected = (1 + (1 - theta) * (1 - theta) * w2 * h * h) / (1 + theta * theta * w2 * h * h);
    CHECK(r.energy_final / r.energy_initial == doctest::Approx(expected).epsilon(1e-13));
  }
}

TEST_CASE("block on a slope: sticks below the friction angle without creep, slides above it at the right rate") {
  const double critical = std::tan(Incline{}.slope);
  const Run stick = run_for(incline({.mu = critical + 1e-6, .speed = 0}), 1, "moreau-jean", 1e-3);
  CHECK(std::abs(stick.final.v[0]) <= 1e-12);
  const Incline creep{.mu = critical - 1e-6, .speed = 0}, stop{.mu = 0.8, .speed = -2};
  CHECK(run_for(incline(creep), 1, "moreau-jean", 1e-3).final.v[0] == doctest::Approx(creep.at(1).v).epsilon(1e-6));
  const Run down = run_for(incline(stop), 2, "moreau-jean", 1e-4);
  CHECK(down.final.q[0] == doctest::Approx(stop.at(2).x).epsilon(1e-3));
  CHECK(std::abs(down.final.v[0]) <= 1e-12);
}

TEST_CASE("reduced and full form give the same step to rounding") {
  for (const double mu : {0.0, 0.1}) {
    const Scene scene = slider_crank({.mu = mu, .omega3 = -0.01});  // a tilt: single corners are met too
    const System system(scene);
    const auto lemke = make_solver("lemke"), other = make_solver("lemke");
    MoreauJean reduced(system), full(system, {.form = Form::full});
    State x = system.initial_state();
    int with_contact = 0;
    for (int k = 0; k < 4000; ++k) {
      State y = x;
      REQUIRE(full.step(5e-5, *other, y).status == Status::solved);
      const StepReport report = reduced.step(5e-5, *lemke, x);
      REQUIRE(report.status == Status::solved);
      with_contact += report.lcp_rows > 0;
      CHECK(full.problem().size() == reduced.problem().size() + system.joint_rows());
      CHECK((x.q - y.q).lpNorm<Eigen::Infinity>() <= 1e-13);
      CHECK((x.v - y.v).lpNorm<Eigen::Infinity>() <= 1e-10);  // |v| reaches 150
    }
    CHECK(with_contact > 500);
  }
}

TEST_CASE("run time grows only with the features that a scene uses") {
  const auto rows_at_rest = [](double mu, double height, bool joints) {
    Scene s = bouncing_ball({.height = height});
    std::get<CornerWall>(s.contacts[0]).law = {.mu = mu};
    s.contact(CornerWall{"ceiling", 0, {0, 0}, kGround, {0, 10}, {0, -1}, {.mu = 0.5}});  // open for ever
    if (joints) s.joint(Distance{"rope", 0, kGround, {0, 0}, {0, 5}, 5 - height});
    const System system(s);
    MoreauJean scheme(system);
    const auto solver = make_solver("lemke");
    State x = system.initial_state();
    return scheme.step(1e-3, *solver, x).lcp_rows;
  };
  CHECK(rows_at_rest(0, 1, false) == 0);    // open gaps: no rows
  CHECK(rows_at_rest(0, 0, false) == 1);    // no friction row where mu = 0
  CHECK(rows_at_rest(0.3, 0, false) == 2);  // the open contact's friction is not there either
  CHECK(rows_at_rest(0.3, 0, true) == 0);  // the rope holds the normal: no impulse moves the contact, so it has no rows
  const System free(bouncing_ball());
  CHECK(free.joint_rows() == 0);
  CHECK(BasicSystem(free).joint_rows() == 0);
}

TEST_CASE("the last step ends at the duration, the clock refuses nonsense") {
  CHECK(run_for(bouncing_ball(), 0.25, "moreau-jean", 0.1).steps == 3);
  CHECK(run_for(bouncing_ball(), 0.25, "moreau-jean", 0.1).final.t == 0.25);
  CHECK(run_for(bouncing_ball(), 0.3, "moreau-jean", 0.1).steps == 3);
  CHECK(run_for(bouncing_ball(), 0.25, "moreau-jean", 1e9).steps == 1);  // and not none
  for (const double h : {0.0, -1.0, std::nan(""), kInf})
    CHECK_THROWS_WITH_AS(run_for(bouncing_ball(), 1, "moreau-jean", h), doctest::Contains("step = "),
                         std::invalid_argument);
  CHECK_THROWS_WITH_AS(run_for(bouncing_ball(), -1, "moreau-jean", 0.1), doctest::Contains("duration = -1"),
                       std::invalid_argument);
  const System system(bouncing_ball());
  CHECK_THROWS_WITH_AS(make_integrator("euler", system), doctest::Contains("moreau-jean"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(make_integrator("moreau-jean:theta=2", system), doctest::Contains("[0.5, 1]"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(make_integrator("moreau-jean:tetha=1", system), doctest::Contains("theta"),
                       std::invalid_argument);
}

TEST_CASE("a run keeps the worst of its steps, not the last") {
  double penetration = 0, last = 0, residual = 0;
  const Run r = run_for(bouncing_ball(), 2, "moreau-jean", 1e-2, [&](const RunSample& m) {
    last = m.report.penetration;
    penetration = std::max(penetration, last);
    residual = std::max(residual, m.report.lcp_residual);
  });
  CHECK(penetration > 10 * last);
  CHECK(r.max_penetration == penetration);
  CHECK(r.max_lcp_residual == residual);
}

TEST_CASE("a tilted box slides off an edge without a stroke of its second corner, whatever it penetrates by") {
  const auto box_at_edge = [](double tilt, double speed, double drop) {  // its lowest corner is 0.03 before the edge
    Scene s{.gravity = {0, -9.81}, .duration = 0.03 / speed + 2e-3};
    const double c = std::cos(tilt), n = std::sin(tilt);
    s.body({.inertia = 0.00167,
            .position = {0.05 * (c - n) - 0.03, 0.05 * (c + n) + 1e-4},
            .angle = tilt,
            .velocity = {speed, -drop}});
    const Polygon table{{-1, -1}, {0, -1}, {0, 0}, {-1, 0}};
    s.contact_set(polygon_polygon({{}, 0, rectangle(0.1, 0.1), kGround, table, 0, {}}));
    return s;
  };
  for (const double tilt : {0.05, 0.1})
    for (const double speed : {1.7, 3.0})
      for (const double drop : {0.02, 0.1}) {
        const Scene s = box_at_edge(tilt, speed, drop);
        const double right = run(s, "event-driven", s.duration / 50).final.v[2];
        for (const double h : {2e-4, 1e-4, 5e-5, 2.5e-5}) {
          CAPTURE(tilt);
          CAPTURE(speed);
          CAPTURE(drop);
          CAPTURE(h);
          const Run r = run(s, "moreau-jean", h);
          CHECK(r.status == Status::solved);
          CHECK(std::abs(r.final.v[2] - right) < 1e3 * h);  // [rad/s]; a stroke makes several
        }
      }
}
