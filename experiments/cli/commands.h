// experiments/cli/commands.h — the subcommands of orthant. Each adds itself; exceptions from a run are bad input.
#pragma once

#include <orthant/core/lcp/solution.h>

#include <CLI/CLI.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace orthant {

void add_solve(CLI::App& app, int& exit_code);
void add_analyse(CLI::App& app, int& exit_code);
void add_enumerate(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_gradient(CLI::App& app, int& exit_code);
void add_lyapunov(CLI::App& app, int& exit_code);
void add_list(CLI::App& app, int& exit_code);
void add_sweep(CLI::App& app, int& exit_code);
void add_results(CLI::App& app, int& exit_code);
void add_report(CLI::App& app, int& exit_code);
void add_view(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_new(CLI::App& app, int& exit_code);
void add_import(CLI::App& app, int& exit_code);
void add_schema(CLI::App& app, int& exit_code);
void add_completion(CLI::App& app, int& exit_code);
void add_man(CLI::App& app, int& exit_code);

/// --time-limit, of `what`.
template <class Seconds> CLI::Option* add_time_limit(CLI::App& command, Seconds& seconds, const std::string& what) {
  return command.add_option("--time-limit", seconds, what)->check([](const std::string& text) {
    double value = 0;  // CLI::Range would let NaN pass
    const bool good = CLI::detail::lexical_cast(text, value) && value >= 1e-6 && value <= 1e9;
    return good ? std::string() : "'" + text + "': must be a time in [1e-6, 1e9] s";
  });
}

inline CLI::Validator not_empty() {
  return CLI::Validator([](const std::string& text) { return text.empty() ? "must not be empty" : ""; }, "");
}

/// --set, repeated.
template <class Sets> void add_overrides(CLI::App& command, Sets& sets) {
  command.add_option("--set", sets, "KEY=VALUE: a scene parameter; may be repeated with other keys")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

/// --solver, --step, --duration and --set of a run.
template <class Arguments> void add_run_options(CLI::App& command, Arguments& arguments) {
  command.add_option("--solver", arguments.solver, "NAME[:option=value,...]")->capture_default_str();
  command.add_option("--step", arguments.step, "step size h [s]; default: the scene's")->check(not_empty());
  command.add_option("--duration", arguments.duration, "time to simulate [s]; default: the scene's")
      ->check(not_empty());
  add_overrides(command, arguments.sets);
}

/// Exit code of an answer; 1 is bad input.
inline int exit_code_of(Status status) { return has_answer(status) ? 0 : status == Status::infeasible ? 2 : 3; }

/// Exit code of a run: one that ends as rounded ended before a rounded step (--rounded stop).
inline int exit_code_of_run(Status status) { return status == Status::rounded ? 3 : exit_code_of(status); }

}  // namespace orthant
