#include "report.h"

#include "experiments/support/event_table.h"
#include "experiments/support/outlines.h"
#include "experiments/sweep/analysis.h"
#include "experiments/sweep/page.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFrames = 1000;
constexpr std::size_t kMostEvents = 2000;  // of a film's table: 100 kB
constexpr double kPatience = 900;  // [s] for all films of a report, which take seconds; past it a film ends early

double rounded(double x) { return std::round(x * 1e7) / 1e7; }  // enough for a drawing

Json pair(const Vector2d& p) { return {p.x(), p.y()}; }

/// What there is to draw of a scene: the bodies' outlines, pins, contacts with walls, names of what events are of.
Json drawing(const Scene& scene) {
  Json bodies = Json::array(), shapes = Json::array(), contacts = Json::array(), pins = Json::array();
  for (const Body& body : scene.bodies) bodies.push_back({{"name", body.name}});
  for (const Outline& outline : outlines(scene)) {
    Json points = Json::array();
    for (const Vector2d& corner : outline.corners) points.push_back({rounded(corner.x()), rounded(corner.y())});
    shapes.push_back({{"body", outline.body}, {"closed", outline.closed}, {"wall", outline.wall}, {"points", points}});
  }
  for (const Joint& joint : scene.joints)
    if (const auto* pin = std::get_if<Revolute>(&joint))
      pins.push_back({{"a", pin->a}, {"point_a", pair(pin->point_a)}, {"body", pin->b}, {"point", pair(pin->point_b)}});
  for (const Contact& contact : scene.contacts) {
    Json one = {{"name", std::visit([](const auto& c) { return c.name; }, contact)}};
    const auto wall = [&](const auto& c, const Vector2d& point) {
      one.update({{"body", c.a},
                  {"point", pair(point)},
                  {"wall", pair(c.wall_point)},
                  {"normal", pair(c.normal)},
                  {"ground", c.b == kGround}});
    };
    if (const auto* corner = std::get_if<CornerWall>(&contact))
      wall(*corner, corner->point);
    else if (const auto* round = std::get_if<DiscWall>(&contact))
      wall(*round, round->centre);
    contacts.push_back(one);
  }
  return {{"bodies", bodies},
          {"outlines", shapes},
          {"pins", pins},
          {"contacts", contacts},
          {"event_contacts", event_contacts(scene)}};
}

/// One run, by frames: t, then x, y, θ of each body, then gap and normal impulse (since the frame before) of each
/// contact;
/// its events: t, kind, contact by number, impulses.
Json film(const System& system, const Json& run, double duration, double& patience) {
  const double step = run.contains("step") ? run.at("step").get<double>() : duration / kFrames;
  const auto integrator = make_integrator(run.at("integrator").get<std::string>(), system);
  const auto solver = make_solver(run.value("solver", "lemke"));
  const double aim = duration / kFrames;
  Json frames = Json::array(), events = Json::array();
  std::vector<Event> located;
  const Clock clock{.step = step,
                    .duration = duration,
                    .every = std::max(1L, std::lround(aim / step)),
                    .time_limit = std::max(patience, 1e-3)};
  const Run result = simulate(*integrator, *solver, clock, [&](const Moment& moment) {
    Json frame = {rounded(moment.state.t)};
    for (const double q : moment.state.q) frame.push_back(rounded(q));
    for (std::size_t i = 0; i < moment.impulses.size(); ++i)
      frame.push_back(rounded(moment.gaps[static_cast<Index>(i)])), frame.push_back(rounded(moment.impulses[i].normal));
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
Scene scene_of(const Json& about, const std::vector<std::string>& sets) {
  const auto scene = about.at("scene").get<std::string>();
  if (about.contains("scene_text")) return parse_scene(about.at("scene_text").get<std::string>(), sets, scene);
  if (!is_built_in(scene))
    throw std::invalid_argument("the results file names the scene '" + scene +
                                "' without its text: let orthant sweep write to it again");
  return make_scene(scene, sets);
}

Json animation(const Json& wanted, const Json& about, double& patience) {
  Json shown = wanted;
  shown["films"] = Json::array();
  for (const Json& run : wanted.at("runs")) {
    Json set =
        wanted.value("set", Json::object());  // what all films of an animation have, then what one has of its own
    set.update(run.value("set", Json::object()));
    const System system(scene_of(about, sets_of(set)));
    shown["scene"] = drawing(system.scene());
    shown["films"].push_back(film(system, run, wanted.value("duration", system.scene().duration), patience));
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

/// Beside the program where it was installed, else in the source tree that it was built from.
std::filesystem::path folder_of_parts() {
  std::error_code error;
  const auto installed =
      std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "../share/orthant/report";
  return !error && std::filesystem::is_directory(installed, error) ? installed : std::filesystem::path(ORTHANT_REPORT);
}

std::string part(const std::string& name) { return read_whole(folder_of_parts() / name); }

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
  std::string html = part("page.html");
  const auto put = [&](const std::string& mark, const std::string& text) {
    const auto at = html.find(mark);
    if (at == std::string::npos) throw std::runtime_error("page.html has no place " + mark);
    html.replace(at, mark.size(), text);
  };
  std::string json = data.dump();
  for (std::size_t i = 0; (i = json.find('<', i)) != std::string::npos;)
    json.replace(i, 1, "\\u003c");  // no tag, no comment
  put("/*page.css*/", part("page.css"));
  put("/*uPlot.css*/", part("node_modules/uplot/dist/uPlot.min.css"));
  put("/*uPlot.js*/", part("node_modules/uplot/dist/uPlot.iife.min.js"));
  put("/*plots.js*/", part("plots.js"));
  put("/*animation.js*/", part("animation.js"));
  put("/*page.js*/", part("page.js"));
  put("/*data*/", json);  // last: nothing is looked for in it
  return html;
}

}  // namespace orthant
