// Random scenes in space of bodies without joints: dropped, sliding, spinning, heaped, in wedges, on moving surfaces.
#include "experiments/studies/motion_storm/spatial_maker.h"

#include <orthant/core/mechanics/spatial/solid.h>

#include <cmath>

namespace orthant::motion_storm {
namespace {

const Vector3d kUp(0, 0, 1);

void throw_all(SpatialMaker& m, double speed, double omega) {
  for (spatial::Body& b : m.scene.bodies)
    b.velocity += speed * m.direction(), b.omega += m.random.uniform(0, omega) * m.direction();
}

/// Half the extent of a form along its own z axis, to stand on.
double half_height(const Solid3& f) {
  switch (f.kind) {
    case Solid3::box:
      return f.size.z() / 2;
    case Solid3::cylinder:
      return f.size.y() / 2;
    case Solid3::ellipsoid:
      return f.size.z();
    case Solid3::capsule:
      return f.size.x() + f.size.y() / 2;
    case Solid3::sphere:
      return f.size.x();
    default:
      return f.reach;
  }
}

/// One that can stand: a box, a can, a ball.
Solid3 standing(SpatialMaker& m) {
  const double u = m.random.uniform();
  if (u < 0.4) return SpatialMaker::brick(m.point(0.1, 0.35));
  const double radius = m.random.uniform(0.05, 0.2);
  return u < 0.7 ? SpatialMaker::can(radius, m.random.uniform(0.05, 0.3)) : SpatialMaker::ball(radius);
}

}  // namespace

void dropped(SpatialMaker& m) {
  const int n = m.random.integer(1, 3);
  const Vector3d normal = m.chance(0.7) ? kUp : Vector3d(0.2, -0.1, 1).normalized();
  for (int i = 0; i < n; ++i) {
    const Solid3 form = m.any();
    m.add(form, Vector3d(0.8 * i, 0, form.reach + 0.2 * i + m.random.uniform(0.02, 0.1)), m.orientation());
  }
  for (BodyId b = 0; b < n; ++b) m.wall(b, {0, 0, 0}, normal);
  throw_all(m, m.pick({0, 1, 3}), m.pick({0, 3, 10}));
}

void sliding(SpatialMaker& m) {  // closed contacts at the start, on the level or a slope
  const double tilt = m.pick({0, 0, 0.2, 0.6});
  const Eigen::Vector4d turn = quaternions::exponential(Vector3d(0, tilt, 0)).normalized();
  const Vector3d normal = quaternions::matrix_of(turn) * kUp;
  const int n = m.random.integer(1, 2);
  for (int i = 0; i < n; ++i) {
    const Solid3 form = standing(m);
    const Vector3d along = quaternions::matrix_of(turn) * Vector3d(0, 0.8 * i, half_height(form));
    const BodyId b = m.add(form, along, turn);
    const Vector3d speed = m.pick({0, 1, 3}) * m.direction();
    m.body(b).velocity = speed - normal.dot(speed) * normal;
    m.body(b).omega = m.pick({0, 0, 5, -20}) * normal;
    m.wall(b, {0, 0, 0}, normal);
  }
  if (m.chance(0.3)) m.scene.load({.body = 0, .force = m.point(-10, 10)});
}

void spinning(SpatialMaker& m) {  // discs and balls that roll, tops, fast spins
  const double u = m.random.uniform();
  const double radius = m.random.uniform(0.05, 0.2);
  if (u < 0.4) {  // a disc on its rim
    const double tilt = m.random.uniform(0.1, 1.4), height = m.pick({0.01, 0.05});
    const Eigen::Vector4d turn = quaternions::exponential(Vector3d(tilt, 0, 0)).normalized();
    const double up = radius * std::sin(tilt) + height / 2 * std::cos(tilt) + m.pick({0, 0, 0.02});
    const BodyId b = m.add(SpatialMaker::can(radius, height), {0, 0, up}, turn);
    m.body(b).omega = m.random.uniform(-20, 20) * (quaternions::matrix_of(turn) * kUp) + m.point(-5, 5);
    m.wall(b, {0, 0, 0}, kUp);
  } else if (u < 0.7) {  // a ball with spin, touching or above
    const BodyId b = m.add(SpatialMaker::ball(radius), {0, 0, radius + m.pick({0, 0.05})});
    m.body(b).velocity = m.point(-2, 2), m.body(b).velocity.z() = 0, m.body(b).omega = m.point(-40, 40);
    m.wall(b, {0, 0, 0}, kUp);
  } else {  // a top on its tip
    const Eigen::Vector4d turn = quaternions::exponential(m.random.uniform(0, 1) * Vector3d(1, 0.2, 0)).normalized();
    const Vector3d axis = quaternions::matrix_of(turn) * kUp;
    const BodyId b = m.add(SpatialMaker::can(radius, 0.03), 0.1 * axis, turn);
    m.scene.contact(spatial::SpherePlane{{}, b, {0, 0, -0.1}, 0, kGround, {0, 0, 0}, kUp, m.law()});
    m.body(b).omega = m.pick({10, 100, 1000}) * axis;
  }
}

void spheres(SpatialMaker& m) {  // over a floor or in a corner, onto each other
  const int n = m.random.integer(2, 4);
  double top = 0;
  for (int i = 0; i < n; ++i) {
    const double radius = m.random.uniform(0.05, 0.15);
    const Vector3d aside = m.chance(0.3) ? Vector3d(0, 0, 0) : Vector3d(0.03 * m.point(-1, 1));
    m.add(SpatialMaker::ball(radius), Vector3d(aside.x(), aside.y(), top + radius + m.pick({0, 0, 0.02})));
    top = m.body(i).position.z() + radius;
  }
  for (BodyId a = 0; a < n; ++a) {
    m.wall(a, {0, 0, 0}, kUp);
    if (m.chance(0.3)) m.wall(a, {-0.2, 0, 0}, {1, 0, 0});
    for (BodyId b = 0; b < a; ++b) m.meet(a, b);
  }
  throw_all(m, m.pick({0, 0, 1}), m.pick({0, 10}));
}

void wedge(SpatialMaker& m) {  // between planes that lean to each other
  const double angle = m.random.uniform(0.2, 1.3);
  const Solid3 form = m.chance(0.5) ? m.ball() : SpatialMaker::brick(m.point(0.1, 0.3));
  const BodyId b = m.add(form, {0, 0, 0},
                         form.kind == Solid3::sphere || m.chance(0.5) ? Eigen::Vector4d(1, 0, 0, 0) : m.orientation());
  const int planes = m.random.integer(2, 3);
  for (int i = 0; i < planes; ++i) {
    const double around = 2 * M_PI * i / planes;
    const Vector3d n(std::cos(around) * std::sin(angle), std::sin(around) * std::sin(angle), std::cos(angle));
    const double low = form.kind == Solid3::sphere ? form.reach : form.reach + 0.01;
    m.wall(b, -(low + m.pick({0, 0, 0.02})) * n, n);
  }
  m.body(b).velocity = m.pick({0, 1, 3}) * m.direction(), m.body(b).omega = m.pick({0, 5}) * m.direction();
}

void billiards(SpatialMaker& m) {  // balls on a table, or in the air, that strike one another
  const int n = m.random.integer(2, 5);
  const bool table = m.chance(0.7);
  for (int i = 0; i < n; ++i) {
    const double radius = 0.05;
    const double beside = m.chance(0.5) ? 0 : m.random.uniform(-0.04, 0.04);
    m.add(SpatialMaker::ball(radius), {i == 0 ? -0.3 : 0.1 * (i - 1) * m.pick({1, 1, 1.1}), beside, radius});
  }
  for (BodyId a = 0; a < n; ++a) {
    if (table) m.wall(a, {0, 0, 0}, kUp);
    for (BodyId b = 0; b < a; ++b)
      if ((m.body(a).position - m.body(b).position).norm() >= 0.1 - 1e-12) m.meet(a, b);
  }
  m.body(0).velocity = {m.random.uniform(1, 5), 0, 0};
  if (m.chance(0.5)) m.body(0).omega = m.point(-30, 30);
  if (!table) m.scene.gravity = {0, 0, 0};
}

void belt(SpatialMaker& m) {  // surfaces that move along themselves, or turn
  const Solid3 form = standing(m);
  const BodyId b = m.add(form, {0.2, 0, half_height(form) + m.pick({0, 0.02})});
  ContactLaw law = m.law();
  law.mu = m.pick({0.1, 0.4, 0.8});
  if (m.chance(0.5))
    law.surface.velocity = {m.random.uniform(-2, 2), m.random.uniform(-2, 2), 0};
  else
    law.surface.omega = m.random.uniform(-5, 5) * kUp;
  if (m.chance(0.3)) law.surface.direction = {1, 0, 0}, law.surface.mu_across = law.mu * m.pick({0.5, 2});
  m.wall(b, {0, 0, 0}, kUp, law);
  if (m.chance(0.5)) m.body(b).velocity = {m.random.uniform(-2, 2), 0, 0};
}

void shaken(SpatialMaker& m) {  // a driven table with bodies on it
  const Vector3d axis = m.chance(0.5) ? kUp : m.chance(0.5) ? Vector3d(1, 0, 0) : m.direction();
  const double amplitude = m.random.uniform(0.005, 0.05), omega = m.random.uniform(5, 40);
  const BodyId table = m.add(SpatialMaker::brick({1.5, 1.5, 0.1}), {0, 0, -0.05});
  m.prismatic(kGround, table, {0, 0, -0.05}, axis);
  m.drive(m.slide(kGround, table, {0, 0, -0.05}, axis), 0, 0, amplitude, omega);
  m.body(table).velocity = amplitude * omega * axis;
  const int n = m.random.integer(1, 2);
  for (int i = 0; i < n; ++i) {
    const Solid3 form = standing(m);
    const BodyId b = m.add(form, {0.6 * i - 0.3, 0, half_height(form) + m.pick({0, 0.01})});
    m.wall(b, {0, 0, 0}, kUp, m.law(), table);
    if (m.chance(0.5)) m.body(b).velocity = m.body(table).velocity;
  }
}

void searched(SpatialMaker& m) {  // boxes, capsules, polytopes and balls against each other: pairs that a search finds
  const int n = m.random.integer(2, 5);
  if (m.chance(0.4)) {  // a stack
    double top = 0;
    for (int i = 0; i < n; ++i) {
      const Vector3d size(m.random.uniform(0.15, 0.4), m.random.uniform(0.15, 0.4), m.random.uniform(0.1, 0.2));
      m.add(SpatialMaker::brick(size), {m.random.uniform(-0.02, 0.02), 0, top + size.z() / 2});
      top += size.z();
    }
  } else {
    for (int i = 0; i < n; ++i) m.add(m.any(true), Vector3d(0.1 * (i % 2), 0.05 * i, 0.35 + 0.7 * i), m.orientation());
    throw_all(m, m.pick({0, 1, 3}), m.pick({0, 5}));
  }
  const ContactLaw law = m.law();
  for (BodyId b = 0; b < n; ++b) m.wall(b, {0, 0, 0}, kUp, law);
  m.search_all();
}

void tumbling(SpatialMaker& m) {  // free bodies: needles, plates, fast spins, unequal moments
  const int n = m.random.integer(1, 2);
  for (int i = 0; i < n; ++i) {
    const double thin = m.pick({1, 0.1, 0.01, 1e-3});
    const Vector3d size = m.chance(0.5) ? Vector3d(thin, thin, 1) : Vector3d(1, m.random.uniform(0.3, 1), thin);
    const BodyId b = m.add(SpatialMaker::brick(0.3 * size), {1.0 * i, 0, 0.5}, m.orientation());
    m.body(b).omega = m.log_uniform(0.1, 100) * m.direction(), m.body(b).velocity = m.point(-1, 1);
    if (m.chance(0.4)) m.wall(b, {0, 0, 0}, kUp);
    if (m.chance(0.3))
      m.scene.load({.body = b,
                    .point = 0.1 * m.direction(),
                    .force = m.point(-5, 5),
                    .moment = m.point(-0.1, 0.1),
                    .frame = m.chance(0.5) ? spatial::Frame::body : spatial::Frame::world});
  }
}

}  // namespace orthant::motion_storm
