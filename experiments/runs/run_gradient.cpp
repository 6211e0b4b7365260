#include "experiments/runs/run_gradient.h"

#include "experiments/runs/trajectory.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/options.h>
#include <orthant/core/support/shortened.h>

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <stdexcept>

namespace orthant {
namespace {

template <class Space> using SceneIn = typename ElementsOf<Space>::Scene;

template <class Space> SceneIn<Space> make_in(const SceneSource& source, const std::vector<std::string>& sets) {
  return std::get<SceneIn<Space>>(source.make_with(sets));
}

[[noreturn]] void refuse_parameter(const std::string& key, const std::string& rule) {
  throw std::invalid_argument("parameter '" + in_one_line(key) + "': " + rule);
}

std::string exactly(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

/// "corners[0][1]" → "corners", {0, 1}.
std::pair<std::string, std::vector<std::size_t>> split_places(const std::string& key) {
  std::string name = key;
  std::vector<std::size_t> places;
  while (name.ends_with(']')) {
    const auto open = name.rfind('[');
    std::size_t place = 0;
    if (open == std::string::npos) break;
    const char *from = name.data() + open + 1, *to = name.data() + name.size() - 1;
    const auto [end, error] = std::from_chars(from, to, place);
    if (error != std::errc() || end != to)
      refuse_parameter(key, "a place must be a whole number from 0 on, such as [0]");
    places.insert(places.begin(), place);
    name.resize(open);
  }
  return {name, places};
}

using Places = std::span<const std::size_t>;

/// The text of a number or of an array; empty: it is or holds something else. With `places` the number there is `x`.
std::string text_of_numbers(const toml::node& node, Places places = {}, std::optional<double> x = {}) {
  const bool here = x && places.empty();
  if (const auto number = node.value<double>()) return exactly(here ? *x : *number);
  const toml::array* array = node.as_array();
  if (array == nullptr) return {};
  std::string list = "[";
  for (std::size_t i = 0; i < array->size(); ++i) {
    const bool below = x && !places.empty() && places.front() == i;
    const std::string entry = below ? text_of_numbers((*array)[i], places.subspan(1), x) : text_of_numbers((*array)[i]);
    if (entry.empty()) return {};
    list += (i > 0 ? ", " : "") + entry;
  }
  return list + "]";
}

/// The entry of an array of arrays; null: there is none.
const toml::node* entry_at(const toml::node& node, Places places) {
  if (places.empty()) return &node;
  const toml::array* array = node.as_array();
  if (array == nullptr || places.front() >= array->size()) return nullptr;
  return entry_at((*array)[places.front()], places.subspan(1));
}

/// The node at a path of plain keys; null: there is none.
const toml::node* node_at(const toml::table& root, std::string_view path) {
  const auto dot = path.find('.');
  const toml::node* node = root.get(path.substr(0, dot));
  if (dot == std::string_view::npos || node == nullptr) return node;
  return node->is_table() ? node_at(*node->as_table(), path.substr(dot + 1)) : nullptr;
}

/// The value's text, as --set or the scene has it; empty: neither does.
std::string text_of_value(const SceneSource& source, const std::string& key) {
  for (const std::string& set : source.sets)
    if (set.starts_with(key + "=")) return set.substr(key.size() + 1);
  if (!source.text && is_built_in(source.name)) {
    std::string value;
    const auto look = [&](const auto& entries) {
      for (const auto& entry : entries)
        if (entry.name == source.name)
          for (const OptionEntry& option : entry.options())
            if (option.name == key) value = option.value;
    };
    look(scenes()), look(spatial_scenes());
    return value;
  }
  const std::string of_scene = source.text ? *source.text : read_scene_text(source.name);  // it has been read
  if (of_scene.find_first_not_of(" \t\r\n") == of_scene.find('<')) return {};              // XML: no keys of a scene
  const toml::table root = toml::parse(of_scene);
  const toml::node* node = node_at(root, key);
  if (node == nullptr) {  // KIND.NAME.KEY
    const auto dot = key.find('.'), second = key.find('.', dot + 1);
    if (dot == std::string::npos || second == std::string::npos) return {};
    const toml::array* elements = root[key.substr(0, dot)].as_array();
    const std::string name = key.substr(dot + 1, second - dot - 1);
    for (std::size_t i = 0; elements != nullptr && i < elements->size(); ++i) {
      const toml::table* element = (*elements)[i].as_table();
      if (element == nullptr) continue;
      const auto given = (*element)["name"].value_or(std::string());
      if ((given.empty() ? key.substr(0, dot) + std::to_string(i + 1) : given) != name) continue;
      node = node_at(*element, key.substr(second + 1));
    }
  }
  if (node == nullptr) return {};
  return text_of_numbers(*node);
}

/// The text of a value that the scene leaves at its default, found by trial; empty: none of the usual ones is it.
template <class Space> std::string text_of_default(const SceneSource& source, const SceneIn<Space>& scene,
                                                   const std::string& key, bool is_array) {
  if (!source.text && is_built_in(source.name)) return {};
  const SystemOf<Space> given(scene);
  std::vector<std::string> usual = {"0", "1"};
  if (is_array && kPlanar<Space>) usual = {"[0, 0]", "[1, 0]", "[0, 1]"};
  if (is_array && !kPlanar<Space>) usual = {"[0, 0, 0]", "[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]", "[1, 0, 0, 0]"};
  for (const std::string& text : usual) try {
      std::vector<std::string> sets = source.sets;
      sets.push_back(key + "=" + text);
      if (same_elements(given, SystemOf<Space>(make_in<Space>(source, sets)))) return text;
    } catch (const std::invalid_argument&) {  // no key of the scene, or out of range
    }
  return {};
}

/// A value's text as a document with the key "value".
toml::table document_of(const std::string& text) {
  toml::table document;
  double number = 0;
  const char* const end = text.data() + text.size();
  if (const auto [last, error] = std::from_chars(text.data(), end, number); error == std::errc() && last == end)
    document.insert("value", number);  // also ".5" and "1.", which TOML does not have
  else
    try {
      document = toml::parse("value = " + text);
    } catch (const toml::parse_error&) {  // a word without quotes: no number
    }
  return document;
}

/// The place of "crank.theta" in q, or behind q in v; in space among the columns of bodies. −1: there is none.
template <class Space> Index place_of_column(const SceneIn<Space>& scene, const std::string& column) {
  const std::vector<std::string> columns = body_columns(scene);
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) return -1;
  const auto k = static_cast<Index>(found - columns.begin());
  if constexpr (!kPlanar<Space>) return k;
  const Index body = k / 6, part = k % 6, dof = 3 * static_cast<Index>(scene.bodies.size());
  return part < 3 ? 3 * body + part : dof + 3 * body + part - 3;
}

/// RunParameterOf::start of "crank.theta"; −1: none.
template <class Space> Index place_of_start(const SceneIn<Space>& scene, const std::string& column) {
  if constexpr (kPlanar<Space>) {
    return place_of_column<Space>(scene, column);
  } else {
    constexpr const char* kParts[] = {".x", ".y", ".z", ".rx", ".ry", ".rz", ".vx", ".vy", ".vz", ".wx", ".wy", ".wz"};
    const Index dof = Space::kVelocities * std::ssize(scene.bodies);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
      for (Index k = 0; k < 12; ++k)
        if (column == scene.bodies[i].name + kParts[k]) {
          const Index first = Space::kVelocities * static_cast<Index>(i);
          return k < 6 ? first + k : dof + first + k - 6;
        }
    return -1;
  }
}

template <class Space>
RunParameterOf<Space> parameter_in(const SceneSource& source, const SceneIn<Space>& scene, const std::string& key) {
  constexpr std::string_view kOfStart = "start.";
  if (key.starts_with(kOfStart)) {
    const Index place = place_of_start<Space>(scene, key.substr(kOfStart.size()));
    if (place < 0)
      refuse_parameter(key, kPlanar<Space> ? "must be start.BODY.COLUMN, COLUMN of x, y, theta, vx, vy, omega"
                                           : "must be start.BODY.COLUMN, COLUMN of x, y, z, rx, ry, rz, vx, vy, vz, "
                                             "wx, wy, wz");
    return {key, 0, {}, place};
  }
  if (key == "duration" || key == "step")
    refuse_parameter(key, "is a setting of the run: must be a value of the scene or its start");
  const auto [name, places] = split_places(key);
  std::string text = text_of_value(source, name);
  if (text.empty()) text = text_of_default<Space>(source, scene, name, places.size() == 1);
  if (text.empty())
    refuse_parameter(key,
                     "no number is found at this key in the scene: must be an option, KIND.NAME.KEY, an entry of an "
                     "array such as KIND.NAME.KEY[0] or KIND.NAME.KEY[0][1], or be given by KEY=VALUE");
  const toml::table document = document_of(text);
  const toml::node* const whole = document.get("value");
  const toml::node* const found = whole != nullptr ? entry_at(*whole, places) : nullptr;
  if (whole != nullptr && whole->is_array() && found == nullptr)
    refuse_parameter(key, "there is no such entry in " + in_one_line(text) + ": places count from 0");
  const auto number = found != nullptr ? found->value<double>() : std::nullopt;
  if (!number)
    refuse_parameter(key, "the value is " + in_one_line(text) +
                              ": must be a number, or one of its entries by their places from 0, such as KEY[0]");
  const auto scene_at = [source, name = name, places = places, document](double x) {
    std::vector<std::string> sets;
    for (const std::string& set : source.sets)
      if (!set.starts_with(name + "=")) sets.push_back(set);
    sets.push_back(name + "=" + text_of_numbers(*document.get("value"), places, x));
    return make_in<Space>(source, sets);
  };
  return {key, *number, scene_at, -1};
}

template <class Space> RunColumn column_in(const SceneIn<Space>& scene, const std::string& column) {
  using Kind = RunColumn::Kind;
  if (const Index place = place_of_column<Space>(scene, column); place >= 0) return {Kind::state, place};
  const auto dot = column.rfind('.');
  const std::string part = dot == std::string::npos ? "" : column.substr(dot + 1);
  const auto kind = part == "gap"                                           ? std::optional(Kind::gap)
                    : part == "impulse_n"                                   ? std::optional(Kind::normal)
                    : part == (kPlanar<Space> ? "impulse_t" : "impulse_t1") ? std::optional(Kind::tangent)
                    : !kPlanar<Space> && part == "impulse_t2"               ? std::optional(Kind::across)
                                                                            : std::nullopt;
  for (std::size_t i = 0; kind && i < scene.contacts.size(); ++i)
    if (std::visit([](const auto& c) { return c.name; }, scene.contacts[i]) == column.substr(0, dot))
      return {*kind, static_cast<Index>(i)};
  throw std::invalid_argument(
      "column '" + in_one_line(column) +
      (kPlanar<Space> ? "': must be BODY.COLUMN, COLUMN of x, y, theta, vx, vy, omega, or CONTACT.gap, "
                        "CONTACT.impulse_n, CONTACT.impulse_t"
                      : "': must be BODY.COLUMN, COLUMN of x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz, or "
                        "CONTACT.gap, CONTACT.impulse_n, CONTACT.impulse_t1, CONTACT.impulse_t2"));
}

}  // namespace

AnyScene SceneSource::make_with(const std::vector<std::string>& other_sets) const {
  return text ? parse_any_scene(*text, other_sets, name) : make_any_scene(name, other_sets);
}

double step_of(const AnyScene& scene) {
  return std::visit([](const auto& s) { return s.step; }, scene);
}
double duration_of(const AnyScene& scene) {
  return std::visit([](const auto& s) { return s.duration; }, scene);
}
std::string name_of_contact(const AnyScene& scene, int contact) {
  return std::visit(
      [&](const auto& s) {
        return std::visit([](const auto& c) { return c.name; }, s.contacts[static_cast<std::size_t>(contact)]);
      },
      scene);
}

RunParameter parameter_of(const SceneSource& source, const Scene& scene, const std::string& key) {
  return parameter_in<Planar>(source, scene, key);
}
RunParameterOf<Spatial> parameter_of(const SceneSource& source, const spatial::Scene& scene, const std::string& key) {
  return parameter_in<Spatial>(source, scene, key);
}
RunColumn column_of(const Scene& scene, const std::string& name) { return column_in<Planar>(scene, name); }
RunColumn column_of(const spatial::Scene& scene, const std::string& name) { return column_in<Spatial>(scene, name); }

namespace {

/// What a call by names stands for.
template <class Space> struct NamedIn {
  NamedIn(const SceneSource& source, SceneIn<Space> made, const std::vector<std::string>& of,
          const std::vector<std::string>& wrt, std::string_view integrator)
      : method(integrator.substr(0, integrator.find(':'))), scene(std::move(made)), system(scene) {
    if (method.size() < integrator.size()) given = integrator.substr(method.size() + 1);
    for (auto column = of.begin(); column != of.end(); ++column) {
      if (std::find(of.begin(), column, *column) != column)
        throw std::invalid_argument("column '" + in_one_line(*column) + "': is given twice: must be given once");
      columns.push_back(column_of(scene, *column));
    }
    for (auto key = wrt.begin(); key != wrt.end(); ++key) {
      if (std::find(wrt.begin(), key, *key) != key) refuse_parameter(*key, "is given twice: must be given once");
      parameters.push_back(parameter_of(source, scene, *key));
    }
  }
  auto scheme(const char* others) const {
    std::conditional_t<kPlanar<Space>, StepScheme, std::variant<MoreauJeanOptions>> scheme;
    const auto refuse = [&](const std::string& rule) {
      throw std::invalid_argument("gradients: the integrator is '" + in_one_line(method) + "': must be moreau-jean" +
                                  rule);
    };
    if constexpr (kPlanar<Space>) {
      if (method == Rattle::kName)
        scheme = RattleOptions{};
      else if (method != MoreauJean::kName)
        refuse(std::string(" or rattle") + others);
    } else if (method != MoreauJean::kName) {
      refuse(", for scenes in space");
    }
    std::visit(
        [&](auto& options) {
          if (!given.empty()) set_options(options, given);
        },
        scheme);
    if constexpr (kPlanar<Space>)
      return scheme;
    else
      return std::get<MoreauJeanOptions>(scheme);
  }
  std::string method, given;
  SceneIn<Space> scene;
  SystemOf<Space> system;
  std::vector<RunColumn> columns;
  std::vector<RunParameterOf<Space>> parameters;
};
using Named = NamedIn<Planar>;

/// what(scene, its space) of a planar scene or one in space.
template <class What> auto in_its_space(const SceneSource& source, What&& what) {
  AnyScene made = source.make();
  if (auto* planar = std::get_if<Scene>(&made)) return what(std::move(*planar), Planar{});
  return what(std::get<spatial::Scene>(std::move(made)), Spatial{});
}

/// Of the motion itself.
GradientOfRun gradient_of_motion(const Named& named, Solver& solver, const Clock& clock) {
  const auto refuse = [](const std::string& what, const char* rule) {
    throw std::invalid_argument("gradients: by event-driven " + what + " has no derivatives: must be " + rule);
  };
  if (!named.scene.collisions.empty())
    refuse("the [[collision]] '" + named.scene.collisions.front().name + "'", "listed as [[contact]]");
  if (!named.scene.frictions.empty())
    refuse("the [[friction]] '" + named.scene.frictions.front().name + "'", "left out, or the integrator moreau-jean");
  if (named.scene.restitution != Restitution::newton) refuse("restitution = poisson", "newton");
  if (named.scene.impacts != Impacts::simultaneous) refuse("impacts = sequential", "simultaneous");
  EventDrivenOptions options;
  if (!named.given.empty()) set_options(options, named.given);
  ColumnSlopes slopes(named.system, named.columns);
  if (slopes.any_impulse())
    throw std::invalid_argument("gradients: by event-driven impulses have none: must be columns of bodies, or gaps");
  std::vector<ParameterChange> changes;
  for (const RunParameter& parameter : named.parameters)
    changes.push_back(changes_of(parameter, named.system, clock.duration));
  GradientOfRun gradient;
  const MotionTangent motion = differentiate_motion(
      named.system, named.parameters, options, solver, clock.duration, clock.step * static_cast<double>(clock.every),
      [&](const State& x, const Eigen::MatrixXd& dq, const Eigen::MatrixXd& dv) {
        gradient.t.push_back(x.t);
        slopes.set_up(x);
        for (std::size_t i = 0; i < named.columns.size(); ++i) {
          gradient.value.push_back(slopes.value(i, x));
          for (std::size_t j = 0; j < changes.size(); ++j) {
            const auto column = static_cast<Index>(j);
            gradient.by.push_back(slopes.push(i, changes[j], dq.col(column).data(), dv.col(column).data()));
          }
        }
      },
      clock.cancel);
  if (!motion.none.empty()) throw std::runtime_error("gradients: the motion has no derivative: " + motion.none);
  gradient.tangent.run.status = motion.status, gradient.tangent.run.why = motion.why;
  gradient.tangent.run.final = motion.final;
  gradient.tangent.warnings = motion.warnings;
  gradient.tangent.q = motion.q, gradient.tangent.v = motion.v;
  return gradient;
}

}  // namespace

GradientOfRun gradient_of_run(const SceneSource& source, const std::vector<std::string>& of,
                              const std::vector<std::string>& wrt, std::string_view integrator, Solver& solver,
                              const Clock& clock) {
  check(clock);
  return in_its_space(source, [&]<class Space>(SceneIn<Space> scene, Space /*of it*/) {
    const NamedIn<Space> named(source, std::move(scene), of, wrt, integrator);
    if constexpr (kPlanar<Space>)
      if (named.method == EventDriven::kName) return gradient_of_motion(named, solver, clock);
    GradientOfRun gradient;
    gradient.tangent =
        differentiate_run(named.system, named.parameters, named.scheme(", or event-driven"), solver, clock,
                          named.columns, [&](double t, const Eigen::VectorXd& value, const Eigen::MatrixXd& by) {
                            gradient.t.push_back(t);
                            for (Index i = 0; i < value.size(); ++i) {
                              gradient.value.push_back(value[i]);
                              for (Index j = 0; j < by.cols(); ++j) gradient.by.push_back(by(i, j));
                            }
                          });
    return gradient;
  });
}

RunAdjoint adjoint_of_run(const SceneSource& source, const std::vector<std::string>& of,
                          const std::vector<std::string>& wrt, std::string_view integrator, Solver& solver,
                          const Clock& clock, Index scalars, const RecordWeights& weights) {
  return in_its_space(source, [&]<class Space>(SceneIn<Space> scene, Space /*of it*/) {
    const NamedIn<Space> named(source, std::move(scene), of, wrt, integrator);
    return differentiate_run_reverse(named.system, named.parameters, named.scheme(" in reverse mode"), solver, clock,
                                     named.columns, scalars, weights);
  });
}

Lyapunov lyapunov_of(const SceneSource& source, std::string_view integrator, Solver& solver, const LyapunovClock& clock,
                     const std::atomic<bool>* cancel) {
  AnyScene made = source.make();
  if (!std::holds_alternative<Scene>(made)) throw std::invalid_argument("lyapunov: the scene must be planar");
  const Named named(source, std::get<Scene>(std::move(made)), {}, {}, integrator);
  if (named.method != EventDriven::kName)
    throw std::invalid_argument("lyapunov: the integrator is '" + in_one_line(named.method) +
                                "': must be event-driven");
  EventDrivenOptions options;
  if (!named.given.empty()) set_options(options, named.given);
  Lyapunov found = lyapunov_exponents(named.system, options, solver, clock, cancel);
  if (!found.none.empty()) throw std::runtime_error("lyapunov: the motion has no tangents: " + found.none);
  return found;
}

}  // namespace orthant
