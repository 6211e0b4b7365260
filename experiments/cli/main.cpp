// orthant — the command line over the libraries. Each subcommand is one file here.
#include "commands.h"

#include <exception>
#include <iostream>

namespace {

/// Messages quote input, and input may hold line ends: one error stays one line.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
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
      "  orthant list");
  int exit_code = 1;
  orthant::add_solve(app, exit_code);
  orthant::add_analyse(app, exit_code);
  orthant::add_simulate(app, exit_code);
  orthant::add_list(app, exit_code);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty())
      throw std::invalid_argument("a subcommand is needed: solve, analyse, simulate or list");
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const std::exception& error) {  // a bad command line or bad input: one line
    std::cerr << "orthant: " << one_line(error.what()) << '\n';
    return 1;
  }
  return exit_code;
}
