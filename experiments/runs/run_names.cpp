#include "experiments/runs/run_names.h"

#include "experiments/runs/trajectory.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/shortened.h>

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
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
  return std::string(text, std::to_chars(text, text + sizeof text, x).ptr);
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

/// KIND.NAME.KEY: the element's kind, its name, the key in it. Empty: another path.
struct ElementKey {
  explicit ElementKey(const std::string& key) {
    const auto dot = key.find('.'), second = key.find('.', dot + 1);
    if (dot == std::string::npos || second == std::string::npos) return;
    kind = key.substr(0, dot), name = key.substr(dot + 1, second - dot - 1), rest = key.substr(second + 1);
  }
  const toml::table* find_in(const toml::table& root) const {
    const toml::array* elements = root[kind].as_array();
    for (std::size_t i = 0; elements != nullptr && i < elements->size(); ++i) {
      const toml::table* element = (*elements)[i].as_table();
      if (element == nullptr) continue;
      const auto given = (*element)["name"].value_or(std::string());
      if ((given.empty() ? kind + std::to_string(i + 1) : given) == name) return element;
    }
    return nullptr;
  }
  std::string kind, name, rest;
};

template <class F> void each_option(const std::string& built_in, F&& f) {
  const auto look = [&](const auto& entries) {
    for (const auto& entry : entries)
      if (entry.name == built_in)
        for (const OptionEntry& option : entry.options()) f(option);
  };
  look(scenes()), look(spatial_scenes());
}

/// The scene's file, which has been read before; empty: a built-in scene, or XML, which has no keys of a scene.
std::optional<toml::table> document_of_scene(const SceneSource& source) {
  if (!source.text && is_built_in(source.name)) return {};
  const std::string text = source.text ? *source.text : read_scene_text(source.name);
  if (text.find_first_not_of(" \t\r\n") == text.find('<')) return {};
  return toml::parse(text);
}

/// The value's text, as --set or the scene has it; empty: neither does.
std::string text_of_value(const SceneSource& source, const std::string& key) {
  for (const std::string& set : source.sets)
    if (set.starts_with(key + "=")) return set.substr(key.size() + 1);
  if (!source.text && is_built_in(source.name)) {
    std::string value;
    each_option(source.name, [&](const OptionEntry& option) {
      if (option.name == key) value = option.value;
    });
    return value;
  }
  const auto root = document_of_scene(source);
  if (!root) return {};
  const toml::node* node = node_at(*root, key);
  if (node == nullptr) {
    const ElementKey of(key);
    const toml::table* element = of.find_in(*root);
    if (element != nullptr) node = node_at(*element, of.rest);
  }
  return node != nullptr ? text_of_numbers(*node) : std::string();
}

/// The rule for a key without a number: what of it the scene does not have.
std::string rule_of_missing(const SceneSource& source, const std::string& key) {
  if (!source.text && is_built_in(source.name)) {
    std::string options;
    each_option(source.name, [&](const OptionEntry& option) { options += option.name + ", "; });
    return "is no option of " + source.name + " with a number: must be one of " + options +
           "BODY.mass, or start.BODY.COLUMN";
  }
  const ElementKey of(key);
  if (const auto root = document_of_scene(source); root && !of.kind.empty()) {
    const std::string kind = in_one_line(of.kind), name = "'" + in_one_line(of.name) + "'";
    if (!(*root)[of.kind].is_array()) return "the scene has no [[" + kind + "]]";
    if (of.find_in(*root) == nullptr) return "the scene has no [[" + kind + "]] with the name " + name;
    return "the [[" + kind + "]] " + name + " has no number '" + in_one_line(of.rest) +
           "': must be one of its keys, or an entry of an array by its place, such as KEY[0] or KEY[0][1]";
  }
  return "no number is found at this key in the scene: must be KIND.NAME.KEY, an entry of an array such as "
         "KIND.NAME.KEY[0] or KIND.NAME.KEY[0][1], start.BODY.COLUMN, or be given by KEY=VALUE";
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

template <class Elements> bool any_named(const Elements& elements, const std::string& name) {
  return std::ranges::any_of(elements, [&](const auto& one) {
    if constexpr (requires { one.name; })
      return one.name == name;
    else
      return std::visit([](const auto& x) { return x.name; }, one) == name;
  });
}

/// The begin of a message: empty where a body has this name.
template <class Scene> std::string no_such_body(const Scene& scene, const std::string& name) {
  return any_named(scene.bodies, name) ? "" : "no body has the name '" + in_one_line(name) + "': ";
}

/// "rod.mass", and in the plane "rod.inertia": also of built-in scenes, whose options may have neither.
template <class Space> std::optional<RunParameterOf<Space>> parameter_of_body(const SceneSource& source,
                                                                              const SceneIn<Space>& scene,
                                                                              const std::string& key) {
  const auto dot = key.rfind('.');
  const std::string part = dot == std::string::npos ? "" : key.substr(dot + 1);
  if (part != "mass" && !(kPlanar<Space> && part == "inertia")) return {};
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name != key.substr(0, dot)) continue;
    const auto number = [i, part](auto& bodies) -> double& {
      if constexpr (kPlanar<Space>)
        if (part == "inertia") return bodies[i].inertia;
      return bodies[i].mass;
    };
    SceneIn<Space> given = scene;
    const auto scene_at = [source, number](double x) {
      auto changed = make_in<Space>(source, source.sets);
      number(changed.bodies) = x;
      return changed;
    };
    return RunParameterOf<Space>{key, number(given.bodies), scene_at, -1};
  }
  return {};
}

template <class Space>
RunParameterOf<Space> parameter_in(const SceneSource& source, const SceneIn<Space>& scene, const std::string& key) {
  constexpr std::string_view kOfStart = "start.";
  if (key.starts_with(kOfStart)) {
    const std::string column = key.substr(kOfStart.size());
    const Index place = place_of_start<Space>(scene, column);
    if (place >= 0) return {key, 0, {}, place};
    refuse_parameter(key, no_such_body(scene, column.substr(0, column.rfind('.'))) +
                              (kPlanar<Space> ? "must be start.BODY.COLUMN, COLUMN of x, y, theta, vx, vy, omega"
                                              : "must be start.BODY.COLUMN, COLUMN of x, y, z, rx, ry, rz, vx, vy, vz, "
                                                "wx, wy, wz"));
  }
  if (auto by_body = parameter_of_body<Space>(source, scene, key)) return *std::move(by_body);
  if (key == "duration" || key == "step")
    refuse_parameter(key, "is a setting of the run: must be a value of the scene or its start");
  const auto [name, places] = split_places(key);
  std::string text = text_of_value(source, name);
  if (text.empty()) text = text_of_default<Space>(source, scene, name, places.size() == 1);
  if (text.empty()) refuse_parameter(key, rule_of_missing(source, name));
  const toml::table document = document_of(text);
  const toml::node* const whole = document.get("value");
  const toml::node* const found = whole != nullptr ? entry_at(*whole, places) : nullptr;
  if (whole != nullptr && whole->is_array() && found == nullptr)
    refuse_parameter(key, "there is no such entry in " + in_one_line(text) + ": places count from 0");
  if (whole != nullptr && whole->is_number() && !places.empty())
    refuse_parameter(key, "the value is " + in_one_line(text) + ", no array: must be written without a place");
  const auto number = found != nullptr ? found->value<double>() : std::nullopt;
  if (!number)
    refuse_parameter(key, "the value is " + in_one_line(text) +
                              ": must be a number, or one of its entries by their places from 0, such as KEY[0]");
  const auto scene_at = [source, name = name, places = places, document](double x) {
    std::vector<std::string> sets;
    for (const std::string& set : source.sets)
      if (!set.starts_with(name + "=")) sets.push_back(set);
    std::string changed = text_of_numbers(*document.get("value"), places, x);
    if (places.size() == 2 && name.ends_with(".inertia")) {  // a tensor stays symmetric
      const std::size_t mirrored[] = {places[1], places[0]};
      changed = text_of_numbers(*document_of(changed).get("value"), mirrored, x);
    }
    sets.push_back(name + "=" + changed);
    return make_in<Space>(source, sets);
  };
  return {key, *number, scene_at, -1};
}

/// Why a name is no column with derivatives.
template <class Space> std::string rule_of_column(const SceneIn<Space>& scene, const std::string& column) {
  for (const char* measure : {"t", "joint_residual", "penetration", "lcp_residual", "lcp_iterations"})
    if (column == measure)
      return std::string("has no derivative: ") +
             (column == "t" ? "records stand at fixed times" : "it measures errors of the step") + ". ";
  const auto dot = column.rfind('.');
  if (dot == std::string::npos) return "";
  const std::string owner = column.substr(0, dot);
  if (any_named(scene.collisions, owner))
    return "has no derivative: the contacts of a [[collision]] are searched, must be listed as [[contact]]. ";
  if (any_named(scene.joints, owner)) return "has no derivative: it is of a joint. ";
  if (!any_named(scene.bodies, owner) && !any_named(scene.contacts, owner) && !any_named(scene.frictions, owner))
    return "no body, contact or friction has the name '" + in_one_line(owner) + "'. ";
  return "";
}

template <class Space> RunColumn column_in(const SceneIn<Space>& scene, const std::string& column) {
  using Kind = RunColumn::Kind;
  if (column == "energy") return {Kind::energy, 0};
  if (const Index place = place_of_column<Space>(scene, column); place >= 0) return {Kind::state, place};
  const auto dot = column.rfind('.');
  const std::string owner = column.substr(0, dot), part = dot == std::string::npos ? "" : column.substr(dot + 1);
  if (part == "impulse")
    for (std::size_t i = 0; i < scene.frictions.size(); ++i)
      if (scene.frictions[i].name == owner) return {Kind::friction, static_cast<Index>(i)};
  const auto kind = part == "gap"                                           ? std::optional(Kind::gap)
                    : part == "impulse_n"                                   ? std::optional(Kind::normal)
                    : part == (kPlanar<Space> ? "impulse_t" : "impulse_t1") ? std::optional(Kind::tangent)
                    : !kPlanar<Space> && part == "impulse_t2"               ? std::optional(Kind::across)
                                                                            : std::nullopt;
  for (std::size_t i = 0; kind && i < scene.contacts.size(); ++i)
    if (std::visit([](const auto& c) { return c.name; }, scene.contacts[i]) == owner)
      return {*kind, static_cast<Index>(i)};
  throw std::invalid_argument(
      "column '" + in_one_line(column) + "': " + rule_of_column<Space>(scene, column) +
      (kPlanar<Space> ? "must be BODY.COLUMN, COLUMN of x, y, theta, vx, vy, omega, or CONTACT.gap, "
                        "CONTACT.impulse_n, CONTACT.impulse_t, FRICTION.impulse, energy"
                      : "must be BODY.COLUMN, COLUMN of x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz, or "
                        "CONTACT.gap, CONTACT.impulse_n, CONTACT.impulse_t1, CONTACT.impulse_t2, FRICTION.impulse, "
                        "energy"));
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

}  // namespace orthant
