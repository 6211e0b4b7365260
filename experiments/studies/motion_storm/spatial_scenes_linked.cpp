// Random mechanisms in space: chains, loops, clearances, rails, gears, ropes, redundant joints, drives on stops.
#include "experiments/studies/motion_storm/spatial_maker.h"

#include <cmath>
#include <numbers>

namespace orthant::motion_storm {
namespace {

using Side = spatial::Limit::Side;

const Vector3d kAbove(0, 0, 1);

/// Rods one after the other from the ground, by joints at random.
void rods_in_space(SpatialMaker& m, Vector3d from, int n) {
  Vector3d along = m.direction();
  for (int i = 0; i < n; ++i) {
    const Vector3d to = from + m.random.uniform(0.15, 0.5) * along;
    const BodyId b = m.rod(from, to), to_body = i == 0 ? kGround : b - 1;
    const double u = m.random.uniform();
    if (u < 0.4)
      m.spherical(to_body, b, from);
    else if (u < 0.8)
      m.revolute(to_body, b, from, m.direction());
    else
      m.universal(to_body, b, from, m.direction());
    from = to, along = (along + 0.8 * m.direction()).normalized();
  }
}

Vector3d end_of(const SpatialMaker& m, BodyId rod) {
  const spatial::Body& b = m.body(rod);
  return b.position + quaternions::matrix_of(b.orientation) * Vector3d(0, 0, m.form(rod).size.y() / 2);
}

/// Where circles about a and b of these radii meet, in the plane y = 0.
Vector3d apex_above(const Vector3d& a, double ra, const Vector3d& b, double rb) {
  const Vector3d d = b - a;
  const double length = d.norm(), along = (length * length + ra * ra - rb * rb) / (2 * length);
  return a + along / length * d +
         std::sqrt(std::max(0.0, ra * ra - along * along)) * Vector3d(-d.z(), 0, d.x()) / length;
}

}  // namespace

void chain(SpatialMaker& m) {
  const int n = m.random.integer(1, 5);
  rods_in_space(m, {0, 0, 0}, n);
  if (m.chance(0.5)) m.turn_about({0, 0, 0}, m.random.uniform(0, 6) * m.direction());
  for (BodyId b = 0; b < n; ++b) {
    if (!m.chance(0.4)) continue;
    if (const auto* pin = std::get_if<spatial::Revolute>(&m.scene.joints[static_cast<std::size_t>(b)])) {
      const spatial::Angle of = pin->angle();
      if (m.chance(0.7)) m.limit(of, Side::upper, m.pick({0, 0.1, 0.5}));
      if (m.chance(0.4)) m.limit(of, Side::lower, -m.random.uniform(0.1, 0.5));
      if (m.chance(0.4)) m.scene.spring(spatial::JointSpring{{}, of, m.log_uniform(0.1, 50), m.pick({0, 0.1}), 0});
    } else if (m.chance(0.5)) {
      const Vector3d at = end_of(m, b), hook = at + m.direction();
      m.scene.spring(
          spatial::PointSpring{{}, b, kGround, m.in_body(b, at), hook, m.log_uniform(1, 100), m.pick({0, 0.5}), 1});
    }
  }
  if (m.chance(0.4)) {  // the end over a floor
    const Vector3d end = end_of(m, n - 1);
    m.scene.contact(spatial::SpherePlane{{},
                                         n - 1,
                                         m.in_body(n - 1, end),
                                         m.pick({0, 0.02}),
                                         kGround,
                                         {0, 0, end.z() - m.random.uniform(0.05, 0.4)},
                                         kAbove,
                                         m.law()});
  }
}

void one_joint(SpatialMaker& m) {  // each kind of joint, of a body with the ground or of two bodies
  const Vector3d axis = m.chance(0.5) ? kAbove : m.direction();
  const Vector3d at = 0.3 * m.direction();
  BodyId a = kGround;
  if (m.chance(0.4)) a = m.add(SpatialMaker::brick(m.point(0.1, 0.3)), -0.3 * m.direction(), m.orientation());
  const BodyId b = m.add(SpatialMaker::brick(m.point(0.1, 0.3)), {0.1, 0, 0.1}, m.orientation());
  switch (m.random.integer(0, 9)) {
    case 0:
      m.spherical(a, b, at);
      break;
    case 1:
      m.revolute(a, b, at, axis);
      break;
    case 2:
      m.cylindrical(a, b, at, axis);
      break;
    case 3:
      m.universal(a, b, at, axis);
      break;
    case 4:
      m.prismatic(a, b, at, axis);
      break;
    case 5:
      m.screw(a, b, at, axis, m.pick({0.01, 0.3, -1}));
      break;
    case 6:
      m.planar(a, b, at, axis);
      break;
    case 7:
      m.in_plane(a, b, at, axis);
      break;
    case 8:
      m.on_line(a, b, at, axis);
      break;
    default:
      m.distance(a, b, at, m.body(b).position + Vector3d(0, 0, 0.1));
  }
  if (a >= 0 && m.chance(0.6)) m.spherical(kGround, a, m.body(a).position + 0.2 * m.direction());
  if (m.chance(0.5)) m.turn_about({0, 0, 0}, m.random.uniform(0, 8) * m.direction());
  if (m.chance(0.4)) m.wall(b, {0, 0, -m.random.uniform(0.35, 0.8)}, kAbove);
}

void loop(SpatialMaker& m) {  // four-bar: pins (redundant in space), or ball joints at one bar
  const double a = m.random.uniform(0.08, 0.15), b = m.random.uniform(0.3, 0.4), c = m.random.uniform(0.25, 0.35);
  const double angle = m.random.uniform(-3, 3);
  const Vector3d O(0, 0, 0), A = a * Vector3d(std::cos(angle), 0, std::sin(angle)), D(0.35, 0, 0);
  const Vector3d B = apex_above(A, b, D, c), y(0, 1, 0);
  const BodyId crank = m.rod(O, A), coupler = m.rod(A, B), rocker = m.rod(D, B);
  const bool balls = m.chance(0.4);
  const int loose = m.random.integer(0, 5);
  const double clearance = m.pick({1e-4, 1e-3});
  const auto join = [&](int i, BodyId x, BodyId other, const Vector3d& at, bool ball) {
    if (i == loose)
      m.socket(other, x, at, clearance);
    else if (ball)
      m.spherical(x, other, at);
    else
      m.revolute(x, other, at, y);
  };
  join(4, kGround, crank, O, false), join(1, crank, coupler, A, balls), join(2, coupler, rocker, B, balls);
  join(5, kGround, rocker, D, false);
  const auto holds = [&](int i) { return !(balls && loose == i); };  // the axis: then its angle is a coordinate
  if (m.chance(0.4)) {
    const double rate = m.random.uniform(-20, 20);
    if (holds(4)) m.drive(m.angle(kGround, crank, y), 0, rate);
  } else if (m.chance(0.5)) {
    m.scene.load({.body = crank, .moment = m.random.uniform(-1, 1) * y});
  }
  if (m.chance(0.3)) {
    const double bound = m.random.uniform(0.05, 0.5);
    if (holds(5)) m.limit(m.angle(kGround, rocker, y), Side::upper, bound);
  }
}

void slider(SpatialMaker& m) {  // crank, rod on ball joints, piston in a guide: prismatic, cylindrical, channel or bush
  const double a = m.random.uniform(0.08, 0.15), b = m.random.uniform(0.3, 0.45), angle = m.random.uniform(-3, 3);
  const double aside = m.pick({0, 0, 0.1});
  const Vector3d A = a * Vector3d(std::cos(angle), 0, std::sin(angle));
  const Vector3d B(A.x() + std::sqrt(b * b - A.z() * A.z() - aside * aside), aside, 0), x(1, 0, 0), y(0, 1, 0);
  const BodyId crank = m.rod({0, 0, 0}, A), rod = m.rod(A, B);
  const Vector3d size(0.1, 0.06, 0.05);
  const BodyId piston = m.add(SpatialMaker::brick(size), B);
  m.revolute(kGround, crank, {0, 0, 0}, y);
  m.chance(0.5) ? m.spherical(crank, rod, A) : m.universal(crank, rod, A, x);
  m.chance(0.7) ? m.spherical(rod, piston, B) : m.socket(rod, piston, B, m.pick({1e-4, 1e-3}));
  const double u = m.random.uniform(), clearance = m.pick({1e-4, 1e-3, 5e-3});
  if (u < 0.35) {
    m.prismatic(kGround, piston, B, x);
  } else if (u < 0.55) {
    m.cylindrical(kGround, piston, B, x);
  } else if (u < 0.8) {
    const spatial::BlockChannel channel{.name = "channel",
                                        .a = piston,
                                        .size = size,
                                        .centre_b = B,
                                        .axis = x,
                                        .up = kAbove,
                                        .width = size.y() + clearance,
                                        .height = size.z() + clearance,
                                        .law = m.law()};
    m.scene.contact_set(spatial::block_in_channel(channel));
  } else {
    m.pin_bush(piston, kGround, B, x, clearance);
  }
  const double omega = m.random.uniform(-20, 20);
  if (m.chance(0.4))
    m.drive(m.angle(kGround, crank, y), 0, omega);
  else
    m.body(crank).omega = omega * y, m.body(crank).velocity = m.body(crank).omega.cross(A / 2);
  if (m.chance(0.3)) m.scene.load({.body = piston, .force = {m.random.uniform(-20, 20), 0, 0}});
}

void clearances(SpatialMaker& m) {  // balls in sockets and pins in bushes, resting, hanging or turning fast
  const double clearance = m.pick({1e-4, 1e-3, 1e-2});
  const Vector3d axis = m.pick({0, 1}) > 0 ? Vector3d(0, 1, 0) : kAbove;
  const BodyId b =
      m.chance(0.5) ? m.add(SpatialMaker::can(0.1, 0.06), {0, 0, 0}) : m.rod({0, 0, 0}, 0.4 * m.direction());
  const Vector3d at = m.form(b).size.x() == 0.1 ? Vector3d(0, 0, 0) : Vector3d(2 * m.body(b).position - end_of(m, b));
  if (m.chance(0.5))
    m.socket(b, kGround, at, clearance);
  else
    m.pin_bush(b, kGround, at, axis, clearance);
  m.body(b).position += clearance * m.pick({0, 0.3, 0.9}) * Vector3d(0.6, 0, -0.8);
  m.body(b).omega = m.pick({0, 3, -30}) * axis;
  if (m.chance(0.4)) {
    const Vector3d end = end_of(m, b);
    const BodyId second = m.rod(end, end + 0.25 * m.direction());
    m.chance(0.5) ? m.socket(second, b, end, clearance) : m.revolute(b, second, end, m.direction());
  }
  if (m.chance(0.5)) {  // a second bearing, on the other side
    const Vector3d other = at + 0.2 * axis;
    m.chance(0.5) ? m.socket(b, kGround, other, clearance) : m.in_plane(kGround, b, at, axis);
  }
  if (m.chance(0.3)) m.scene.load({.body = b, .moment = m.random.uniform(-0.5, 0.5) * axis});
}

void rail(SpatialMaker& m) {  // carriages and screws on rails with stops and springs, a pendulum below
  const Vector3d axis = m.chance(0.5) ? Vector3d(1, 0, 0) : m.direction();
  const BodyId cart = m.add(SpatialMaker::brick({0.2, 0.1, 0.1}), {0, 0, 0},
                            m.chance(0.5) ? m.orientation() : Eigen::Vector4d(1, 0, 0, 0));
  const Vector3d at = m.chance(0.5) ? Vector3d(0, 0, 0) : Vector3d(0, 0.1, 0.05);
  const double u = m.random.uniform();
  if (u < 0.5)
    m.prismatic(kGround, cart, at, axis);
  else if (u < 0.7)
    m.cylindrical(kGround, cart, at, axis);
  else if (u < 0.85)
    m.screw(kGround, cart, at, axis, m.pick({0.05, 0.5}));
  else
    m.on_line(kGround, cart, at, axis);
  const spatial::Slide along = m.slide(kGround, cart, at, axis);
  if (u < 0.7) m.body(cart).velocity = m.random.uniform(-3, 3) * axis;
  if (m.chance(0.6)) m.limit(along, Side::upper, m.pick({0, 0.1, 0.2}));
  if (m.chance(0.6)) m.limit(along, Side::lower, -m.pick({0.05, 0.1}));
  if (m.chance(0.4)) m.scene.spring(spatial::JointSpring{{}, along, m.log_uniform(10, 500), m.pick({0, 1}), 0});
  if (m.chance(0.2)) m.scene.friction({{}, along, m.random.uniform(0, 5)});
  if (m.chance(0.5)) {
    const BodyId bob = m.rod(at, at + 0.3 * m.direction());
    m.chance(0.5) ? m.spherical(cart, bob, at) : m.universal(cart, bob, at, m.direction());
    m.body(bob).velocity = m.body(cart).velocity;
  }
}

void ropes(SpatialMaker& m) {  // weights on ropes, bars and springs
  const int n = m.random.integer(1, 4);
  Vector3d above(0, 0, 0);
  for (int i = 0; i < n; ++i) {
    const Vector3d at = above + m.random.uniform(0.25, 0.5) * (m.direction() - kAbove).normalized();
    const BodyId b =
        m.add(m.chance(0.5) ? SpatialMaker::ball(0.06) : SpatialMaker::brick({0.12, 0.1, 0.08}), at, m.orientation());
    const BodyId to = i == 0 ? kGround : b - 1;
    const Vector3d hook = at + Vector3d(0, 0, 0.03);
    const double length = (hook - above).norm(), u = m.random.uniform();
    if (u < 0.5)
      m.limit(m.span(to, b, above, hook), Side::upper, length + m.pick({0, 0, 0.02, 0.1}));
    else if (u < 0.75)
      m.distance(to, b, above, hook);
    else
      m.scene.spring(spatial::PointSpring{
          {}, to, b, m.in_body(to, above), m.in_body(b, hook), m.log_uniform(20, 2000), m.pick({0, 0.5}), length});
    m.body(b).velocity = m.point(-2, 2), m.body(b).omega = m.point(-4, 4);
    above = at;
  }
  if (m.chance(0.4)) m.wall(n - 1, {0, 0, above.z() - 0.4}, kAbove);
}

void jammed(SpatialMaker& m) {  // a drive against a stop, a wall, or a ball in its way
  const Vector3d y(0, 1, 0);
  const double omega = m.random.uniform(2, 20), length = m.random.uniform(0.2, 0.5), far = m.random.uniform(0.1, 0.6);
  const BodyId crank = m.rod({0, 0, 0}, {length, 0, 0});
  m.revolute(kGround, crank, {0, 0, 0}, y);
  m.turn_about({0, 0, 0}, omega * y);
  m.drive(m.angle(kGround, crank, y), 0, omega);
  const Vector3d there = length * Vector3d(std::cos(far), 0, -std::sin(far)), back(std::sin(far), 0, std::cos(far));
  const double u = m.random.uniform();
  if (u < 0.35) {
    m.limit(m.angle(kGround, crank, y), Side::upper, far);
  } else if (u < 0.7) {
    m.scene.contact(spatial::SpherePlane{{}, crank, {0, 0, length / 2}, 0, kGround, there, back, m.law()});
  } else {  // a ball between a sphere on the crank and a wall
    const BodyId ball = m.add(SpatialMaker::ball(0.05), there + 0.06 * back);
    m.wall(ball, there, back);
    m.scene.contact(spatial::SphereSphere{{}, ball, {0, 0, 0}, 0.05, crank, {0, 0, length / 2}, 0.02, m.law()});
  }
}

void gears(SpatialMaker& m) {  // wheels in mesh, bevelled or parallel, driven, braked by stops, with springs
  const Vector3d one = kAbove, other = m.chance(0.6) ? kAbove : m.direction();
  const BodyId first = m.add(SpatialMaker::can(0.1, 0.03), {0, 0, 0}),
               second = m.add(SpatialMaker::can(0.2, 0.03), {0.3, 0, 0}, m.orientation());
  m.revolute(kGround, first, {0, 0, 0}, one), m.revolute(kGround, second, {0.3, 0, 0}, other);
  const spatial::Angle turn = m.angle(kGround, first, one), along = m.angle(kGround, second, other);
  const double ratio = m.pick({-0.5, 2, -1, 1.0 / 3});
  m.scene.joint(spatial::Gear({}, turn, along, ratio, 0));
  const double omega = m.random.uniform(-10, 10);
  m.body(first).omega = omega * one, m.body(second).omega = ratio * omega * other;
  if (m.chance(0.3)) m.drive(turn, 0, omega);
  if (m.chance(0.5)) m.limit(along, omega * ratio > 0 ? Side::upper : Side::lower, omega * ratio > 0 ? 0.3 : -0.3);
  if (m.chance(0.4)) m.scene.spring(spatial::JointSpring{{}, turn, m.log_uniform(0.1, 10), m.pick({0, 0.01}), 0.2});
  if (m.chance(0.3)) {
    const BodyId bob = m.rod({0.3, 0, 0}, {0.3, 0.2, -0.1});
    m.spherical(second, bob, {0.3, 0, 0});
  }
  if (m.chance(0.4)) {  // its teeth have play
    const auto of_gear = std::find_if(m.scene.joints.begin(), m.scene.joints.end(),
                                      [](const auto& j) { return std::holds_alternative<spatial::Gear>(j); });
    const auto gear = std::get<spatial::Gear>(*of_gear);
    m.scene.joints.erase(of_gear);
    m.scene.contact_set(spatial::meshing("teeth", gear, m.log_uniform(1e-3, 0.1), {.e = m.pick({0, 0.3, 0.8})}));
  }
}

void redundant(SpatialMaker& m) {  // parallel bars on pins, joints that repeat each other, and a load on the platform
  const double length = m.random.uniform(0.2, 0.5), span = m.random.uniform(0.3, 0.6),
               angle = m.random.uniform(0.3, 2.8);
  const double omega = m.random.uniform(-6, 6);
  const Vector3d y(0, 1, 0), arm = length * Vector3d(std::cos(angle), 0, std::sin(angle)), turn = -omega * y;
  const int bars = m.random.integer(2, 3);
  const BodyId platform = m.add(SpatialMaker::brick({span, 0.2, 0.06}), arm + Vector3d(span / 2, 0, 0));
  for (int i = 0; i < bars; ++i) {
    const Vector3d foot(i * span / (bars - 1), m.pick({0, 0, 0.1}), 0);
    const BodyId bar = m.rod(foot, foot + arm);
    m.revolute(kGround, bar, foot, y);
    m.chance(0.7) ? m.revolute(bar, platform, foot + arm, y) : m.spherical(bar, platform, foot + arm);
    m.body(bar).velocity = turn.cross(arm) / 2, m.body(bar).omega = turn;
  }
  m.body(platform).velocity = turn.cross(arm);
  if (m.chance(0.3)) m.distance(kGround, platform, {0, 0, 0}, arm);
  if (m.chance(0.3)) m.revolute(kGround, 1, {0, 0, 0}, y);
  if (m.chance(0.5)) {
    const Solid3 form = m.chance(0.5) ? m.ball() : SpatialMaker::brick({0.15, 0.15, 0.15});
    const double half = form.kind == Solid3::sphere ? form.reach : 0.075;
    const BodyId load = m.add(form, arm + Vector3d(m.random.uniform(0, span), 0, 0.03 + half + m.pick({0, 0.05})));
    m.body(load).velocity = m.body(platform).velocity;
    m.wall(load, m.body(platform).position + Vector3d(0, 0, 0.03), kAbove, m.law(), platform);
  }
  if (m.chance(0.3)) m.limit(m.angle(kGround, 1, y), omega > 0 ? Side::lower : Side::upper, omega > 0 ? -0.3 : 0.3);
}

void mixed(SpatialMaker& m) {  // a tree of any bodies and joints over a floor, each thing by chance
  const int n = m.random.integer(2, 4);
  for (int i = 0; i < n; ++i) {
    const Solid3 form = m.any();
    const BodyId b =
        m.add(form, {0.6 * i, m.random.uniform(-0.2, 0.2), 0.5 + m.random.uniform(0, 0.4)}, m.orientation());
    const BodyId to = m.chance(0.3) ? kGround : b - 1;
    const Vector3d middle = to < 0 ? m.body(b).position : Vector3d((m.body(to).position + m.body(b).position) / 2);
    const double u = m.random.uniform();
    if (u < 0.2)
      m.spherical(to, b, middle);
    else if (u < 0.4)
      m.revolute(to, b, middle, m.direction());
    else if (u < 0.5)
      m.cylindrical(to, b, middle, m.direction());
    else if (u < 0.6)
      m.fixed(to, b, middle);
    else if (u < 0.7)
      m.socket(b, to, middle, m.pick({1e-3, 1e-2}));
    else if (u < 0.8)
      m.limit(m.span(to, b, middle + Vector3d(0, 0, 0.3), middle), Side::upper, m.pick({0.3, 0.35}));
    if (m.chance(0.6)) m.wall(b, {0, 0, 0}, kAbove);
    if (m.chance(0.3))
      m.scene.spring(spatial::PointSpring{
          {}, b, kGround, {0, 0, 0}, {0.6 * i, 0, 1.5}, m.log_uniform(5, 200), m.pick({0, 1}), 0.8});
    if (m.chance(0.2)) m.scene.load({.body = b, .force = m.point(-5, 5)});
    m.body(b).velocity = m.pick({0, 0, 1}) * m.direction();
  }
}

}  // namespace orthant::motion_storm
