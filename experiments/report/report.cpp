#include "experiments/report/report.h"

#include "experiments/report/parts.h"
#include "experiments/runs/drawing.h"
#include "experiments/runs/event_table.h"
#include "experiments/runs/trajectory.h"
#include "experiments/sweep/analysis.h"
#include "experiments/sweep/page.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <cmath>
#include <variant>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFrames = 1000;
constexpr std::size_t kMostEvents = 2000;  // of a film's table: 100 kB
constexpr double kPatience = 900;  // [s] for all films of a report, which take seconds; past it a film ends early

double rounded(double x) { return std::round(x * 1e7) / 1e7; }  // enough for a drawing

template <class S> using SpaceOfScene = std::conditional_t<std::is_same_v<S, Scene>, Planar, Spatial>;

/// After t of a frame: x, y, θ of each body, then gap and normal impulse (since the frame before) of each contact.
void append_frame(const System&, const RunSample& moment, Json& frame) {
  for (const double q : moment.state.q) frame.push_back(rounded(q));
  for (std::size_t i = 0; i < moment.impulses.size(); ++i)
    frame.push_back(rounded(moment.gaps[static_cast<Index>(i)])), frame.push_back(rounded(moment.impulses[i].normal));
}

/// In space x, y, z and quaternion of each body, then gap and three impulses: columns of a trajectory.
void append_frame(const SystemOf<Spatial>& system, const RunSampleOf<Spatial>& moment, Json& frame) {
  std::vector<double> row;
  append_row(system, moment, row);
  const auto contacts = row.begin() + 1 + 13 * system.bodies();
  for (auto body = row.begin() + 1; body < contacts; body += 13)
    for (auto q = body; q < body + 7; ++q) frame.push_back(rounded(*q));
  for (auto x = contacts; x < contacts + 4 * system.listed(); ++x) frame.push_back(rounded(*x));  // no searched pairs
}

/// One run by frames; its events: t, kind, contact by number, impulses.
template <class Space> Json film(const SystemOf<Space>& system, const Json& run, double duration, double& patience) {
  const double step = run.contains("step") ? run.at("step").get<double>() : duration / kFrames;
  const auto integrator = make_integrator(run.at("integrator").get<std::string>(), system);
  const auto solver = make_solver(run.value("solver", "auto"));
  const double aim = duration / kFrames;
  Json frames = Json::array(), events = Json::array();
  std::vector<Event> located;
  const Clock clock{.step = step,
                    .duration = duration,
                    .every = std::max(1L, std::lround(aim / step)),
                    .time_limit = std::max(patience, 1e-3)};
  const Run result = simulate(*integrator, *solver, clock, [&](const RunSampleOf<Space>& moment) {
    Json frame = {rounded(moment.state.t)};
    append_frame(system, moment, frame);
    frames.push_back(frame);
    append_events(system, moment.events, located);
  });
  for (const Event& event : located) {
    if (events.size() == kMostEvents) break;
    const auto kind = kEventNames[static_cast<std::size_t>(event.kind)];
    events.push_back({event.t, kind, event.contact, event.normal, event.tangent});
  }
  patience -= result.seconds;
  return {{"label", run.value("label", run.at("integrator").get<std::string>())},
          {"status", name(result.status)},
          {"frames", frames},
          {"events", events},
          {"event_count", located.size()}};
}

/// Opens no file: a results file may be a stranger's.
AnyScene scene_of(const Json& about, const std::vector<std::string>& sets) {
  const auto scene = about.at("scene").get<std::string>();
  if (about.contains("scene_text")) return parse_any_scene(about.at("scene_text").get<std::string>(), sets, scene);
  if (!is_built_in(scene))
    throw std::invalid_argument("the results file names the scene '" + scene +
                                "' without its text: let orthant sweep write to it again");
  return make_any_scene(scene, sets);
}

Json animation(const Json& wanted, const Json& about, double& patience) {
  Json shown = wanted;
  shown["films"] = Json::array();
  for (const Json& run : wanted.at("runs")) {
    Json set =
        wanted.value("set", Json::object());  // what all films of an animation have, then what one has of its own
    set.update(run.value("set", Json::object()));
    std::visit(
        [&]<class Scene>(const Scene& scene) {
          const SystemOf<SpaceOfScene<Scene>> system(scene);
          shown["scene"] = drawing(system.scene());
          shown["films"].push_back(film(system, run, wanted.value("duration", system.scene().duration), patience));
        },
        scene_of(about, sets_of(set)));
  }
  return shown;
}

Json by_column(const std::vector<ResultRow>& rows) {
  Json columns = Json::object();
  for (const char* name : columns_of_figures()) {
    Json& column = columns[name] = Json::array();
    for (const ResultRow& row : rows) column.push_back(row.at(name));
  }
  return columns;
}

}  // namespace

Json report_data(const Results& results) {
  Json data = Json::object();
  double patience = kPatience;
  for (const auto& [name, about] : results.sweeps()) {
    const auto rows = results.rows(name);
    for (const auto& [key, value] : about.items())
      if (key != "page" && key != "question" && key != "scene" && key != "scene_text") data[key] = value;
    check_animations(about.at("page").at("animation"),
                     [&about = about](const std::vector<std::string>& sets) { return scene_of(about, sets); });
    Json animations = Json::array();
    for (const Json& wanted : about.at("page").at("animation"))
      animations.push_back(animation(wanted, about, patience));
    data["sweeps"].push_back({{"name", name},
                              {"question", about.at("question")},
                              {"answer", answer(rows)},
                              {"asked", results.members(name)},
                              {"rows", by_column(rows)},
                              {"orders", fitted_orders(rows)},
                              {"targets", error_targets()},
                              {"times", time_to_error(rows)},
                              {"figures", about.at("page").at("figure")},
                              {"animations", animations}});
  }
  if (!data.contains("sweeps")) throw std::invalid_argument("the results file holds no sweep");
  return data;
}

std::string page(const Json& data) {
  bool in_space = false;
  for (const Json& sweep : data.at("sweeps"))
    for (const Json& animation : sweep.at("animations"))
      if (animation.contains("scene") && animation.at("scene").value("dimension", 2) == 3) in_space = true;
  return assembled("page.html", data, in_space);
}

}  // namespace orthant
