// orthant — the command line over the libraries. Each subcommand is one file here.
#include "commands.h"

#include "../support/manifest.h"

#include <orthant/solvers/registry.h>

#include <exception>
#include <iostream>

namespace {

/// Messages quote input, and input may hold line ends: one error stays one line.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  return text;
}

/// What a report of a fault needs: revision, compiler, packages, and which optional back-ends are in it.
std::string version_text() {
  const auto m = orthant::manifest();
  std::string text = "orthant " + m["version"].get<std::string>() + " (" + m["revision"].get<std::string>() + ")\n" +
                     m["compiler"].get<std::string>() + ", " + m["flags"].get<std::string>();
  for (const auto& [package, version] : m["packages"].items())
    text += "\n" + package + " " + version.get<std::string>();
  const auto problem = orthant::Lcp::standard(orthant::DenseMatrix(Eigen::MatrixXd::Identity(1, 1)), {-1});
  for (const char* backend : {"ipopt", "nlopt"})
    text += std::string("\n") + backend + ": " +
            (orthant::make_solver(backend)->why_not(problem).empty() ? "present" : "absent");
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Orthant: linear complementarity problems and nonsmooth mechanics");
  app.footer(
      "Exit codes: 0 solved, 1 bad input, 2 proved infeasible, 3 not solved.\n"
      "Examples:\n"
      "  orthant simulate slider_crank --set mu=0.1 --step 1e-5 --output run.csv\n"
      "  orthant solve --matrix M.mtx --vector q.mtx --solver lemke --json\n"
      "  orthant analyse M.mtx\n"
      "  orthant replay failed_step_17.json\n"
      "  orthant list");
  app.set_version_flag("--version", version_text, "What this is, built from what and how");
  int exit_code = 1;
  orthant::add_solve(app, exit_code);
  orthant::add_analyse(app, exit_code);
  orthant::add_enumerate(app, exit_code);
  orthant::add_replay(app, exit_code);
  orthant::add_simulate(app, exit_code);
  orthant::add_list(app, exit_code);
  orthant::add_sweep(app, exit_code);
  orthant::add_results(app, exit_code);
  orthant::add_report(app, exit_code);
  orthant::add_completion(app, exit_code);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) {
      std::string known;
      for (const CLI::App* command : app.get_subcommands(nullptr)) known += " " + command->get_name();
      throw std::invalid_argument("a subcommand is needed, one of:" + known);
    }
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const std::exception& error) {  // a bad command line or bad input: one line
    std::cerr << "orthant: " << one_line(error.what()) << '\n';
    return 1;
  }
  return exit_code;
}
