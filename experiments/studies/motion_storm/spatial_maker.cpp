#include "experiments/studies/motion_storm/spatial_maker.h"

#include <orthant/core/mechanics/spatial/polyhedron.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <algorithm>
#include <numbers>

namespace orthant::motion_storm {
namespace {

spatial::Solid solid_of(const Solid3& form) {
  const Vector3d& s = form.size;
  switch (form.kind) {
    case Solid3::sphere:
      return spatial::sphere(s.x());
    case Solid3::box:
      return spatial::box(s);
    case Solid3::cylinder:
      return spatial::cylinder(s.x(), s.y());
    case Solid3::ellipsoid:
      return spatial::ellipsoid(s);
    case Solid3::capsule:
      return spatial::capsule(s.x(), s.y());
    default: {
      const auto p = spatial::polyhedron(spatial::hull_of(form.corners));
      return {p.volume, p.inertia};
    }
  }
}

}  // namespace

SpatialMaker::SpatialMaker(Random& random_) : Drawing(random_) {
  scene.gravity = chance(0.8) ? Vector3d(0, 0, -9.81) : chance(0.5) ? Vector3d(0, 0, 0) : point(-10, 10);
  draw_ranges();
}

Vector3d SpatialMaker::point(double lo, double hi) {
  const double x = random.uniform(lo, hi), y = random.uniform(lo, hi);
  return {x, y, random.uniform(lo, hi)};
}

Vector3d SpatialMaker::direction() {
  for (;;) {
    const Vector3d p = point(-1, 1);
    if (p.norm() > 0.1 && p.norm() < 1) return p.normalized();
  }
}

Eigen::Vector4d SpatialMaker::orientation() {
  const Vector3d axis = direction();
  return quaternions::exponential(random.uniform(-3, 3) * axis).normalized();
}

Solid3 SpatialMaker::can(double radius, double height) {
  return {Solid3::cylinder, {radius, height, 0}, {}, std::hypot(radius, height / 2)};
}

Solid3 SpatialMaker::wedge() {
  for (;;) {
    Solid3 form{Solid3::polytope, {0, 0, 0}, {}, 0};
    for (int i = random.integer(4, 6); i > 0; --i) form.corners.push_back(random.uniform(0.15, 0.3) * direction());
    const spatial::Hull hull = spatial::hull_of(form.corners);
    const auto p = spatial::polyhedron(hull);
    form.corners = hull.corners;
    for (Vector3d& c : form.corners) c -= p.centre, form.reach = std::max(form.reach, c.norm());
    if (p.volume > 0.1 * std::pow(form.reach, 3)) return form;  // no needles
  }
}

Solid3 SpatialMaker::any(bool searched) {
  const double u = random.uniform();
  if (u < 0.3) return ball();
  if (u < 0.55) return brick(point(0.1, 0.35));
  if (u < 0.7) {
    const double radius = random.uniform(0.04, 0.12), length = random.uniform(0.1, 0.3);
    return {Solid3::capsule, {radius, length, 0}, {}, radius + length / 2};
  }
  if (u < 0.8 || searched) return wedge();
  if (u < 0.9) {
    const double radius = random.uniform(0.05, 0.2);
    return can(radius, random.uniform(0.05, 0.3));
  }
  const Vector3d axes = point(0.06, 0.2);
  return {Solid3::ellipsoid, axes, {}, axes.maxCoeff()};
}

BodyId SpatialMaker::add(const Solid3& form, const Vector3d& position, const Eigen::Vector4d& orientation,
                         double mass_of_it) {
  const double m = mass_of_it > 0 ? mass_of_it : mass();
  forms.push_back(form);
  return scene.body(
      {.mass = m, .inertia = m * solid_of(form).inertia, .position = position, .orientation = orientation});
}

BodyId SpatialMaker::rod(const Vector3d& from, const Vector3d& to, double mass_of_it) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), to - from);
  const double length = (to - from).norm();
  return add(can(length / 20, length), (from + to) / 2,
             Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z()).normalized(), mass_of_it);
}

void SpatialMaker::wall(BodyId a, const Vector3d& at, const Vector3d& normal, const ContactLaw& law, BodyId b) {
  const Solid3& f = form(a);
  const Vector3d p = in_body(b, at), n = in_frame(b, normal.normalized());
  const std::string name = "wall" + std::to_string(scene.contacts.size());
  const auto sphere = [&](const Vector3d& centre, double radius) {
    scene.contact(spatial::SpherePlane{{}, a, centre, radius, b, p, n, law});
  };
  switch (f.kind) {
    case Solid3::sphere:
      return sphere({0, 0, 0}, f.size.x());
    case Solid3::capsule:
      sphere({0, 0, f.size.y() / 2}, f.size.x()), sphere({0, 0, -f.size.y() / 2}, f.size.x());
      return;
    case Solid3::box:
      for (const Vector3d& c : spatial::box_corners(f.size / 2)) sphere(c, 0);
      return;
    case Solid3::polytope:
      for (const Vector3d& c : f.corners) sphere(c, 0);
      return;
    case Solid3::ellipsoid:
      return scene.contact(spatial::EllipsoidPlane{{}, a, {0, 0, 0}, f.size, {1, 0, 0, 0}, b, p, n, law});
    default: {
      spatial::RimPlane rim{
          .name = name, .a = a, .radius = f.size.x(), .b = b, .plane_point = p, .normal = n, .law = law};
      rim.centre.z() = -f.size.y() / 2, scene.contact_set(spatial::standing_rim(rim, 1));
      rim.centre.z() = f.size.y() / 2, scene.contact_set(spatial::standing_rim(rim, 4));
    }
  }
}

void SpatialMaker::meet(BodyId a, BodyId b) {
  scene.contact(spatial::SphereSphere{{}, a, {0, 0, 0}, form(a).size.x(), b, {0, 0, 0}, form(b).size.x(), law()});
}

void SpatialMaker::search_all() {
  spatial::Collision all{.name = "all", .shapes = {}, .law = law(), .neighbours = 12};
  for (BodyId b = 0; b < bodies(); ++b) {
    const Solid3& f = form(b);
    spatial::Shape shape{.body = b, .corners = f.corners};
    if (f.kind == Solid3::box) shape.corners = spatial::box_corners(f.size / 2);
    if (f.kind == Solid3::sphere) shape.corners = {Vector3d::Zero()}, shape.radius = f.size.x();
    if (f.kind == Solid3::capsule)
      shape.corners = {{0, 0, -f.size.y() / 2}, {0, 0, f.size.y() / 2}}, shape.radius = f.size.x();
    if (!shape.corners.empty()) all.shapes.push_back(shape);
  }
  scene.collision(all);
}

void SpatialMaker::spherical(BodyId a, BodyId b, const Vector3d& at) {
  scene.joint(spatial::Spherical{{}, a, b, in_body(a, at), in_body(b, at)});
}
void SpatialMaker::revolute(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) {
  const spatial::Angle of = angle(a, b, axis);
  scene.joint(spatial::Revolute{
      {}, a, b, in_body(a, at), in_body(b, at), of.axis_a, of.axis_b, of.reference_a, of.reference_b});
}
void SpatialMaker::cylindrical(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) {
  const spatial::Angle of = angle(a, b, axis);
  scene.joint(spatial::Cylindrical{
      {}, a, b, in_body(a, at), in_body(b, at), of.axis_a, of.axis_b, of.reference_a, of.reference_b});
}
void SpatialMaker::universal(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) {
  scene.joint(spatial::Universal{
      {}, a, b, in_body(a, at), in_body(b, at), in_frame(a, axis), in_frame(b, spatial::perpendicular(axis))});
}
void SpatialMaker::prismatic(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) {
  scene.joint(spatial::Prismatic{{}, a, b, in_body(a, at), in_body(b, at), in_frame(a, axis), relative(a, b)});
}
void SpatialMaker::fixed(BodyId a, BodyId b, const Vector3d& at) {
  scene.joint(spatial::Fixed{{}, a, b, in_body(a, at), in_body(b, at), relative(a, b)});
}
void SpatialMaker::screw(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis, double pitch) {
  const spatial::Angle of = angle(a, b, axis);
  scene.joint(spatial::Screw{
      {}, a, b, in_body(a, at), in_body(b, at), of.axis_a, of.axis_b, of.reference_a, of.reference_b, pitch, 0});
}
void SpatialMaker::planar(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) {
  scene.joint(spatial::PlaneJoint{{}, a, b, in_body(a, at), in_body(b, at), in_frame(a, axis), in_frame(b, axis)});
}
void SpatialMaker::in_plane(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) {
  scene.joint(spatial::PointInPlane{{}, a, b, in_body(a, at), in_body(b, at), in_frame(a, axis)});
}
void SpatialMaker::on_line(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) {
  scene.joint(spatial::PointOnLine{{}, a, b, in_body(a, at), in_body(b, at), in_frame(a, axis)});
}
void SpatialMaker::distance(BodyId a, BodyId b, const Vector3d& at_a, const Vector3d& at_b) {
  scene.joint(spatial::Distance{{}, a, b, in_body(a, at_a), in_body(b, at_b), (at_a - at_b).norm()});
}
void SpatialMaker::socket(BodyId a, BodyId b, const Vector3d& at, double clearance) {
  scene.contact(spatial::Socket{{}, a, in_body(a, at), 0.02, b, in_body(b, at), 0.02 + clearance, law()});
}
void SpatialMaker::pin_bush(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis, double clearance) {
  spatial::PinBush pin{.name = "pin" + std::to_string(scene.contacts.size())};
  pin.a = a, pin.centre_a = in_body(a, at), pin.axis_a = in_frame(a, axis), pin.radius_a = 0.02;
  pin.b = b, pin.centre_b = in_body(b, at), pin.axis_b = in_frame(b, axis), pin.radius_b = 0.02 + clearance;
  pin.law = law(), pin.rim_of_pin = chance(0.5);
  scene.contact_set(spatial::pin_in_bush(pin, random.uniform(0.04, 0.1)));
}

spatial::Angle SpatialMaker::angle(BodyId a, BodyId b, const Vector3d& axis) const {
  spatial::Angle of{.a = a, .b = b, .axis_a = in_frame(a, axis), .axis_b = in_frame(b, axis)};
  of.reference_a = spatial::perpendicular(of.axis_a);
  const Vector3d world =
      a < 0 ? of.reference_a : Vector3d(quaternions::matrix_of(body(a).orientation) * of.reference_a);
  const Vector3d r = in_frame(b, world);
  of.reference_b = (r - of.axis_b.dot(r) * of.axis_b).normalized();
  return of;
}
spatial::Slide SpatialMaker::slide(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) const {
  return {a, b, in_body(a, at), in_body(b, at), in_frame(a, axis)};
}
spatial::Span SpatialMaker::span(BodyId a, BodyId b, const Vector3d& at_a, const Vector3d& at_b) const {
  return {a, b, in_body(a, at_a), in_body(b, at_b)};
}
void SpatialMaker::limit(const spatial::Coordinate& of, spatial::Limit::Side side, double bound) {
  scene.contact(spatial::Limit{{}, of, side, bound, {.e = law().e}});
}
void SpatialMaker::drive(const spatial::Coordinate& of, double offset, double rate, double amplitude, double omega) {
  TimeLaw time;
  time.offset = offset, time.rate_of_change = rate, time.amplitude = amplitude, time.omega = omega;
  scene.joint(spatial::Drive{{}, of, time});
}

void SpatialMaker::turn_about(const Vector3d& centre, const Vector3d& omega) {
  for (spatial::Body& b : scene.bodies) b.velocity = omega.cross(b.position - centre), b.omega = omega;
}

Vector3d SpatialMaker::in_body(BodyId b, const Vector3d& world) const {
  return b < 0 ? world : Vector3d(quaternions::matrix_of(body(b).orientation).transpose() * (world - body(b).position));
}
Vector3d SpatialMaker::in_frame(BodyId b, const Vector3d& d) const {
  return (b < 0 ? d : Vector3d(quaternions::matrix_of(body(b).orientation).transpose() * d)).normalized();
}
Eigen::Vector4d SpatialMaker::relative(BodyId a, BodyId b) const {
  const auto of = [&](BodyId i) { return i < 0 ? Eigen::Vector4d(1, 0, 0, 0) : body(i).orientation; };
  return quaternions::product(quaternions::inverse(of(a)), of(b)).normalized();
}

}  // namespace orthant::motion_storm
