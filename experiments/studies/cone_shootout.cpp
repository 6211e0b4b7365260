// Who solves contact problems with Coulomb's cone, to which accuracy, and how fast?
//
// Solvers of the registry and rivals (experiments/benchmarks/cone) on FCLIB files, JSON problems, or time steps of
// scenes (studies/support/contact_steps.h). One measure for all: the scale-free residual
// (core/lcp/judge/certify_cones.h), recomputed by the second judge (support/independent_judge.h). For each tolerance a
// method is run with its own stopping tolerance at that value, then tenfold lower, until the measure is reached or its
// time is over: the time counted is that of the loosest run that reaches it. Processor time. Writes a row per case,
// and performance profiles (Dolan & Moré 2002): the share of problems solved within a factor of the best time,
// failures kept.
#include "experiments/runs/manifest.h"
#include "experiments/runs/problem_file.h"
#include "experiments/studies/support/contact_steps.h"
#include "experiments/studies/support/independent_judge.h"
#include "experiments/studies/support/rivals.h"
#include "experiments/support/between.h"
#include "experiments/support/clock.h"
#include "experiments/support/command_line.h"
#include "experiments/support/isolated.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <iomanip>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

using namespace orthant;

namespace {

struct Plan {
  std::filesystem::path output = "results/cone_shootout", rivals, save;
  std::vector<std::string> problems, scenes,
      solvers{"auto", "prox", "newton-ac", "newton-min", "newton-fb", "admm", "pgs", "interior-point"};
  std::vector<double> tolerances{1e-4, 1e-8, 1e-12};
  std::size_t steps = 4;  // of a scene
  double time = 10;       // of a solve [s]
};

struct Case {
  std::string problem, method, status;
  double tolerance = 0, seconds = kInf, residual = kInf;
  bool reached() const { return residual <= tolerance; }
};

/// One run in a process of its own: "status seconds residual".
std::string one_run(const Lcp& problem, const std::string& solver, const Rival* rival, double own, double time) {
  std::ostringstream said;
  said.precision(17);
  if (rival != nullptr) {
    Trial trial;
    const Vector z = answer_of_rival(problem, *rival, own, trial);
    said << trial.status << ' ' << trial.seconds << ' ' << (z.allFinite() ? independent_scale_free(problem, z) : kInf);
  } else {
    const auto method =
        make_solver(solver + (solver.find(':') == std::string::npos ? ":" : ",") + "tolerance=" + detail::text_of(own));
    method->set_time_limit(time), method->set_proof_search(false);
    Solution s;
    const auto timing = rival::time_calls([] {}, [&] { method->solve(problem, s); });
    said << name(s.status) << ' ' << timing.seconds << ' '
         << (s.z.allFinite() ? independent_scale_free(problem, s.z) : kInf);
  }
  return said.str();
}

Case try_to(const Lcp& problem, const std::string& solver, const Rival* rival, double tolerance, double time) {
  Case best;
  best.tolerance = tolerance, best.status = "late";
  const double least = rival != nullptr ? tolerance * 1e-6 : tolerance * 1e-3;
  for (double own = tolerance; own >= std::max(least, 1e-15); own /= 10) {
    Case now = best;
    Isolated isolated(1, 0);
    isolated.start([&] { return one_run(problem, solver, rival, own, time); }, 1.5 * time + 1,
                   [&](const Outcome& outcome) {
                     std::istringstream words(outcome.text);
                     std::string seconds, residual;
                     if (outcome.kind == Outcome::finished && words >> now.status >> seconds >> residual)
                       now.seconds = std::strtod(seconds.c_str(), nullptr),
                       now.residual = std::strtod(residual.c_str(), nullptr);
                     else
                       now.status = outcome.kind == Outcome::killed ? "late" : "crashed";
                   });
    isolated.wait_for_all();
    if (!(now.residual >= best.residual)) best = now;
    if (best.reached() || now.status == "late" || now.status == "unsupported" || now.status == "failed" ||
        now.seconds > time)
      break;
  }
  return best;
}

std::string profile_csv(const std::vector<Case>& cases, const std::vector<std::string>& methods, double tolerance) {
  std::map<std::string, double> fastest;
  std::set<std::string> problems;
  for (const Case& c : cases) {
    if (c.tolerance != tolerance) continue;
    problems.insert(c.problem);
    auto [place, fresh] = fastest.try_emplace(c.problem, kInf);
    if (c.reached()) place->second = std::min(place->second, c.seconds);
  }
  std::ostringstream out;
  out << "tolerance,method,factor,share\n";
  for (const std::string& method : methods)
    for (double factor = 1; factor < 2000; factor *= std::sqrt(2.0)) {
      int within = 0;
      for (const Case& c : cases)
        within += c.method == method && c.tolerance == tolerance && c.reached() &&
                  c.seconds <= factor * std::max(fastest.at(c.problem), 1e-6);
      out << tolerance << ',' << method << ',' << factor << ','
          << static_cast<double>(within) / static_cast<double>(problems.size()) << '\n';
    }
  return out.str();
}

std::vector<std::filesystem::path> files_of(const std::vector<std::string>& given) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path path : given) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(path))
      if (entry.path().extension() == ".hdf5" || entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Files and steps of scenes, by name; the latter saved as FCLIB files with their solutions where a folder is given.
std::vector<std::pair<std::string, Lcp>> problems_of(const Plan& plan) {
  std::vector<std::pair<std::string, Lcp>> all;
  for (const auto& file : files_of(plan.problems)) all.emplace_back(file.stem().string(), read_problem_file(file));
  for (const std::string& scene : plan.scenes) {
    int number = 0;
    for (const ContactProblem& c : contact_steps(scene, plan.steps)) {
      std::string name = scene + "-" + std::to_string(++number);
      std::ranges::replace_if(
          name, [](char x) { return x == ':' || x == '=' || x == ',' || x == '/'; }, '-');
      all.emplace_back(name, c.problem);
      if (plan.save.empty()) continue;
      std::filesystem::create_directories(plan.save);
      const auto solver = make_solver("auto:tolerance=1e-13");
      solver->set_time_limit(plan.time);
      Solution s;
      solver->solve(c.problem, s);
      write_fclib(plan.save / (name + ".hdf5"), c, has_answer(s.status) ? &s : nullptr);
    }
  }
  if (all.empty()) throw std::invalid_argument("no problem: name files or scenes");
  return all;
}

void run(const Plan& plan, const std::string& command_line) {
  for (const std::string& spec : plan.solvers) make_solver(spec);  // unknown: said at once
  const auto others = plan.rivals.empty() ? std::vector<Rival>() : rivals(plan.rivals);
  std::vector<std::string> methods = plan.solvers;
  for (const Rival& rival : others) methods.push_back(rival.name);
  std::filesystem::create_directories(plan.output);
  std::vector<Case> cases;
  std::ostringstream table;
  table << "problem,rows,method,tolerance,status,seconds,residual\n";
  for (const auto& [problem_name, problem] : problems_of(plan)) {
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const Rival* rival = m < plan.solvers.size() ? nullptr : &others[m - plan.solvers.size()];
      if (rival != nullptr && !rival->absent.empty()) continue;
      for (const double tolerance : plan.tolerances) {
        Case c = try_to(problem, methods[m], rival, tolerance, plan.time);
        c.problem = problem_name, c.method = methods[m];
        table << c.problem << ',' << problem.size() << ',' << c.method << ',' << tolerance << ',' << c.status << ','
              << c.seconds << ',' << c.residual << '\n';
        cases.push_back(c);
        if (!c.reached() && c.status == "unsupported") break;
      }
    }
    write_whole(plan.output / "cases.csv", table.str());
  }
  std::string profiles;
  for (const double tolerance : plan.tolerances) {
    const std::string csv = profile_csv(cases, methods, tolerance);
    profiles += profiles.empty() ? csv : csv.substr(csv.find('\n') + 1);
    std::cout << "residual <= " << tolerance << ":  method, solved, geometric mean of seconds / best seconds\n";
    std::map<std::string, double> fastest;
    for (const Case& c : cases)
      if (c.tolerance == tolerance && c.reached()) {
        auto [place, fresh] = fastest.try_emplace(c.problem, c.seconds);
        place->second = std::min(place->second, c.seconds);
      }
    for (const std::string& method : methods) {
      int solved = 0;
      double sum = 0;
      for (const Case& c : cases)
        if (c.method == method && c.tolerance == tolerance && c.reached())
          ++solved, sum += std::log(std::max(c.seconds, 1e-7) / std::max(fastest.at(c.problem), 1e-7));
      std::cout << "  " << std::left << std::setw(24) << method << std::right << std::setw(5) << solved << std::setw(10)
                << std::setprecision(3) << (solved > 0 ? std::exp(sum / solved) : kInf) << '\n';
    }
  }
  write_whole(plan.output / "profiles.csv", profiles);
  auto about = manifest();
  about["command"] = command_line;
  write_whole(plan.output / "manifest.json", about.dump(2) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  CLI::App app("Contact problems with Coulomb's cone: who solves them, how exactly, how fast");
  app.add_option("--problems", plan.problems, "files (.hdf5 of FCLIB, .json), or folders of them");
  app.add_option("--scenes", plan.scenes, "scenes in space, NAME[:option=value,...] ...: problems of their time steps");
  app.add_option("--steps", plan.steps, "problems of a scene")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--save", plan.save, "folder: the scenes' problems as FCLIB files with their solutions");
  app.add_option("--output", plan.output, "folder for tables and manifest")->capture_default_str();
  app.add_option("--solvers", plan.solvers, "NAME[:option=value,...] ...")->capture_default_str();
  app.add_option("--rivals", plan.rivals, "folder of rivals' drivers; they take part as well");
  app.add_option("--tolerances", plan.tolerances, "scale-free residuals to reach")
      ->check(between(1e-15, 1.0))
      ->capture_default_str();
  app.add_option("--time-limit", plan.time, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  try {
    run(plan, command_line);
  } catch (const std::exception& error) {
    std::cerr << "cone_shootout: " << error.what() << '\n';
    return 1;
  }
}
