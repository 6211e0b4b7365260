#include "experiments/sweep/page.h"

#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <stdexcept>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kColumnsOfFigures[] = {"integrator",     "solver",
                                             "parameters",     "step",
                                             "rtol",           "repeats",
                                             "status",         "why",
                                             "value",          "error",
                                             "seconds",        "lcp_solves",
                                             "events",         "lcp_iterations",
                                             "impulse",        "first_touch",
                                             "first_release",  "last_release",
                                             "touching",       "energy_initial",
                                             "spin_drift",     "friction_impulse",
                                             "energy_drift",   "energy_final",
                                             "momentum_drift", "max_joint_residual",
                                             "max_penetration"};
constexpr const char* kDerivedColumns[] = {"energy_lost", "lost_per_turn"};

constexpr std::size_t kMostFigures = 100;        // of one table
constexpr double kMostSteps = 1e6 * (1 + 1e-9);  // of an animated run

[[noreturn]] void refuse(const std::string& key, const std::string& value, const std::string& rule) {
  throw std::invalid_argument(key + (value.empty() ? "" : " = " + value) + ": " + rule);
}

std::string list_of(const std::set<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

void check_tables(const Json& list, const std::string& key) {
  if (!list.is_array() || !std::ranges::all_of(list, [](const Json& one) { return one.is_object(); }))
    refuse(key, list.dump(), "must be tables [[" + key + "]]");
}

/// Of a table: texts are texts, those needed are there.
void check_texts(const Json& table, const std::string& where, std::initializer_list<const char*> needed,
                 std::initializer_list<const char*> others) {
  for (const char* key : needed)
    if (!table.contains(key)) refuse(where + key, "", "is missing");
  for (const auto& list : {needed, others})
    for (const char* key : list)
      if (table.contains(key) && !table[key].is_string()) refuse(where + key, table[key].dump(), "must be a text");
}

void check_number(const Json& table, const std::string& where, const char* key, double low, double high) {
  if (!table.contains(key)) return;
  const Json& value = table[key];
  if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high))
    refuse(where + key, value.is_number() ? detail::text_of(value.get<double>()) : value.dump(),
           "must be a number in [" + detail::text_of(low) + ", " + detail::text_of(high) + "]");
}

Json table_at(const Json& table, const std::string& where, const char* key) {
  const Json part = table.value(key, Json::object());
  if (!part.is_object()) refuse(where + key, part.dump(), "must be a table");
  return part;
}

template <class Scene> void check_run_of(const Json& animation, const Json& run, const Scene& scene) {
  constexpr bool planar = std::is_same_v<Scene, orthant::Scene>;
  const SystemOf<std::conditional_t<planar, Planar, Spatial>> system(scene);
  const double duration = animation.value("duration", system.scene().duration);
  if (run.contains("step") && !(duration <= kMostSteps * run["step"].get<double>()))
    refuse("animation.runs.step", detail::text_of(run["step"].get<double>()),
           "must make at most a million steps of the animation's " + detail::text_of(duration) + " s");
  make_integrator(run["integrator"].get<std::string>(), system);
  make_solver(run.value("solver", "auto"));
  if (!animation.contains("magnify")) return;
  if (!planar) refuse("animation.magnify", animation["magnify"].dump(), "must be absent where the scene is in space");
  const auto magnified = animation["magnify"].get<std::string>();
  if (std::ranges::none_of(system.scene().bodies, [&](const auto& body) { return body.name == magnified; }))
    refuse("animation.magnify", animation["magnify"].dump(), "must be a body of the scene");
}

void check_animation(const Json& animation, const SceneWith& scene) {
  check_keys(animation, "animation.", {"title", "note", "set", "magnify", "seconds", "duration", "runs"});
  check_texts(animation, "animation.", {"title"}, {"note", "magnify"});
  check_number(animation, "animation.", "seconds", 0.1, 3600);
  check_number(animation, "animation.", "duration", 1e-12, 1e9);
  const Json runs = animation.value("runs", Json::array());
  check_tables(runs, "animation.runs");
  if (runs.empty()) refuse("animation.runs", "[]", "must have at least one run");
  for (const Json& run : runs) {
    check_keys(run, "animation.runs.", {"label", "integrator", "solver", "step", "set"});
    check_texts(run, "animation.runs.", {"integrator"}, {"label", "solver"});
    check_number(run, "animation.runs.", "step", 1e-15, 1e9);
    Json set = table_at(animation, "animation.", "set");
    set.update(table_at(run, "animation.runs.", "set"));
    std::visit([&](const auto& made) { check_run_of(animation, run, made); }, scene(sets_of(set)));
  }
}

}  // namespace

std::span<const char* const> columns_of_figures() { return kColumnsOfFigures; }

std::vector<std::string> sets_of(const Json& set) {
  std::vector<std::string> sets;
  for (const auto& [name, value] : set.items()) sets.push_back(name + '=' + value.dump());
  return sets;
}

void check_keys(const Json& table, const std::string& where, const std::set<std::string>& known) {
  if (!table.is_object()) refuse(where.substr(0, where.find_last_not_of('.') + 1), table.dump(), "must be a table");
  for (const auto& [key, value] : table.items())
    if (!known.contains(key)) refuse(where + key, value.dump(), "unknown key, must be one of " + list_of(known));
}

Json one_by_one(const Json& figures) {
  constexpr const char* kTexts[] = {"title", "note", "x", "y", "x_label", "y_label"};
  check_tables(figures, "figure");
  Json all = Json::array();
  for (const Json& figure : figures) {
    std::size_t count = 1;
    for (const char* key : kTexts)
      if (figure.contains(key) && figure[key].is_array()) count = std::max(count, figure[key].size());
    if (count > kMostFigures) refuse("figure", "", "a list of at most " + std::to_string(kMostFigures) + " texts");
    for (std::size_t i = 0; i < count; ++i) {
      Json one = figure;
      for (const char* key : kTexts) {
        if (!one.contains(key) || !one[key].is_array()) continue;
        if (one[key].size() != count)
          refuse(std::string("figure.") + key, figure[key].dump(),
                 "must have as many texts as the figure's other lists: " + std::to_string(count));
        one[key] = Json(figure[key][i]);
      }
      all.push_back(std::move(one));
    }
  }
  return all;
}

void check_figures(const Json& figures, const std::set<std::string>& parameters) {
  check_tables(figures, "figure");
  std::set<std::string> columns(std::begin(kColumnsOfFigures), std::end(kColumnsOfFigures));
  columns.insert(std::begin(kDerivedColumns), std::end(kDerivedColumns));
  columns.insert(parameters.begin(), parameters.end());
  for (const Json& figure : figures) {
    check_keys(figure, "figure.",
               {"title", "note", "x", "y", "by", "solver", "integrator", "timed", "worst", "octaves", "dots", "where",
                "first", "log", "x_label", "y_label"});
    check_texts(figure, "figure.", {"title", "x", "y", "by"},
                {"note", "solver", "integrator", "first", "log", "x_label", "y_label"});
    for (const char* key : {"timed", "worst", "octaves", "dots"})
      if (figure.contains(key) && !figure[key].is_boolean())
        refuse(std::string("figure.") + key, figure[key].dump(), "must be true or false");
    for (const char* key : {"x", "y", "by"})
      if (!columns.contains(figure[key].get<std::string>()))
        refuse(std::string("figure.") + key, figure[key].dump(), "must be one of " + list_of(columns));
    const Json where = table_at(figure, "figure.", "where");
    for (const auto& [name, value] : where.items())
      if (!columns.contains(name)) refuse("figure.where." + name, value.dump(), "must be one of " + list_of(columns));
    if (!std::set<std::string>{"", "x", "y", "xy"}.contains(figure.value("log", "")))
      refuse("figure.log", figure["log"].dump(), "must be \"\", \"x\", \"y\" or \"xy\"");
  }
}

void check_animations(const Json& animations, const SceneWith& scene) {
  check_tables(animations, "animation");
  for (const Json& animation : animations) {
    try {
      check_animation(animation, scene);
    } catch (const std::invalid_argument& error) {
      const std::string words = error.what();
      throw std::invalid_argument(words.starts_with("animation") ? words : "animation: " + words);
    }
  }
}

}  // namespace orthant
