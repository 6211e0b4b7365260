// Random mechanisms with relations between coordinates: gears, racks, ropes over pulleys.
#include "experiments/studies/motion_storm/maker.h"

#include <orthant/core/mechanics/planar/relation.h>

#include <array>
#include <cmath>

namespace orthant::motion_storm {
namespace {

/// Wheels on pins, `ratio` teeth of the second to one of the first; something hangs on the second.
void geared_wheels(Maker& m) {
  const double ratio = m.pick({1, 2, -3, 0.1});
  const BodyId first = m.add({0.1, {}}, {0, 0}, 0), second = m.add({0.1, {}}, {0.3, 0}, m.random.uniform(-1, 1));
  m.pin(kGround, {0, 0}, first, {0, 0}), m.pin(kGround, {0.3, 0}, second, {0, 0});
  const auto mesh = [&](const char* name) {
    m.scene.joint(Relation(name, {{1, angle_of(first)}, {ratio, angle_of(second)}}, ratio * m.body(second).angle));
  };
  mesh("mesh");
  if (m.chance(0.2)) mesh("again");  // redundant
  m.body(second).omega = m.random.uniform(-5, 5), m.body(first).omega = -ratio * m.body(second).omega;
  if (m.chance(0.5)) {
    const Vector2d hook = 0.08 * Vector2d(std::cos(m.random.uniform(-3, 3)), 1).normalized();
    const BodyId arm = m.rod(m.body(second).position + hook, m.body(second).position + hook + Vector2d(0.2, -0.1));
    m.pin(second, m.in_body(second, m.body(second).position + hook), arm, {-m.length_of(arm) / 2, 0});
    m.body(arm).velocity = m.body(second).omega * perp(hook);
  }
  if (m.chance(0.5))
    m.limit(angle_of(first), Limit::Side::upper, m.random.uniform(0, 0.5), m.law().e);
  else if (m.chance(0.5))
    m.drive(angle_of(first), 0, m.body(first).omega);
  if (m.chance(0.5)) m.scene.load({.body = first, .torque = m.random.uniform(-1, 1)});
}

/// A rack on a rail, with a stop or a spring, moved by a wheel that turns.
void rack_and_pinion(Maker& m) {
  const double radius = m.random.uniform(0.05, 0.2), omega = m.random.uniform(-10, 10);
  const BodyId wheel = m.add({radius, {}}, {0, 0}), rack = m.add(m.box(0.4, 0.05), {0, -radius});
  const Slide along{kGround, rack, {0, -radius}, {0, 0}, {1, 0}};
  m.pin(kGround, {0, 0}, wheel, {0, 0});
  m.scene.joint(Prismatic{{}, kGround, rack, {0, -radius}, {0, 0}, {1, 0}, 0});
  m.scene.joint(Relation("rack", {{1, along}, {-radius, angle_of(wheel)}}));
  m.body(wheel).omega = omega, m.body(rack).velocity = {radius * omega, 0};
  if (m.chance(0.6)) m.limit(along, Limit::Side::upper, m.random.uniform(0, 0.2), m.law().e);
  if (m.chance(0.6)) m.limit(along, Limit::Side::lower, -m.random.uniform(0, 0.2), m.law().e);
  if (m.chance(0.5)) m.scene.spring(JointSpring{{}, along, m.log_uniform(10, 500), m.pick({0, 1}), 0});
  if (m.chance(0.4)) m.scene.load({.body = wheel, .torque = m.random.uniform(-2, 2)});
  if (m.chance(0.4)) {
    const BodyId block = m.add(m.box(0.1, 0.1), {0.25 + m.pick({0, 0.1}), -radius});
    m.wall(block, {0, -radius - 0.05}, {0, 1}), m.meet(rack, block);
  }
}

/// Two weights on a rope over a pulley, or two pulleys; a floor below one.
void pulley(Maker& m) {
  const double apart = m.random.uniform(0.3, 0.8), ratio = m.pick({1, 2});
  const BodyId left = m.add(m.box(0.1, 0.1), {-apart, -m.random.uniform(0.3, 0.8)});
  const BodyId right = m.add(m.any(), {apart, -m.random.uniform(0.4, 0.8)});
  const std::vector<CoordinateTerm> rope{{1, Span{kGround, left, {-apart, 0}, {0, 0.05}}},
                                         {ratio, Span{kGround, right, {apart, 0}, {0, 0}}}};
  const double now = -m.body(left).position.y() - 0.05 - ratio * m.body(right).position.y();
  const double speed = m.random.uniform(-1, 1);
  m.body(left).velocity = {0, ratio * speed}, m.body(right).velocity = {0, -speed};
  if (m.chance(0.7))
    m.scene.contact(RelationLimit("rope", rope, Limit::Side::upper, now + m.pick({0, 0, 0.05}), m.law().e));
  else
    m.scene.joint(Relation("belt", rope, now));
  m.wall(left, {0, m.body(left).position.y() - 0.05 - m.pick({0, 0.1})}, {0, 1});
  if (m.chance(0.3)) m.wall(right, {0, m.body(right).position.y() - 0.5}, {0, 1});
  if (m.chance(0.4)) m.body(right).velocity.x() = m.random.uniform(-1, 1);
}

}  // namespace

void gears(Maker& m) {  // relations between coordinates
  constexpr std::array kinds{geared_wheels, rack_and_pinion, pulley};
  kinds[static_cast<std::size_t>(m.random.integer(0, 2))](m);
}

}  // namespace orthant::motion_storm
