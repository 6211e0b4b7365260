// Stacks whose top weighs a million times the rest: every direct and Newton solver answers, and nothing moves.
#include "tests/support/runs.h"

#include <orthant/core/mechanics/planar/contact_sets.h>

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>

using namespace orthant;

namespace {

/// Boxes of 1 m, or of half-sides `half` [m], on one another, both corners of each face in contact.
Scene stack(std::initializer_list<double> masses, double mu, const Vector2d& half = {0.5, 0.5}) {
  const double x = half.x(), y = half.y();
  const Polygon square = {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  Scene scene{.gravity = {0, -9.81}};
  BodyId below = kGround;
  for (const double m : masses) {
    const BodyId box = scene.body({.mass = m,
                                   .inertia = m * half.squaredNorm() / 3,
                                   .position = {0, y * static_cast<double>(2 * scene.bodies.size() + 1)}});
    const std::string name = "c" + std::to_string(box);
    const ContactLaw law{.mu = mu};
    if (below == kGround)
      scene.contact_set(polygon_wall({.name = name, .a = box, .law = law}, square));
    else
      scene.contact_set(polygon_polygon({name, box, square, below, square, 0, law}));
    below = box;
  }
  return scene;
}

}  // namespace

TEST_CASE("a stack under a million times its mass stays where it is, whatever direct or Newton solver answers") {
  for (const double mu : {0.0, 0.5})
    for (const std::string_view solver : {"lemke", "path", "newton-min", "newton-fb", "auto"}) {
      CAPTURE(mu);
      CAPTURE(solver);
      Scene scene = stack({1, 1, 1e6}, mu);
      scene.duration = mu > 0 ? 0.04 : 0.4;  // without friction rounding parts contacts after 0.2 s
      const System system(scene);
      const Run r = run(scene, "moreau-jean", 1e-3, {}, solver);
      CHECK(r.status == Status::solved);
      CHECK(r.max_penetration <= 1e-11);
      CHECK((r.final.q - system.initial_state().q).lpNorm<Eigen::Infinity>() <= 1e-6);
    }
}

TEST_CASE("contacts that are open after free flight, and shut by the impulses of others, take part in the step") {
  for (const std::string_view scheme : {"stewart-trinkle", "anitescu-potra", "paoli-schatzman"})
    for (const double mu : {0.1, 0.4})
      for (const auto& masses : {std::initializer_list<double>{1, 1e6}, {1, 1, 1e6}, {1, 1e6, 1, 1e6}})
        for (const double gap : {0.0, 1e-12, 1e-9}) {
          CAPTURE(scheme);
          CAPTURE(mu);
          CAPTURE(masses.size());
          CAPTURE(gap);
          Scene scene = stack(masses, mu);
          scene.duration = 0.05;
          for (Body& body : scene.bodies) body.position.y() += gap;
          const System system(scene);
          const Run r = run(scene, scheme, 1e-3, {}, "auto");
          CHECK(r.status == Status::solved);
          CHECK(r.max_penetration <= 1e-11);
          CHECK((r.final.q - system.initial_state().q).lpNorm<Eigen::Infinity>() <= gap + 1e-10);
        }
}

TEST_CASE("newton-fb certifies redundant contacts with friction under ratios of 1e6") {
  const Scene scene = [] {
    Scene s = stack({1, 15.8489, 251.189, 3981.07, 63095.7, 1e6}, 0.3);
    s.duration = 0.03;
    return s;
  }();
  CHECK(run(scene, "stewart-trinkle", 1e-3, {}, "newton-fb").status == Status::solved);
}

TEST_CASE("flat boxes, each 16 times as heavy as the one below: a light row counts in its own unit") {
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle", "generalized-alpha", "rattle"})
    for (const std::string_view solver : {"newton-fb", "newton-min", "interior-point"}) {
      CAPTURE(scheme);
      CAPTURE(solver);
      Scene scene =
          stack({1, 15.848931924611133, 251.18864315095797, 3981.0717055349733, 63095.73444801932, 1e6}, 0, {0.3, 0.1});
      scene.duration = 0.16;
      const System system(scene);
      const Run r = run(scene, scheme, 1e-3, {}, solver);
      CHECK(r.status == Status::solved);
      CHECK((r.final.q - system.initial_state().q).lpNorm<Eigen::Infinity>() <= 1e-6);
    }
}

TEST_CASE("a ball that starts inside the floor is pushed out, not shot off") {
  Scene scene{.gravity = {0, -9.81}};
  const BodyId ball = scene.body({.mass = 1, .inertia = 0.01, .position = {0, 0.05}});
  scene.contact(DiscWall{.a = ball, .radius = 0.1, .law = {.mu = 0.3, .e = 0.5}});
  scene.duration = 0.5;
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle", "anitescu-potra"}) {
    CAPTURE(scheme);
    const Run r = run(scene, scheme, 1e-3);
    CHECK(r.status == Status::solved);
    CHECK(std::abs(r.final.v[1]) <= 0.01);
    CHECK(r.final.q[1] >= 0.05);
  }
}

TEST_CASE("a light ball under a heavy one: there is always a motion, and event-driven proves nothing else") {
  for (const double ratio : {1e6, 1e9, 3e9}) {
    CAPTURE(ratio);
    Scene s{.gravity = {0, -9.81}};
    const auto low = s.body({.name = "low", .mass = 1, .inertia = 0.1, .position = {0, 0.5}});
    const auto high = s.body({.name = "high", .mass = ratio, .inertia = 0.1 * ratio, .position = {0, 1.6}});
    s.contact(DiscWall{"floor", low, {0, 0}, 0.5, kGround, {0, 0}, {0, 1}, {.mu = 0.3, .e = 0.2}});
    s.contact(DiscDisc{"between", high, {0, 0}, 0.5, low, {0, 0}, 0.5, {.mu = 0.3, .e = 0.2}});
    s.duration = 0.22;  // the bounces have ended
    const Run r = run(s, "event-driven", 1e-3);
    CAPTURE(r.why);
    CHECK(r.status != Status::infeasible);
    if (ratio < 1e7) CHECK(r.status == Status::solved);
  }
}
