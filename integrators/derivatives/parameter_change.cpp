#include <orthant/integrators/derivatives/parameter_change.h>

#include <cmath>
#include <stdexcept>
#include <tuple>

namespace orthant {

namespace {

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

template <class List> void list_changed(const List& base, const List& other, std::vector<int>& changed) {
  if (base.size() != other.size())
    throw std::invalid_argument("a parameter must not change the number of elements of the scene");
  for (std::size_t i = 0; i < base.size(); ++i)
    if (!alike(base[i], other[i])) changed.push_back(static_cast<int>(i));
}

}  // namespace

ParameterChange changes_of(const RunParameter& parameter, const System& system, double relative_step) {
  ParameterChange change;
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("derivative with respect to " + parameter.name + ": " + why);
  };
  change.start_q.setZero(system.dof()), change.start_v.setZero(system.dof());
  if (parameter.start >= 2 * system.dof()) refuse("start must be below " + std::to_string(2 * system.dof()));
  if (parameter.start >= 0) {
    const bool velocity = parameter.start >= system.dof();
    (velocity ? change.start_v : change.start_q)[parameter.start - (velocity ? system.dof() : 0)] = 1;
  }
  if (!parameter.scene) return change;
  change.step = relative_step * (parameter.value != 0 ? std::abs(parameter.value) : 1e-2);
  for (const int k : {-2, -1, 1, 2}) try {
      change.at[static_cast<std::size_t>(k < 0 ? k + 2 : k + 1)] =
          std::make_unique<System>(parameter.scene(parameter.value + k * change.step));
    } catch (const std::invalid_argument& error) {
      refuse(std::string("the scene must exist on both sides of its value: ") + error.what());
    }
  const Scene &base = system.scene(), &other = change.at[2]->scene();
  if (change.at[2]->dof() != system.dof() || change.at[2]->joint_rows() != system.joint_rows())
    refuse("a parameter must not change the number of elements of the scene");
  list_changed(base.joints, other.joints, change.joints);
  list_changed(base.contacts, other.contacts, change.contacts);
  list_changed(base.springs, other.springs, change.springs);
  list_changed(base.frictions, other.frictions, change.frictions);
  list_changed(base.loads, other.loads, change.loads);

  const auto of_vectors = [&](auto&& get) -> Eigen::VectorXd {
    const auto x = [&](std::size_t k) -> decltype(auto) { return get(*change.at[k]); };
    return (x(0) - 8 * x(1) + 8 * x(2) - x(3)) / (12 * change.step);
  };
  if (change.at[2]->mass() != system.mass()) change.mass = of_vectors([](const System& s) { return s.mass(); });
  if (change.at[2]->weight() != system.weight()) change.weight = of_vectors([](const System& s) { return s.weight(); });
  change.start_q += of_vectors([](const System& s) { return s.initial_state().q; });
  change.start_v += of_vectors([](const System& s) { return s.initial_state().v; });
  for (int i = 0; i < system.contacts(); ++i) {
    const ContactLaw &one = system.law(i), &two = change.at[2]->law(i);
    const auto numbers = [](const ContactLaw& l) { return std::tie(l.mu, l.e, l.e_t, l.mu_static, l.belt); };
    if (numbers(one) == numbers(two)) continue;
    const auto d = change.derivative<5>([&](const System& s, std::array<double, 5>& x) {
      const ContactLaw& l = s.law(i);
      x = {l.mu, l.e, l.e_t, l.mu_static, l.belt};
    });
    change.laws.push_back({i, d[0], d[1], d[2], d[3], d[4]});
  }
  for (std::size_t i = 0; i < base.frictions.size(); ++i)
    if (base.frictions[i].bound != other.frictions[i].bound)
      change.bounds.emplace_back(static_cast<int>(i), change.derivative<1>([&](const System& s, auto& x) {
        x[0] = s.scene().frictions[i].bound;
      })[0]);
  return change;
}

}  // namespace orthant
