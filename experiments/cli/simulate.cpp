// orthant simulate SCENE — one run: a trajectory as CSV, a summary for people or as JSON.
#include "experiments/cli/commands.h"

#include "experiments/runs/check.h"
#include "experiments/runs/checkpoint.h"
#include "experiments/runs/event_table.h"
#include "experiments/runs/manifest.h"
#include "experiments/runs/trajectory.h"
#include "experiments/runs/trajectory_files.h"
#include "experiments/runs/warnings.h"
#include "experiments/support/status_line.h"
#include "experiments/support/stop_signal.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/file.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/run_fields.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <optional>
#include <sstream>
#include <variant>

namespace orthant {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments {
  std::string scene, integrator = "moreau-jean", solver = "auto", rounded = "take", output, checkpoint, failed_steps;
  std::vector<std::string> sets;
  std::optional<double> step, duration, time_limit;
  long every = 1, checkpoint_every = 1000;
  int threads = 1;
  bool json = false, resume = false, check = false, reactions = false;
};

/// All that decides a run, in one text: a checkpoint of another is no place to go on from.
std::string label_of(const SimulateArguments& a) {
  std::string label = "revision " + manifest()["revision"].get<std::string>() + ", integrator " + a.integrator +
                      ", solver " + a.solver + ", scene " + a.scene;
  for (const std::string& set : a.sets) label += ", " + set;
  return is_built_in(a.scene) ? label : label + "\n" + read_scene_text(a.scene);
}

/// Why a checkpoint with the one label is no place for a run with the other to go on from.
std::string difference(const std::string& kept, const std::string& wanted) {
  const std::string was = kept.substr(0, kept.find('\n')), is = wanted.substr(0, wanted.find('\n'));
  return was == is ? "is of another content of the scene's file (" + is + "): must be of this one"
                   : "is of another run (" + was + "): must be of this one (" + is + ")";
}

/// What a run leaves: its records, the last of them, its events.
struct Kept {
  std::vector<std::string> columns;
  std::vector<double> table, last;
  std::vector<Event> events;
};

nlohmann::ordered_json summary(const Run& run, const Kept& kept) {
  nlohmann::ordered_json::object_t final;  // operator[] would compare each name with all before it
  for (std::size_t i = 0; i < kept.last.size(); ++i) final.emplace_back(kept.columns[i], kept.last[i]);
  nlohmann::ordered_json json = {{"status", name(run.status)}, {"why", run.why}, {"final", final}};
  if (run.why.empty()) json.erase("why");
  visit_fields(run, [&](const char* field, const char*, const char*, auto value) {
    if (static_cast<double>(value) != kInf) json[field] = value;
  });
  return json;
}

/// What repetitions say of the last state, see check.h: null for an error that nothing was compared for.
void add_check(const CheckedRun& checked, nlohmann::ordered_json& json) {
  nlohmann::ordered_json::object_t errors, digits;
  for (const CheckedColumn& c : checked.columns) {
    errors.emplace_back(c.name, c.error < kInf ? nlohmann::ordered_json(c.error) : nlohmann::ordered_json());
    digits.emplace_back(c.name, c.digits);
  }
  json["check_against"] = checked.against;
  if (!checked.left_out.empty()) json["check_left_out"] = checked.left_out;
  json["check_error"] = errors, json["check_digits"] = digits;
}

constexpr const char* kNowhere = "none";  // --failed-steps

/// Where the problem of a failed step goes: a name that is free, or a file that holds the same already.
fs::path failed_step_file(const SimulateArguments& arguments, long step, const std::string& content) {
  const fs::path folder = arguments.failed_steps.empty()
                              ? (arguments.output == "-" ? fs::path() : fs::path(arguments.output).parent_path())
                              : fs::path(arguments.failed_steps);
  const auto name_of = "failed_step_" + std::to_string(step);
  auto file = folder / (name_of + ".json");
  for (int k = 2; fs::exists(file) && read_whole(file) != content; ++k)
    file = folder / (name_of + "_" + std::to_string(k) + ".json");
  return file;
}

/// Says which step failed and why, and keeps its problem, where there is one.
template <class Integrator>
void report_failed_step(const SimulateArguments& arguments, const Integrator& integrator, const Run& run) {
  std::cerr << "orthant: step " << run.steps + 1 << " at t = " << run.final.t << " s failed: " << name(run.status);
  if (!run.why.empty()) std::cerr << ": " << run.why;
  if (run.status == Status::time_limit) {
    std::cerr << '\n';
    return;
  }
  if (integrator.problem().size() == 0) {
    std::cerr << (run.why.empty() ? " (the basic system could not be solved; there was no complementarity problem)\n"
                                  : "\n");
    return;
  }
  if (arguments.failed_steps == kNowhere) {
    std::cerr << '\n';
    return;
  }
  try {
    const std::string note =
        "scene " + arguments.scene + ", integrator " + arguments.integrator + ", solver " + arguments.solver;
    const std::string content = to_json(integrator.problem(), note);
    if (!arguments.failed_steps.empty()) fs::create_directories(arguments.failed_steps);
    const fs::path file = failed_step_file(arguments, run.steps + 1, content);
    write_whole(file, content);
    std::cerr << "; its problem is in " << file.string() << " (orthant solve replays it)\n";
  } catch (const std::exception& error) {  // the run's own result is not lost with it
    std::cerr << "; its problem could not be kept: " << error.what() << '\n';
  }
}

template <class Scene> void write_kept(const SimulateArguments& arguments, const Scene& scene, const Kept& kept) {
  if (arguments.output == "-")
    std::cout << to_csv(kept.columns, kept.table);
  else if (!arguments.output.empty())
    write_trajectory(arguments.output, scene, kept.columns, kept.table, kept.events);
}

void check_output(const SimulateArguments& arguments) {
  if (arguments.output.empty() || arguments.output == "-") return;
  check_trajectory_file(arguments.output);
  check_writable(arguments.output);
  if (!is_built_in(arguments.scene)) check_apart("--output", arguments.output, "the scene", arguments.scene);
}

/// Checkpoints of the run, and what an earlier one left in `kept`.
template <class Scene> Restart restart_of(const SimulateArguments& arguments, const Scene& scene, Kept& kept) {
  Restart restart;
  if (arguments.reactions && !arguments.checkpoint.empty())
    throw std::invalid_argument("--reactions: must be left out with --checkpoint: they need the record before");
  if (arguments.checkpoint.empty()) {
    if (arguments.resume) throw std::invalid_argument("--resume: needs --checkpoint FILE to continue from");
    return restart;
  }
  check_writable(arguments.checkpoint);
  if (!arguments.output.empty() && arguments.output != "-")
    check_apart("--checkpoint", arguments.checkpoint, "--output", arguments.output);
  check_takes_checkpoint(arguments.checkpoint);
  for (const fs::path& left : leftovers_beside(fs::weakly_canonical(fs::absolute(arguments.checkpoint))))
    fs::remove(left);
  const std::string label = label_of(arguments);
  restart.every = arguments.checkpoint_every;
  restart.save = [&, label](const std::string& bytes) {
    try {
      write_checkpoint(arguments.checkpoint, {label, kept.table, kept.last, kept.events, bytes});
    } catch (...) {  // ends the run; what is done is not lost with it
      write_kept(arguments, scene, kept);
      throw;
    }
  };
  if (arguments.resume && fs::exists(arguments.checkpoint)) {
    Checkpoint earlier = read_checkpoint(arguments.checkpoint);
    if (earlier.label != label)
      throw std::invalid_argument(arguments.checkpoint + ": " + difference(earlier.label, label));
    kept.table = std::move(earlier.table), kept.last = std::move(earlier.last);
    kept.events = std::move(earlier.events), restart.from = std::move(earlier.run);
  }
  return restart;
}

/// "t = 3.2 of 10 s, 14 s left, 120 events"; the time left by what the run has come since the first look.
class ProgressWords {
 public:
  ProgressWords(const Reached& reached, double duration) : reached_(reached), duration_(duration) {}
  std::string operator()(double seconds) {
    const double t = reached_.t.load(std::memory_order_relaxed);
    const long events = reached_.events.load(std::memory_order_relaxed);
    if (first_seconds_ < 0) first_seconds_ = seconds, first_t_ = t;
    std::ostringstream text;
    text.precision(4);
    text << "orthant: t = " << t << " of " << duration_ << " s, ";
    if (t > first_t_) text << std::ceil((seconds - first_seconds_) * (duration_ - t) / (t - first_t_)) << " s left, ";
    text << events << (events == 1 ? " event" : " events");
    return text.str();
  }

 private:
  const Reached& reached_;
  double duration_, first_seconds_ = -1, first_t_ = 0;
};

/// The run's own status, and 128 + N where signal N stopped it, as a shell says.
template <class Integrator>
int report_end(const SimulateArguments& arguments, const Integrator& integrator, const Run& run) {
  if (run.status == Status::cancelled && StopSignal::which() != 0) {
    std::cerr << "orthant: stopped by " << (StopSignal::which() == SIGINT ? "Ctrl-C" : "a signal")
              << " at t = " << run.final.t << " s, after " << run.steps << " steps";
    if (!arguments.output.empty())
      std::cerr << "; the trajectory up to there is in " << (arguments.output == "-" ? "the output" : arguments.output);
    if (!arguments.checkpoint.empty()) std::cerr << "; --resume continues from the last checkpoint";
    std::cerr << '\n';
    return 128 + StopSignal::which();
  }
  if (run.status != Status::solved) report_failed_step(arguments, integrator, run);
  return exit_code_of_run(run.status);
}

void print_summary(const SimulateArguments& arguments, const nlohmann::ordered_json& json) {
  std::ostream& out = arguments.output == "-" ? std::cerr : std::cout;
  if (arguments.json) {
    out << json.dump(2) << '\n';
    return;
  }
  for (const auto& [key, value] : json.items()) {
    if (!value.is_object()) {
      out << key << " = " << value << '\n';
      continue;
    }
    for (const auto& [column, number] : value.items()) out << key << "." << column << " = " << number << '\n';
  }
}

Clock clock_of(const SimulateArguments& arguments, double step, double duration, Reached& reached) {
  return {.step = arguments.step.value_or(step),
          .duration = arguments.duration.value_or(duration),
          .every = arguments.every,
          .time_limit = arguments.time_limit.value_or(kInf),
          .cancel = StopSignal::flag(),
          .rounded = arguments.rounded == kRoundedNames[1] ? Rounded::stop : Rounded::take,
          .reached = &reached};
}

template <class Space> int run_system(const SimulateArguments& arguments, const SystemOf<Space>& system) {
  const auto integrator = make_integrator(arguments.integrator, system);
  const auto solver = make_solver(arguments.solver);
  std::vector<std::unique_ptr<Solver>> helpers;
  for (int i = 1; i < arguments.threads; ++i) helpers.push_back(make_solver(arguments.solver));
  integrator->employ(std::move(helpers));
  const auto& scene = system.scene();
  Reached reached;
  const Clock clock = clock_of(arguments, scene.step, scene.duration, reached);
  check_output(arguments);
  std::vector<std::string> warnings;
  for (const Remark& remark : remarks_on_start(system)) {
    std::cerr << "orthant: " << (remark.warning ? "warning: " : "note: ") << remark.words << '\n';
    if (remark.warning) warnings.push_back(remark.words);
  }

  Kept kept{trajectory_columns(scene), {}, {}, {}};
  std::conditional_t<kPlanar<Space>, std::monostate, std::optional<JointCoordinates>> coordinates;
  const Restart restart = restart_of(arguments, scene, kept);
  if constexpr (!kPlanar<Space>) coordinates.emplace(system);
  std::optional<ReactionsOf<Space>> reactions;
  if (arguments.reactions) {
    reactions.emplace(system);
    for (std::string& column : reaction_columns(scene)) kept.columns.push_back(std::move(column));
  }
  const auto record = [&](const RunSampleOf<Space>& moment) {
    if (!arguments.output.empty() || arguments.json) append_events(system, moment.events, kept.events);
    kept.last.clear();
    append_row(system, moment, kept.last);
    if (reactions) append_reactions(*reactions, moment, kept.last);
    if (!arguments.output.empty()) kept.table.insert(kept.table.end(), kept.last.begin(), kept.last.end());
    if constexpr (!kPlanar<Space>)
      for (const double value : coordinates->at(moment.state)) kept.last.push_back(value);
  };
  const StopSignal stop;
  StatusLine line(ProgressWords(reached, clock.duration));
  const Run run = simulate(*integrator, *solver, clock, record, restart);
  line.end();
  write_kept(arguments, scene, kept);
  for (const std::string& warning : warnings_of(system, run, arguments.integrator, clock.step)) {
    std::cerr << "orthant: warning: " << warning << '\n';
    warnings.push_back(warning);
  }
  const int exit_code = report_end(arguments, *integrator, run);

  if constexpr (!kPlanar<Space>)
    kept.columns.insert(kept.columns.end(), coordinates->names().begin(), coordinates->names().end());
  auto json = summary(run, kept);
  if (arguments.check && run.status == Status::solved)
    add_check(check_run(system, arguments.integrator, arguments.solver, clock, run), json);
  if (arguments.json) {
    json["warnings"] = warnings;
    json["event_table"] = events_to_json(scene, kept.events);
  }
  print_summary(arguments, json);
  return exit_code;
}

int run_simulate(SimulateArguments arguments) {
  for (const std::string& set : arguments.sets)
    if (set.find('=') == std::string::npos)
      throw std::invalid_argument("--set '" + set + "': must have the form KEY=VALUE");
  return std::visit([&arguments](const auto& system) { return run_system(arguments, system); },
                    make_any_system(arguments.scene, arguments.sets));
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = app.add_subcommand("simulate", "Run a scene: a built-in name or a TOML file");
  command->add_option("scene", arguments->scene, "built-in scene (see `orthant list scenes`) or TOML file")->required();
  command->add_option("--integrator", arguments->integrator, "NAME[:option=value,...]")->capture_default_str();
  add_run_options(*command, *arguments);
  command
      ->add_option("--output", arguments->output,
                   "trajectory: .csv, .h5 (HDF5), .pvd (VTK, for ParaView), or - (CSV to "
                   "standard output, summary to standard error); events: NAME.events.csv, or in the HDF5 file")
      ->check(not_empty());
  command->add_option("--every", arguments->every, "record every so many steps")
      ->check(CLI::Range(1L, 1'000'000'000'000'000L))
      ->capture_default_str();
  command->add_option("--checkpoint", arguments->checkpoint, "file for the state of the run, written periodically")
      ->check(not_empty());
  command->add_option("--checkpoint-every", arguments->checkpoint_every, "how often: steps between two")
      ->check(CLI::Range(1, 1000000000))
      ->capture_default_str();
  command->add_flag("--resume", arguments->resume,
                    "continue from the checkpoint, if it exists, with the bits of the run that wrote it");
  command
      ->add_option("--rounded", arguments->rounded,
                   "a step with a problem that is rounded only: take (and count it), or stop before it")
      ->check(CLI::IsMember({std::string(kRoundedNames[0]), std::string(kRoundedNames[1])}))
      ->capture_default_str();
  add_time_limit(*command, arguments->time_limit, "of the run [s of wall time]; the finished part is kept");
  command
      ->add_option("--threads", arguments->threads, "to solve large islands at the same time; no result depends on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_flag("--reactions", arguments->reactions,
                    "the joints' reaction forces, too: JOINT.force_x [N] … JOINT.moment [N m], means between records");
  command->add_flag("--check", arguments->check,
                    "repeat the run with a tighter tolerance, or smaller steps, and report how many digits agree");
  command
      ->add_option("--failed-steps", arguments->failed_steps,
                   "folder for the problem of a failed step, or none; default: the output's folder")
      ->check(not_empty());
  command->add_flag("--json", arguments->json, "summary, warnings and events as one JSON object");
  command->footer(
      "Exit codes: 0 solved to the end, 1 bad input, 2 a step was proved infeasible, 3 a step was not solved,\n"
      "130 stopped by Ctrl-C, 143 by SIGTERM: the finished part is kept.\n"
      "Examples:\n"
      "  orthant simulate slider_crank --set mu=0.1 --step 1e-5 --output run.csv\n"
      "  orthant simulate mine.toml --integrator adaptive:rtol=1e-6 --step 1e-2 --output run.pvd\n"
      "  orthant simulate mine.toml --set contact.floor.mu=0.3 --json");
  command->callback([arguments, &exit_code] { exit_code = run_simulate(*arguments); });
}

}  // namespace orthant
