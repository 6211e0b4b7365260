#include "experiments/sweep/sweep.h"

#include "experiments/sweep/page.h"
#include "experiments/sweep/reference_table.h"

#include "experiments/runs/trajectory.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/core/support/shortened.h>
#include <orthant/core/support/toml_nesting.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMostCases = 1e6, kMostValues = 1e5;
constexpr std::uintmax_t kLargestSweep = 16 << 20;  // [bytes]

Json json_of(const toml::node& node, const std::string& file) {
  if (const auto* table = node.as_table()) {
    Json json = Json::object();
    for (const auto& [key, value] : *table) json[std::string(key.str())] = json_of(value, file);
    return json;
  }
  if (const auto* array = node.as_array()) {
    Json json = Json::array();
    for (const toml::node& value : *array) json.push_back(json_of(value, file));
    return json;
  }
  if (const auto value = node.value_exact<std::string>()) return *value;
  if (const auto value = node.value_exact<std::int64_t>()) return *value;
  if (const auto value = node.value_exact<double>()) return *value;
  if (const auto value = node.value_exact<bool>()) return *value;
  throw std::invalid_argument(file + ":" + std::to_string(node.source().begin.line) +
                              ": a date or time: no key takes one");
}

/// 0.3 and not 0.30000000000000004, where rounding has no say.
double fifteen_digits(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", x);
  return std::strtod(text, nullptr);
}

/// As the file has it: JSON has no nan and no inf.
std::string shown(const Json& value) {
  const bool is_special = value.is_number_float() && !std::isfinite(value.get<double>());
  return is_special ? detail::text_of(value.get<double>()) : value.dump();
}

void check_scene(const Scene& scene) { check(scene); }
void check_scene(const spatial::Scene& scene) { check(scene); }

/// Reads one file: where, for messages; the parts of a grid one by one.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {
    const std::string text = read_whole(file, largest_input(kLargestSweep));
    refuse_deep(text, file.string());
    try {
      root_ = json_of(toml::parse(text, file.string()), file.string());
    } catch (const toml::parse_error& error) {
      throw std::invalid_argument(file.string() + ":" + std::to_string(error.source().begin.line) + ": " +
                                  std::string(error.description()));
    }
  }

  Sweep read(bool quick) {
    only(root_, "", {"question", "scene", "duration", "measure", "reference", "grid", "figure", "animation"});
    const bool grids_have = root_.contains("grid") && root_["grid"].is_array() &&
                            std::ranges::all_of(root_["grid"], [](const Json& grid) { return grid.contains("scene"); });
    Sweep sweep{.name = file_.stem().stem().string(),
                .question = text("question", ""),
                .scene = grids_have ? text("scene", "") : text("scene")};
    if (!sweep.scene.empty()) set_scene(common_, "scene", sweep.scene);
    common_.measure = text("measure", "energy");
    read_reference();
    if (!root_.contains("grid") || !root_["grid"].is_array() || root_["grid"].empty())
      fail("grid", "", "a sweep needs at least one [[grid]]");
    std::set<std::string> known;
    for (const Json& grid : root_["grid"]) {
      for (Case& c : cases(grid, quick))
        if (known.insert(c.key()).second) sweep.cases.push_back(std::move(c));
      if (!quick) cases(grid, true);  // it has to be right as well
    }
    if (sweep.cases.empty()) fail("grid", "", quick ? "--quick leaves no case" : "there is no case");
    sweep.page = page();
    sweep.scene_text = common_.scene_text;
    return sweep;
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& value, const std::string& rule) const {
    throw std::invalid_argument(file_.string() + ": " + key + (value.empty() ? "" : " = " + value) + ": " + rule);
  }
  template <class Work> auto in_file(const std::string& key, Work&& work) const -> decltype(work()) {
    try {
      return work();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(file_.string() + ": " + (key.empty() ? "" : key + ": ") + error.what());
    }
  }
  void only(const Json& table, const std::string& where, const std::set<std::string>& known) const {
    in_file("", [&] { return check_keys(table, where, known), 0; });
  }
  std::string text(const char* key, std::optional<std::string> otherwise = {}) const {
    if (!root_.contains(key)) {
      if (!otherwise) fail(key, "", "is missing");
      return *otherwise;
    }
    if (!root_[key].is_string()) fail(key, root_[key].dump(), "must be a text");
    return root_[key].get<std::string>();
  }
  double number(const std::string& key, const Json& value, double low, double high) const {
    if (!value.is_number()) fail(key, value.dump(), "must be a number");
    const auto x = value.get<double>();
    if (!(x >= low && x <= high))
      fail(key, shown(value), "must be in [" + detail::text_of(low) + ", " + detail::text_of(high) + "]");
    return x;
  }

  int whole(const std::string& key, const Json& value, double low, double high) const {
    const double x = number(key, value, low, high);
    if (x != std::floor(x)) fail(key, value.dump(), "must be a whole number");
    return static_cast<int>(x);
  }

  /// A number, a table's file, "exact" or an integrator.
  void read_reference() {
    if (root_.contains("reference") && root_["reference"].is_number()) {
      common_.known = number("reference", root_["reference"], -1e300, 1e300);
      common_.reference = detail::text_of(*common_.known);
      return;
    }
    common_.reference = text("reference", "");
    if (common_.reference.ends_with(".csv"))
      in_file("reference", [&] { return table_.emplace(file_.parent_path() / common_.reference), 0; });
    else if (!common_.reference.empty() && common_.reference != "exact")
      check_integrator("reference", common_.reference);
  }

  /// What the report shows.
  Json page() const {
    Json page = {{"figure", root_.value("figure", Json::array())},
                 {"animation", root_.value("animation", Json::array())}};
    std::set<std::string> parameters;  // of both grids, the whole and the quick
    for (const Json& grid : root_["grid"]) {
      if (grid.contains("scene")) parameters.insert(kSceneParameter);
      for (const char* part : {"/set", "/quick/set"})
        if (const Json::json_pointer at(part); grid.contains(at))
          for (const auto& [name, value] : grid.at(at).items()) parameters.insert(name);
    }
    in_file("", [&] {
      page["figure"] = one_by_one(page["figure"]);
      check_figures(page["figure"], parameters);
      if (!page["animation"].empty() && common_.scene.empty())
        throw std::invalid_argument("animation: needs a scene of the whole sweep");
      check_animations(page["animation"],
                       [&](const std::vector<std::string>& sets) { return make_any_scene(common_.scene, sets); });
      return 0;
    });
    if (root_.contains("duration"))
      for (Json& animation : page["animation"])
        if (!animation.contains("duration")) animation["duration"] = root_["duration"];
    return page;
  }

  /// A list, a range, or one value: the values.
  std::vector<Json> values(const std::string& key, const Json& node) const {
    if (node.is_array()) {
      if (node.empty()) fail(key, "[]", "must have at least one value");
      return {node.begin(), node.end()};
    }
    if (!node.is_object()) return {node};
    only(node, key + ".", {"from", "to", "count", "scale"});
    for (const char* part : {"from", "to", "count"})
      if (!node.contains(part)) fail(key, node.dump(), std::string("a range needs ") + part);
    const double from = number(key + ".from", node["from"], -1e300, 1e300),
                 to = number(key + ".to", node["to"], -1e300, 1e300);
    const int count = whole(key + ".count", node["count"], 1, kMostValues);
    const Json scale = node.value("scale", Json("linear"));
    if (scale != "linear" && scale != "log") fail(key + ".scale", scale.dump(), "must be \"linear\" or \"log\"");
    if (scale == "log" && !(from > 0 && to > 0))
      fail(key, node.dump(), "a range in logarithms needs from > 0 and to > 0");
    std::vector<Json> all;
    for (int i = 0; i < count; ++i) {
      const double s = count > 1 ? i / (count - 1.0) : 0;
      const double x = s == 1 ? to : scale == "log" ? from * std::pow(to / from, s) : from + s * (to - from);
      all.emplace_back(fifteen_digits(x));
    }
    return all;
  }

  void set_scene(Case& c, const std::string& key, const std::string& name) const {
    c.scene = name, c.scene_text.clear();
    if (is_built_in(name)) return;
    if (const auto near = file_.parent_path() / name; std::filesystem::exists(near)) c.scene = near.string();
    in_file(key, [&] { return make_any_scene(c.scene); });  // throws, in words
    c.scene_text = read_scene_text(c.scene);
  }

  void check_integrator(const std::string& key, const std::string& spec) const {
    static const System anything = [] {
      Scene scene;
      scene.body({});
      return System(scene);
    }();
    in_file(key, [&] { return make_integrator(spec, anything); });
  }

  /// Every combination; the values of each key are applied to all cases so far.
  std::vector<Case> cases(Json grid, bool quick) const {
    static const std::set<std::string> kKeys = {"scene", "duration", "integrator", "solver",    "step",
                                                "rtol",  "set",      "repeats",    "time_limit"};
    std::set<std::string> with_quick = kKeys;
    with_quick.insert("quick");
    only(grid, "grid.", with_quick);
    if (grid.contains("quick") && quick) {
      if (grid["quick"].is_object()) {
        only(grid["quick"], "grid.quick.", kKeys);
        grid.update(Json(grid["quick"]));
      } else if (grid["quick"] == false) {
        return {};
      } else if (grid["quick"] != true) {
        fail("grid.quick", shown(grid["quick"]), "must be a table, true or false");
      }
    }
    if (!grid.contains("integrator")) fail("grid.integrator", "", "is missing");
    std::vector<Case> all{common_};
    const auto combine = [&](const std::string& key, const Json& node, auto&& apply) {
      const auto list = values(key, node);
      if (static_cast<double>(all.size() * list.size()) > kMostCases) fail(key, "", "makes more than a million cases");
      std::vector<Case> more;
      for (const Case& c : all)
        for (const Json& value : list) apply(more.emplace_back(c), value);
      all = std::move(more);
    };
    const auto word = [&](const std::string& key, const Json& value) {
      if (!value.is_string()) fail(key, value.dump(), "must be a text");
      return value.get<std::string>();
    };
    for (Case& c : all) {
      if (grid.contains("repeats")) c.repeats = whole("grid.repeats", grid["repeats"], 0, 1000);
      if (grid.contains("time_limit")) c.time_limit = number("grid.time_limit", grid["time_limit"], 1e-3, 1e6);
    }
    combine("grid.integrator", grid["integrator"],
            [&](Case& c, const Json& value) { c.integrator = word("grid.integrator", value); });
    combine("grid.solver", grid.value("solver", Json("auto")),
            [&](Case& c, const Json& value) { c.solver = word("grid.solver", value); });
    if (grid.contains("scene"))
      combine("grid.scene", grid["scene"], [&](Case& c, const Json& value) {
        const std::string name = word("grid.scene", value);
        set_scene(c, "grid.scene", name);
        c.parameters.emplace_back(kSceneParameter, std::filesystem::path(name).stem().string());
      });
    const Json set = grid.value("set", Json::object());
    if (!set.is_object()) fail("grid.set", set.dump(), "must be a table");
    for (const auto& [name, node] : set.items())
      combine("grid.set." + name, node,
              [&, &name = name](Case& c, const Json& value) { c.parameters.emplace_back(name, value); });
    if (grid.contains("rtol"))
      combine("grid.rtol", grid["rtol"],
              [&](Case& c, const Json& value) { c.rtol = number("grid.rtol", value, 1e-16, 1); });
    set_times(all, grid);
    combine("grid.step", grid.value("step", Json(nullptr)), [&](Case& c, const Json& value) {
      if (value.is_null()) return;
      c.step = number("grid.step", value, 1e-15, c.duration);
    });
    for (Case& c : all) c.step = c.duration / std::round(c.duration / c.step);
    if (table_)
      for (Case& c : all) c.known = in_file("reference", [&] { return table_->value_for(c); });
    check(all);
    return all;
  }

  /// The scene's own step and duration, where the file has none; every scene is read once, so that bad parameters are
  /// reported before anything runs.
  void set_times(std::vector<Case>& all, const Json& grid) const {
    std::map<std::pair<std::string, std::vector<std::string>>, Clock> known;
    for (Case& c : all) {
      const auto entry = known.try_emplace({c.scene, c.sets()});
      Clock& clock = entry.first->second;
      if (entry.second) {
        const AnyScene any = in_file("grid.set", [&] { return make_any_scene(c.scene, c.sets()); });
        std::visit(
            [&](const auto& scene) {
              if (is_built_in(c.scene)) in_file("grid.set", [&] { return check_scene(scene), 0; });
              const auto columns = measures_of(scene);
              if (std::find(columns.begin(), columns.end(), c.measure) == columns.end())
                fail("measure", '"' + c.measure + '"', "the scene has no such column");
              clock = {.step = scene.step, .duration = scene.duration};
            },
            any);
      }
      c.step = clock.step;
      c.duration = grid.contains("duration")    ? number("grid.duration", grid["duration"], 1e-12, 1e9)
                   : root_.contains("duration") ? number("duration", root_["duration"], 1e-12, 1e9)
                                                : clock.duration;
    }
  }

  void check(const std::vector<Case>& all) const {
    std::set<std::string> seen;
    for (const Case& c : all) {
      if (seen.insert("i" + c.integrator_spec()).second) check_integrator("grid.integrator", c.integrator_spec());
      if (seen.insert("s" + c.solver).second) in_file("grid.solver", [&] { return make_solver(c.solver); });
      if (c.reference == "exact") in_file("reference", [&] { return exact_measure(c); });
    }
  }

  std::filesystem::path file_;
  Json root_;
  Case common_;
  std::optional<ReferenceTable> table_;  // of reference values
};

}  // namespace

std::vector<Case> Sweep::reference_cases() const {
  std::map<std::string, Case> all;  // by key
  for (const Case& c : cases)
    if (const auto other = c.reference_case()) {
      Case& kept = all.try_emplace(other->key(), *other).first->second;
      kept.time_limit = std::max(kept.time_limit, other->time_limit);
    }
  std::vector<Case> list;
  for (auto& [key, c] : all) list.push_back(std::move(c));
  return list;
}

Sweep read_sweep(const std::filesystem::path& file, bool quick) {
  return in_a_line([&] { return Reader(file).read(quick); });
}

}  // namespace orthant
