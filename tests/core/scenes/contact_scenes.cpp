// Scenes of impact and dry friction: their exact answers against figures of 18 digits or known fractions, and the
// drawings against the answers.
#include "tests/support/runs.h"

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/scenes/arch.h>
#include <orthant/core/scenes/collinear.h>
#include <orthant/core/scenes/cradle.h>
#include <orthant/core/scenes/elliptic.h>
#include <orthant/core/scenes/grain_column.h>
#include <orthant/core/scenes/painleve_rod.h>
#include <orthant/core/scenes/rocking_block.h>
#include <orthant/core/scenes/rod_drop.h>
#include <orthant/core/scenes/roll.h>
#include <orthant/core/scenes/sphere_bounce.h>
#include <orthant/core/scenes/superball.h>
#include <orthant/core/scenes/table.h>
#include <orthant/core/scenes/tower.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace orthant;

namespace {

void check_each(const std::vector<double>& a, const std::vector<double>& b, double tolerance = 1e-15) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - b[i]) <= tolerance);
}

State end(const Scene& scene, double duration, double h) {
  const Run r = run_for(scene, duration, kSymmetric, h);
  REQUIRE(r.status == Status::solved);
  return r.final;
}

}  // namespace

TEST_CASE("super-ball: one impact after the other, or both at once") {
  for (const auto& [ratio, lower, upper] : {std::array{3.0, 0.0, 2.0},
                                            {9.0, 0.6, 2.6},
                                            {100.0, 97.0 / 101, 299.0 / 101},
                                            {1e6, 0.999996000003999996, 2.999996000003999996}}) {
    const SuperBall::Speeds u = SuperBall{.ratio = ratio}.after();
    CHECK(std::abs(u.lower - lower) < 1e-15);
    CHECK(std::abs(u.upper - upper) < 1e-15);
  }
  const SuperBall::Speeds light = SuperBall{.ratio = 1}.after();  // the lower one comes back at 1, and is turned again
  CHECK(light.lower + light.upper == 2);
  CHECK(light.lower == 1);
  const SuperBall::Speeds together = SuperBall{.e = 0.5, .gap = 0}.after();
  CHECK(together.lower == 0.5);
  CHECK(together.upper == 0.5);
}

TEST_CASE("cradle: laws differ, each keeps the momentum and for e = 1 the energy") {
  check_each(Cradle{}.after(), {-1.0 / 3, 2.0 / 3, 2.0 / 3});
  check_each(Cradle{.balls = 4}.after(), {-0.5, 0.5, 0.5, 0.5});
  check_each(Cradle{.e = 0.5}.after(), {0, 0.5, 0.5});
  check_each(Cradle{.e = 0}.after(), {1.0 / 3, 1.0 / 3, 1.0 / 3});
  check_each(Cradle{.balls = 5, .impacts = Impacts::sequential}.after(), {0, 0, 0, 0, 1});
  check_each(Cradle{.balls = 4, .gap = 1e-3}.after(), {0, 0, 0, 1});
  for (const double e : {0.0, 0.3, 0.9, 1.0}) {
    const auto u = Cradle{.balls = 6, .e = e, .impacts = Impacts::sequential}.after();
    double momentum = 0, energy = 0;
    for (const double v : u) momentum += v, energy += v * v;
    CHECK(std::abs(momentum - 1) < 1e-14);
    if (e == 1) CHECK(std::abs(energy - 1) < 1e-14);
    if (e == 0) check_each(u, std::vector<double>(6, 1.0 / 6), 1e-14);
    for (std::size_t i = 0; i + 1 < u.size(); ++i) CHECK(u[i] - u[i + 1] < 1e-15);  // none approaches any more
  }
}

TEST_CASE("from sliding to rolling") {
  const Roll sphere, disc{.inertia_factor = 0.5};
  CHECK(sphere.rolling_time() == doctest::Approx(0.7281199941750400466).epsilon(1e-15));
  CHECK(sphere.at(sphere.rolling_time()).x == doctest::Approx(3.1205142607501716283).epsilon(1e-15));
  CHECK(sphere.at(2).v == doctest::Approx(25.0 / 7).epsilon(1e-15));
  CHECK(disc.rolling_time() == doctest::Approx(0.84947332653754672103).epsilon(1e-15));
  CHECK(disc.at(disc.rolling_time()).x == doctest::Approx(3.539472193906444671).epsilon(1e-15));
  const Roll holds{.mu = 0.165, .speed = 0, .slope = std::numbers::pi / 6},
      slips{.mu = 0.1, .speed = 0, .slope = std::numbers::pi / 6};
  CHECK(holds.at(1).v == doctest::Approx(3.5035714285714285714).epsilon(1e-15));
  CHECK(slips.at(1).v == doctest::Approx(4.0554290788874656875).epsilon(1e-15));
  CHECK(-slips.omega(1) == doctest::Approx(2.1239273027813357812).epsilon(1e-15));
  CHECK(slips.rolling_time() == kInf);
  for (const Roll& p : {sphere, disc, holds, slips}) {
    const State x = end(roll(p), 1.5, 1e-3);
    CHECK(std::abs(x.q[0] - p.at(1.5).x) < 3e-3);
    CHECK(std::abs(x.v[0] - p.at(1.5).v) < 1e-3);
    CHECK(std::abs(x.v[2] - p.omega(1.5)) < 1e-3);
  }
}

TEST_CASE("rocking block: impacts of the exact motion, not of the linearized one") {
  CHECK(elliptic_integral(1.2, 0.3) == doctest::Approx(std::ellint_1(std::sqrt(0.91), 1.2)).epsilon(1e-14));
  const RockingBlock p;
  CHECK(p.ratio() == doctest::Approx(0.91176470588235294118).epsilon(1e-15));
  CHECK(p.impact_time(1) == doctest::Approx(0.31230857511262229335).epsilon(1e-13));
  CHECK(p.impact_time(2) == doctest::Approx(0.82059222908260084177).epsilon(1e-13));
  CHECK(p.impact_time(3) == doctest::Approx(1.251876744461842692).epsilon(1e-13));
  CHECK(p.impact_time(4) == doctest::Approx(1.6258666133099822059).epsilon(1e-13));
  CHECK(p.impact_speed(1) == doctest::Approx(0.8934143073025634752).epsilon(1e-13));
  CHECK(p.impact_speed(4) == doctest::Approx(0.67717549432247782642).epsilon(1e-13));
  for (const double t : {0.1, 0.5, 1.0, 1.4}) {  // the equation of motion, and no jump of the angle
    const Motion now = p.at(t), next = p.at(t + 1e-5), before = p.at(t - 1e-5);
    CHECK((next.x - before.x) / 2e-5 == doctest::Approx(now.v).epsilon(1e-7));
    const double alpha = p.slenderness(), rate = 0.75 * p.g / std::hypot(0.1, 0.4), side = now.x > 0 ? 1 : -1;
    CHECK((next.v - before.v) / 2e-5 == doctest::Approx(-side * rate * std::sin(alpha - side * now.x)).epsilon(1e-6));
  }
  CHECK(std::abs(p.at(p.impact_time(2) + 1e-9).x) < 1e-8);
  for (const double t : {0.2, 0.7, 1.5}) {
    const State x = end(rocking_block(p), t, 1e-4);
    CHECK(std::abs(x.q[2] - p.at(t).x) < 2e-3);
  }
  // Just slender enough to lift the old corner, and just not.
  const RockingBlock lifts{.half_width = 0.1, .half_height = 0.072}, stops{.half_width = 0.1, .half_height = 0.07};
  CHECK(stops.ratio() == 0);
  const double t = stops.impact_time(1);
  CHECK(stops.at(t + 0.01).x == 0);
  CHECK(end(rocking_block(stops), t + 0.05, 1e-4).v.norm() < 1e-12);
  const Motion rocks = lifts.at(lifts.impact_time(1) + 1e-3);
  CHECK(rocks.v < 0);
  CHECK(end(rocking_block(lifts), lifts.impact_time(1) + 1e-3, 1e-5).v[2] == doctest::Approx(rocks.v).epsilon(0.05));
}

TEST_CASE("Painleve's rod: none, one or two contact forces") {
  check_each(PainleveRod{.mu = 1}.forces(), {24.525}, 1e-12);
  check_each(PainleveRod{.mu = 1, .omega = 4}.forces(), {0});
  check_each(PainleveRod{}.forces(), {});
  check_each(PainleveRod{.omega = 4}.forces(), {0, 22.504175279993270}, 1e-12);
  CHECK(std::abs(PainleveRod{.mu = 1.3471506281091268, .angle = std::numbers::pi / 3}.A()) < 1e-15);
  CHECK(PainleveRod{}.A() == doctest::Approx(-0.2).epsilon(1e-14));
  // Its drawing has these very A and b: W_N (W_N + μ W_T)ᵀ / m where the friction pushes, and the bias less gravity.
  for (const double omega : {0.0, 4.0}) {
    const PainleveRod p{.omega = omega};
    const System system(painleve_rod(p));
    const State x = system.initial_state();
    Terms terms(system);
    set_poses(system, x.t, x.q, terms.at), set_twists(system, x.v, terms.at);
    evaluate_gaps(system, terms), evaluate_closed(system, 1e-15, terms), evaluate_biases(system, terms);
    REQUIRE(terms.closed.size() == 1);
    const ContactRows& rows = terms.closed[0].rows;
    CHECK(std::abs(apply(rows.normal, x.v.data())) < 1e-15);
    CHECK(apply(rows.tangent, x.v.data()) == doctest::Approx(-p.slide));
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3);
    apply_transposed(rows.normal, 1, force.data()), apply_transposed(rows.tangent, p.mu, force.data());
    const Eigen::VectorXd a = system.inverse_mass().cwiseProduct(force);
    CHECK(apply(rows.normal, a.data()) == doctest::Approx(p.A()).epsilon(1e-13));
    CHECK(terms.contact_bias[0].normal - p.g == doctest::Approx(p.b()).epsilon(1e-13));
  }
}

TEST_CASE("forces of a table, a tower and a column of grains at rest") {
  const Table four;
  check_each({four.misfit(std::array{0.0, 0.0, 0.6 * kGravity, 0.4 * kGravity})}, {0}, 1e-15);
  CHECK(four.misfit(std::array{-0.02 * kGravity, 0.16 * kGravity, 0.34 * kGravity, 0.52 * kGravity}) >
        0.1);  // least norm
  CHECK(Tower{}.force(1) == doctest::Approx(1000001 * kGravity));
  CHECK(Tower{}.force(2) == doctest::Approx(1000000 * kGravity));
  const Tower slender{.blocks = 8, .ratio = 0.1, .g = 1};
  CHECK(slender.force(1) == doctest::Approx(1.1111111).epsilon(1e-15));
  CHECK(slender.force(8) == doctest::Approx(1e-7).epsilon(1e-15));
  CHECK(GrainColumn{}.force(1) == 10 * kGravity);
  CHECK(GrainColumn{}.impulse(10, 0) == 1);
  const auto impulses_of = [](const Scene& scene, double duration) {
    std::vector<double> sum(scene.contacts.size());
    const Run r = run(scene, kSymmetric, duration, [&](const RunSample& m) {
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += m.impulses[i].normal;
    });
    CHECK(r.status == Status::solved);
    CHECK(r.final.v.lpNorm<Eigen::Infinity>() < 1e-10);  // rounding of impulses up to 1e6 N s
    return sum;
  };
  for (Scene scene : {table(), table({.legs = 9, .offset = -0.3})}) {
    scene.duration = 0x1p-7;
    auto forces = impulses_of(scene, scene.duration);
    for (double& f : forces) f /= scene.duration;
    const Table p{.legs = static_cast<int>(forces.size()), .offset = scene.bodies[0].position.x()};
    CHECK(p.misfit(forces) < 1e-11);
  }
  for (const int corners : {1, 2}) {
    const Tower p{.blocks = 8, .ratio = 10, .corners = corners};
    Scene scene = tower(p);
    scene.duration = 0x1p-7;
    const auto impulses = impulses_of(scene, scene.duration);
    for (int k = 1; k <= p.blocks; ++k) {
      double sum = 0;
      for (int c = 0; c < corners; ++c) sum += impulses[static_cast<std::size_t>(corners * (k - 1) + c)];
      CHECK(sum / scene.duration == doctest::Approx(p.force(k)).epsilon(1e-8));
    }
  }
  for (const int grains : {1, 10, 100}) {
    const GrainColumn p{.grains = grains};
    Scene scene = grain_column(p);
    scene.duration = 0x1p-7;
    const auto impulses = impulses_of(scene, scene.duration);
    for (int k = 1; k <= grains; ++k)
      CHECK(impulses[static_cast<std::size_t>(k - 1)] == doctest::Approx(p.impulse(k, scene.duration)).epsilon(1e-12));
  }
}

TEST_CASE("the arch: least thickness; it stands above and falls below") {
  for (const int voussoirs : {10, 20, 50})
    CHECK(Arch{.voussoirs = voussoirs}.least_thickness() == doctest::Approx(0.10746010989152).epsilon(1e-12));
  CHECK(Arch{.voussoirs = 1000}.least_thickness() == doctest::Approx(0.1074780381074763).epsilon(1e-5));
  const auto speed_after = [](double thickness) {
    Scene scene = arch({.thickness = thickness});
    scene.duration = 0.02;
    const Run r = run(scene, "rattle", 1e-3, {}, "auto");
    REQUIRE(r.status == Status::solved);
    return r.final.v.lpNorm<Eigen::Infinity>();
  };
  const Arch p;
  CHECK(speed_after(1.02 * p.least_thickness()) < 1e-10);
  CHECK(speed_after(0.98 * p.least_thickness()) > 1e-3);
}

TEST_CASE("one impact: a rough floor under a ball, a smooth one under a slanting rod") {
  const SphereBounce sticks, slides{.mu = 0.1};
  CHECK(sticks.after().vx == doctest::Approx(15.0 / 7).epsilon(1e-15));
  CHECK(-sticks.after().omega == doctest::Approx(15.0 / 7).epsilon(1e-15));
  CHECK(sticks.after().vy == doctest::Approx(3.2).epsilon(1e-15));
  CHECK(slides.after().vx == doctest::Approx(2.28).epsilon(1e-15));
  CHECK(-slides.after().omega == doctest::Approx(1.8).epsilon(1e-15));
  CHECK(RodDrop{}.after().impulse == doctest::Approx(0.6).epsilon(1e-15));
  CHECK(RodDrop{}.after().vy == doctest::Approx(-0.4).epsilon(1e-15));
  CHECK(-RodDrop{}.after().omega == doctest::Approx(1.2727922061357857).epsilon(1e-15));
}
