// Bodies that stand, lie and are pulled on several contacts: all contacts of a body act together.
#include "tests/support/event_record.h"

#include <orthant/core/scenes/motion.h>
#include <orthant/core/scenes/slider_crank_exact.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace orthant;

namespace {

/// Discs fall between two walls 1 m apart; the fifth of 0.2 m on the floor jams the row.
Scene pile(int discs, double mu, double e) {
  Scene s{.gravity = {0, -kGravity}};
  const double r = 0.1;
  for (int i = 0; i < discs; ++i) {
    const int row = i / 4, column = i % 4;
    const double mass = 1 + 0.1 * i;
    s.body({.mass = mass,
            .inertia = mass * r * r / 2,
            .position = {-0.3 + 0.213 * column + 0.052 * row, 0.15 + 0.011 * i + 0.25 * row},
            .omega = mu > 0 ? i : 0.0});
    const ContactLaw law{.mu = mu, .e = e};
    s.contact(DiscWall{"", i, {0, 0}, r, kGround, {0, 0}, {0, 1}, law});
    s.contact(DiscWall{"", i, {0, 0}, r, kGround, {-0.5, 0}, {1, 0}, law});
    s.contact(DiscWall{"", i, {0, 0}, r, kGround, {0.5, 0}, {-1, 0}, law});
    for (int j = 0; j < i; ++j) s.contact(DiscDisc{"", i, {0, 0}, r, j, {0, 0}, r, law});
  }
  return s;
}

}  // namespace

TEST_CASE("a box pulled ever harder: both corners let go together, when friction is used up") {
  Scene s{.gravity = {0, -kGravity}};
  s.body({.mass = 1, .inertia = 1.0 / 150, .position = {0, 0.1}});
  for (const double x : {-0.1, 0.1}) s.contact(CornerWall{"", 0, {x, -0.1}, kGround, {0, 0}, {0, 1}, {.mu = 0.3}});
  for (const double rise : {1.0, 1e-9}) {  // [s] until 10 N; within the shorter times are known to 1e-7 of it only
    CAPTURE(rise);
    s.loads.clear();
    s.load({.name = "pull", .body = 0, .force = {10, 0}, .factor = [=](double t) {
              return std::clamp(t / rise, 0.0, 1.0);
            }});
    s.loads[0].breakpoints = {rise};
    const double slip = 0.3 * kGravity / 10;
    for (const double step : {2.0, 0.1}) {
      const EventRecord record = tell(s, 2, step);
      REQUIRE(record.run.status == Status::solved);
      REQUIRE(record.events.size() == 2);
      for (const Event& e : record.events) {
        CHECK(e.kind == EventKind::slip);
        CHECK(e.t == doctest::Approx(slip * rise).epsilon(1e-6));
      }
      const double v = 5 * rise * (1 - slip) * (1 - slip) + 10 * (2 - rise) * (1 - slip);
      CHECK(record.run.final.v[0] == doctest::Approx(v).epsilon(1e-9));
    }
  }
}

TEST_CASE("piles come to rest, by event-driven and adaptive alike") {
  for (const char* spec : {"event-driven", "adaptive"}) {
    CAPTURE(spec);
    const Run smooth = run_for(pile(6, 0, 0.5), 2, spec, 0.1);
    REQUIRE_MESSAGE(smooth.status == Status::solved, smooth.why);
    // Five lie side by side from wall to wall, the sixth, of 1.4 kg, upon two of them.
    CHECK(smooth.energy_final == doctest::Approx(kGravity * (0.75 + 0.14 * std::sqrt(3.0))).epsilon(1e-6));
    CHECK(smooth.max_penetration <= 1e-6);
    const Run rough = run_for(pile(6, 0.3, 0.3), 2, spec, 0.1);
    REQUIRE(rough.status == Status::solved);
    CHECK(rough.energy_final > kGravity * 0.75);
    CHECK(rough.energy_final < 11);
    CHECK(rough.final.v.lpNorm<Eigen::Infinity>() <= 1e-3);
    CHECK(rough.max_penetration <= 1e-6);
    MESSAGE(std::string(spec) << ": " << smooth.seconds << " s, with friction " << rough.seconds << " s");
  }
}

TEST_CASE("rocking block: impacts without slip on time, and it comes to rest") {
  const double b = 0.1, h = 0.4, radius = std::hypot(b, h), alpha = std::atan2(b, h), tilt = alpha / 2;
  Scene s;
  s.gravity = {0, -kGravity};
  // Tilted about the left lower corner, which lies in the origin.
  const double up = std::numbers::pi / 2 - alpha + tilt;
  const auto block = s.body({.name = "block",
                             .mass = 1,
                             .inertia = radius * radius / 3,
                             .position = {radius * std::cos(up), radius * std::sin(up)},
                             .angle = tilt});
  s.contact(CornerWall{"left", block, {-b, -h}, kGround, {0, 0}, {0, 1}, {.mu = 1}});
  s.contact(CornerWall{"right", block, {b, -h}, kGround, {0, 0}, {0, 1}, {.mu = 1}});
  const EventRecord record = tell(s, 8, 1);
  REQUIRE(record.run.status == Status::solved);
  std::vector<double> times;
  for (const Event& e : record.of(EventKind::impact))
    if (times.empty() || e.t > times.back() + 1e-6) times.push_back(e.t);
  REQUIRE(times.size() > 10);
  const double exact[] = {0.31230857511262229, 0.82059222908260084, 1.251876744461843, 1.625866613309982};
  for (std::size_t i = 0; i < 4; ++i) CHECK(times[i] == doctest::Approx(exact[i]).epsilon(1e-10));
  CHECK(record.run.final.q[2] == doctest::Approx(0).epsilon(1e-10));
  CHECK(record.run.final.v.lpNorm<Eigen::Infinity>() <= 1e-12);
}

TEST_CASE("corners that strike together stay together, however often the run is looked at") {
  const Scene wide = slider_crank({.clearance = 0.01});
  const double theta1 = run_for(wide, 0.2, "event-driven", 0.2).final.q[2];
  for (const double step : {1e-2, 1e-3, 1e-4}) {
    const Run r = run_for(wide, 0.2, "event-driven", step);
    CAPTURE(step);
    CHECK(std::abs(r.final.q[2] - theta1) < 1e-9);
    CHECK(std::abs(r.final.q[8]) < 1e-11);
  }
}

TEST_CASE("blocks of mass 1, 1 and 1e6 stand: redundant contacts are no inconsistency") {
  for (const double mu : {0.0, 0.5}) {
    CAPTURE(mu);
    Scene s{.gravity = {0, -9.81}};
    const std::vector<Vector2d> square = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    const ContactLaw law{.mu = mu};
    for (int i = 0; i < 3; ++i) {
      const double mass = i < 2 ? 1 : 1e6;
      s.body({.mass = mass, .inertia = mass / 6, .position = {0, i + 0.5}});
    }
    for (const Vector2d& corner : {square[0], square[1]})
      s.contact(CornerWall{"", 0, corner, kGround, {0, 0}, {0, 1}, law});
    for (int i = 0; i < 2; ++i)
      for (const Vector2d& corner : {square[0], square[1]})
        s.contact(CornerWall{"", i + 1, corner, i, {0, 0.5}, {0, 1}, law});
    const Run r = run_for(s, 0.02, "event-driven", 0.01);
    INFO(r.why);
    CHECK(r.status == Status::solved);
    CHECK(r.final.v.lpNorm<Eigen::Infinity>() <= 1e-9);
  }
}

TEST_CASE("a box thrown up by a driven table stays level, however often the run is looked at") {
  Scene s{.gravity = {0, -kGravity}};
  s.body({.name = "table", .mass = 100, .inertia = 10});
  s.body({.name = "box", .mass = 1, .inertia = 1.0 / 150, .position = {0, 0.1}});
  s.joint(Prismatic{"guide", kGround, 0, {0, 0}, {0, 0}, {0, 1}});
  s.spring(PointSpring{"bed", kGround, 0, {0, -5}, {0, 0}, 1e5, 10, 5});
  s.load({.name = "drive", .body = 0, .force = {0, 3000}, .factor = [](double t) { return std::cos(20 * t); }});
  for (const double x : {-0.1, 0.1}) s.contact(CornerWall{"", 1, {x, -0.1}, 0, {0, 0}, {0, 1}, {.mu = 0.3, .e = 0.5}});
  for (const double step : {5.0, 0.1, 1e-2}) {
    const Run r = run_for(s, 5, kScheme, step);
    CAPTURE(step);
    REQUIRE(r.status == Status::solved);
    CHECK(std::abs(r.final.q[5]) < 1e-9);
    CHECK(r.final.q[4] == doctest::Approx(0.120587513).epsilon(1e-6));  // adaptive at 1e-9: 0.12058749
  }
}

TEST_CASE("friction redistributed repeatedly at one time: it ends as a crowd of events") {
  const Polygon plank = {{-0.3, -0.1}, {0.3, -0.1}, {0.3, 0.1}, {-0.3, 0.1}};
  const ContactLaw law{.mu = 1.5, .mu_static = 1.95};
  Scene s{.gravity = {0, -9.81}};
  const BodyId disc = s.body({.mass = 0.766,
                              .inertia = 0.0307,
                              .position = {0, 0.7},
                              .angle = -0.4766,
                              .velocity = {0.529, -1.053},
                              .omega = -4.215});
  const BodyId board = s.body({.mass = 0.573,
                               .inertia = 0.1051,
                               .position = {0.05, 0.15},
                               .angle = 0.2865,
                               .velocity = {-1.307, -1.724},
                               .omega = -4.782});
  s.contact_set(polygon_wall({.name = "floor", .a = board, .wall_point = {0, -0.5}, .law = law}, plank));
  s.contact(DiscPolygon{.name = "disc", .a = disc, .radius = 0.2, .b = board, .corners = plank, .law = law});
  const Run coarse = run_for(s, 0.4, kScheme, 0.01);
  REQUIRE(coarse.status == Status::solved);
  for (const double step : {1e-3, 1.5e-3}) {
    const Run fine = run_for(s, 0.4, kScheme, step);
    REQUIRE(fine.status == Status::solved);
    CHECK((fine.final.q - coarse.final.q).lpNorm<Eigen::Infinity>() <= 1e-10);
  }
}

TEST_CASE("a box's corner comes to the edge of another box: its normal jumps there, no velocity does") {
  const auto box = [](double x, double y) { return Polygon{{-x, -y}, {x, -y}, {x, y}, {-x, y}}; };
  const Polygon lower = box(0.31852913583277875, 0.24240270589579332),
                upper = box(0.22594898883315664, 0.16566352649908661);
  const ContactLaw law{.mu = 0.38899049574070471};
  Scene s{.gravity = {0, -9.81}};
  s.body({.mass = 1.5084387842771163,
          .inertia = 0.080560628107586518,
          .position = {-0.15733223164759308, 0.32864295135966332},
          .angle = 1.5278482063092722,
          .velocity = {-0.87180006373450325, -0.60615651709754947},
          .omega = 2.6527271013350129});
  s.body({.mass = 0.95068959020101795,
          .inertia = 0.024875537697188237,
          .position = {-0.10095706132862046, 0.83339687041986343},
          .angle = -0.14673138132570901,
          .velocity = {-0.55527520936132668, -0.94283611939874934},
          .omega = 4.6506000620929999});
  s.contact_set(polygon_wall({.name = "floor", .a = 0, .law = law}, lower));
  s.contact_set(polygon_polygon({.name = "pair", .a = 0, .corners_a = lower, .b = 1, .corners_b = upper, .law = law}));
  const Eigen::VectorXd exact = run_for(s, 0.013, "moreau-jean", 1e-6).final.q;  // to 1e-7
  for (const char* spec : {"event-driven", "event-driven:rtol=1e-8", "adaptive"})
    for (const double h : {0.013, 1e-3}) {
      CAPTURE(spec);
      CAPTURE(h);
      const Run r = run_for(s, 0.013, spec, h);
      REQUIRE(r.status == Status::solved);
      CHECK((r.final.q - exact).lpNorm<Eigen::Infinity>() <= 1e-6);
    }
}

TEST_CASE("a drawer that friction locks in its guide stays at rest, without changes of mode and without crossings") {
  const double length = 0.2, height = 0.1;
  for (const double mu : {0.6, 1.0})
    for (const double swing : {0.0, 5.0}) {
      CAPTURE(mu);
      CAPTURE(swing);
      Scene s{.duration = 1};
      const BodyId drawer = s.body({.inertia = 0.004});
      for (const double x : {-1, 1})
        for (const double y : {-1, 1})
          s.contact(CornerWall{
              "", drawer, {x * length / 2, y * height / 2}, kGround, {0, y * height / 2}, {0, -y}, {.mu = mu}});
      s.load({.name = "push", .body = drawer, .point = {-length / 2, -0.4}, .force = {10, 0}});
      s.load({.name = "more",
              .body = drawer,
              .point = {-length / 2, -0.4},
              .force = {3, 0},
              .factor = [=](double t) { return swing > 0 ? std::cos(swing * t) : 0.0; },
              .omega = swing});
      for (const char* scheme : {"event-driven", "adaptive"}) {
        CAPTURE(scheme);
        const Run r = run(s, scheme, 1e-2, {}, "auto");
        CHECK_MESSAGE(r.status == Status::solved, r.why);
        CHECK(r.crossings == 0);
        CHECK(r.events < 10);
        CHECK(r.final.q.lpNorm<Eigen::Infinity>() < 1e-12);
      }
    }
}

namespace {

/// A rotor that its motor turns at constant speed: it does no work.
void add_idle_motor(Scene& s) {
  const BodyId rotor = s.body({.name = "rotor", .position = {9, 0}, .omega = 1});
  const Revolute shaft{"shaft", kGround, rotor, {9, 0}, {0, 0}};
  s.joint(shaft);
  s.joint(Drive{"motor", Angle{kGround, rotor}, {.rate_of_change = 1}});
}

}  // namespace

TEST_CASE("a drive that does no work shortens no step of bodies that rest or slide elsewhere") {
  for (const double mu : {0.0, 0.3})
    for (const double speed : {0.0, 0.3}) {
      Scene s{.gravity = {0, -9.81}, .duration = 0.05};
      add_idle_motor(s);
      const BodyId box = s.body({.name = "box", .inertia = 0.0067, .position = {0, 0.1}, .velocity = {speed, 0}});
      for (const Vector2d& corner : rectangle(0.2, 0.2))
        s.contact(CornerWall{{}, box, corner, kGround, {0, 0}, {0, 1}, {.mu = mu}});
      for (const char* scheme : {"event-driven", "adaptive"}) {
        CAPTURE(mu);
        CAPTURE(speed);
        CAPTURE(scheme);
        const Run r = run(s, scheme, s.duration);
        INFO(r.why);
        CHECK(r.status == Status::solved);
        CHECK(r.crossings == 0);
        CHECK(r.accepted < 40);
        CHECK(std::abs(r.motion.work) < 1e-12);
      }
    }
}

TEST_CASE("the work of drives is that of the contacts that act, whatever contacts are listed before them") {
  for (const char* scheme : {"event-driven", "adaptive"})
    for (const bool last : {false, true}) {
      CAPTURE(scheme);
      CAPTURE(last);
      Scene s{.gravity = {0, -10}, .duration = 1};
      const BodyId ball =
          s.body({.name = "ball", .mass = 0.1, .inertia = 1e-3, .position = {-5, 1}, .velocity = {0, 20}});
      const BodyId lift = s.body({.name = "lift", .inertia = 0.1, .velocity = {0, 0.1}});
      const BodyId box = s.body({.name = "box", .inertia = 0.01, .position = {0, 0.1}, .velocity = {0, 0.1}});
      s.joint(Prismatic{"rail", kGround, lift, {0, 0}, {0, 0}, {0, 1}, 0});
      s.joint(Drive{"winch", Slide{kGround, lift, {0, 0}, {0, 0}, {0, 1}}, {.rate_of_change = 0.1}});
      const DiscWall above{"ball_on_floor", ball, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {}},
          on{"box_on_lift", box, {0, 0}, 0.1, lift, {0, 0}, {0, 1}, {}};
      s.contact(last ? on : above), s.contact(last ? above : on);
      for (const double step : {0.01, 1.0}) {
        const Run r = run(s, scheme, step);
        REQUIRE(r.status == Status::solved);
        CHECK(r.motion.work == doctest::Approx(2).epsilon(1e-9));
        CHECK(r.motion.energy_defect < 1e-9);
      }
    }
}
