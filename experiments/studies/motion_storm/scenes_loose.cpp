// Random scenes of bodies without joints: dropped, stacked, side by side, spinning, in wedges, on belts and tables.
#include "experiments/studies/motion_storm/maker.h"

#include <orthant/core/mechanics/planar/chain.h>

#include <cmath>
#include <numbers>

namespace orthant::motion_storm {
namespace {

void throw_about(Maker& m, double speed, double omega) {
  for (Body& b : m.scene.bodies) b.velocity += m.point(-speed, speed), b.omega += m.random.uniform(-omega, omega);
}

}  // namespace

void dropped(Maker& m) {
  const int n = m.random.integer(1, 5);
  for (int i = 0; i < n; ++i)
    m.add(m.any(), {0.7 * (i % 3) + m.random.uniform(-0.05, 0.05), 0.32 + 0.65 * (i / 3) + m.random.uniform(0, 0.03)},
          m.random.uniform(-3, 3));
  for (BodyId b = 0; b < n; ++b) m.wall(b, {0, 0}, m.chance(0.8) ? Vector2d(0, 1) : Vector2d(0.1, 1));
  if (m.chance(0.7)) m.meet_all();
  throw_about(m, m.pick({0, 1, 3}), m.pick({0, 3, 10}));
}

void stack(Maker& m) {
  const int n = m.random.integer(2, 5);
  const bool same = m.chance(0.5);
  double top = 0;
  for (int i = 0; i < n; ++i) {
    const double width = same ? 0.3 : m.random.uniform(0.15, 0.4), height = same ? 0.2 : m.random.uniform(0.1, 0.3);
    m.add(m.box(width, height), {same ? 0 : m.random.uniform(-0.03, 0.03), top + height / 2});
    top += height;
  }
  m.wall(0, {0, 0}, {0, 1});
  for (BodyId b = 0; b + 1 < n; ++b) m.meet(b, b + 1);
  if (m.chance(0.3)) m.wall(n - 1, {0, 0}, {0, 1});
  if (m.chance(0.4)) m.body(m.random.integer(0, n - 1)).velocity.x() = m.random.uniform(-2, 2);
  if (m.chance(0.3)) m.scene.load({.body = n - 1, .force = m.point(-5, 5)});
}

void seams(Maker& m) {  // flush tiles in the ground, each a polygon of its own
  const double width = m.random.uniform(0.1, 0.4), height = m.random.uniform(0.1, 0.3);
  const double tile = m.random.uniform(0.2, 1), first = -m.random.uniform(0.2, 0.8) * tile;
  const BodyId a = m.add(m.chance(0.8) ? m.box(width, height) : m.disc(), {0, 0});
  const double above = m.form(a).corners.empty() ? m.form(a).radius : height / 2;
  m.body(a).position.y() = above + m.pick({0, 0, 0.01});
  m.body(a).velocity.x() = m.random.uniform(-4, 4);
  if (m.chance(0.2)) m.body(a).omega = m.random.uniform(-3, 3);
  for (int i = -2; i < 3; ++i) {
    const double x = first + i * tile;
    m.tile(a, {{x, -0.2}, {x + tile, -0.2}, {x + tile, 0}, {x, 0}});
  }
}

void side_by_side(Maker& m) {  // boxes that touch their neighbours, on a floor; a row or two of a brick wall
  const int n = m.random.integer(2, 4);
  const double width = 0.25, height = m.random.uniform(0.1, 0.3);
  for (int i = 0; i < n; ++i) m.add(m.box(width, height), {i * width, height / 2});
  for (BodyId b = 0; b < n; ++b) m.wall(b, {0, 0}, {0, 1});
  for (BodyId b = 0; b + 1 < n; ++b) m.meet(b, b + 1);
  const BodyId top = m.add(m.chance(0.7) ? m.box(0.2, 0.15) : m.disc(), {0, 0});
  const double half = m.form(top).corners.empty() ? m.form(top).radius : 0.075;
  m.body(top).position = {m.random.uniform(0, (n - 1) * width), height + half + m.pick({0, 0, 0.02})};
  m.body(top).velocity.x() = m.random.uniform(-3, 3);
  for (BodyId b = 0; b < n; ++b) m.meet(b, top);
  if (m.chance(0.3)) m.body(0).velocity.x() = m.random.uniform(-1, 1);
}

void spinning(Maker& m) {  // what turns fast meets pegs and balls: free, or on a pin
  const double reach = m.random.uniform(0.3, 0.6), thick = m.pick({0.05, 0.1, 0.02});
  const BodyId arm = m.add(m.box(2 * reach, thick), {0, 0}, m.random.uniform(-3, 3));
  m.body(arm).omega = m.log_uniform(3, 100) * (m.chance(0.5) ? 1 : -1);
  if (m.chance(0.6)) m.pin(kGround, {0, 0}, arm, {0, 0});
  const int n = m.random.integer(1, 3);
  for (int i = 0; i < n; ++i) {
    const double angle = m.body(arm).angle + m.random.uniform(0.7, 2.4) + (m.chance(0.5) ? std::numbers::pi : 0);
    const Vector2d at = m.random.uniform(0.6, 1.3) * reach * Vector2d(std::cos(angle), std::sin(angle));
    if (m.chance(0.4)) {
      m.peg(arm, at, 0.03);
      continue;
    }
    Form small = m.chance(0.5) ? Form{m.random.uniform(0.02, 0.06), {}} : m.box(0.1, 0.1);
    const BodyId b = m.add(small, at);
    if (m.chance(0.5)) m.body(b).velocity = -m.random.uniform(0.5, 3) * at;
    m.meet(arm, b);
  }
}

void wedge(Maker& m) {  // one or two bodies between walls: a groove, a slot, a corner
  const int n = m.random.integer(1, 2);
  const double slope = m.pick({0.2, 0.5, 1, 2, 5});
  const Vector2d left = Vector2d(slope, 1).normalized(), right = Vector2d(-slope, 1).normalized();
  for (int i = 0; i < n; ++i) {
    const BodyId b = m.add(m.any(), {0, 0}, m.random.uniform(-3, 3));
    const double r = m.form(b).radius;
    m.body(b).position = {0, (i == 0 ? r : 2.2 * r + 0.6) * std::sqrt(1 + slope * slope) + m.pick({0, 0.01, 0.1})};
    m.wall(b, {0, 0}, left), m.wall(b, {0, 0}, right);
    if (m.chance(0.3)) m.wall(b, {0, 0.05}, {0, 1});
  }
  if (n == 2) m.meet(0, 1);
  throw_about(m, m.pick({0, 0.5, 2}), m.pick({0, 5}));
}

void terrain(Maker& m) {  // bodies on a ground of straight pieces, with notches and ridges of any sharpness
  GroundChain ground;
  double x = -1;
  for (int i = m.random.integer(4, 7); i >= 0; --i, x += m.random.uniform(0.15, 0.7))
    ground.points.emplace_back(x, m.pick({0, 0, 0.1, 0.3}) * m.random.uniform(-1, 1));
  const int n = m.random.integer(1, 2);
  for (int i = 0; i < n; ++i) {
    const Vector2d at(m.random.uniform(-0.7, x - 0.7), m.random.uniform(0.6, 0.9) + 0.6 * i);
    const BodyId b = m.add(m.any(), at, m.random.uniform(-3, 3));
    const std::string name = "ground" + std::to_string(i);
    if (m.form(b).corners.empty())
      m.scene.contact_set(chain_disc({name, b, {0, 0}, m.form(b).radius, kGround, {}, m.law()}, ground));
    else
      m.scene.contact_set(chain_polygon({name, b, m.form(b).corners, kGround, {}, 0, m.law()}, ground));
  }
  if (n == 2) m.meet(0, 1);
  throw_about(m, m.pick({0, 1, 3}), m.pick({0, 5}));
}

void ladder_of_masses(Maker& m) {  // discs in a line, heavy and light, between walls
  const int n = m.random.integer(2, 5);
  m.scene.gravity = {0, 0};
  double x = 0;
  const double ratio = m.pick({1, 10, 100, 1e4, 1e6});
  for (int i = 0; i < n; ++i) {
    const Form disc{m.random.uniform(0.05, 0.15), {}};
    x += disc.radius;
    m.add(disc, {x, 0}, 0, m.chance(0.5) ? 1 : ratio);
    x += disc.radius + (m.chance(0.3) ? 0 : m.random.uniform(0.01, 0.2));
  }
  for (BodyId b = 0; b + 1 < n; ++b) m.meet(b, b + 1);
  m.wall(0, {-m.random.uniform(0, 0.2), 0}, {1, 0});
  if (m.chance(0.4)) m.wall(n - 1, {x + 0.2, 0}, {-1, 0});
  m.body(n - 1).velocity.x() = -m.random.uniform(0.5, 5);
}

void billiards(Maker& m) {  // bodies thrown at each other and at pegs
  const int n = m.random.integer(2, 5);
  if (m.chance(0.6)) m.scene.gravity = {0, 0};
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    const Vector2d out(std::cos(angle), std::sin(angle));
    const BodyId b = m.add(m.any(), m.random.uniform(0.8, 1) * out, m.random.uniform(-3, 3));
    m.body(b).velocity = -m.random.uniform(0.5, 6) * out + m.point(-0.3, 0.3);
    m.body(b).omega = m.random.uniform(-5, 5);
  }
  m.meet_all();
  if (m.chance(0.4))
    for (BodyId b = 0; b < n; ++b) m.peg(b, {0, 0}, 0.05);
}

void belt(Maker& m) {  // a block on a belt, held by a spring: stick and slip
  const BodyId block = m.add(m.box(0.2, 0.1), {0, 0.05});
  m.wall(block, {0, 0}, {0, 1});
  const double speed = m.random.uniform(-2, 2), static_more = m.pick({1, 1, 1.5});
  for (Contact& c : m.scene.contacts) {
    auto& law = std::get<CornerWall>(c).law;
    law.mu = std::max(law.mu, 0.1), law.belt = speed;
    if (static_more > 1) law.mu_static = static_more * law.mu;
  }
  m.scene.spring(
      PointSpring{{}, kGround, block, {-0.5, 0.05}, {-0.1, 0}, m.log_uniform(10, 1000), m.pick({0, 0, 2}), 0.4});
  if (m.chance(0.4)) {
    const BodyId other = m.add(m.any(), {0, 0.5}, m.random.uniform(-3, 3));
    m.meet(block, other);
  }
  if (m.chance(0.5)) m.body(block).velocity.x() = m.random.uniform(-2, 2);
}

void shaken(Maker& m) {  // a driven table with bodies on it
  const BodyId table = m.add(m.box(2, 0.1), {0, -0.05}, 0, 10);
  const double amplitude = m.log_uniform(1e-3, 0.05), omega = m.random.uniform(5, 60);
  const Vector2d axis = m.chance(0.7) ? Vector2d(0, 1) : Vector2d(1, 0);
  m.scene.joint(Prismatic{{}, kGround, table, {0, -0.05}, {0, 0}, axis, 0});
  m.drive(Slide{kGround, table, {0, -0.05}, {0, 0}, axis}, 0, 0, amplitude, omega);
  m.body(table).velocity = amplitude * omega * axis;
  const int n = m.random.integer(1, 3);
  for (int i = 0; i < n; ++i) {
    const BodyId b = m.add(m.any(), {0, 0}, m.chance(0.5) ? 0 : m.random.uniform(-3, 3));
    m.body(b).position = {0.65 * (i - 1), m.form(b).radius + m.pick({0, 0.01})};
    m.meet(table, b);
  }
}

}  // namespace orthant::motion_storm
