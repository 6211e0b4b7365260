#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/parameter_change.h>
#include <orthant/integrators/derivatives/parameter_step.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <tuple>

namespace orthant {

namespace {

template <class Space> using SceneOf = typename ElementsOf<Space>::Scene;

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

/// The factor of another scene, its pieces those between `knots`: beyond its own end each goes on by extrapolation.
class MovedFactor {
 public:
  template <class AnyLoad> MovedFactor(const AnyLoad& other, std::vector<double> knots)
      : factor_(other.factor), own_(other.breakpoints), knots_(std::move(knots)) {}
  double operator()(double t) const {
    const auto i = static_cast<std::size_t>(std::upper_bound(knots_.begin(), knots_.end(), t) - knots_.begin());
    if (i > 0 && t < own_[i - 1]) return beyond(own_[i - 1], own_[i - 1] - t);
    if (i < own_.size() && t >= own_[i]) {
      const double inside = std::nextafter(own_[i], -std::abs(own_[i]) - 1);
      return beyond(inside, inside - t);
    }
    return factor_(t);
  }

 private:
  double beyond(double end, double by) const {
    return 3 * factor_(end) - 3 * factor_(end + by) + factor_(end + 2 * by);
  }
  std::function<double(double)> factor_;
  std::vector<double> own_, knots_;
};

/// The scene at value + k step, its loads' breakpoints where `base` has them.
template <class Space> std::unique_ptr<SystemOf<Space>> system_at(const RunParameterOf<Space>& parameter, double value,
                                                                  const SceneOf<Space>& base) {
  SceneOf<Space> scene = parameter.scene(value);
  for (std::size_t i = 0; i < scene.loads.size() && i < base.loads.size(); ++i) {
    auto& load = scene.loads[i];
    const std::vector<double>& knots = base.loads[i].breakpoints;
    if (!load.factor || load.breakpoints.size() != knots.size() || load.breakpoints == knots) continue;
    load.factor = MovedFactor(load, knots), load.breakpoints = knots;
  }
  return std::make_unique<SystemOf<Space>>(std::move(scene));
}

template <class Space> bool fill(const RunParameterOf<Space>& parameter, const SceneOf<Space>& base,
                                 ParameterChangeOf<Space>& change, std::string& why) {
  for (std::size_t k = 0; k < 4; ++k) try {
      change.at[k] = system_at<Space>(parameter, parameter.value + change.places[k] * change.step, base);
    } catch (const std::invalid_argument& error) {
      why = error.what();
      return false;
    }
  return true;
}

/// Scenes on both sides, or else on one. False: on neither.
template <class Space> bool place(const RunParameterOf<Space>& parameter, const SceneOf<Space>& base, double step,
                                  ParameterChangeOf<Space>& change, std::string& why) {
  change.step = step, change.side = 0;
  change.places = {-2, -1, 1, 2}, change.weights = {1. / 12, -8. / 12, 8. / 12, -1. / 12};
  if (fill<Space>(parameter, base, change, why)) return true;
  for (const int side : {1, -1}) {
    change.side = side, change.places = {0, side, 2 * side, 3 * side};
    change.weights = {-11. / 6 * side, 3. * side, -1.5 * side, 1. / 3 * side};
    if (fill<Space>(parameter, base, change, why)) return true;
  }
  return false;
}

template <class Space> void list_all(const SystemOf<Space>& system, const SystemOf<Space>& changed, double duration,
                                     ParameterChangeOf<Space>& change) {
  const SceneOf<Space>&base = system.scene(), &other = changed.scene();
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

/// Breakpoints of loads that move with the parameter.
template <class Space>
void note_knots(const RunParameterOf<Space>& parameter, const SceneOf<Space>& base, ParameterChangeOf<Space>& change) {
  std::array<SceneOf<Space>, 4> scenes;
  for (const int load : change.loads) {
    const auto i = static_cast<std::size_t>(load);
    if (base.loads[i].breakpoints.empty()) continue;
    if (scenes[2].loads.empty())
      for (std::size_t k = 0; k < 4; ++k) scenes[k] = parameter.scene(parameter.value + change.places[k] * change.step);
    for (std::size_t b = 0; b < base.loads[i].breakpoints.size(); ++b) {
      double by = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (scenes[k].loads[i].breakpoints.size() > b) by += change.weights[k] * scenes[k].loads[i].breakpoints[b];
      if (by /= change.step; std::abs(by) > 1e-9) change.knots.emplace_back(base.loads[i].breakpoints[b], by);
    }
  }
}

/// The scenes, with the step that resolves the parts that change.
template <class Space> void choose_step(const RunParameterOf<Space>& parameter, const SystemOf<Space>& system,
                                        double duration, double relative, ParameterChangeOf<Space>& change) {
  const double of_zero = relative * 1e-2;
  const double first = parameter.value != 0 ? relative * std::abs(parameter.value) : of_zero;
  constexpr double kFine = 1e-8, kCoarse = 1e-4;  // of the largest derivative of an element
  constexpr int kTries = 16;
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("derivative with respect to " + parameter.name + ": " + why);
  };
  std::string why;
  const auto measured = [&](double step) -> std::optional<StepError> {
    if (!place<Space>(parameter, system.scene(), step, change, why)) return {};
    if (change.other().dof() != system.dof() || change.other().joint_rows() != system.joint_rows())
      refuse("a parameter must not change the number of elements of the scene");
    list_all(system, change.other(), duration, change);
    return error_of_step(change, system, duration);
  };
  double step = first;
  std::optional<StepError> error = measured(step);
  if (!error) refuse("the scene must exist on one side of its value: " + why);
  if (error->rounding >= 1 && step < of_zero) {  // a value of rounding only: as zero
    error = measured(of_zero);
    if (error)
      step = of_zero;
    else
      error = measured(step);
  }
  double best = step;
  const int side = change.side;
  StepError least = *error;
  const double way = least.rounding > least.truncation ? 10 : 0.1;
  for (int i = 0; i < kTries && least.sum() > kFine; ++i) {
    error = measured(step *= way);
    if (!error || change.side != side || error->sum() > 10 * least.sum()) break;
    if (error->sum() < least.sum()) least = *error, best = step;
  }
  if (change.step != best) measured(best);
  if (least.sum() > kCoarse)
    refuse("no step of a difference resolves the change of the scene: two of them differ by " +
           detail::text_of(least.sum()) + " of it");
}

void change_start(Eigen::Index entry, const System& system, ParameterChange& change) {
  const bool velocity = entry >= system.dof();
  (velocity ? change.start_v : change.start_q)[entry - (velocity ? system.dof() : 0)] = 1;
}

/// About and along the world's axes.
void change_start(Eigen::Index entry, const SystemOf<Spatial>& system, ParameterChangeOf<Spatial>& change) {
  const bool velocity = entry >= system.dof();
  if (velocity) entry -= system.dof();
  const Eigen::Index body = body_of_entry<Spatial>(entry), axis = entry % 3;
  Eigen::VectorXd& to = velocity ? change.start_v : change.start_q;
  if (!is_rotation<Spatial>(entry)) {
    to[entry] = 1;
    return;
  }
  const State start = system.initial_state();
  const Vector3d turn = quaternions::matrix_of(quaternion(start.q, body)).row(axis).transpose();  // in its axes
  rotation<Spatial>(to, body) = turn;
  if (!velocity) {  // ω stays in the world
    const Vector3d omega = rotation<Spatial>(start.v, body);
    rotation<Spatial>(change.start_v, body) = omega.cross(turn);
  }
}

/// Masses, and tensors in the axes of the scene as it is.
void change_masses(const SystemOf<Spatial>& system, ParameterChangeOf<Spatial>& change) {
  const auto& bodies = system.scene().bodies;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(system.dof());
  for (int i = 0; i < system.bodies(); ++i) {
    const auto body = static_cast<std::size_t>(i);
    if (change.other().scene().bodies[body].mass != bodies[body].mass)
      translation<Spatial>(mass, i).setConstant(
          change.derivative<1>([&](const auto& s, auto& x) { x[0] = s.scene().bodies[body].mass; })[0]);
    if (change.other().scene().bodies[body].inertia == bodies[body].inertia) continue;
    const auto d = change.derivative<9>([&](const SystemOf<Spatial>& s, std::array<double, 9>& x) {
      Eigen::Map<Eigen::Matrix3d>(x.data()) = tensor_in_axes(system, s, i);
    });
    const Eigen::Matrix3d tensor = Eigen::Map<const Eigen::Matrix3d>(d.data());
    change.inertia.emplace_back(i, (tensor + tensor.transpose()) / 2);
  }
  if (!mass.isZero(0)) change.mass = mass;
}

}  // namespace

template <class Space> ParameterChangeOf<Space> changes_of(const RunParameterOf<Space>& parameter,
                                                           const SystemOf<Space>& system, double duration,
                                                           double relative_step) {
  using Of = SystemOf<Space>;
  ParameterChangeOf<Space> change;
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("derivative with respect to " + parameter.name + ": " + why);
  };
  change.start_q.setZero(system.dof()), change.start_v.setZero(system.dof());
  if (parameter.start >= 2 * system.dof()) refuse("start must be below " + std::to_string(2 * system.dof()));
  if (parameter.start >= 0) change_start(parameter.start, system, change);
  if (!parameter.scene) return change;
  choose_step(parameter, system, duration, relative_step, change);
  const auto &base = system.scene(), &other = change.other().scene();
  note_knots<Space>(parameter, base, change);
  if constexpr (kPlanar<Space>)
    for (std::size_t i = 0; i < base.frictions.size(); ++i)
      if (base.frictions[i].mu != other.frictions[i].mu)
        refuse("the friction '" + base.frictions[i].name + "' depends on its joint's load");

  const auto of_vectors = [&](auto&& get) -> Eigen::VectorXd {
    Eigen::VectorXd sum = change.weights[0] * get(*change.at[0]);
    for (std::size_t k = 1; k < 4; ++k) sum += change.weights[k] * get(*change.at[k]);
    return sum / change.step;
  };
  if constexpr (kPlanar<Space>) {
    if (change.other().mass() != system.mass()) change.mass = of_vectors([](const Of& s) { return s.mass(); });
  } else {
    change_masses(system, change);
  }
  if (change.other().weight() != system.weight()) change.weight = of_vectors([](const Of& s) { return s.weight(); });
  for (int i = 0; i < system.contacts(); ++i)
    if (!system.law(i).frictional() && change.other().law(i).mu == 0 && change.other().law(i).frictional())
      refuse("a contact without friction has no static one: mu must be > 0");
  if constexpr (kPlanar<Space>) {
    change.start_q += of_vectors([](const Of& s) { return s.initial_state().q; });
    change.start_v += of_vectors([](const Of& s) { return s.initial_state().v; });
  } else {
    const State start = system.initial_state();
    change.start_q += of_vectors(
        [&](const Of& s) -> Eigen::VectorXd { return between<Spatial>(start.q, start_in_axes(system, s).q); });
    change.start_v += of_vectors([&](const Of& s) -> Eigen::VectorXd { return start_in_axes(system, s).v; });
  }
  for (int i = 0; i < system.contacts(); ++i) {
    const ContactLaw &one = system.law(i), &two = change.other().law(i);
    const auto numbers = [](const ContactLaw& l) {
      return std::tie(l.mu, l.e, l.e_t, l.mu_static, l.belt, l.surface.rolling, l.surface.spinning);
    };
    if (numbers(one) == numbers(two)) continue;
    if ((one.surface.rolling > 0) != (two.surface.rolling > 0)) refuse("rolling must be > 0");
    if ((one.surface.spinning > 0) != (two.surface.spinning > 0)) refuse("spinning must be > 0");
    const auto d = change.template derivative<7>([&](const Of& s, std::array<double, 7>& x) {
      const ContactLaw& l = s.law(i);
      x = {l.mu, l.e, l.e_t, l.mu_static, l.belt, l.surface.rolling, l.surface.spinning};
    });
    change.laws.push_back({i, d[0], d[1], d[2], d[3], d[4], d[5], d[6]});
  }
  for (std::size_t i = 0; i < base.frictions.size(); ++i)
    if (base.frictions[i].bound != other.frictions[i].bound)
      change.bounds.emplace_back(static_cast<int>(i), change.template derivative<1>([&](const Of& s, auto& x) {
        x[0] = s.scene().frictions[i].bound;
      })[0]);
  return change;
}

template <class Space>
std::vector<char> begun_frictions(std::type_identity_t<std::span<const ParameterChangeOf<Space>>> changes,
                                  const SystemOf<Space>& system) {
  std::vector<char> begun;
  for (const auto& change : changes)
    for (const auto& d : change.laws) {
      if (d.mu == 0 || system.law(d.contact).frictional()) continue;
      begun.resize(static_cast<std::size_t>(system.contacts()), 0);
      begun[static_cast<std::size_t>(d.contact)] = 1;
    }
  return begun;
}

template <class Space>
std::vector<std::string> one_sided_in_words(const std::vector<RunParameterOf<Space>>& parameters,
                                            const std::vector<ParameterChangeOf<Space>>& changes) {
  std::vector<std::string> words;
  for (std::size_t j = 0; j < changes.size(); ++j)
    if (changes[j].side != 0)
      words.push_back(parameters[j].name + " = " + detail::text_of(parameters[j].value) +
                      " is at the end of its range: the derivative is one-sided, of " +
                      (changes[j].side > 0 ? "larger" : "smaller") + " values");
  return words;
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
  list_all(one, other, 1, change);
  change.at[0] = std::make_unique<SystemOf<Space>>(a), change.at[2] = std::make_unique<SystemOf<Space>>(b);
  return same_samples(change, one);
}

#define ORTHANT_PARAMETERS(Space)                                                                                     \
  template ParameterChangeOf<Space> changes_of(const RunParameterOf<Space>&, const SystemOf<Space>&, double, double); \
  template std::vector<char> begun_frictions(std::type_identity_t<std::span<const ParameterChangeOf<Space>>>,         \
                                             const SystemOf<Space>&);                                                 \
  template std::vector<std::string> one_sided_in_words(const std::vector<RunParameterOf<Space>>&,                     \
                                                       const std::vector<ParameterChangeOf<Space>>&);                 \
  template bool same_elements(const SystemOf<Space>&, const SystemOf<Space>&);
ORTHANT_PARAMETERS(Planar)
ORTHANT_PARAMETERS(Spatial)
#undef ORTHANT_PARAMETERS

}  // namespace orthant
