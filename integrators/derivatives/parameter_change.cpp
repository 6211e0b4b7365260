#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/parameter_change.h>
#include <orthant/integrators/derivatives/parameter_scenes.h>
#include <orthant/integrators/derivatives/parameter_step.h>

#include <cmath>
#include <stdexcept>
#include <tuple>

namespace orthant {

namespace {

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
  choose_scenes(parameter, system, duration, relative_step, change);
  const auto &base = system.scene(), &other = change.other().scene();
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
      refuse("a contact without friction has no static one: its mu must be > 0");
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
    if ((one.surface.rolling > 0) != (two.surface.rolling > 0))
      refuse("rolling = 0: the run has no rolling friction to differentiate: must be > 0");
    if ((one.surface.spinning > 0) != (two.surface.spinning > 0))
      refuse("spinning = 0: the run has no spinning friction to differentiate: must be > 0");
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

template <class Space>
std::vector<std::string> evaluated_knots_in_words(const std::vector<RunParameterOf<Space>>& parameters,
                                                  const std::vector<ParameterChangeOf<Space>>& changes, double step,
                                                  double duration, std::span<const double> loads,
                                                  std::span<const double> drives) {
  constexpr double kSameTime = 1e-9;  // of a step
  std::vector<std::string> words;
  for (std::size_t j = 0; j < changes.size(); ++j) {
    const auto look = [&](const std::vector<std::pair<double, double>>& knots, std::span<const double> places) {
      for (const auto& [t, by] : knots)
        for (const double place : places) {
          const double steps = t / step - place;
          if (t < 0 || t > duration || std::abs(steps - std::round(steps)) > kSameTime) continue;
          words.push_back(
              parameters[j].name + " moves the time " + detail::text_of(t) +
              " s of a table, which is evaluated there: the derivative is one-sided; another step avoids it");
          return true;
        }
      return false;
    };
    if (!look(changes[j].knots, loads)) look(changes[j].drive_knots, drives);
  }
  return words;
}

#define ORTHANT_PARAMETERS(Space)                                                                                     \
  template ParameterChangeOf<Space> changes_of(const RunParameterOf<Space>&, const SystemOf<Space>&, double, double); \
  template std::vector<char> begun_frictions(std::type_identity_t<std::span<const ParameterChangeOf<Space>>>,         \
                                             const SystemOf<Space>&);                                                 \
  template std::vector<std::string> one_sided_in_words(const std::vector<RunParameterOf<Space>>&,                     \
                                                       const std::vector<ParameterChangeOf<Space>>&);                 \
  template std::vector<std::string> evaluated_knots_in_words(                                                         \
      const std::vector<RunParameterOf<Space>>&, const std::vector<ParameterChangeOf<Space>>&, double, double,        \
      std::span<const double>, std::span<const double>);
ORTHANT_PARAMETERS(Planar)
ORTHANT_PARAMETERS(Spatial)
#undef ORTHANT_PARAMETERS

}  // namespace orthant
