#include "drawing.h"

#include "event_table.h"
#include "outlines.h"

#include <cmath>

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

}  // namespace orthant
