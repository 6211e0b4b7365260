// orthant gradient SCENE — derivatives of a run's last state with respect to parameters of the scene and the start.
#include "experiments/cli/commands.h"

#include "experiments/runs/run_gradient.h"
#include "experiments/support/stop_signal.h"

#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <iomanip>
#include <iostream>
#include <sstream>

namespace orthant {
namespace {

struct GradientArguments {
  std::string scene, integrator = "moreau-jean", solver = "auto";
  std::vector<std::string> sets, of, wrt;
  std::optional<double> step, duration, time_limit;
  bool json = false;
};

std::vector<std::string> warnings_of(const RunTangent& tangent, const AnyScene& scene) {
  std::vector<std::string> all = tangent.warnings;
  if (!tangent.degenerate.empty()) {
    const DegenerateStep& first = tangent.degenerate.front();
    std::ostringstream words;
    words << tangent.degenerate.size() << " steps have weakly active contacts, the first at t = " << first.t << " s ("
          << name_of_contact(scene, first.contacts.front())
          << "): only one-sided derivatives exist, these hold such contacts as they are";
    all.push_back(words.str());
  }
  if (tangent.inconsistent > 0)
    all.push_back("in " + std::to_string(tangent.inconsistent) +
                  " steps a parameter parts redundant contacts: there is no derivative");
  return all;
}

nlohmann::ordered_json as_json(const GradientArguments& arguments, const GradientOfRun& gradient,
                               const std::vector<std::string>& warnings) {
  const Run& run = gradient.tangent.run;
  nlohmann::ordered_json json = {{"status", name(run.status)}};
  if (!run.why.empty()) json["why"] = run.why;
  json["t"] = run.final.t;
  if (run.status == Status::solved) {
    const std::size_t columns = arguments.of.size(), count = arguments.wrt.size();
    for (std::size_t i = 0; i < columns; ++i) {
      json["values"][arguments.of[i]] = gradient.value[gradient.value.size() - columns + i];
      for (std::size_t j = 0; j < count; ++j)
        json["derivatives"][arguments.of[i]][arguments.wrt[j]] =
            gradient.by[gradient.by.size() - columns * count + i * count + j];
    }
  }
  json["warnings"] = warnings;
  return json;
}

int run_gradient(const GradientArguments& arguments) {
  const SceneSource source{{}, arguments.scene, arguments.sets};
  const AnyScene scene = source.make();
  const StopSignal stop;
  const auto solver = make_solver(arguments.solver);
  const Clock clock{.step = arguments.step.value_or(step_of(scene)),
                    .duration = arguments.duration.value_or(duration_of(scene)),
                    .time_limit = arguments.time_limit.value_or(kInf),
                    .cancel = StopSignal::flag()};
  const GradientOfRun gradient =
      gradient_of_run(source, arguments.of, arguments.wrt, arguments.integrator, *solver, clock);
  const RunTangent& tangent = gradient.tangent;
  const bool solved = tangent.run.status == Status::solved;
  const std::vector<std::string> warnings = solved ? warnings_of(tangent, scene) : std::vector<std::string>{};
  if (arguments.json) std::cout << as_json(arguments, gradient, warnings).dump(2) << '\n';
  if (tangent.run.status != Status::solved) {
    std::cerr << "orthant: the run ended at t = " << tangent.run.final.t << " s: " << name(tangent.run.status)
              << (tangent.run.why.empty() ? "" : ": ") << tangent.run.why << '\n';
    if (tangent.run.status == Status::cancelled && StopSignal::which() != 0) return 128 + StopSignal::which();
    return exit_code_of_run(tangent.run.status);
  }
  for (const std::string& warning : warnings) std::cerr << "orthant: warning: " << warning << '\n';
  if (arguments.json) return 0;
  const std::size_t columns = arguments.of.size(), count = arguments.wrt.size();
  std::cout << std::setprecision(12);
  for (std::size_t i = 0; i < columns; ++i) {
    std::cout << arguments.of[i] << " = " << gradient.value[gradient.value.size() - columns + i] << '\n';
    for (std::size_t j = 0; j < count; ++j)
      std::cout << "d " << arguments.of[i] << " / d " << arguments.wrt[j] << " = "
                << gradient.by[gradient.by.size() - columns * count + i * count + j] << '\n';
  }
  return 0;
}

}  // namespace

void add_gradient(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<GradientArguments>();
  CLI::App* command = app.add_subcommand("gradient", "Derivatives of a run's last row by parameters and start");
  command->add_option("scene", arguments->scene, "built-in scene or TOML file")->required();
  command
      ->add_option("--of", arguments->of,
                   "columns, such as crank.theta,corner1.gap,corner1.impulse_n,bearing.impulse,energy; in space "
                   "rod.x, rod.qw, rod.wz, ball.impulse_t1")
      ->required()
      ->delimiter(',');
  command
      ->add_option("--wrt", arguments->wrt,
                   "keys of --set with a number, such as mu or body.rod.mass, entries of arrays as "
                   "body.rod.position[0], and start.BODY.x, y, theta, vx, vy, omega; in space x, y, z, rx, ry, rz "
                   "(turns about the world's axes), vx, vy, vz, wx, wy, wz")
      ->required()
      ->delimiter(',');
  command
      ->add_option("--integrator", arguments->integrator,
                   "moreau-jean; in the plane also rattle, or event-driven (the motion itself) "
                   "[:option=value,...]")
      ->capture_default_str();
  add_run_options(*command, *arguments);
  add_time_limit(*command, arguments->time_limit, "of the run [s of wall time]");
  command->add_flag("--json", arguments->json, "values, derivatives and warnings as one JSON object");
  command->footer(
      "Exit codes: 0 done, 1 bad input, 2 a step was proved infeasible, 3 a step was not solved, 130 stopped by "
      "Ctrl-C.\n"
      "Example:\n"
      "  orthant gradient slider_crank --step 1e-4 --duration 0.1 --of crank.theta --wrt mu,e,start.crank.omega");
  command->callback([arguments, &exit_code] { exit_code = run_gradient(*arguments); });
}

}  // namespace orthant
