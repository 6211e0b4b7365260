// orthant view — one run as one HTML page: of a scene, which is run, or of a trajectory file.
#include "experiments/cli/commands.h"

#include "experiments/report/view.h"
#include "experiments/runs/drawing.h"
#include "experiments/runs/event_table.h"
#include "experiments/runs/trajectory.h"
#include "experiments/support/page_server.h"
#include "experiments/support/printable.h"
#include "experiments/support/status_line.h"
#include "experiments/support/stop_signal.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/file.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>
#include <variant>

namespace orthant {
namespace {

constexpr double kRecords = 4000;  // of a run that is made for a view; a page has at most 1200 frames

constexpr const char *kPlanarIntegrator = "adaptive", *kSpatialIntegrator = "moreau-jean";

struct ViewArguments {
  std::string input, scene, integrator, solver = "auto", output;
  std::vector<std::string> sets;
  std::optional<double> step, duration, time_limit;
  std::optional<int> serve;
  bool json = false;
};

struct Viewed {
  nlohmann::ordered_json data;
  Status status = Status::solved;
};

std::string name_of(const ViewArguments& a) { return printable(std::filesystem::path(a.input).stem().string()); }

std::string words_of(const ViewArguments& a, const Run& run, double step) {
  std::ostringstream text;
  text.precision(4);
  text << a.integrator << ", solver " << a.solver << ", step " << step << " s: " << name(run.status);
  if (!run.why.empty()) text << ": " << run.why;
  for (const std::string& set : a.sets) text << "; " << set;
  return text.str();
}

template <class Space> Viewed of_system(const ViewArguments& a, const SystemOf<Space>& system) {
  const auto& scene = system.scene();
  const auto integrator = make_integrator(a.integrator, system);
  const auto solver = make_solver(a.solver);
  Clock clock{.step = a.step.value_or(scene.step),
              .duration = a.duration.value_or(scene.duration),
              .time_limit = a.time_limit.value_or(kInf),
              .cancel = StopSignal::flag()};
  std::conditional_t<kPlanar<Space>, std::optional<PushLog>, std::monostate> pushes;
  bool pushing = false;  // each step is recorded then
  if constexpr (kPlanar<Space>) pushes.emplace(system), pushing = PushLog::wanted(system, clock);
  if (!pushing) clock.every = std::max(1L, std::lround(clock.duration / clock.step / kRecords));
  RecordedRun record{trajectory_columns(scene), {}, {}, {}, {}};
  std::vector<Event> events;
  const StopSignal stop;
  Run run;
  with_elapsed_line("view", [&] {
    run = simulate(*integrator, *solver, clock, [&](const RunSampleOf<Space>& moment) {
      append_row(system, moment, record.table);
      append_events(system, moment.events, events);
      if constexpr (kPlanar<Space>)
        if (pushing) pushes->add(moment);
    });
  });
  if constexpr (kPlanar<Space>) record.pushes = pushes->pushes();
  const auto names = event_contacts(scene);
  for (const Event& e : events)
    record.events.push_back({e.t, std::string(kEventNames[static_cast<std::size_t>(e.kind)]),
                             names[static_cast<std::size_t>(e.contact)], e.normal, e.tangent});
  return {view_data(name_of(a), words_of(a, run, clock.step), record, drawing(scene)), run.status};
}

Viewed of_scene(ViewArguments a) {
  const AnySystem any = make_any_system(a.input, a.sets);
  if (a.integrator.empty()) a.integrator = std::holds_alternative<System>(any) ? kPlanarIntegrator : kSpatialIntegrator;
  return std::visit([&a](const auto& system) { return of_system(a, system); }, any);
}

/// The drawing of --scene, which must have the run's columns.
nlohmann::ordered_json drawing_of_scene(const ViewArguments& a, const RecordedRun& run) {
  return std::visit(
      [&](const auto& scene) {
        auto expected = trajectory_columns(scene), columns = run.columns;
        if (columns.size() > expected.size())  // a run with --reactions
          for (std::string& column : reaction_columns(scene)) expected.push_back(std::move(column));
        std::sort(expected.begin(), expected.end()), std::sort(columns.begin(), columns.end());
        if (columns != expected)
          throw std::invalid_argument("--scene '" + a.scene + "': must be the scene that " + a.input +
                                      " is a run of: it has other columns");
        return drawing(scene);
      },
      make_any_scene(a.scene, a.sets));
}

/// In words, which numbers of the run are NaN or infinite; empty: none.
std::string not_finite(const RecordedRun& run) {
  std::size_t count = 0, first = 0;
  for (std::size_t i = 0; i < run.table.size(); ++i)
    if (!std::isfinite(run.table[i])) {
      const bool gap = run.columns[i % run.columns.size()].ends_with(".gap");  // infinite where no pair is near
      if (gap && !std::isnan(run.table[i])) continue;
      if (count++ == 0) first = i;
    }
  if (count == 0) return {};
  return std::to_string(count) + (count == 1 ? " number is" : " numbers are") + " NaN or infinite, the first " +
         run.columns[first % run.columns.size()] + " in row " + std::to_string(first / run.columns.size() + 1) +
         ": plots have gaps there, bodies are not drawn";
}

Viewed of_file(const ViewArguments& a) {
  const RecordedRun run = read_run(a.input);
  const std::string wrong = not_finite(run);
  if (!wrong.empty()) std::cerr << "orthant: warning: " << printable(a.input) << ": " << wrong << '\n';
  nlohmann::ordered_json shown;
  if (!a.scene.empty())
    shown = drawing_of_scene(a, run);
  else if (run.drawing.empty())
    std::cerr << "orthant: note: a CSV file holds no drawing: bodies are shown as points. --scene SCENE draws them\n";
  return {view_data(name_of(a), "recorded in " + printable(a.input) + (wrong.empty() ? "" : "; " + wrong), run, shown)};
}

bool is_view(const std::string& file) {
  constexpr std::size_t kHead = 4096;  // [bytes]
  std::string head(kHead, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), kHead);
  return head.find(kViewMark) != std::string::npos;
}

/// The page of a run by default, where no other file has that name.
std::string output_of(const ViewArguments& a) {
  if (!a.output.empty()) return a.output;
  const std::string file = std::filesystem::path(a.input).stem().string() + ".html";
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error) && !is_view(file))
    throw std::invalid_argument(file +
                                ": exists, and is no page of orthant view: must be named by --output to be replaced");
  return file;
}

int run_view(const ViewArguments& a) {
  const bool recorded = is_recorded_run(a.input);
  if (!recorded && !a.scene.empty())
    throw std::invalid_argument("--scene: is for trajectory files; '" + a.input + "' is a scene itself");
  const std::string output = output_of(a);
  const bool writes = !a.serve || !a.output.empty();
  if (writes) {
    if (recorded || !is_built_in(a.input)) check_apart("--output", output, "the input", a.input);
    check_writable(output);
  }
  const Viewed viewed = recorded ? of_file(a) : of_scene(a);
  const std::string page = view_page(viewed.data);
  if (writes) {
    write_whole(output, page);
    if (a.json)
      std::cout << nlohmann::json{{"view", output}, {"bytes", page.size()}, {"status", name(viewed.status)}}.dump()
                << '\n';
    else
      std::cout << "view: " << output << '\n';
  }
  if (a.serve) serve_page(page, *a.serve);
  return exit_code_of_run(viewed.status);
}

}  // namespace

void add_view(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand("view", "One run as one HTML page: motion, forces, columns, events");
  command->add_option("input", arguments->input, "scene (built-in or TOML), or a trajectory: .csv, .h5")->required();
  command
      ->add_option("--output", arguments->output,
                   "the page; default: the input's name with .html, which replaces an earlier page only")
      ->check(not_empty());
  command->add_option("--scene", arguments->scene, "of a trajectory in CSV: the scene, for its drawing");
  command
      ->add_option("--serve", arguments->serve,
                   "show the page at http://127.0.0.1:PORT until Ctrl-C, without writing a file; 0: any free port")
      ->check(CLI::Range(0, 65535));
  command
      ->add_option("--integrator", arguments->integrator,
                   "NAME[:option=value,...]; in space the default is moreau-jean")
      ->default_str(kPlanarIntegrator);
  add_run_options(*command, *arguments);
  add_time_limit(*command, arguments->time_limit, "of the run [s of wall time]; the finished part is shown");
  command->add_flag("--json", arguments->json, "where the page is, as one JSON object");
  command->footer(
      "Exit codes: 0 done, 1 bad input, 2 a step was proved infeasible, 3 a step was not solved: the page shows the\n"
      "run up to there.\n"
      "Examples:\n"
      "  orthant view slider_crank --set mu=0.1\n"
      "  orthant view run.csv --scene mine.toml --output run.html\n"
      "  orthant view run.h5 --serve 8000");
  command->callback([arguments, &exit_code] { exit_code = run_view(*arguments); });
}

}  // namespace orthant
