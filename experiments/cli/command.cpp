// orthant — the command line over the libraries. Each subcommand is one file here.
#include "experiments/cli/command.h"

#include "experiments/cli/commands.h"
#include "experiments/cli/error_object.h"

#include "experiments/runs/manifest.h"
#include "experiments/support/help_text.h"
#include "experiments/support/printable.h"

#include <orthant/core/support/file.h>
#include <orthant/solvers/proof/farkas_simplex.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <iostream>
#include <string_view>

namespace {

/// What was written has arrived: a full disk is no success.
int finish(int exit_code) {
  std::cout.flush();
  if (std::cout) return exit_code;
  std::cerr << "orthant: cannot write standard output" << (errno != 0 ? std::string(": ") + std::strerror(errno) : "")
            << '\n';
  return 1;
}

/// What a report of a fault needs: revision, compiler, packages, and which optional back-ends are in it.
nlohmann::ordered_json version() {
  auto m = orthant::manifest();
  m.erase("written");
  const auto problem = orthant::Lcp::standard(orthant::DenseMatrix(Eigen::MatrixXd::Identity(1, 1)), {-1});
  for (const char* backend : {"ipopt", "nlopt"})
    m["backends"][backend] = orthant::make_solver(backend)->why_not(problem).empty();
  m["backends"]["clp"] = orthant::has_simplex();
  return m;
}

void print_version(bool as_json) {
  const auto m = version();
  if (as_json) {
    std::cout << m.dump(2) << '\n';
    return;
  }
  std::cout << "orthant " << m["version"].get<std::string>() << " (" << m["revision"].get<std::string>() << ")\n"
            << m["compiler"].get<std::string>() << ", " << m["flags"].get<std::string>() << '\n';
  for (const auto& [package, number] : m["packages"].items())
    std::cout << package << ' ' << number.get<std::string>() << '\n';
  for (const auto& [backend, present] : m["backends"].items())
    std::cout << backend << ": " << (present ? "present" : "absent") << '\n';
}

/// Wherever it stands: orthant --max-input 8GiB solve FILE, orthant solve FILE --max-input 8GiB.
void add_max_input(CLI::App& app) {
  const char* what = "largest file that is read, such as 8GiB; 0: 4 GiB of a problem, 16 MiB of a scene or sweep";
  app.add_option_function<std::uint64_t>("--max-input", orthant::set_largest_input, what)
      ->transform(CLI::AsSizeValue(true))
      ->check([](const std::string& text) {  // -1 has become a number near 2^64
        std::uint64_t bytes = 0;
        const bool good = CLI::detail::lexical_cast(text, bytes) && bytes <= INT64_MAX;
        return good ? std::string() : "must be a size of 0 bytes to 8 EiB";
      });
}

/// Wherever it stands, and more than once.
void add_plugin(CLI::App& app, const orthant::PluginKind& kind) {
  app.add_option_function<std::vector<std::string>>(
         "--plugin",
         [load = kind.load](const std::vector<std::string>& files) {
           for (const std::string& file : files) load(file);
         },
         kind.what)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

bool has(int argc, const char* const* argv, std::string_view word) {
  return std::any_of(argv, argv + argc, [&](std::string_view given) {
    return given == word || (given.starts_with(word) && given.substr(word.size()).starts_with('='));
  });
}

[[noreturn]] void refuse_subcommand(const CLI::App& app, const std::string& given) {
  std::string known;
  for (const CLI::App* command : app.get_subcommands(nullptr)) known += " " + command->get_name();
  throw std::invalid_argument("'" + given + "' is no subcommand, one of:" + known);
}

/// The help's first lines: the commands, and where to read more.
int print_subcommands(const CLI::App& app) {
  std::string text = app.get_description() + "\nUsage: orthant COMMAND [OPTIONS]\n\n";
  std::size_t longest = 0;
  for (const CLI::App* command : app.get_subcommands(nullptr)) longest = std::max(longest, command->get_name().size());
  for (const CLI::App* command : app.get_subcommands(nullptr))
    text += "  " + command->get_name() + std::string(longest + 2 - command->get_name().size(), ' ') +
            command->get_description() + "\n";
  text += "\northant --help has examples, orthant COMMAND --help more of each.\n";
  std::cerr << orthant::wrapped(text, orthant::terminal_width());
  return 1;
}

}  // namespace

int orthant::run_command(int argc, const char* const* argv, const PluginKind& plugins) {
  CLI::App app("Orthant: linear complementarity problems and nonsmooth mechanics");
  app.footer(
      "Exit codes: 0 solved, 1 bad input, 2 proved infeasible, 3 not solved.\n"
      "Examples:\n"
      "  orthant simulate slider_crank --set mu=0.1 --step 1e-5 --output run.csv\n"
      "  orthant new mechanism --output mine.toml\n"
      "  orthant check mine.toml\n"
      "  orthant import robot.urdf --output robot.toml\n"
      "  orthant view slider_crank --output view.html\n"
      "  orthant solve --matrix M.mtx --vector q.mtx --solver lemke --json\n"
      "  orthant analyse M.mtx\n"
      "  orthant enumerate --matrix M.mtx --vector q.mtx\n"
      "  orthant replay failed_step_17.json\n"
      "  orthant sweep mine.sweep.toml --results mine.sqlite\n"
      "  orthant results mine.sqlite --orders\n"
      "  orthant report mine.sqlite --output mine.html\n"
      "  orthant list solvers\n"
      "orthant COMMAND --help has more of each.");
  app.require_subcommand(0, 1);  // `orthant man solve`: the second word is no other command
  bool version = false, json = false;
  CLI::Option* shown = app.add_flag("--version", version, "version, revision, compiler and flags");
  app.add_flag("--json", json, "with --version: as one JSON object")->needs(shown);
  int exit_code = 1;
  orthant::add_solve(app, exit_code);
  orthant::add_analyse(app, exit_code);
  orthant::add_enumerate(app, exit_code);
  orthant::add_replay(app, exit_code);
  orthant::add_simulate(app, exit_code);
  orthant::add_gradient(app, exit_code);
  orthant::add_lyapunov(app, exit_code);
  orthant::add_list(app, exit_code);
  orthant::add_sweep(app, exit_code);
  orthant::add_results(app, exit_code);
  orthant::add_report(app, exit_code);
  orthant::add_view(app, exit_code);
  orthant::add_check(app, exit_code);
  orthant::add_new(app, exit_code);
  orthant::add_import(app, exit_code);
  orthant::add_schema(app, exit_code);
  orthant::add_completion(app, exit_code);
  orthant::add_man(app, exit_code);
  add_max_input(app);
  add_plugin(app, plugins);
  for (CLI::App* command : app.get_subcommands(nullptr)) {
    add_max_input(*command);
    add_plugin(*command, plugins);
  }
  try {
    const std::string first = argc > 1 ? argv[1] : "-";
    if (!first.starts_with('-') &&
        app.get_subcommands([&](const CLI::App* c) { return c->get_name() == first; }).empty())
      refuse_subcommand(app, first);
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) {
      if (!version) return print_subcommands(app);
      print_version(json);
      return finish(0);
    }
  } catch (const CLI::CallForHelp&) {
    std::cout << orthant::wrapped(app.help(), orthant::terminal_width());
    return finish(0);
  } catch (const CLI::Success& other) {
    return finish(app.exit(other));
  } catch (const std::exception& error) {  // a bad command line or bad input: one line
    const std::string words = orthant::printable(plugins.words(error));
    if (has(argc, argv, "--json")) std::cout << orthant::error_object(words).dump() << '\n', finish(1);
    std::cerr << "orthant: " << words << '\n';
    return 1;
  }
  return finish(exit_code);
}
