#include <orthant/integrators/derivatives/changed_elements.h>
#include <orthant/integrators/derivatives/parameter_step.h>

#include <stdexcept>
#include <tuple>

namespace orthant {

namespace {

template <class Space> using SceneIn = typename ElementsOf<Space>::Scene;

// Whether two elements have the same rows, residuals and forces. Contact laws do not count.
bool alike(const Angle& x, const Angle& y) { return x.a == y.a && x.b == y.b; }
template <class Points> bool same_points(const Points& x, const Points& y) {
  return x.a == y.a && x.b == y.b && x.point_a == y.point_a && x.point_b == y.point_b;
}
bool alike(const Slide& x, const Slide& y) { return same_points(x, y) && x.axis == y.axis; }
bool alike(const Span& x, const Span& y) { return same_points(x, y); }
bool alike(const Coordinate& x, const Coordinate& y) {
  return x.index() == y.index() &&
         std::visit([&](const auto& c) { return alike(c, std::get<std::remove_cvref_t<decltype(c)>>(y.kind())); },
                    x.kind());
}
bool alike(const TimeLaw& x, const TimeLaw& y) {
  const auto numbers = [](const TimeLaw& l) {
    return std::tie(l.offset, l.rate_of_change, l.amplitude, l.omega, l.phase);
  };
  return numbers(x) == numbers(y) && x.table.times().empty() && y.table.times().empty();
}
bool alike(const Revolute& x, const Revolute& y) { return same_points(x, y); }
bool alike(const Fixed& x, const Fixed& y) { return same_points(x, y) && x.angle == y.angle; }
bool alike(const Prismatic& x, const Prismatic& y) {
  return same_points(x, y) && x.axis == y.axis && x.angle == y.angle;
}
bool alike(const Distance& x, const Distance& y) { return same_points(x, y) && x.length == y.length; }
bool alike(const Drive& x, const Drive& y) { return alike(x.of, y.of) && alike(x.law, y.law); }
bool alike(const CornerWall& x, const CornerWall& y) {
  return x.a == y.a && x.b == y.b && x.point == y.point && x.wall_point == y.wall_point && x.normal == y.normal;
}
bool alike(const DiscWall& x, const DiscWall& y) {
  return x.a == y.a && x.b == y.b && x.centre == y.centre && x.radius == y.radius && x.wall_point == y.wall_point &&
         x.normal == y.normal;
}
template <class Discs> bool same_discs(const Discs& x, const Discs& y) {
  return x.a == y.a && x.b == y.b && x.centre_a == y.centre_a && x.centre_b == y.centre_b && x.radius_a == y.radius_a &&
         x.radius_b == y.radius_b;
}
bool alike(const DiscDisc& x, const DiscDisc& y) { return same_discs(x, y); }
bool alike(const Journal& x, const Journal& y) { return same_discs(x, y); }
bool alike(const Limit& x, const Limit& y) { return alike(x.of, y.of) && x.side == y.side && x.bound == y.bound; }
template <class Damped> bool same_tension(const Damped& x, const Damped& y) {
  return x.stiffness == y.stiffness && x.damping == y.damping && x.rest == y.rest;
}
bool alike(const PointSpring& x, const PointSpring& y) { return same_points(x, y) && same_tension(x, y); }
bool alike(const TorsionSpring& x, const TorsionSpring& y) { return x.a == y.a && x.b == y.b && same_tension(x, y); }
bool alike(const JointSpring& x, const JointSpring& y) { return alike(x.of, y.of) && same_tension(x, y); }
bool alike(const JointFriction& x, const JointFriction& y) { return alike(x.of, y.of); }
bool alike(const Load& x, const Load& y) {
  return x.body == y.body && x.point == y.point && x.force == y.force && x.torque == y.torque && !x.factor && !y.factor;
}
template <class Other> bool alike(const Other& /*x*/, const Other& /*y*/) { return false; }  // polygons, custom ones
template <class... Kinds> bool alike(const std::variant<Kinds...>& x, const std::variant<Kinds...>& y) {
  return x.index() == y.index() &&
         std::visit([&](const auto& one) { return alike(one, std::get<std::remove_cvref_t<decltype(one)>>(y)); }, x);
}

template <class List> void same_size(const List& base, const List& other) {
  if (base.size() != other.size())
    throw std::invalid_argument("a parameter must not change the number of elements of the scene");
}

template <class List> void list_changed(const List& base, const List& other, std::vector<int>& changed) {
  for (std::size_t i = 0; i < base.size(); ++i)
    if (!alike(base[i], other[i])) changed.push_back(static_cast<int>(i));
}

}  // namespace

template <class Space> void list_changed_elements(const SystemOf<Space>& system, const SystemOf<Space>& changed,
                                                  double duration, ParameterChangeOf<Space>& change) {
  const SceneIn<Space>&base = system.scene(), &other = changed.scene();
  for (auto* list : {&change.joints, &change.contacts, &change.springs, &change.frictions, &change.loads})
    list->clear();
  change.moves_drive = false;
  same_size(base.joints, other.joints), same_size(base.contacts, other.contacts);
  same_size(base.springs, other.springs), same_size(base.frictions, other.frictions);
  same_size(base.loads, other.loads);
  if constexpr (kPlanar<Space>) {
    list_changed(base.joints, other.joints, change.joints);
    list_changed(base.contacts, other.contacts, change.contacts);
    list_changed(base.springs, other.springs, change.springs);
    list_changed(base.frictions, other.frictions, change.frictions);
    list_changed(base.loads, other.loads, change.loads);
  } else {
    list_elements(system, changed, duration, change);
  }
  for (const int joint : change.joints) {
    const auto j = static_cast<std::size_t>(joint);
    using DriveOf = typename ElementsOf<Space>::Drive;
    if (const auto* one = std::get_if<DriveOf>(&base.joints[j]), *two = std::get_if<DriveOf>(&other.joints[j]);
        one && two)
      change.moves_drive = change.moves_drive || one->law.table.times() != two->law.table.times();
  }
}

template <class Space> bool same_elements(const SystemOf<Space>& one, const SystemOf<Space>& other) {
  const auto &a = one.scene(), &b = other.scene();
  if (one.dof() != other.dof() || one.contacts() != other.contacts() || one.joint_rows() != other.joint_rows() ||
      a.joints.size() != b.joints.size() || a.springs.size() != b.springs.size() ||
      a.frictions.size() != b.frictions.size() || a.loads.size() != b.loads.size())
    return false;
  if (one.mass() != other.mass() || one.weight() != other.weight() ||
      one.initial_state().q != other.initial_state().q || one.initial_state().v != other.initial_state().v)
    return false;
  const auto law = [](const ContactLaw& l) {
    return std::tie(l.mu, l.e, l.e_t, l.mu_static, l.belt, l.surface.rolling, l.surface.spinning);
  };
  for (int i = 0; i < one.contacts(); ++i)
    if (law(one.law(i)) != law(other.law(i))) return false;
  for (std::size_t i = 0; i < a.frictions.size(); ++i) {
    if (a.frictions[i].bound != b.frictions[i].bound) return false;
    if constexpr (kPlanar<Space>)
      if (a.frictions[i].mu != b.frictions[i].mu || a.frictions[i].radius != b.frictions[i].radius) return false;
  }
  ParameterChangeOf<Space> change;
  list_changed_elements(one, other, 1, change);
  change.at[0] = std::make_unique<SystemOf<Space>>(a), change.at[2] = std::make_unique<SystemOf<Space>>(b);
  return same_samples(change, one);
}

#define ORTHANT_CHANGED_ELEMENTS(Space)                                                       \
  template void list_changed_elements(const SystemOf<Space>&, const SystemOf<Space>&, double, \
                                      ParameterChangeOf<Space>&);                             \
  template bool same_elements(const SystemOf<Space>&, const SystemOf<Space>&);
ORTHANT_CHANGED_ELEMENTS(Planar)
ORTHANT_CHANGED_ELEMENTS(Spatial)
#undef ORTHANT_CHANGED_ELEMENTS

}  // namespace orthant
