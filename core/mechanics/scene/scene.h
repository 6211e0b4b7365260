// core/mechanics/scene/scene.h — mechanism as plain data: bodies, joints, contacts, friction, springs, loads. SI units.
//
//   Scene s;
//   const auto rod = s.body({.name = "rod", .mass = 1, .inertia = 1.0 / 12, .position = {0.5, 0}});
//   s.joint(Revolute{"pin", kGround, rod, {0, 0}, {-0.5, 0}});
#pragma once

#include <orthant/core/mechanics/planar/collision.h>
#include <orthant/core/mechanics/planar/contact_sets.h>
#include <orthant/core/mechanics/planar/custom_contact.h>
#include <orthant/core/mechanics/planar/custom_joint.h>
#include <orthant/core/mechanics/planar/distance.h>
#include <orthant/core/mechanics/planar/drive.h>
#include <orthant/core/mechanics/planar/fixed.h>
#include <orthant/core/mechanics/planar/joint_friction.h>
#include <orthant/core/mechanics/planar/journal.h>
#include <orthant/core/mechanics/planar/limit.h>
#include <orthant/core/mechanics/planar/load.h>
#include <orthant/core/mechanics/planar/prismatic.h>
#include <orthant/core/mechanics/planar/revolute.h>
#include <orthant/core/mechanics/planar/spring.h>
#include <orthant/core/mechanics/scene/add_named.h>
#include <orthant/core/mechanics/scene/impact_law.h>

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace orthant {

struct Body {
  std::string name;
  double mass = 1, inertia = 1;  // [kg], [kg m²] about the centre of mass, > 0
  Vector2d position{0, 0};       // [m] of the centre of mass
  double angle = 0;              // [rad] counter-clockwise
  Vector2d velocity{0, 0};       // [m/s]
  double omega = 0;              // [rad/s]
};

using Joint = std::variant<Revolute, Prismatic, Fixed, Distance, Drive, CustomJoint>;
using Contact =
    std::variant<CornerWall, DiscWall, DiscDisc, DiscPolygon, PolygonPolygon, Journal, Limit, CustomContact>;
using Spring = std::variant<PointSpring, TorsionSpring, JointSpring>;

template <class T, class Variant> inline constexpr bool kAlternative = false;
template <class T, class... Kinds>
inline constexpr bool kAlternative<T, std::variant<Kinds...>> = (std::is_same_v<T, Kinds> || ...);

template <class Joint> int row_count(const Joint& joint) {
  const auto count = [](const auto& j) {
    if constexpr (requires { j.row_count(); })
      return j.row_count();
    else
      return j.kRows;
  };
  return std::visit(count, joint);
}
/// Whether the joint is given in time.
inline bool driven(const Joint& joint) {
  const auto* custom = std::get_if<CustomJoint>(&joint);
  return std::holds_alternative<Drive>(joint) || (custom != nullptr && custom->driven());
}

struct Scene {
  Vector2d gravity{0, 0};  // [m/s²]
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Contact> contacts;
  std::vector<Collision> collisions;
  std::vector<JointFriction> frictions;
  std::vector<Spring> springs;
  std::vector<Load> loads;
  Restitution restitution = Restitution::newton;
  Impacts impacts = Impacts::simultaneous;
  bool assemble = false;             // bodies are moved into their joints and journals at the start (assemble.h)
  double duration = 1, step = 1e-3;  // [s] defaults of `simulate`

  /// Each adds one element; without a name it becomes body1, body2, … joint1, … by its place.
  BodyId body(Body b) {
    add_named(bodies, std::move(b), "body");
    return static_cast<BodyId>(bodies.size()) - 1;
  }
  void joint(Joint j) { add_named(joints, std::move(j), "joint"); }
  void contact(Contact c) { add_named(contacts, std::move(c), "contact"); }
  /// Kinds from outside; one that is derived from a built-in kind is its own, not cut down to that.
  template <JointKind T>
    requires(!kAlternative<T, Joint>)
  void joint(T j) { joint(Joint(CustomJoint(std::move(j)))); }
  template <ContactKind T>
    requires(!kAlternative<T, Contact>)
  void contact(T c) { contact(Contact(CustomContact(std::move(c)))); }
  /// Adds the contacts of a set (contact_sets.h): contact_set(guide({…})), contact_set(polygon_polygon({…})).
  template <class Set> void contact_set(const Set& contacts_of_it) {
    for (const auto& c : contacts_of_it) contact(c);
  }
  void collision(Collision c) { add_named(collisions, std::move(c), "collision"); }
  void friction(JointFriction f) { add_named(frictions, std::move(f), "friction"); }
  void spring(Spring s) { add_named(springs, std::move(s), "spring"); }
  void load(Load l) { add_named(loads, std::move(l), "load"); }
};

/// Kinds of elements of a scene, by dimension.
template <class Space> struct ElementsOf;
template <> struct ElementsOf<Planar> {
  using Scene = orthant::Scene;
  using Body = orthant::Body;
  using Joint = orthant::Joint;
  using Contact = orthant::Contact;
  using ContactBias = orthant::ContactBias;
  using Spring = orthant::Spring;
  using Friction = JointFriction;
  using Drive = orthant::Drive;
};

/// Error of check(). Kind, index and field name the faulty element, so that a reader of files can point at the line.
struct SceneError : std::invalid_argument {
  SceneError(const std::string& what, std::string kind_, std::size_t index_, std::string field_)
      : std::invalid_argument(what), kind(std::move(kind_)), index(index_), field(std::move(field_)) {}
  std::string kind;  // "body", "joint", "contact", "collision", "friction", "spring", "load"; empty: the scene itself
  std::size_t index = 0;
  std::string field;
};

/// Throws SceneError naming element, field, value and rule: masses and inertias > 0, finite numbers, two different
/// bodies that exist, unit directions, radii and lengths > 0, convex polygons, bearings wider than their journals, 0 ≤
/// μ ≤ 1e6, μ_static 0 or ≥ μ, e in [0, 1], e_t in [−1, 1], stiffness, damping and dry friction ≥ 0, breakpoints
/// ascending, rows of custom joints and contacts that are the derivatives they stand for (derivatives.h), at least one
/// body, names distinct within a kind and made of A–Z a–z 0–9 _ -.
void check(const Scene& scene);
/// The same of the contacts from number `first` on only, and of the names of all contacts.
void check_contacts(const Scene& scene, std::size_t first);

/// The same scene with every pair that a collision stands for as a contact of its own, behind the others: NAME_1,
/// NAME_2, …
Scene with_pairs_listed(const Scene& scene);

}  // namespace orthant
