// Ghost collisions: what slides over a seam between neighbours that lie flush moves on as over one surface.
#include <doctest/doctest.h>

#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

#include <orthant/core/mechanics/planar/chain.h>
#include <orthant/core/mechanics/scene/derivatives.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {
namespace {

using testing::Draws;
using testing::VectorXd;

Polygon block(double left, double right, double bottom, double top) {
  return {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
}

Vector2d turned(const Vector2d& p, double angle) { return Eigen::Rotation2Dd(angle) * p; }
Polygon placed(Polygon p, double angle, const Vector2d& at) {
  for (Vector2d& corner : p) corner = turned(corner, angle) + at;
  return p;
}

/// A box or a disc that slides on tiles of the ground, all of it turned by `angle` and moved.
struct OnTiles {
  double width = 0.5, height = 0.5, speed = 3, mu = 0, angle = 0, slope = 0, seconds = 0.2, left = 2;
  double start = 0.2;                  // [m] of the centre from the left tile's end
  std::vector<double> seams = {0, 2};  // [m] the tiles' ends; the first reaches back to −left
  Vector2d at{0, 0};
  bool disc = false;

  Scene scene() const {
    Scene s{.gravity = turned({kGravity * std::sin(slope), -kGravity * std::cos(slope)}, angle), .duration = seconds};
    s.body({.name = "box",
            .mass = 1,
            .inertia = disc ? height * height / 8 : (width * width + height * height) / 12,
            .position = turned({start, height / 2}, angle) + at,
            .angle = angle,
            .velocity = turned({speed, 0}, angle),
            .omega = 0});
    const ContactLaw law{.mu = mu};
    double from = -left;
    for (const double to : seams) {
      const Polygon tile = placed(block(from, to, -0.5, 0), angle, at);
      if (disc)
        s.contact(DiscPolygon{"", 0, {0, 0}, height / 2, kGround, tile, law});
      else
        s.contact_set(polygon_polygon(
            {"tile" + std::to_string(s.contacts.size()), 0, rectangle(width, height), kGround, tile, 0, law}));
      from = to;
    }
    return s;
  }
  /// As on one half-plane: the way and the speed along it.
  Vector2d exact() const {
    const double pull = kGravity * std::sin(slope), rub = mu * kGravity * std::cos(slope);
    const double stops = rub > pull ? speed / (rub - pull) : kInf, t = std::min(seconds, stops);
    return {start + speed * t + (pull - rub) * t * t / 2, speed + (pull - rub) * t};
  }
  /// Largest of: the way's error [m], the speed's [m/s], height's, tilt's.
  double error(const Run& run) const {
    const Vector2d q = turned(Vector2d(run.final.q.head<2>()) - at, -angle), v = turned(run.final.v.head<2>(), -angle);
    const Vector2d right = exact();
    double worst = std::max(
        {std::abs(q.x() - right.x()), std::abs(v.x() - right.y()), std::abs(q.y() - height / 2), std::abs(v.y())});
    if (!disc) worst = std::max({worst, std::abs(run.final.q[2] - angle), std::abs(run.final.v[2])});
    return worst;
  }
};

OnTiles random_tiles(Draws& random) {
  OnTiles s;
  s.width = random(0.1, 0.9), s.height = s.width * random(0.4, 1.6);
  s.speed = random(0.5, 8), s.start = random(-0.6, 0.4);
  s.seams = {random(-0.1, 0.1)};
  const int tiles = static_cast<int>(random(1, 4));
  for (int i = 0; i < tiles; ++i) s.seams.push_back(s.seams.back() + random(0.2, 1));
  s.seams.back() += 3;
  s.mu = random(0, 1) < 0.5 ? 0 : 0.1;
  if (random(0, 1) < 0.6) s.angle = random(-3, 3);
  if (random(0, 1) < 0.5) s.at = random.point(20);
  if (random(0, 1) < 0.3) s.slope = random(-0.2, 0.5);
  return s;
}

constexpr std::string_view kEveryIntegrator[] = {"moreau-jean",     "stewart-trinkle",   "anitescu-potra",
                                                 "paoli-schatzman", "generalized-alpha", "rattle",
                                                 "adaptive",        "event-driven"};

/// Schemes of fixed step are exact where nothing accelerates the motion along the surface; else of first order in h,
/// and the relaxed friction of anitescu-potra lifts what slides by a part of it.
double allowed(std::string_view scheme, bool accelerated, double h) {
  return scheme == "adaptive" ? 1e-5 : scheme == "event-driven" || !accelerated ? 1e-7 : 4 * h;
}

}  // namespace

TEST_CASE("a box slides over seams between flush tiles as over one surface, with every integrator") {
  for (const std::string_view scheme : kEveryIntegrator) {
    Draws random(11);
    int wrong = 0;
    for (int i = 0; i < 200; ++i) {
      const OnTiles slide = random_tiles(random);
      const double h = i % 2 == 0 ? 5e-3 : 2e-3;
      const Run r = run(slide.scene(), scheme, h);
      const bool right =
          r.status == Status::solved && slide.error(r) < allowed(scheme, slide.mu > 0 || slide.slope != 0, h);
      if (!right && ++wrong <= 3)
        MESSAGE(std::string(scheme), " ", i, " mu ", slide.mu, " slope ", slide.slope, " angle ", slide.angle, " v ",
                slide.speed, " h ", h, " err ", slide.error(r), " ", std::string(name(r.status)), " ", r.why);
    }
    CAPTURE(scheme);
    CHECK(wrong == 0);
  }
}

TEST_CASE("a box that stands exactly on seams at the ends of steps goes on, with every integrator") {
  for (const std::string_view scheme : kEveryIntegrator)
    for (const double h : {1e-3, 2e-3, 5e-3, 1e-2, 0.05}) {
      CAPTURE(scheme);
      CAPTURE(h);
      OnTiles slide;  // 3 m/s: the corners are at 0, 0.5, 1 at multiples of 0.05 s
      slide.start = -0.4, slide.seams = {0, 0.5, 1, 3}, slide.seconds = 0.5;
      const Run r = run(slide.scene(), scheme, h);
      INFO(r.why);
      CHECK(r.status == Status::solved);
      CHECK(slide.error(r) < allowed(scheme, false, h));
    }
}

TEST_CASE("a disc slides over seams between flush tiles as over one surface, with every integrator") {
  for (const std::string_view scheme : kEveryIntegrator) {
    Draws random(12);
    int wrong = 0;
    for (int i = 0; i < 100; ++i) {
      OnTiles slide = random_tiles(random);
      slide.disc = true, slide.mu = 0;
      const Run r = run(slide.scene(), scheme, 5e-3);
      const bool right = r.status == Status::solved && slide.error(r) < allowed(scheme, slide.slope != 0, 5e-3);
      if (!right && ++wrong <= 3)
        MESSAGE(std::string(scheme), " ", i, " slope ", slide.slope, " angle ", slide.angle, " err ", slide.error(r),
                " ", std::string(name(r.status)), " ", r.why);
    }
    CAPTURE(scheme);
    CHECK(wrong == 0);
  }
}

TEST_CASE("shapes of a collision: a box and a disc slide over a row of ground tiles") {
  for (const std::string_view scheme : kEveryIntegrator) {
    CAPTURE(scheme);
    for (const double mu : {0.0, 0.1}) {
      Scene s{.gravity = {0, -kGravity}, .duration = 0.5};
      s.body({.name = "box", .inertia = 0.04, .position = {0.3, 0.25}, .velocity = {3, 0}});
      s.body({.name = "disc", .inertia = 0.01, .position = {-2.7, 0.2}, .velocity = {3, 0}});
      Collision c{.name = "all", .shapes = {}, .law = {.mu = mu}, .neighbours = 12};
      for (int i = -8; i < 8; ++i) c.shapes.push_back({.corners = block(0.5 * i, 0.5 * (i + 1), -0.3, 0)});
      c.shapes.push_back({.body = 0, .corners = rectangle(0.5, 0.5)});
      if (mu == 0) c.shapes.push_back({.body = 1, .radius = 0.2});
      s.collision(c);
      const Run r = run(s, scheme, 2e-3);
      REQUIRE(r.status == Status::solved);
      CHECK(std::abs(r.final.q[0] - (0.3 + 1.5 - mu * kGravity / 8)) < allowed(scheme, mu > 0, 2e-3));
      CHECK(std::abs(r.final.q[1] - 0.25) < (scheme == "anitescu-potra" && mu > 0 ? 1e-3 : 1e-9));
      CHECK(std::abs(r.final.q[2]) < 1e-9);
      if (mu > 0) continue;
      CHECK(std::abs(r.final.q[3] - (-2.7 + 1.5)) < 1e-9);
      CHECK(std::abs(r.final.q[4] - 0.2) < 1e-9);
    }
  }
}

TEST_CASE("a box slides over two free boxes that lie side by side, with every integrator") {
  for (const std::string_view scheme : kEveryIntegrator)
    for (const double mu : {0.0, 0.1}) {
      CAPTURE(scheme);
      CAPTURE(mu);
      Scene s{.gravity = {0, -kGravity}, .duration = 0.5};
      s.body({.name = "box", .mass = 1, .inertia = 0.04, .position = {-0.7, 0.75}, .velocity = {3, 0}});
      for (const double x : {-1.0, 1.0}) {
        const BodyId under = s.body({.mass = 20, .inertia = 7, .position = {x, 0.25}});
        s.contact_set(polygon_wall({"floor" + std::to_string(under), under, {}, kGround, {0, 0}, {0, 1}, {.mu = 0.8}},
                                   rectangle(2, 0.5)));
        s.contact_set(polygon_polygon(
            {"on" + std::to_string(under), 0, rectangle(0.5, 0.5), under, rectangle(2, 0.5), 0, {.mu = mu}}));
      }
      const Run r = run(s, scheme, 2e-3);
      INFO(r.why);
      REQUIRE(r.status == Status::solved);
      CHECK(std::abs(r.final.q[0] - (-0.7 + 1.5 - mu * kGravity / 8)) < allowed(scheme, mu > 0, 2e-3));
      CHECK(std::abs(r.final.q[1] - 0.75) < (scheme == "anitescu-potra" && mu > 0 ? 1e-3 : 1e-6));
      CHECK(std::abs(r.final.q[2]) < 1e-6);
      CHECK(std::abs(r.final.q[3] + 1) < 1e-6);
      CHECK(std::abs(r.final.q[6] - 1) < 1e-6);
    }
}

namespace {

const std::vector<Vector2d> kRamp = {{-4, 0}, {-1, 0}, {0, 0}, {3, 3 * std::tan(0.3)}};

/// A frictionless disc comes along the flat and meets the ramp without rebound: its speed along the ramp goes on.
double way_up(double radius, double speed, double start, double t) {
  const double meets = (-radius * std::tan(0.15) - start) / speed, s = t - meets;
  return speed * std::cos(0.3) * s - kGravity * std::sin(0.3) * s * s / 2;
}

}  // namespace

TEST_CASE("a chain: no joint of a flat part is felt, and a concave one turns the way, with every integrator") {
  for (const std::string_view scheme : kEveryIntegrator) {
    CAPTURE(scheme);
    const double radius = 0.2, speed = 4, start = -1.5, t = 0.6, h = 1e-3;
    Scene s{.gravity = {0, -kGravity}, .duration = t};
    s.body({.name = "disc", .inertia = 0.02, .position = {start, radius}, .velocity = {speed, 0}});
    s.contact_set(chain_disc({.name = "ground", .a = 0, .radius = radius}, {.points = kRamp}));
    CHECK(s.contacts.size() == 2);  // points in a line are one segment
    const Run r = run(s, scheme, h);
    INFO(r.why);
    REQUIRE(r.status == Status::solved);
    const Vector2d along(std::cos(0.3), std::sin(0.3));
    const Vector2d centre = Vector2d(-radius * std::tan(0.15), radius) + way_up(radius, speed, start, t) * along;
    const double allowed = scheme == "event-driven" ? 1e-9 : scheme == "adaptive" ? 1e-5 : 2 * speed * h;
    CHECK((r.final.q.head<2>() - centre).norm() < allowed);
    if (scheme == "event-driven") CHECK((run(s, scheme, 0.1).final.q.head<2>() - centre).norm() < allowed);
  }
}

TEST_CASE("a chain: a box slides off a flat part, down over a convex joint, and rests in a valley") {
  Scene s{.gravity = {0, -kGravity}, .duration = 4};
  s.body({.name = "box", .inertia = 0.01, .position = {-0.5, 0.15}, .velocity = {2.5, 0}});
  s.contact_set(chain_polygon({.name = "ground", .a = 0, .corners_a = rectangle(0.3, 0.3), .law = {.mu = 0.3}},
                              {.points = {{-2, 0}, {0, 0}, {2, -1.5}, {4, -1.5}, {4, 1}}}));
  for (const std::string_view scheme : {"moreau-jean", "generalized-alpha", "rattle", "stewart-trinkle"}) {
    CAPTURE(scheme);
    const Run r = run(s, scheme, 1e-3);
    REQUIRE(r.status == Status::solved);
    CHECK(r.final.v.norm() < 1e-3);
    CHECK(std::abs(r.final.q[1] + 1.5 - 0.15) < 2e-2);
    CHECK(r.final.q[0] < 4 - 0.15 + 1e-2);
    CHECK(r.max_penetration < 2e-2);
  }
}

TEST_CASE("a triangle falls into a sharp notch of a chain, with every integrator") {
  Scene s{.gravity = {0, -kGravity}, .duration = 1};
  s.body({.name = "triangle",
          .inertia = 0.008428199574945313,
          .position = {-0.10234383203445614, 0.6430249515576586},
          .angle = 0.8816359372601568,
          .velocity = {-0.29039427841050713, 0}});
  const Polygon triangle = {{0.12983219612211228, 0},
                            {-0.06491609806105611, 0.11243798007087272},
                            {-0.0649160980610562, -0.11243798007087268}};
  s.contact_set(
      chain_polygon({.name = "notch", .a = 0, .corners_a = triangle, .law = {.mu = 0.3, .e = 0.3, .mu_static = 0.45}},
                    {.points = {{-2.45, 1.73}, {0, 0}, {1.79, 2.41}}}));
  for (const std::string_view scheme : kEveryIntegrator) {
    CAPTURE(scheme);
    const Run r = run(s, scheme, 1e-3);
    INFO(r.why);
    REQUIRE(r.status == Status::solved);
    CHECK(r.max_penetration < 2e-3);
    CHECK(r.energy_final == doctest::Approx(1.156).epsilon(scheme == "anitescu-potra" ? 0.2 : 0.02));
  }
}

TEST_CASE(
    "a box slides up a ramp and down behind its crest, on a chain, tiles and a collision, with every integrator") {
  const std::vector<Vector2d> ramp = {{-2, -1}, {0, 0}, {3, -0.6}};
  const Polygon box = rectangle(0.4, 0.2);
  const auto scene = [&](int kind) {
    Scene s{.gravity = {0, -kGravity}, .duration = 0.8};
    s.body({.name = "box", .inertia = 0.0167, .position = {-0.6, 0}, .angle = std::atan(0.5), .velocity = {2.1, 1.05}});
    const std::vector<Polygon> pieces = chain_pieces({.points = ramp});
    const Polygon one = {{-2, -1}, {-2, -2}, {3, -2}, {3, -0.6}, {0, 0}};  // the same surface
    if (kind == 0) s.contact_set(polygon_polygon({"one", 0, box, kGround, one, 0, {}}));
    if (kind == 1) s.contact_set(chain_polygon({.name = "chain", .a = 0, .corners_a = box}, {.points = ramp}));
    if (kind == 2) {
      s.contact_set(polygon_polygon({"up", 0, box, kGround, {{-2, -1}, {-2, -2}, {0, -2}, {0, 0}}, 0, {}}));
      s.contact_set(polygon_polygon({"down", 0, box, kGround, {{0, 0}, {0, -2}, {3, -2}, {3, -0.6}}, 0, {}}));
    }
    if (kind == 3) {
      Collision c{.name = "all", .shapes = {{.body = 0, .corners = box}}};
      for (const Polygon& p : pieces) c.shapes.push_back({.corners = p});
      s.collision(c);
    }
    return s;
  };
  for (const std::string_view scheme : kEveryIntegrator) {
    const Run one = run(scene(0), scheme, 1e-3);
    INFO(one.why);
    REQUIRE(one.status == Status::solved);
    for (const int kind : {1, 2, 3}) {
      const Run r = run(scene(kind), scheme, 1e-3);
      CAPTURE(scheme);
      CAPTURE(kind);
      CAPTURE(r.why);
      CAPTURE(one.final.q.transpose());
      CAPTURE(r.final.q.transpose());
      CHECK(r.status == Status::solved);
      CHECK(r.max_penetration <= one.max_penetration + 1e-3);
      CHECK(r.energy_final < r.energy_initial);
      CHECK(r.energy_rises == 0);
      CHECK((r.final.q - one.final.q).cwiseAbs().maxCoeff() < 0.02);
    }
  }
}

TEST_CASE("contacts next to covered faces have rows and biases that are the derivatives of their gaps") {
  Draws random(21);
  Scene s;
  s.body({}), s.body({});
  const std::vector<Vector2d> hills = {{-3, 0}, {-1, 0.2}, {0, 0}, {1, 0.4}, {2, -0.3}, {3, 0.1}};
  s.contact_set(chain_polygon({.name = "box", .a = 0, .corners_a = rectangle(0.7, 0.4), .b = 1}, {.points = hills}));
  s.contact_set(chain_disc({.name = "disc", .a = 0, .radius = 0.3, .b = 1}, {.points = hills}));
  const System system(s);
  int wrong = 0;
  for (int i = 0; i < 300; ++i) {
    Kinematics k;
    for (int body = 0; body < 2; ++body) {
      const double angle = random(-3, 3);
      const Vector2d at = body == 0 ? Vector2d(random(-3, 3), random(-0.1, 0.6)) : Vector2d(0, 0);
      k.pose.push_back({at, angle, std::cos(angle), std::sin(angle)});
    }
    k.pose[0].x = k.pose[1].turn(k.pose[0].x);
    k.pose.emplace_back();
    for (const Contact& contact : system.scene().contacts) wrong += !wrong_derivative(contact, k).empty();
  }
  CHECK(wrong == 0);
}

}  // namespace orthant
