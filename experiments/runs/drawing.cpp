#include "experiments/runs/drawing.h"

#include "experiments/runs/event_table.h"
#include "experiments/runs/outlines.h"
#include "experiments/runs/solids.h"

#include <cmath>
#include <variant>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double x) { return std::round(x * 1e7) / 1e7; }  // enough for a drawing

Json pair(const Vector2d& p) { return {p.x(), p.y()}; }

template <class OnWall> Json on_wall(const OnWall& c, const Vector2d& point) {
  return {{"body", c.a}, {"point", pair(point)},    {"wall", pair(c.wall_point)}, {"normal", pair(c.normal)},
          {"on", c.b},   {"ground", c.b == kGround}};
}

template <class Round> Json round_pair(const Round& c, bool inside) {
  return {{"a", c.a},        {"point_a", pair(c.centre_a)}, {"radius_a", c.radius_a},
          {"b", c.b},        {"point_b", pair(c.centre_b)}, {"radius_b", c.radius_b},
          {"inside", inside}};
}

Json force_of(const Contact& contact) {
  Json one = Json::object();
  if (const auto* corner = std::get_if<CornerWall>(&contact)) one = on_wall(*corner, corner->point);
  if (const auto* disc = std::get_if<DiscWall>(&contact)) one = on_wall(*disc, disc->centre);
  if (const auto* discs = std::get_if<DiscDisc>(&contact)) one["centres"] = round_pair(*discs, false);
  if (const auto* journal = std::get_if<Journal>(&contact)) one["centres"] = round_pair(*journal, true);
  return one;
}

Json triple(const Vector3d& p) { return {p.x(), p.y(), p.z()}; }
Json rounded_triple(const Vector3d& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

Json solid_of(const DrawnSolid& solid) {
  struct Words {
    Json operator()(const drawn::Sphere& s) const {
      return {{"kind", s.hollow ? "socket" : "sphere"}, {"centre", triple(s.centre)}, {"radius", s.radius}};
    }
    Json operator()(const drawn::Capsule& s) const {
      return {{"kind", "capsule"}, {"from", triple(s.from)}, {"to", triple(s.to)}, {"radius", s.radius}};
    }
    Json operator()(const drawn::Polytope& s) const {
      Json points = Json::array();
      for (const Vector3d& p : s.points) points.push_back(rounded_triple(p));
      return {{"kind", "polytope"}, {"points", points}, {"faces", s.faces}};
    }
    Json operator()(const drawn::Plane& s) const {
      return {{"kind", "plane"}, {"point", triple(s.point)}, {"normal", triple(s.normal)}, {"half", s.half}};
    }
  };
  Json all = {{"body", solid.body}};
  all.update(std::visit(Words{}, solid.shape));
  return all;
}

template <class J> const char* kind_of() {
  using std::is_same_v;
  return is_same_v<J, spatial::Revolute>       ? "revolute"
         : is_same_v<J, spatial::Cylindrical>  ? "cylindrical"
         : is_same_v<J, spatial::Screw>        ? "cylindrical"
         : is_same_v<J, spatial::Prismatic>    ? "prismatic"
         : is_same_v<J, spatial::PointOnLine>  ? "point-on-line"
         : is_same_v<J, spatial::PlaneJoint>   ? "planar"
         : is_same_v<J, spatial::PointInPlane> ? "point-in-plane"
         : is_same_v<J, spatial::Universal>    ? "universal"
         : is_same_v<J, spatial::Distance>     ? "distance"
         : is_same_v<J, spatial::Fixed>        ? "fixed"
                                               : "spherical";
}

/// With its axis, in a's frame, where it has one.
struct JointWords {
  template <class J>
    requires requires(const J& j) { j.point_a; }
  Json operator()(const J& j) const {
    Json one = {{"name", j.name}, {"kind", kind_of<J>()},      {"a", j.a}, {"point_a", triple(j.point_a)},
                {"body", j.b},    {"point", triple(j.point_b)}};
    if constexpr (requires { j.axis_a; })
      one["axis"] = triple(j.axis_a);
    else if constexpr (requires { j.axis; })
      one["axis"] = triple(j.axis);
    return one;
  }
  Json operator()(const spatial::Drive&) const { return nullptr; }
  Json operator()(const spatial::Gear&) const { return nullptr; }
};

template <class Round> Json round_spatial(const Round& c, bool inside) {
  return {{"a", c.a},        {"point_a", triple(c.centre_a)}, {"radius_a", c.radius_a},
          {"b", c.b},        {"point_b", triple(c.centre_b)}, {"radius_b", c.radius_b},
          {"inside", inside}};
}

Json force_of(const spatial::Contact& contact) {
  Json one = Json::object();
  if (const auto* c = std::get_if<spatial::SpherePlane>(&contact))
    one = {{"body", c->a},
           {"point", triple(c->centre)},
           {"radius", c->radius},
           {"on", c->b},
           {"normal", triple(c->normal)}};
  if (const auto* c = std::get_if<spatial::SphereSphere>(&contact)) one["centres"] = round_spatial(*c, false);
  if (const auto* c = std::get_if<spatial::Socket>(&contact)) one["centres"] = round_spatial(*c, true);
  return one;
}

}  // namespace

nlohmann::ordered_json drawing(const Scene& scene) {
  Json bodies = Json::array(), shapes = Json::array(), contacts = Json::array(), pins = Json::array();
  for (const Body& body : scene.bodies) bodies.push_back({{"name", body.name}});
  for (const Outline& outline : outlines(scene)) {
    Json points = Json::array();
    for (const Vector2d& corner : outline.corners) points.push_back({rounded(corner.x()), rounded(corner.y())});
    shapes.push_back({{"body", outline.body}, {"closed", outline.closed}, {"wall", outline.wall}, {"points", points}});
  }
  for (const Joint& joint : scene.joints)
    if (const auto* pin = std::get_if<Revolute>(&joint))
      pins.push_back({{"a", pin->a}, {"point_a", pair(pin->point_a)}, {"body", pin->b}, {"point", pair(pin->point_b)}});
  for (const Contact& contact : scene.contacts) {
    Json one = {{"name", std::visit([](const auto& c) { return c.name; }, contact)}};
    one.update(force_of(contact));
    contacts.push_back(one);
  }
  return {{"bodies", bodies},
          {"outlines", shapes},
          {"pins", pins},
          {"contacts", contacts},
          {"event_contacts", event_contacts(scene)}};
}

nlohmann::ordered_json drawing(const spatial::Scene& scene) {
  Json bodies = Json::array(), shapes = Json::array(), joints = Json::array(), contacts = Json::array();
  Json names = Json::array();
  for (const spatial::Body& body : scene.bodies) bodies.push_back({{"name", body.name}});
  for (const DrawnSolid& solid : solids(scene)) shapes.push_back(solid_of(solid));
  for (const spatial::Joint& joint : scene.joints)
    if (const Json one = std::visit(JointWords{}, joint); !one.is_null()) joints.push_back(one);
  for (const spatial::Contact& contact : scene.contacts) {
    Json one = std::visit([](const auto& c) -> Json { return {{"name", c.name}, {"mu", c.law.mu}}; }, contact);
    one.update(force_of(contact));
    contacts.push_back(one), names.push_back(one.at("name"));
  }
  return {{"dimension", 3},   {"bodies", bodies},     {"solids", shapes},
          {"joints", joints}, {"contacts", contacts}, {"event_contacts", names}};
}

}  // namespace orthant
