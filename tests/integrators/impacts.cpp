// Impact laws by name: exact answers of impacts one at a time and together, what each law conserves, and what it costs.
#include "tests/support/runs.h"

#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/cradle.h>
#include <orthant/core/scenes/grain_column.h>
#include <orthant/core/scenes/rod_drop.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/sphere_bounce.h>
#include <orthant/core/scenes/superball.h>
#include <orthant/integrators/fixed_step/moreau_jean.h>
#include <orthant/integrators/fixed_step/paoli_schatzman.h>
#include <orthant/integrators/fixed_step/rattle.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace orthant;

namespace {

constexpr std::array kWithLaws = {"moreau-jean", "moreau-jean:form=full", "stewart-trinkle", "event-driven"};
constexpr std::array kRestitutions = {Restitution::newton, Restitution::poisson};
constexpr std::array kOrders = {Impacts::simultaneous, Impacts::sequential};

State end(const Scene& scene, std::string_view integrator, std::string_view solver = "lemke") {
  const Run r = run(scene, integrator, scene.step, {}, solver);
  REQUIRE_MESSAGE(r.status == Status::solved, r.why);
  return r.final;
}

/// A rod that strikes a rough floor at a slant, so that normal and tangential directions see each other.
Scene rough_rod(Restitution restitution, double mu, double e, double vx) {
  Scene s = rod_drop({.angle = 1.1, .e = e, .restitution = restitution});
  s.bodies[0].velocity.x() = vx;
  for (Contact& c : s.contacts) std::get<CornerWall>(c).law.mu = mu;
  return s;
}

}  // namespace

TEST_CASE("cradle and super-ball: the speeds that each law of impact gives, momentum and energy with them") {
  for (const char* integrator : kWithLaws)
    for (const Restitution restitution : kRestitutions)
      for (const Impacts impacts : kOrders) {
        CAPTURE(integrator);
        CAPTURE(static_cast<int>(restitution));
        CAPTURE(static_cast<int>(impacts));
        for (const int balls : {2, 3, 4, 7})
          for (const double e : {0.0, 0.5, 1.0}) {
            const Cradle p{.balls = balls, .e = e, .impacts = impacts, .restitution = restitution};
            const State x = end(cradle(p), integrator);
            const auto exact = p.after();
            double momentum = 0, energy = 0;
            for (int i = 0; i < balls; ++i) {
              CHECK(std::abs(x.v[3 * i] - exact[static_cast<std::size_t>(i)]) < 1e-9);
              momentum += x.v[3 * i], energy += x.v[3 * i] * x.v[3 * i];
            }
            CHECK(std::abs(momentum - 1) < 1e-14);
            if (e == 1) CHECK(std::abs(energy - 1) < 1e-14);
          }
        for (const double ratio : {1.0, 3.0, 1e6}) {
          const SuperBall p{.ratio = ratio, .gap = 0, .impacts = impacts, .restitution = restitution};
          const State x = end(superball(p), integrator);
          CHECK(std::abs(x.v[1] - p.after().lower) < 1e-13);
          CHECK(std::abs(x.v[4] - p.after().upper) < 1e-13);
        }
      }
  for (const char* integrator : {"moreau-jean", "adaptive", "event-driven"}) {  // by a gap, under the plain law
    const SuperBall p;
    const State x = end(superball(p), integrator);
    CHECK(std::abs(x.v[4] - p.after().upper) < 1e-9);
  }
}

TEST_CASE("one contact by itself: both laws give Newton's result, step by step where forces act too") {
  for (const char* integrator : kWithLaws)
    for (const Restitution restitution : kRestitutions) {
      CAPTURE(integrator);
      for (const double mu : {0.5, 0.1}) {
        const SphereBounce p{.mu = mu, .restitution = restitution};
        const State x = end(sphere_bounce(p), integrator);
        CHECK(std::abs(x.v[0] - p.after().vx) < 1e-14);
        CHECK(std::abs(x.v[1] - p.after().vy) < 1e-14);
        CHECK(std::abs(x.v[2] - p.after().omega) < 1e-14);
      }
      const RodDrop p{.restitution = restitution};
      const State x = end(rod_drop(p), integrator);
      CHECK(std::abs(x.v[1] - p.after().vy) < 1e-12);
      CHECK(std::abs(x.v[2] - p.after().omega) < 1e-12);
    }
  for (const char* integrator : {"moreau-jean", "stewart-trinkle"}) {
    Scene ball = bouncing_ball({.e = 0.8});
    const State newton = end(ball, integrator);
    ball.restitution = Restitution::poisson;
    const State poisson = end(ball, integrator);
    CHECK((newton.q - poisson.q).norm() < 1e-13);
    ball.restitution = Restitution::newton, ball.impacts = Impacts::sequential;
    CHECK((end(ball, integrator).q - newton.q).norm() < 1e-13);
  }
}

TEST_CASE("impacts one after the other end where what is left is rounding of the rates") {
  Scene s{.gravity = {0, -9.81}, .restitution = Restitution::poisson, .impacts = Impacts::sequential};
  const BodyId disc = s.body({.mass = 1.130600807147834,
                              .inertia = 0.015653759751076187,
                              .position = {0.012431213300705636, 0.6},
                              .angle = 0.06846683390174602,
                              .velocity = {0.22108947362801246, -1.4192310755916167},
                              .omega = -1.3280654989613394});
  s.contact(DiscWall{{},
                     disc,
                     {-0.033416466295614386, 0},
                     0.1323676738280534,
                     kGround,
                     {0, 0},
                     Vector2d(-0.14067144814005922, 1).normalized(),
                     {.mu = 0.1, .belt = -0.04646243792202376}});
  for (const double step : {1e-3, 5e-4, 1e-4}) {
    CAPTURE(step);
    s.step = step, s.duration = 1;
    const Run r = run(s, "moreau-jean", step);
    CHECK(r.status == Status::solved);
    CHECK(r.why == "");
  }
}

TEST_CASE("every solver of the registry carries the laws") {
  for (const SolverEntry& entry : solvers())
    for (const Restitution restitution : kRestitutions)
      for (const Impacts impacts : kOrders) {
        Scene s = rough_rod(restitution, 0.3, 0.5, 1);
        s.impacts = impacts;
        const Run r = run(s, "moreau-jean", s.step, {}, entry.name), by_lemke = run(s, "moreau-jean", s.step);
        CAPTURE(entry.name);
        REQUIRE(by_lemke.status == Status::solved);
        if (r.status == Status::solved) CHECK((r.final.v - by_lemke.final.v).norm() < 1e-6);
      }
}

TEST_CASE(
    "impacts one after the other: what approaches equally fast strikes together, no order of the scene's decides") {
  Scene scene;
  scene.impacts = Impacts::sequential;
  scene.duration = 0.01;
  const auto block = scene.body({.name = "block", .mass = 2, .inertia = 0.1, .velocity = {0, -1}});
  for (const double side : {-0.5, 0.5})
    scene.contact(CornerWall{"", block, {side, 0}, kGround, {0, 0}, {0, 1}, {.e = 0.5}});
  for (const Restitution law : {Restitution::newton, Restitution::poisson}) {
    scene.restitution = law;
    const Run r = run(scene, "moreau-jean", 1e-3);
    REQUIRE(r.status == Status::solved);
    CHECK(r.final.v[1] == doctest::Approx(0.5));
    CHECK(std::abs(r.final.v[2]) < 1e-14);
  }
}

TEST_CASE("a contact that is listed twice changes no impact, whichever copy a solver gives the impulse") {
  const auto plank = [](Restitution restitution, Impacts impacts, double mu, double e, int again) {
    Scene s{.gravity = {0, -9.81}, .restitution = restitution, .impacts = impacts};
    s.duration = 0.2, s.step = 1e-3;
    const BodyId body = s.body({.mass = 1, .inertia = 0.2, .position = {0, 0.2}, .velocity = {0.3, -1}, .omega = 0.4});
    for (int i = 0; i < 4; ++i) {
      const CornerWall corner{.a = body, .point = {i % 2 == 0 ? -0.5 : 0.4, -0.1}, .law = {.mu = mu, .e = e}};
      if (i < 2 || i - 2 == again || again == 2) s.contact(corner);
    }
    return s;
  };
  for (const char* integrator : {"moreau-jean", "stewart-trinkle"})
    for (const Restitution restitution : kRestitutions)
      for (const Impacts impacts : kOrders)
        for (const double mu : {0.0, 0.2})
          for (const double e : {0.5, 0.9}) {
            const State once = end(plank(restitution, impacts, mu, e, -1), integrator);
            for (const int again : {0, 1, 2})
              for (const char* solver : {"lemke", "path", "auto", "psor:omega=1", "newton-min"}) {
                CAPTURE(integrator);
                CAPTURE(static_cast<int>(restitution));
                CAPTURE(static_cast<int>(impacts));
                CAPTURE(mu);
                CAPTURE(e);
                CAPTURE(again);
                CAPTURE(solver);
                const State twice = end(plank(restitution, impacts, mu, e, again), integrator, solver);
                CHECK((twice.v - once.v).lpNorm<Eigen::Infinity>() < 1e-9);
              }
          }
}

TEST_CASE("column of grains: impulses of all levels, exact for every law") {
  for (const char* integrator : kWithLaws)
    for (const Restitution restitution : kRestitutions) {
      const GrainColumn p{.grains = 10, .g = 0};
      Scene s = grain_column(p);
      s.restitution = restitution;
      std::vector<double> sum(s.contacts.size());
      const Run r = run(s, integrator, s.step, [&](const RunSample& m) {
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += m.impulses[i].normal;
      });
      CAPTURE(integrator);
      REQUIRE(r.status == Status::solved);
      for (int k = 1; k <= p.grains; ++k)
        CHECK(sum[static_cast<std::size_t>(k - 1)] == doctest::Approx(p.impulse(k, 0)).epsilon(1e-12));
      CHECK(r.energy_rises == 0);
    }
}

TEST_CASE("Newton's law with friction raises the energy, and the rise is reported; Poisson's law does not") {
  // By scanning starts: where normal and tangential directions are coupled, slip that turns round makes the difference.
  int rises = 0;
  for (const char* integrator : {"moreau-jean", "event-driven", "rattle", "adaptive"})
    for (const double vx : {-2.0, -1.0, -0.5, 0.5, 1.0, 2.0})
      for (const double mu : {0.3, 1.0}) {
        CAPTURE(integrator);
        const Run newton = run(rough_rod(Restitution::newton, mu, 0.9, vx), integrator, 1e-3);
        REQUIRE(newton.status == Status::solved);
        const double rise = newton.energy_final - newton.energy_initial;
        CHECK((newton.energy_rises > 0) == (rise > 1e-9));
        if (newton.energy_rises == 0) continue;
        ++rises;
        CHECK(newton.energy_rises == 1);
        const bool exact =
            std::string_view(integrator) == "moreau-jean" || std::string_view(integrator) == "event-driven";
        CHECK(newton.max_energy_rise ==
              doctest::Approx(rise).epsilon(exact ? 1e-9 : 0.02));  // else: rows of other times
        CHECK(newton.max_energy_rise_time == doctest::Approx(0.01).epsilon(0.2));
        if (!exact) continue;
        const Run poisson = run(rough_rod(Restitution::poisson, mu, 0.9, vx), integrator, 1e-3);
        REQUIRE(poisson.status == Status::solved);
        CHECK(poisson.energy_rises == 0);
        CHECK(poisson.energy_final <= poisson.energy_initial);
      }
  CHECK(rises >= 4);
  // Schemes that locate events give the time of the event, whatever the output step.
  int located = 0;
  for (const char* integrator : {"event-driven", "adaptive"})
    for (const double vx : {-2.0, -1.0, 1.0, 2.0}) {
      const Scene s = rough_rod(Restitution::newton, 1.0, 0.9, vx);
      std::vector<double> impacts;
      const Run r = run(s, integrator, s.duration, [&](const RunSample& m) {
        for (const Event& event : m.events) impacts.push_back(event.t);
      });
      if (r.energy_rises == 0) continue;
      ++located;
      CHECK(std::find(impacts.begin(), impacts.end(), r.max_energy_rise_time) != impacts.end());
    }
  CHECK(located > 0);
  // Each rise counts, also where one step has several; the largest and their number bound what came in.
  int several = 0;
  for (const char* integrator : {"event-driven", "adaptive"})
    for (const double vx : {-2.0, -1.0, 1.0, 2.0}) {
      Scene s = rough_rod(Restitution::newton, 1.0, 0.9, vx);
      Body other = s.bodies[0];
      other.name = "other", other.position += Vector2d{10, 0.002};
      const BodyId twin = s.body(other);
      for (const double end : {-1.0, 1.0}) {
        CornerWall corner = std::get<CornerWall>(s.contacts[end < 0 ? 0 : 1]);
        corner.name = "", corner.a = twin;
        s.contact(corner);
      }
      const Run once = run(rough_rod(Restitution::newton, 1.0, 0.9, vx), integrator, s.duration);
      const Run r = run(s, integrator, s.duration);
      REQUIRE(r.status == Status::solved);
      CHECK(r.energy_rises == 2 * once.energy_rises);
      CHECK(r.energy_final - r.energy_initial <= static_cast<double>(r.energy_rises) * r.max_energy_rise + 1e-9);
      several += r.energy_rises > 1;
    }
  CHECK(several > 0);
  // What only the step does is not counted: bounces under gravity, contacts of a fast mechanism with much too long
  // steps.
  for (const double e : {0.0, 0.9, 1.0}) CHECK(run(bouncing_ball({.e = e}), "moreau-jean", 1e-3).energy_rises == 0);
  for (const char* integrator : {"moreau-jean", "stewart-trinkle", "rattle"})
    for (const double h : {1e-3, 1e-4}) CHECK(run(slider_crank(), integrator, h).energy_rises == 0);
}

TEST_CASE("tangential restitution is for impacts: what slides on is under friction alone, scheme by scheme") {
  Scene block;
  block.gravity = {0, -kGravity};
  block.body({.mass = 1, .inertia = 1, .position = {0, 0}, .velocity = {2, 0}});
  block.contact(CornerWall{"floor", 0, {0, 0}, kGround, {0, 0}, {0, 1}, {.mu = 0.3, .e_t = -1}});
  const SphereBounce ball{.mu = 10};
  Scene bounce = sphere_bounce(ball);
  for (Contact& c : bounce.contacts) std::visit([](auto& contact) { contact.law.e_t = 0.5; }, c);
  const double grip = 1 / (1 + 1 / ball.inertia_factor);  // of Δγ_T that goes into v_x
  for (const std::string_view spec :
       {"moreau-jean", "stewart-trinkle", "generalized-alpha", "rattle", "event-driven", "adaptive"}) {
    CAPTURE(spec);
    const Run slid = run_for(block, 0.5, spec, 1e-3);
    REQUIRE(slid.status == Status::solved);
    CHECK(std::abs(slid.final.v[0] - (2 - 0.3 * kGravity * 0.5)) <= (spec == "adaptive" ? 1e-6 : 1e-9));
    const Run bounced = run(bounce, spec, bounce.step);
    REQUIRE(bounced.status == Status::solved);
    CHECK(std::abs(bounced.final.v[0] - (ball.vx - grip * 1.5 * ball.vx)) <= 1e-9);
  }
  const System system(block);
  CHECK_THROWS_WITH_AS(
      make_integrator("paoli-schatzman", system),
      "integrator paoli-schatzman: contact \"floor\" has e_t = -1: must be 0, or the integrator one of "
      "moreau-jean, stewart-trinkle, anitescu-potra, generalized-alpha, rattle, adaptive, event-driven",
      std::invalid_argument);
}

TEST_CASE("an integrator that cannot take a law says so when it is made") {
  for (const IntegratorEntry& entry : integrators())
    for (const auto& [restitution, impacts] :
         {std::pair{Restitution::poisson, Impacts::simultaneous}, {Restitution::newton, Impacts::sequential}}) {
      Scene s = cradle({.impacts = impacts, .restitution = restitution});
      const System system(s);
      std::string said;
      try {
        make_integrator(entry.name, system);
      } catch (const std::invalid_argument& error) {
        said = error.what();
      }
      const bool takes = entry.name == "moreau-jean" || entry.name == "stewart-trinkle" ||
                         entry.name == "event-driven" || entry.name == "adaptive";
      CHECK(said.empty() == takes);
      if (takes) continue;
      CHECK(said.starts_with("integrator " + std::string(entry.name) + ": "));
      CHECK(said.ends_with("one of moreau-jean, stewart-trinkle, adaptive, event-driven"));
      CHECK(said.find(restitution == Restitution::poisson ? "restitution = \"poisson\"" : "impacts = \"sequential\"") !=
            std::string::npos);
    }
}

TEST_CASE("each integrator takes or refuses each feature as its capabilities say, made by name or directly") {
  Scene laws = cradle({.impacts = Impacts::sequential, .restitution = Restitution::newton});
  Scene grip = sphere_bounce({});
  for (Contact& c : grip.contacts) std::visit([](auto& contact) { contact.law.e_t = 0.5; }, c);
  Scene brake;
  brake.body({.name = "wheel", .mass = 1, .inertia = 1});
  brake.joint(Revolute{"axle", kGround, 0, {0, 0}, {0, 0}});
  brake.friction({"brake", Angle{kGround, 0}, 0, 0.1, 0.05, 0});  // by the load of the axle
  const auto throws = [](const auto& make) {
    try {
      make();
    } catch (const std::invalid_argument&) {
      return true;
    }
    return false;
  };
  for (const IntegratorEntry& entry : integrators()) {
    CAPTURE(entry.name);
    const auto refuses = [&](const Scene& scene) {
      const System system(scene);
      return throws([&] { make_integrator(entry.name, system); });
    };
    CHECK(refuses(laws) == !entry.can.impact_laws);
    CHECK(refuses(grip) == !entry.can.tangential_restitution);
    CHECK(refuses(brake) == !entry.can.loaded_friction);
    const System plain(slider_crank({}));
    CHECK(make_integrator(entry.name, plain)->controls_step() == entry.can.error_control);
  }
  const System struck(grip), turning(brake);
  CHECK(throws([&] { PaoliSchatzman direct(struck); }));
  CHECK(throws([&] { Rattle direct(turning); }));
  CHECK_FALSE(throws([&] { MoreauJean direct(turning); }));
}

// A system that ends before its integrator would leave it dangling.
template <class Given>
concept makes_integrator = requires(Given&& system) {
  make_integrator("rattle", std::forward<Given>(system));
};
static_assert(makes_integrator<const System&> && makes_integrator<System&> && !makes_integrator<System>);
