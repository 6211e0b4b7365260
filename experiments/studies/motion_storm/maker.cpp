#include "experiments/studies/motion_storm/maker.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant::motion_storm {
namespace {

Polygon about_centroid(Polygon p) {
  double area = 0;
  Vector2d first(0, 0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double twice = cross(p[i], p[next(p, i)]);
    area += twice / 2, first += twice / 6 * (p[i] + p[next(p, i)]);
  }
  for (Vector2d& corner : p) corner -= first / area;
  return p;
}

/// ∫ r² dA / A of a polygon about the origin, its centroid [m²].
double gyration(const Polygon& p) {
  double area = 0, second = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector2d &a = p[i], &b = p[next(p, i)];
    area += cross(a, b) / 2, second += cross(a, b) * (a.dot(a) + a.dot(b) + b.dot(b)) / 12;
  }
  return second / area;
}

}  // namespace

Maker::Maker(Random& random_) : Drawing(random_) {
  scene.gravity = chance(0.8) ? Vector2d(0, -9.81) : chance(0.5) ? Vector2d(0, 0) : point(-10, 10);
  draw_ranges();
}

Form Maker::polygon() {
  for (;;) {
    const int n = random.integer(3, 6);
    const double radius = random.uniform(0.1, 0.3);
    std::vector<double> angles;
    for (int i = 0; i < n; ++i) angles.push_back(random.uniform(0, 2 * std::numbers::pi));
    std::sort(angles.begin(), angles.end());
    Polygon corners;
    bool apart = true;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      corners.push_back(radius * Vector2d(std::cos(angles[i]), std::sin(angles[i])));
      const double step =
          i + 1 < angles.size() ? angles[i + 1] - angles[i] : angles[0] + 2 * std::numbers::pi - angles[i];
      apart = apart && step > 0.5 && step < 2.6;  // [rad] no needles
    }
    if (!apart) continue;
    Form form{0, about_centroid(corners)};
    for (const Vector2d& c : form.corners) form.radius = std::max(form.radius, c.norm());
    return form;
  }
}

Form Maker::any() {
  const double u = random.uniform();
  if (u < 0.35) return disc();
  if (u < 0.75) return box(random.uniform(0.1, 0.4), random.uniform(0.1, 0.4));
  return polygon();
}

BodyId Maker::add(const Form& form, const Vector2d& position, double angle, double mass_of_it) {
  const double m = mass_of_it > 0 ? mass_of_it : mass();
  const double k2 = form.corners.empty() ? form.radius * form.radius / 2 : gyration(form.corners);
  forms.push_back(form);
  return scene.body({.mass = m, .inertia = m * k2, .position = position, .angle = angle});
}

BodyId Maker::rod(const Vector2d& from, const Vector2d& to, double mass_of_it) {
  const double m = mass_of_it > 0 ? mass_of_it : mass(), length = (to - from).norm();
  forms.push_back({length / 2, {}});
  return scene.body({.mass = m,
                     .inertia = m * length * length / 12,
                     .position = (from + to) / 2,
                     .angle = std::atan2(to.y() - from.y(), to.x() - from.x())});
}

void Maker::meet(BodyId a, BodyId b) {
  const ContactLaw l = law();
  const Form &fa = form(a), &fb = form(b);
  if (fa.corners.empty() && fb.corners.empty())
    scene.contact(DiscDisc{{}, a, {0, 0}, fa.radius, b, {0, 0}, fb.radius, l});
  else if (fa.corners.empty())
    scene.contact(DiscPolygon{{}, a, {0, 0}, fa.radius, b, fb.corners, l});
  else if (fb.corners.empty())
    scene.contact(DiscPolygon{{}, b, {0, 0}, fb.radius, a, fa.corners, l});
  else
    scene.contact_set(
        polygon_polygon({"pair" + std::to_string(a) + "-" + std::to_string(b), a, fa.corners, b, fb.corners, 0, l}));
}

void Maker::meet_all() {
  for (BodyId a = 0; a < static_cast<BodyId>(scene.bodies.size()); ++a)
    for (BodyId b = a + 1; b < static_cast<BodyId>(scene.bodies.size()); ++b) meet(a, b);
}

void Maker::wall(BodyId a, const Vector2d& at, const Vector2d& normal) {
  const ContactLaw l = law();
  if (form(a).corners.empty())
    scene.contact(DiscWall{{}, a, {0, 0}, form(a).radius, kGround, at, normal.normalized(), l});
  else
    scene.contact_set(
        polygon_wall({"wall" + std::to_string(scene.contacts.size()), a, {0, 0}, kGround, at, normal.normalized(), l},
                     form(a).corners));
}

void Maker::peg(BodyId a, const Vector2d& at, double radius) {
  const ContactLaw l = law();
  if (form(a).corners.empty())
    scene.contact(DiscDisc{{}, a, {0, 0}, form(a).radius, kGround, at, radius, l});
  else
    scene.contact(DiscPolygon{{}, kGround, at, radius, a, form(a).corners, l});
}

void Maker::tile(BodyId a, const Polygon& corners) {
  const ContactLaw l = law();
  if (form(a).corners.empty())
    scene.contact(DiscPolygon{{}, a, {0, 0}, form(a).radius, kGround, corners, l});
  else
    scene.contact_set(
        polygon_polygon({"tile" + std::to_string(scene.contacts.size()), a, form(a).corners, kGround, corners, 0, l}));
}

void Maker::pin(BodyId a, const Vector2d& point_a, BodyId b, const Vector2d& point_b) {
  scene.joint(Revolute{{}, a, b, point_a, point_b});
}

void Maker::journal(BodyId a, const Vector2d& point_a, BodyId b, const Vector2d& point_b, double clearance) {
  scene.contact(Journal{{}, a, point_a, 0.01, b, point_b, 0.01 + clearance, law()});
}

void Maker::limit(const Coordinate& of, Limit::Side side, double bound, double e) {
  scene.contact(Limit{{}, of, side, bound, {.e = e}});
}

void Maker::drive(const Coordinate& of, double offset, double rate, double amplitude, double omega) {
  TimeLaw time;
  time.offset = offset, time.rate_of_change = rate, time.amplitude = amplitude, time.omega = omega;
  scene.joint(Drive{{}, of, time});
}

void Maker::turn_about(const Vector2d& centre, double omega) {
  for (Body& b : scene.bodies) b.velocity = omega * perp(b.position - centre), b.omega = omega;
}

Vector2d Maker::in_body(BodyId b, const Vector2d& world) const {
  if (b < 0) return world;
  const Body& it = body(b);
  const Pose pose{it.position, it.angle, std::cos(it.angle), std::sin(it.angle)};
  return pose.turn_back(world - it.position);
}

}  // namespace orthant::motion_storm
