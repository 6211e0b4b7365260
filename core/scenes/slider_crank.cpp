#include <orthant/core/scenes/slider_crank.h>

namespace orthant {
namespace {

/// Bodies and pins, stretched out along +x; the velocities satisfy the pins.
Scene linkage(const SliderCrank& p, BodyId& slider) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 0.2, s.step = 1e-5;
  const double tip = p.l1 * p.omega1;  // [m/s] upward velocity of the crank's pin
  const auto crank = s.body({.name = "crank",
                             .mass = p.m1,
                             .inertia = p.J1,
                             .position = {p.l1 / 2, 0},
                             .velocity = {0, p.l1 / 2 * p.omega1},
                             .omega = p.omega1});
  const auto rod = s.body({.name = "rod",
                           .mass = p.m2,
                           .inertia = p.J2,
                           .position = {p.l1 + p.l2 / 2, 0},
                           .velocity = {0, tip + p.l2 / 2 * p.omega2},
                           .omega = p.omega2});
  slider = s.body({.name = "slider",
                   .mass = p.m3,
                   .inertia = p.J3,
                   .position = {p.l1 + p.l2, 0},
                   .angle = p.theta3,
                   .velocity = {0, tip + p.l2 * p.omega2},
                   .omega = p.omega3});
  s.joint(Revolute{"crank_pin", kGround, crank, {0, 0}, {-p.l1 / 2, 0}});
  s.joint(Revolute{"rod_pin", crank, rod, {p.l1 / 2, 0}, {-p.l2 / 2, 0}});
  s.joint(Revolute{"slider_pin", rod, slider, {p.l2 / 2, 0}, {0, 0}});
  return s;
}

}  // namespace

Scene slider_crank(const SliderCrank& p) {
  BodyId slider = kGround;
  Scene s = linkage(p, slider);
  const double wall = p.b + p.clearance;
  const ContactLaw law{.mu = p.mu, .e = p.e, .e_t = p.e_t};
  s.contact(CornerWall{"corner1", slider, {-p.a, p.b}, kGround, {0, wall}, {0, -1}, law});
  s.contact(CornerWall{"corner2", slider, {p.a, p.b}, kGround, {0, wall}, {0, -1}, law});
  s.contact(CornerWall{"corner3", slider, {-p.a, -p.b}, kGround, {0, -wall}, {0, 1}, law});
  s.contact(CornerWall{"corner4", slider, {p.a, -p.b}, kGround, {0, -wall}, {0, 1}, law});
  return s;
}

Scene slider_crank_ideal(const SliderCrank& p) {
  BodyId slider = kGround;
  Scene s = linkage(p, slider);
  s.joint(Prismatic{"guide", kGround, slider, {0, 0}, {0, 0}, {1, 0}, 0});
  return s;
}

}  // namespace orthant
