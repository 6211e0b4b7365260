// Static friction above kinetic, and surfaces that move: what Moreau–Jean stepping makes of them.
#include "tests/support/runs.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/incline.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

namespace {

ContactLaw& law_of(Scene& scene) { return std::get<CornerWall>(scene.contacts[0]).law; }

}  // namespace

TEST_CASE("Coulomb decay: stops where it should, and stays to the last bit") {
  const CoulombDecay p;
  Scene scene = coulomb_decay(p);
  double last = 0;
  const Run r = run(scene, kSymmetric, 1e-3, [&](const RunSample& m) {
    if (m.state.t > 8 * p.half_swing()) CHECK(m.state.q[0] == doctest::Approx(last).epsilon(1e-15));
    last = m.state.q[0];
  });
  CHECK(std::abs(r.final.q[0] + 0.2) < 5e-3);
  CHECK(std::abs(r.final.v[0]) < 1e-15);
}

TEST_CASE("static friction holds what kinetic friction cannot, at the start and after a stop") {
  for (const double speed : {0.0, 1.0}) {
    const Incline p{.mu = 0.3, .mu_static = 0.6, .speed = speed};  // tan 30° = 0.577
    const Run r = run(incline(p), kSymmetric, 1e-3);
    CHECK(std::abs(r.final.v[0]) <= 1e-12);
    CHECK(std::abs(r.final.q[0] - p.at(2).x) < 2e-3);
  }
  const Incline slides{.mu = 0.3, .mu_static = 0.57, .speed = 1};
  CHECK(run(incline(slides), kSymmetric, 1e-3).final.v[0] == doctest::Approx(slides.at(2).v).epsilon(1e-2));
}

TEST_CASE("a belt takes a block along: the motion is that on a resting floor, seen from the belt") {
  Scene moving = incline({.mu = 0.5, .speed = 2}), resting = incline({.mu = 0.5, .speed = 1.3});
  law_of(moving).belt = 0.7;
  const Run a = run(moving, kSymmetric, 1e-3), b = run(resting, kSymmetric, 1e-3);
  CHECK(a.final.v[0] == doctest::Approx(b.final.v[0] + 0.7).epsilon(1e-12));
  CHECK(a.final.q[0] == doctest::Approx(b.final.q[0] + 0.7 * 2).epsilon(1e-12));
}

TEST_CASE("mu_static equal to mu, and friction given as static alone") {
  Scene plain = incline({.mu = 0.5}), same = incline({.mu = 0.5, .mu_static = 0.5});
  CHECK(run(plain, kSymmetric, 1e-3).final.q == run(same, kSymmetric, 1e-3).final.q);
  const Run r = run(incline({.mu = 0, .mu_static = 0.6, .speed = 0}), kSymmetric, 1e-3);
  CHECK(std::abs(r.final.v[0]) <= 1e-12);
}

TEST_CASE("static friction holds while the normal turns: a disc rolls in a cup, as it must up to mu_static") {
  // phi'' = -g sin(phi) / (1.5 (R - r)) without slip, which needs friction up to tan(phi) / 3 = 0.52 at the start.
  constexpr double kR = 0.5, kr = 0.1, kStart = 1, kG = 9.81;
  double phi = kStart, rate = 0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {  // leapfrog: 1e-8
    constexpr double h = 2.0 / kSteps;
    rate -= h / 2 * kG * std::sin(phi) / (1.5 * (kR - kr));
    phi += h * rate;
    rate -= h / 2 * kG * std::sin(phi) / (1.5 * (kR - kr));
  }
  const double rolled = (kR - kr) / kr * (kStart - phi);
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    Scene s{.gravity = {0, -kG}, .duration = 2};
    const BodyId disc = s.body(
        {.mass = 1, .inertia = kr * kr / 2, .position = {(kR - kr) * std::sin(kStart), -(kR - kr) * std::cos(kStart)}});
    s.contact(Journal{"cup", disc, {0, 0}, kr, kGround, {0, 0}, kR, {.mu = 0.15, .e = 0, .mu_static = 0.6}});
    const double turned = std::abs(run(s, scheme.name, 1e-3).final.q[2]);
    CHECK(std::abs(turned - std::abs(rolled)) < 0.1);
  }
}

TEST_CASE(
    "static friction of a box that stands on two corners: both give way at once, when the whole is no longer held") {
  // A load that grows by 5 N a second, below the centre: the corners' shares of the weight change as it grows.
  constexpr double kMu = 0.3, kMuStatic = 0.5, kWeight = 9.81, kRate = 5;
  const double slips = kMuStatic * kWeight / kRate, end = 2, free = end - slips;
  const double x = kRate / 6 * (std::pow(end, 3) - std::pow(slips, 3)) - kRate / 2 * slips * slips * free -
                   kMu * kWeight / 2 * free * free;
  Scene s{.gravity = {0, -kWeight}, .duration = end};
  const BodyId box = s.body({.mass = 1, .inertia = 0.02 / 3, .position = {0, 0.1}});
  for (const double side : {-0.1, 0.1})
    s.contact(
        CornerWall{"", box, {side, -0.1}, kGround, {0, 0}, {0, 1}, {.mu = kMu, .e = 0.1, .mu_static = kMuStatic}});
  s.load({"push", box, {0, -0.05}, {kRate, 0}, 0, [](double t) { return t; }});
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    if (scheme.name == "anitescu-potra") continue;  // what slides hovers in it, and tilts where the corners differ
    const double error = std::abs(run(s, scheme.name, 1e-3).final.q[0] - x);
    CHECK(error < (scheme.name == "event-driven" ? 1e-9 : scheme.name == "adaptive" ? 1e-6 : 3e-3));
  }
}

TEST_CASE("static friction holds a block that is struck, tilts, and leaves the belt for a step") {
  const Scene scene = std::get<Scene>(read_any_scene(ORTHANT_TEST_DATA "/belt_block_struck.toml"));
  const double x = run(scene, "event-driven", 1e-3).final.q[0];
  for (const std::string_view scheme : {"moreau-jean", "rattle", "generalized-alpha"}) {
    CAPTURE(scheme);
    CHECK(std::abs(run(scene, scheme, 1e-4).final.q[0] - x) < 1e-3);
  }
}
