// orthant simulate SCENE — one run: a trajectory as CSV, a summary for people or as JSON.
#include "commands.h"

#include "../support/checkpoint.h"
#include "../support/limits.h"
#include "../support/manifest.h"
#include "../support/trajectory.h"
#include "../support/trajectory_files.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/mechanics/dynamics/redundancy.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/file.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iostream>

namespace orthant {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments {
  std::string scene, integrator = "moreau-jean", solver = "lemke", output, checkpoint;
  std::vector<std::string> sets;
  std::optional<double> step, duration, time_limit;
  long every = 1, checkpoint_every = 1000;
  int threads = 1;
  bool json = false, resume = false;
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

nlohmann::ordered_json summary(const Run& run, const std::vector<std::string>& columns,
                               const std::vector<double>& last) {
  nlohmann::ordered_json::object_t final;  // operator[] would compare each name with all before it
  for (std::size_t i = 0; i < columns.size(); ++i) final.emplace_back(columns[i], last[i]);
  nlohmann::ordered_json json = {{"status", name(run.status)},
                                 {"why", run.why},
                                 {"final", final},
                                 {"steps", run.steps},
                                 {"seconds", run.seconds},
                                 {"energy_initial", run.energy_initial},
                                 {"energy_final", run.energy_final},
                                 {"max_joint_residual", run.max_joint_residual},
                                 {"max_joint_rate", run.max_joint_rate},
                                 {"max_penetration", run.max_penetration},
                                 {"max_lcp_residual", run.max_lcp_residual},
                                 {"accepted", run.accepted},
                                 {"rejected", run.rejected},
                                 {"events", run.events},
                                 {"crossings", run.crossings},
                                 {"energy_rises", run.energy_rises},
                                 {"max_energy_rise", run.max_energy_rise},
                                 {"passages", run.passages},
                                 {"lcp_solves", run.lcp_solves},
                                 {"lcp_iterations", run.lcp_iterations}};
  if (run.why.empty()) json.erase("why");
  return json;
}

/// The problem that stopped the run, beside the output file (or here); its name is told.
void dump_failed_step(const SimulateArguments& arguments, const Integrator& integrator, const Run& run) {
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
  const auto folder = fs::path(arguments.output).parent_path();
  const auto name_of = "failed_step_" + std::to_string(run.steps + 1);
  auto file = folder / (name_of + ".json");
  for (int k = 2; fs::exists(file); ++k) file = folder / (name_of + "_" + std::to_string(k) + ".json");
  try {
    write_problem(file, integrator.problem(),
                  "scene " + arguments.scene + ", integrator " + arguments.integrator + ", solver " + arguments.solver);
    std::cerr << "; its problem is in " << file.string() << " (orthant solve replays it)\n";
  } catch (const std::exception& error) {  // the run's own result is not lost with it
    std::cerr << "; its problem could not be kept: " << error.what() << '\n';
  }
}

bool along_an_angle(const Contact& contact) {
  const auto* limit = std::get_if<Limit>(&contact);
  return limit != nullptr && std::holds_alternative<Angle>(limit->of.kind());
}

/// A start that breaks the scene's own constraints is run all the same, but not without a word.
void warn_of_start(const System& system) {
  constexpr double kSmall = 1e-6;  // [m, rad], [m/s, rad/s]: what a scene file's digits may leave
  const State x = system.initial_state();
  Terms terms(system);
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_residual(system, terms);
  evaluate_joint_rows(system, terms);
  BroadPhase(system).find(Eigen::VectorXd::Zero(system.dof()), terms);
  evaluate_gaps(system, terms);
  double rate = 0;
  for (Index i = 0; i < terms.phi.size(); ++i) rate = std::max(rate, std::abs(terms.missing_rate(i, x.v)));
  const auto warn = [](const char* what, double size, const char* unit, const char* then) {
    std::cerr << "orthant: warning: at the start " << what << " by " << size << " " << unit << ": " << then << '\n';
  };
  if (const double off = terms.phi.size() > 0 ? terms.phi.lpNorm<Eigen::Infinity>() : 0; off > kSmall)
    warn("joints are off", off, "m or rad", "the bodies are moved onto them, but where joints=none");
  if (rate > kSmall * (1 + x.v.lpNorm<Eigen::Infinity>()))
    warn("velocities break joints", rate, "m/s or rad/s", "they are changed to keep them");
  Index deepest = 0;
  if (const double deep = terms.gap.size() > 0 ? -terms.gap.minCoeff(&deepest) : 0; deep > kSmall) {
    const bool listed = deepest < system.listed();
    const bool turns = listed && along_an_angle(system.scene().contacts[static_cast<std::size_t>(deepest)]);
    warn("contacts penetrate", deep, turns ? "rad" : "m",
         "moreau-jean leaves it, paoli-schatzman throws them apart, the others differ");
  }
  constexpr int kMostRows = 600;  // more would take longer than a word is worth
  if (system.joint_rows() > kMostRows) return;
  if (const std::string words = describe(find_redundancy(system, x.q), system); !words.empty())
    std::cerr << "orthant: note: at the start " << words << '\n';
}

void warn_of_energy(const Scene& scene, const Run& run) {
  if (run.energy_rises == 0) return;
  std::cerr << "orthant: warning: impacts raised the energy in " << run.energy_rises
            << (run.energy_rises == 1 ? " step" : " steps") << ", at most by " << run.max_energy_rise
            << " J at t = " << run.max_rise_time << " s: "
            << (scene.restitution == Restitution::newton
                    ? "Newton's law with friction or several e can; restitution = \"poisson\" is safer there"
                    : "friction with tangential restitution or several e can")
            << "; so can steps in which bodies move as far as they are wide\n";
}

void warn_of_passages(const Scene& scene, const Run& run) {
  if (run.passages == 0) return;
  const auto name = [&](BodyId body) {
    return body < 0 ? "the ground" : "\"" + scene.bodies[static_cast<std::size_t>(body)].name + "\"";
  };
  const Passage& first = run.first_passage;
  std::cerr << "orthant: warning: bodies passed through each other, unseen, in " << run.passages
            << (run.passages == 1 ? " step" : " steps") << ": first " << name(first.body) << " and "
            << name(first.other) << " at t = " << run.first_passage_time << " s, where the one moved " << first.moved
            << " m in a step and the thinner is " << first.width << " m wide: a smaller step sees them\n";
}

int run_simulate(const SimulateArguments& arguments) {
  for (const std::string& set : arguments.sets)
    if (set.find('=') == std::string::npos)
      throw std::invalid_argument("--set '" + set + "': must have the form KEY=VALUE");
  const System system(make_scene(arguments.scene, arguments.sets));
  const auto integrator = make_integrator(arguments.integrator, system);
  const auto solver = make_solver(arguments.solver);
  std::vector<std::unique_ptr<Solver>> helpers;
  for (int i = 1; i < arguments.threads; ++i) helpers.push_back(make_solver(arguments.solver));
  integrator->employ(std::move(helpers));
  const Scene& scene = system.scene();
  const Clock clock{.step = arguments.step.value_or(scene.step),
                    .duration = arguments.duration.value_or(scene.duration),
                    .every = arguments.every,
                    .time_limit = arguments.time_limit.value_or(kInf)};
  if (!arguments.output.empty()) {
    check_trajectory_file(arguments.output), check_writable(arguments.output);
    if (!is_built_in(arguments.scene)) check_apart("--output", arguments.output, "the scene", arguments.scene);
  }

  warn_of_start(system);
  const auto columns = trajectory_columns(scene);
  std::vector<double> table, last;
  Restart restart;
  if (!arguments.checkpoint.empty()) {
    check_writable(arguments.checkpoint);
    if (!arguments.output.empty()) check_apart("--checkpoint", arguments.checkpoint, "--output", arguments.output);
    check_takes_checkpoint(arguments.checkpoint);
    for (const fs::path& left : leftovers_beside(fs::weakly_canonical(fs::absolute(arguments.checkpoint))))
      fs::remove(left);
    const std::string label = label_of(arguments);
    restart.every = arguments.checkpoint_every;
    restart.save = [&, label](const std::string& bytes) {
      try {
        write_checkpoint(arguments.checkpoint, {label, table, last, bytes});
      } catch (...) {  // ends the run; what is done is not lost with it
        if (!arguments.output.empty()) write_trajectory(arguments.output, scene, columns, table);
        throw;
      }
    };
    if (arguments.resume && fs::exists(arguments.checkpoint)) {
      Checkpoint kept = read_checkpoint(arguments.checkpoint);
      if (kept.label != label) throw std::invalid_argument(arguments.checkpoint + ": " + difference(kept.label, label));
      table = std::move(kept.table), last = std::move(kept.last), restart.from = std::move(kept.run);
    }
  } else if (arguments.resume) {
    throw std::invalid_argument("--resume: needs --checkpoint FILE, to go on from");
  }
  const auto record = [&](const Moment& moment) {
    if (!arguments.output.empty()) append_row(system, moment, table);
    last.clear();
    append_row(system, moment, last);
  };
  const Run run = simulate(*integrator, *solver, clock, record, restart);
  if (!arguments.output.empty()) write_trajectory(arguments.output, scene, columns, table);
  warn_of_energy(scene, run);
  warn_of_passages(scene, run);
  for (const std::string& limit : limits_entered(system, run, arguments.integrator, clock.step))
    std::cerr << "orthant: warning: " << limit << '\n';
  if (run.status != Status::solved) dump_failed_step(arguments, *integrator, run);

  const auto json = summary(run, columns, last);
  if (arguments.json) {
    std::cout << json.dump(2) << '\n';
  } else {
    for (const auto& [key, value] : json.items()) {
      if (!value.is_object()) {
        std::cout << key << " = " << value << '\n';
        continue;
      }
      for (const auto& [column, number] : value.items()) std::cout << key << "." << column << " = " << number << '\n';
    }
  }
  return exit_code_of(run.status);
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = app.add_subcommand("simulate", "Run a scene: a built-in name or a TOML file");
  command->add_option("scene", arguments->scene, "built-in scene (see `orthant list scenes`) or TOML file")->required();
  command->add_option("--integrator", arguments->integrator, "NAME[:option=value,...]")->capture_default_str();
  command->add_option("--solver", arguments->solver, "NAME[:option=value,...]")->capture_default_str();
  const CLI::Validator given([](const std::string& text) { return text.empty() ? "must not be empty" : ""; }, "");
  command->add_option("--step", arguments->step, "step size h [s]; default: the scene's")->check(given);
  command->add_option("--duration", arguments->duration, "time to simulate [s]; default: the scene's")->check(given);
  command->add_option("--set", arguments->sets, "KEY=VALUE: a scene parameter; may be repeated with other keys")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--output", arguments->output, "trajectory: .csv, .h5 (HDF5), or .pvd (VTK, for ParaView)")
      ->check(given);
  command->add_option("--every", arguments->every, "record every so many steps")
      ->check(CLI::Range(1L, 1'000'000'000'000'000L))
      ->capture_default_str();
  command->add_option("--checkpoint", arguments->checkpoint, "a file to go on from after a kill, written now and then")
      ->check(given);
  command->add_option("--checkpoint-every", arguments->checkpoint_every, "how often: steps between two")
      ->check(CLI::Range(1, 1000000000))
      ->capture_default_str();
  command->add_flag("--resume", arguments->resume,
                    "go on from the checkpoint, if there is one; to the bits of an unbroken run");
  add_time_limit(*command, arguments->time_limit, "of the run [s of wall time]; what is done by then is kept");
  command
      ->add_option("--threads", arguments->threads, "to solve large islands at the same time; no result depends on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "summary as one JSON object");
  command->footer(
      "Exit codes: 0 solved to the end, 1 bad input, 2 a step was proved infeasible, 3 a step was not solved.\n"
      "Examples:\n"
      "  orthant simulate slider_crank --set mu=0.1 --step 1e-5 --output run.csv\n"
      "  orthant simulate mine.toml --integrator adaptive:rtol=1e-6 --step 1e-2 --output run.pvd\n"
      "  orthant simulate mine.toml --set contact.floor.mu=0.3 --json");
  command->callback([arguments, &exit_code] { exit_code = run_simulate(*arguments); });
}

}  // namespace orthant
