// Random mechanisms: chains, linkages with clearances, guides and rails, redundant joints, ropes, drives against stops.
#include "experiments/studies/motion_storm/maker.h"

#include <cmath>
#include <numbers>

namespace orthant::motion_storm {
namespace {

/// Where circles about a and b of these radii meet, on the left of a → b.
Vector2d apex(const Vector2d& a, double ra, const Vector2d& b, double rb) {
  const Vector2d d = b - a;
  const double length = d.norm(), along = (length * length + ra * ra - rb * rb) / (2 * length);
  return a + along / length * d + std::sqrt(std::max(0.0, ra * ra - along * along)) * perp(d) / length;
}

/// Rods one after the other from a pin in the ground; all angles at random.
void rods_from(Maker& m, Vector2d from, int n) {
  double angle = m.random.uniform(-3, 3);
  for (int i = 0; i < n; ++i) {
    const Vector2d to = from + m.random.uniform(0.15, 0.5) * Vector2d(std::cos(angle), std::sin(angle));
    const BodyId b = m.rod(from, to);
    m.pin(i == 0 ? kGround : b - 1, i == 0 ? from : m.in_body(b - 1, from), b, m.in_body(b, from));
    from = to, angle += m.random.uniform(-1.5, 1.5);
  }
}

}  // namespace

void linked_chain(Maker& m) {
  const int n = m.random.integer(1, 6);
  rods_from(m, {0, 0}, n);
  if (m.chance(0.5)) m.turn_about({0, 0}, m.random.uniform(-8, 8));
  for (BodyId b = 0; b < n; ++b) {
    if (!m.chance(0.4)) continue;
    const Angle between{b - 1, b};
    const double now = m.body(b).angle - (b > 0 ? m.body(b - 1).angle : 0);
    if (m.chance(0.7)) m.limit(between, Limit::Side::upper, now + m.pick({0, 0.1, 0.5}), m.law().e);
    if (m.chance(0.4)) m.limit(between, Limit::Side::lower, now - m.random.uniform(0.1, 0.5), m.law().e);
    if (m.chance(0.4)) m.scene.spring(JointSpring{{}, between, m.log_uniform(0.1, 50), m.pick({0, 0.1}), now});
  }
  if (m.chance(0.4)) {  // the end over a floor
    const Vector2d end = m.body(n - 1).position;
    m.scene.contact(CornerWall{
        {}, n - 1, {m.length_of(n - 1) / 2, 0}, kGround, {0, end.y() - m.random.uniform(0.3, 0.6)}, {0, 1}, m.law()});
  }
}

void pin_contact(Maker& m) {  // contacts at points that joints hold
  const Vector2d at = m.chance(0.5) ? Vector2d(0, 0) : m.point(-2, 2);
  const double turn = m.pick({0, 0, 0.7, -2});
  const Vector2d normal(-std::sin(turn), std::cos(turn));
  rods_from(m, at, m.random.integer(1, 3));
  if (m.chance(0.5)) m.turn_about(at, m.random.uniform(-5, 5));
  const Vector2d end(-m.length_of(0) / 2, 0);
  const double radius = m.pick({0.02, 0.05});
  switch (m.random.integer(0, 3)) {
    case 0:
      m.scene.contact(DiscWall{{}, 0, end, radius, kGround, at - radius * normal, normal, m.law()});
      break;
    case 1:
      m.scene.contact(CornerWall{{}, 0, end, kGround, at, normal, m.law()});
      break;
    case 2:
      m.scene.contact(DiscDisc{{}, 0, end, radius, kGround, at - 2 * radius * normal, radius, m.law()});
      break;
    default:
      m.scene.contact(Journal{{}, 0, end, radius, kGround, at, radius + m.pick({1e-4, 1e-3}), m.law()});
      m.scene.contact(CornerWall{{}, 0, end, kGround, at, normal, m.law()});
  }
  if (m.chance(0.3)) m.limit(Span{kGround, 0, at, {m.length_of(0) / 2, 0}}, Limit::Side::upper, m.length_of(0), 0);
  if (m.chance(0.3)) m.pin(kGround, at, 0, end);  // twice the same
}

void hinged_plank(Maker& m) {  // a plank hinged at a corner that touches the floor
  const double width = m.random.uniform(0.4, 1.2), height = m.random.uniform(0.05, 0.3);
  const double turn = m.random.uniform(0.05, 1.4), tilt = m.pick({0, 0, 0.3, -1.1});
  const Vector2d at = m.chance(0.5) ? Vector2d(0, 0) : m.point(-3, 3);
  const Form box = m.box(width, height);
  const BodyId plank = m.add(box, {0, 0}, turn + tilt);
  const Vector2d corner = box.corners[0];
  const double c = std::cos(turn + tilt), s = std::sin(turn + tilt);
  m.body(plank).position = at - Vector2d(c * corner.x() - s * corner.y(), s * corner.x() + c * corner.y());
  m.pin(kGround, at, plank, corner);
  m.wall(plank, at, {-std::sin(tilt), std::cos(tilt)});
  m.scene.gravity = 9.81 * Vector2d(std::sin(tilt), -std::cos(tilt));
  if (m.chance(0.5)) m.turn_about(at, m.random.uniform(-4, 2));
  if (m.chance(0.3)) {
    const BodyId ball = m.add({0.08, {}}, at + Vector2d(-std::sin(tilt), std::cos(tilt)) * (width + 0.5));
    m.meet(plank, ball);
  }
}

void four_bar(Maker& m) {  // with a clearance at one pin, or several; driven or swinging
  const double a = m.random.uniform(0.08, 0.15), b = m.random.uniform(0.3, 0.4), c = m.random.uniform(0.25, 0.35);
  const double angle = m.random.uniform(-3, 3);
  const Vector2d A = a * Vector2d(std::cos(angle), std::sin(angle)), D(0.35, 0), B = apex(A, b, D, c);
  const BodyId crank = m.rod({0, 0}, A), coupler = m.rod(A, B), rocker = m.rod(D, B);
  const double clearance = m.pick({1e-4, 2e-4, 1e-3});
  const int loose = m.random.integer(0, 3);
  const Vector2d pins[] = {{0, 0}, A, D, B};
  const BodyId pairs[][2] = {{kGround, crank}, {crank, coupler}, {kGround, rocker}, {coupler, rocker}};
  for (int i = 0; i < 4; ++i) {
    const auto [x, y] = pairs[i];
    if (i == loose && m.chance(0.8))
      m.journal(y, m.in_body(y, pins[i]), x, m.in_body(x, pins[i]), clearance);
    else
      m.pin(x, m.in_body(x, pins[i]), y, m.in_body(y, pins[i]));
  }
  const double omega = m.random.uniform(-20, 20);
  m.body(crank).velocity = omega * perp(m.body(crank).position), m.body(crank).omega = omega;
  if (m.chance(0.4) && loose != 0)
    m.drive(angle_of(crank), angle, omega);
  else if (m.chance(0.5))
    m.scene.load({.body = crank, .torque = m.random.uniform(-2, 2)});
  if (m.chance(0.3)) m.limit(angle_of(rocker), Limit::Side::lower, m.body(rocker).angle - 0.5, m.law().e);
}

void slider(Maker& m) {  // slider-crank: guide or rail, pin or journal
  const double a = m.random.uniform(0.08, 0.15), b = m.random.uniform(0.25, 0.4), angle = m.random.uniform(-3, 3);
  const Vector2d A = a * Vector2d(std::cos(angle), std::sin(angle));
  const Vector2d B(A.x() + std::sqrt(b * b - A.y() * A.y()), 0);
  const BodyId crank = m.rod({0, 0}, A), rod = m.rod(A, B), piston = m.add(m.box(0.1, 0.05), B);
  m.pin(kGround, {0, 0}, crank, m.in_body(crank, {0, 0})), m.pin(crank, m.in_body(crank, A), rod, m.in_body(rod, A));
  const double clearance = m.pick({1e-4, 1e-3, 5e-3});
  if (m.chance(0.6))
    m.pin(rod, m.in_body(rod, B), piston, {0, 0});
  else
    m.journal(rod, m.in_body(rod, B), piston, {0, 0}, m.pick({1e-4, 1e-3}));
  if (m.chance(0.7)) {
    m.scene.contact_set(
        guide({.name = "guide", .a = piston, .width = 0.1, .height = 0.05, .clearance = clearance, .law = m.law()}));
  } else {
    m.scene.joint(Prismatic{{}, kGround, piston, {0, 0}, {0, 0}, {1, 0}, 0});
    if (m.chance(0.4))
      m.scene.contact_set(guide({.name = "beside",
                                 .a = piston,
                                 .width = 0.1,
                                 .height = 0.05,
                                 .clearance = m.pick({0, 1e-4}),
                                 .law = m.law()}));
  }
  const double omega = m.random.uniform(-20, 20);
  m.body(crank).velocity = omega * perp(m.body(crank).position), m.body(crank).omega = omega;
  if (m.chance(0.4)) m.drive(angle_of(crank), angle, omega);
  if (m.chance(0.3)) m.scene.load({.body = piston, .force = {m.random.uniform(-20, 20), 0}});
}

void redundant(Maker& m) {  // parallel bars, joints that repeat each other
  const double length = m.random.uniform(0.2, 0.5), span = m.random.uniform(0.3, 0.6);
  const double angle = m.random.uniform(0.3, 2.8), omega = m.random.uniform(-6, 6);
  const Vector2d arm = length * Vector2d(std::cos(angle), std::sin(angle));
  const int bars = m.random.integer(2, 4);
  const BodyId platform = m.add(m.box(span, 0.06), arm + Vector2d(span / 2, 0));
  for (int i = 0; i < bars; ++i) {
    const Vector2d foot(i * span / (bars - 1), 0);
    const BodyId bar = m.rod(foot, foot + arm);
    m.pin(kGround, foot, bar, m.in_body(bar, foot));
    m.pin(bar, m.in_body(bar, foot + arm), platform, m.in_body(platform, foot + arm));
    m.body(bar).velocity = omega * perp(arm) / 2, m.body(bar).omega = omega;
  }
  m.body(platform).velocity = omega * perp(arm);
  if (m.chance(0.3)) m.scene.joint(Distance{{}, kGround, platform, {0, 0}, m.in_body(platform, arm), length});
  if (m.chance(0.3)) m.pin(kGround, {0, 0}, 1, m.in_body(1, {0, 0}));
  if (m.chance(0.6)) {
    const BodyId load = m.add(m.chance(0.5) ? m.disc() : m.box(0.15, 0.15), {0, 0});
    const double half = m.form(load).corners.empty() ? m.form(load).radius : 0.075;
    m.body(load).position = arm + Vector2d(m.random.uniform(0, span), 0.03 + half + m.pick({0, 0.05}));
    m.body(load).velocity = m.body(platform).velocity;
    m.meet(platform, load);
  }
  if (m.chance(0.4))
    m.limit(angle_of(1), omega < 0 ? Limit::Side::lower : Limit::Side::upper, angle + (omega < 0 ? -0.3 : 0.3),
            m.law().e);
}

void rail(Maker& m) {  // carriages on rails with stops, springs, contacts along the rail, a pendulum below
  const double turn = m.pick({0, 0, 0.6, 1.3});
  const Vector2d axis(std::cos(turn), std::sin(turn));
  const int n = m.random.integer(1, 2);
  for (int i = 0; i < n; ++i) {
    const Vector2d at = 0.5 * i * axis;
    const BodyId cart = m.add(m.box(0.2, 0.1), at, turn);
    m.scene.joint(Prismatic{{}, kGround, cart, {0, 0}, {0, 0}, axis, turn});
    m.body(cart).velocity = m.random.uniform(-3, 3) * axis;
    const Slide along{kGround, cart, {0, 0}, {0, 0}, axis};
    if (m.chance(0.6)) m.limit(along, Limit::Side::upper, 0.5 * i + m.pick({0, 0.1, 0.2}), m.law().e);
    if (m.chance(0.6)) m.limit(along, Limit::Side::lower, 0.5 * i - m.pick({0.05, 0.1}), m.law().e);
    if (m.chance(0.4)) m.scene.spring(JointSpring{{}, along, m.log_uniform(10, 500), m.pick({0, 1}), 0.5 * i});
    if (m.chance(0.4)) m.wall(cart, -0.05 * perp(axis), perp(axis));  // touches along the rail
    if (m.chance(0.4)) {
      const Vector2d end = at + m.random.uniform(0.2, 0.4) * Vector2d(0.3, -1).normalized();
      const BodyId bob = m.rod(at, end);
      m.pin(cart, {0, 0}, bob, m.in_body(bob, at));
      m.body(bob).velocity = m.body(cart).velocity;
    }
  }
  const BodyId last = m.scene.bodies.size() > 1 ? static_cast<BodyId>(m.scene.bodies.size()) - 1 : 0;
  if (n == 2 && m.form(last).corners.size() == 4) m.meet(0, last);
}

void ropes(Maker& m) {  // weights on ropes, bars and springs
  const int n = m.random.integer(1, 4);
  Vector2d above(0, 0);
  for (int i = 0; i < n; ++i) {
    const Vector2d at = above + m.random.uniform(0.2, 0.5) * Vector2d(m.random.uniform(-1, 1), -1).normalized();
    const Form form = m.chance(0.5) ? Form{0.06, {}} : m.box(0.12, 0.1);
    const BodyId b = m.add(form, at, m.random.uniform(-1, 1));
    const BodyId to = i == 0 ? kGround : b - 1;
    const Vector2d hook = m.in_body(to, above), own = m.in_body(b, at + Vector2d(0, 0.03));
    const double length = (at + Vector2d(0, 0.03) - above).norm();
    const double u = m.random.uniform();
    if (u < 0.5)
      m.limit(Span{to, b, hook, own}, Limit::Side::upper, length + m.pick({0, 0, 0.02, 0.1}), m.law().e);
    else if (u < 0.75)
      m.scene.joint(Distance{{}, to, b, hook, own, length});
    else
      m.scene.spring(PointSpring{{}, to, b, hook, own, m.log_uniform(20, 2000), m.pick({0, 0.5}), length});
    m.body(b).velocity = m.point(-2, 2), m.body(b).omega = m.random.uniform(-4, 4);
    above = at;
  }
  if (m.chance(0.5)) m.meet_all();
  if (m.chance(0.4)) m.wall(n - 1, {0, above.y() - 0.4}, {0, 1});
}

void jammed(Maker& m) {  // a drive against a stop, a wall, or what stands in its way
  const double angle = m.random.uniform(-1, 1), omega = m.random.uniform(2, 20), length = m.random.uniform(0.2, 0.5);
  const Vector2d end = length * Vector2d(std::cos(angle), std::sin(angle));
  const BodyId crank = m.rod({0, 0}, end);
  m.pin(kGround, {0, 0}, crank, {-length / 2, 0});
  m.turn_about({0, 0}, omega);
  m.drive(angle_of(crank), angle, omega);
  const double far = m.random.uniform(0.1, 0.6);
  const Vector2d there = length * Vector2d(std::cos(angle + far), std::sin(angle + far));
  const Vector2d back = -perp(there).normalized();
  switch (m.random.integer(0, 3)) {
    case 0:
      m.limit(angle_of(crank), Limit::Side::upper, angle + far, m.law().e);
      break;
    case 1:
      m.scene.contact(CornerWall{{}, crank, {length / 2, 0}, kGround, there, back, m.law()});
      break;
    case 2: {  // a ball between the crank and a wall
      const Vector2d ball_at = there - 0.06 * back;
      const BodyId ball = m.add({0.05, {}}, ball_at);
      m.scene.contact(DiscWall{{}, ball, {0, 0}, 0.05, kGround, ball_at - 0.06 * back, back, m.law()});
      m.scene.contact(DiscPolygon{{}, ball, {0, 0}, 0.05, crank, rectangle(length, 0.01), m.law()});
      break;
    }
    default: {  // a link behind it that comes to a stop
      const Vector2d tip = end + Vector2d(0.1, 0.3), foot = tip + Vector2d(0.05, -0.4);
      const BodyId link = m.rod(end, tip), arm = m.rod(foot, tip);
      m.pin(crank, {length / 2, 0}, link, m.in_body(link, end));
      if (m.chance(0.5))
        m.pin(link, m.in_body(link, tip), arm, m.in_body(arm, tip));
      else
        m.journal(link, m.in_body(link, tip), arm, m.in_body(arm, tip), 2e-4);
      m.pin(kGround, foot, arm, m.in_body(arm, foot));
      const double now = m.body(arm).angle;
      m.limit(angle_of(arm), Limit::Side::lower, now - m.random.uniform(0, 0.3), m.law().e);
      m.limit(angle_of(arm), Limit::Side::upper, now + m.random.uniform(0.01, 0.3), m.law().e);
    }
  }
}

void rotor(Maker& m) {  // journals in bearings; a rod or a disc that turns or rests in it
  const double clearance = m.pick({1e-4, 1e-3, 1e-2}), mass = m.mass();
  const BodyId b = m.chance(0.5) ? m.add({0.1, {}}, {0, 0}, 0, mass) : m.rod({0, 0}, {0.4, 0}, mass);
  const Vector2d own = m.form(b).radius == 0.1 ? Vector2d(0, 0) : Vector2d(-m.length_of(b) / 2, 0);
  m.journal(b, own, kGround, {0, 0}, clearance);
  m.body(b).position += clearance * m.pick({0.3, 0.9, 1}) * Vector2d(0, -1);
  m.body(b).omega = m.pick({0, 3, -30});
  if (m.chance(0.4)) {
    const Vector2d far = m.body(b).position + Vector2d(m.form(b).radius, 0);
    const BodyId second = m.rod(far, far + Vector2d(0.2, -0.2));
    m.journal(second, m.in_body(second, far), b, m.in_body(b, far), clearance);
  }
  if (m.chance(0.3)) m.scene.load({.body = b, .torque = m.random.uniform(-1, 1)});
}

void mixed(Maker& m) {  // a tree of any bodies and joints over a floor, each thing by chance
  const int n = m.random.integer(2, 6);
  for (int i = 0; i < n; ++i) {
    const BodyId b = m.add(m.any(), {0.55 * i, 0.5 + m.random.uniform(0, 0.5)}, m.random.uniform(-3, 3));
    const BodyId to = m.chance(0.3) ? kGround : b - 1;
    const Vector2d middle = to < 0 ? m.body(b).position : Vector2d((m.body(to).position + m.body(b).position) / 2);
    const Vector2d on_to = m.in_body(to, middle), own = m.in_body(b, middle);
    const double turned = m.body(b).angle - (to < 0 ? 0 : m.body(to).angle);
    const double u = m.random.uniform();
    if (u < 0.3)
      m.pin(to, on_to, b, own);
    else if (u < 0.4)
      m.scene.joint(Prismatic{{}, to, b, on_to, own, {0.6, 0.8}, turned});
    else if (u < 0.5)
      m.scene.joint(Fixed{{}, to, b, on_to, own, -turned});
    else if (u < 0.6)
      m.scene.spring(PointSpring{{}, to, b, on_to + Vector2d(0.1, 0.1), own, 100, 0.5, 0.1});
    else if (u < 0.7)
      m.limit(Span{to, b, on_to + Vector2d(0, 0.2), own}, Limit::Side::upper, 0.22, m.law().e);
    m.wall(b, {0, m.random.uniform(-0.3, 0.15)}, {0, 1});
    if (i > 1 && m.chance(0.5)) m.meet(b - 2, b);
  }
  if (m.chance(0.5)) m.body(m.random.integer(0, n - 1)).velocity = m.point(-3, 3);
}

}  // namespace orthant::motion_storm
