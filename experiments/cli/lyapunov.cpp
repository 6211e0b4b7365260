// orthant lyapunov SCENE — Lyapunov exponents of a planar scene's motion by event-driven.
#include "experiments/cli/commands.h"

#include "experiments/runs/run_gradient.h"
#include "experiments/support/stop_signal.h"

#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <iomanip>
#include <iostream>

namespace orthant {
namespace {

struct LyapunovArguments {
  std::string scene, integrator = "event-driven", solver = "auto";
  std::vector<std::string> sets;
  LyapunovClock clock{.every = 0};  // 0: a hundredth of the duration
  std::optional<double> duration;
  bool json = false;
};

nlohmann::ordered_json listed(const Eigen::VectorXd& numbers) {
  auto list = nlohmann::ordered_json::array();
  for (const double x : numbers) list.push_back(std::isfinite(x) ? nlohmann::ordered_json(x) : nullptr);
  return list;
}

int run_lyapunov(const LyapunovArguments& arguments) {
  const SceneSource source{{}, arguments.scene, arguments.sets};
  LyapunovClock clock = arguments.clock;
  clock.duration = arguments.duration.value_or(duration_of(source.make()));
  if (clock.every == 0) clock.every = clock.duration / 100;
  const StopSignal stop;
  const auto solver = make_solver(arguments.solver);
  const Lyapunov found = lyapunov_of(source, arguments.integrator, *solver, clock, StopSignal::flag());
  if (arguments.json) {
    nlohmann::ordered_json json = {{"status", name(found.status)}};
    if (!found.why.empty()) json["why"] = found.why;
    json["t"] = found.final.t;
    if (found.status == Status::solved)
      json["exponents"] = listed(found.exponents), json["last_half"] = listed(found.last_half);
    std::cout << json.dump(2) << '\n';
  }
  if (found.status != Status::solved) {
    std::cerr << "orthant: the motion ended at t = " << found.final.t << " s: " << name(found.status)
              << (found.why.empty() ? "" : ": ") << found.why << '\n';
    if (found.status == Status::cancelled && StopSignal::which() != 0) return 128 + StopSignal::which();
    return exit_code_of_run(found.status);
  }
  if (arguments.json) return 0;
  std::cout << std::setprecision(9) << "exponents [1/s], and those of the second half of the time:\n";
  for (Eigen::Index i = 0; i < found.exponents.size(); ++i)
    std::cout << found.exponents[i] << "  " << found.last_half[i] << '\n';
  return 0;
}

}  // namespace

void add_lyapunov(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<LyapunovArguments>();
  CLI::App* command = app.add_subcommand("lyapunov", "Lyapunov exponents of a planar motion with impacts and friction");
  command->add_option("scene", arguments->scene, "built-in scene or TOML file")->required();
  command->add_option("--count", arguments->clock.count, "exponents, the largest first; twice the degrees of freedom")
      ->capture_default_str();
  command->add_option("--duration", arguments->duration, "time to average over [s]; default: the scene's");
  command->add_option("--transient", arguments->clock.transient, "time before it [s]")->capture_default_str();
  command->add_option("--every", arguments->clock.every,
                      "time between two orthonormalizations [s]; default: a hundredth of the duration");
  command->add_option("--integrator", arguments->integrator, "event-driven[:option=value,...]")->capture_default_str();
  command->add_option("--solver", arguments->solver, "NAME[:option=value,...]")->capture_default_str();
  command->add_option("--set", arguments->sets, "KEY=VALUE: a scene parameter; may be repeated with other keys")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_flag("--json", arguments->json, "exponents as one JSON object; null: minus infinity");
  command->footer(
      "Exit codes: 0 done, 1 bad input or a motion without tangents, 3 not solved, 130 stopped by Ctrl-C.\n"
      "Example:\n"
      "  orthant lyapunov impact_oscillator --count 6 --transient 100 --duration 200");
  command->callback([arguments, &exit_code] { exit_code = run_lyapunov(*arguments); });
}

}  // namespace orthant
