// orthant solve — one problem from files: Matrix Market, JSON or FCLIB.
#include "experiments/cli/commands.h"
#include "experiments/cli/problem_arguments.h"

#include "experiments/support/status_line.h"

#include <orthant/core/lcp/files/io_fclib.h>
#include <orthant/core/lcp/judge/active_set.h>
#include <orthant/core/lcp/judge/cell_words.h>
#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/lcp/judge/error_bound.h>
#include <orthant/solvers/cones/facets.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <chrono>
#include <iostream>

namespace orthant {
namespace {

struct SolveArguments {
  ProblemArguments problem;
  std::string solver = "auto";
  std::string output;
  std::optional<double> time_limit;
  int facets = 0;  // 0: the discs themselves
  bool velocity = false;
  bool json = false, error_bound = false, log = false;
};

std::vector<double> list(const Vector& x) { return {x.data(), x.data() + x.size()}; }

bool is_fclib(const std::string& file) { return file.ends_with(".hdf5") || file.ends_with(".h5"); }

/// ‖x − y‖ / ‖y‖ with the entries multiplied by `unit`.
double distance(const Vector& x, const Vector& y, const Eigen::VectorXd& unit) {
  const double size = y.cwiseProduct(unit).norm(), apart = (x - y).cwiseProduct(unit).norm();
  return apart == 0 ? 0 : apart / size;
}

/// How far a pyramid's answer is from the disc's, in units of each contact (cones/contact.h).
nlohmann::ordered_json facet_error(const Lcp& problem, const Solution& s, const Facets& facets, int sides) {
  nlohmann::ordered_json json = {{"sides", sides}, {"pyramid_status", name(facets.pyramid_status())}};
  Solution disc;
  make_solver("auto")->solve(problem, disc);
  json["disc_status"] = name(disc.status);
  if (!has_answer(disc.status) || !s.z.allFinite()) return json;
  cones::Blocks blocks;
  Vector d;
  blocks.load(problem), blocks.scale(problem.A, d);
  json["distance_z"] = distance(s.z, disc.z, d.cwiseInverse());
  json["distance_w"] = distance(s.w, disc.w, d);
  return json;
}

/// Each class of the exhaustive search (judge/cells.h): sides by row of the problem, and why none has a solution.
nlohmann::ordered_json cells_of(const Lcp& problem, const std::vector<Cell>& cells) {
  auto classes = nlohmann::ordered_json::array();
  for (const Cell& cell : cells)
    classes.push_back(
        {{"sides", letters(cell)}, {"expressed", cell.expressed}, {"why", words_of(cell.why)}, {"row", cell.row}});
  return {{"count", count_cells(problem)}, {"order", order_of_decision(problem)}, {"classes", std::move(classes)}};
}

int run_solve(const SolveArguments& a) {
  const auto method = make_solver(a.solver);
  ContactProblem contacts;
  const bool fclib = a.problem.matrix.empty() && is_fclib(a.problem.problem);
  if (!fclib && (a.velocity || !a.output.empty()))
    throw std::invalid_argument((a.velocity ? "--velocity" : "--output = " + a.output) +
                                ": needs a problem from an FCLIB file (.hdf5), not from " +
                                (a.problem.matrix.empty() ? a.problem.problem : a.problem.matrix));
  if (fclib)
    contacts = read_fclib(a.problem.problem);
  else
    contacts.problem = read_problem(a.problem);
  if (a.velocity && !contacts.global)
    throw std::invalid_argument("--velocity: " + a.problem.problem +
                                " is a local problem, without bodies: needs group fclib_global");
  if (!contacts.unfit.empty()) std::cerr << "orthant: the file's solution was left out: " << contacts.unfit << '\n';
  const Lcp& problem = contacts.problem;
  if (a.facets != 0 && !problem.discs()) throw std::invalid_argument("--facets: the problem has no friction discs");
  Facets facets(*method, std::max(a.facets, 3), 0);
  Solver* const solver = a.facets != 0 ? &facets : method.get();
  Solution s;
  IterationLog log;
  if (a.log) solver->set_log(&log);
  solver->set_time_limit(a.time_limit.value_or(kInf));
  const double seconds = with_elapsed_line("solve", [&] {
    const auto begin = std::chrono::steady_clock::now();
    solver->solve(problem, s);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  });
  const std::string reason = s.status == Status::unsupported ? solver->refusal(problem) : "";

  nlohmann::ordered_json json = {{"status", name(s.status)},
                                 {"residual", s.residual},
                                 {"residual_scale_free", nullptr},
                                 {"residual_natural", nullptr},
                                 {"rounding", s.rounding},
                                 {"iterations", s.iterations},
                                 {"factorizations", s.factorizations},
                                 {"seconds", seconds},
                                 {"solver", a.solver},
                                 {"z", list(s.z)},
                                 {"w", list(s.w)},
                                 {"certificate", nullptr}};
  if (problem.discs() && s.z.allFinite()) {
    const ConeResiduals residuals = cone_residuals(problem, s.z);
    json["residual_scale_free"] = residuals.scale_free, json["residual_natural"] = residuals.natural;
  } else {
    json.erase("residual_scale_free"), json.erase("residual_natural");
  }
  if (a.velocity) json["velocity"] = list(contacts.velocity(s.z));
  if (a.facets != 0) json["facets"] = facet_error(problem, s, facets, a.facets);
  if (s.certificate.size() > 0) json["certificate"] = list(s.certificate);
  if (!s.cells.empty()) json["cells"] = cells_of(problem, s.cells);
  if (const std::string words = why(s); !words.empty()) json["why"] = words;
  if (has_answer(s.status)) {  // rows count from 0
    const ActiveSet active = active_set(problem, s);
    json["active_set"] = {
        {"lower", active.lower}, {"inside", active.inside}, {"upper", active.upper}, {"degenerate", active.degenerate}};
    json["uniqueness"] = name(active.isolation);
  }
  if (a.error_bound) {
    Budget budget;
    budget.start(a.time_limit.value_or(kInf), nullptr);
    const double bound = s.z.allFinite() ? error_bound(problem, s.z, [&] { return budget.exhausted(); }) : kInf;
    json["error_bound"] = bound < kInf ? nlohmann::ordered_json(bound) : nullptr;  // null: none is known
  }
  if (!reason.empty()) json["why_not"] = reason;
  if (!a.output.empty()) write_fclib(a.output, contacts, &s);
  if (a.log) {
    json["log"] = nlohmann::ordered_json::array();
    for (const auto& [iteration, merit, step, event] : log)
      json["log"].push_back({{"iteration", iteration}, {"merit", merit}, {"step", step}, {"event", event}});
  }
  if (a.json) {
    std::cout << json.dump(2) << '\n';
  } else {
    for (const auto& [key, value] : json.items()) {
      if (key != "log") std::cout << key << " = " << value << '\n';
    }
    for (const auto& entry : log)
      std::cout << "log " << entry.iteration << ": merit " << entry.merit << ", step " << entry.step
                << (entry.event.empty() ? "" : ", ") << entry.event << '\n';
  }
  if (!reason.empty()) std::cerr << "orthant: " << a.solver << " cannot take this problem: " << reason << '\n';
  return exit_code_of(s.status);
}

}  // namespace

void add_solve(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<SolveArguments>();
  CLI::App* command = app.add_subcommand("solve", "Solve one problem: find z in [lower, upper] with w = M z + q");
  add_problem_options(*command, arguments->problem);
  command->add_option("--solver", arguments->solver, "NAME[:option=value,...]")->capture_default_str();
  add_time_limit(*command, arguments->time_limit, "of the solve, and of its error bound [s]");
  command
      ->add_option("--facets", arguments->facets,
                   "friction discs as pyramids with so many sides; says how far that is off")
      ->check(CLI::Range(3, 1024));
  command->add_flag("--velocity", arguments->velocity, "velocities of the bodies, of a global FCLIB problem");
  command->add_option("--output", arguments->output, "FCLIB file of the problem with its solution");
  command->add_flag("--log", arguments->log, "its iterations, too");
  command->add_flag("--error-bound", arguments->error_bound, "a bound on |z - solution|, where theory gives one");
  command->add_flag("--json", arguments->json, "answer as one JSON object");
  command->footer(
      "Exit codes: 0 solved, 1 bad input, 2 proved infeasible, 3 not solved.\n"
      "Examples:\n"
      "  orthant solve --matrix M.mtx --vector q.mtx\n"
      "  orthant solve mine.json --solver pgs:omega=1.3,max_sweeps=500 --log\n"
      "  orthant solve contacts.hdf5 --time-limit 10 --json");
  command->callback([arguments, &exit_code] { exit_code = run_solve(*arguments); });
}

}  // namespace orthant
