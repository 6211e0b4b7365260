// How far is a pyramid with 4, 8, 16, … sides from Coulomb's cone, and what does it cost?
//
// Random contact problems with known solutions and of full rank (core/lcp/problems/disc_contacts.h), so that the
// velocity is unique, and files. Each is solved with discs (auto) and as pyramids (solvers/cones/facets.h) that stand
// still, by a method of linear problems; then with pyramids of 8 sides that turn. Error: ‖D (w − w_disc)‖ / ‖D q‖ in
// scale-free numbers (D: cones/contact.h). Time: of the processor, relative to the disc's. Prints one line for each
// number of sides; writes a row for each case into --output. A pyramid without an answer is a row as well.
#include "experiments/runs/manifest.h"
#include "experiments/runs/problem_file.h"
#include "experiments/studies/support/independent_judge.h"
#include "experiments/support/between.h"
#include "experiments/support/clock.h"
#include "experiments/support/command_line.h"

#include <orthant/core/lcp/cones/contact.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/core/support/file.h>
#include <orthant/solvers/cones/facets.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>

using namespace orthant;

namespace {

struct FacetStudy {
  std::filesystem::path output;
  std::vector<std::string> problems;
  std::vector<int> sides{4, 8, 16, 32, 64}, contacts{1, 5, 10, 20};
  int seeds = 10;
  std::string method = "lemke";
  double time = 10;  // of a solve [s]
};

struct Sum {
  int problems = 0, answered = 0;
  std::vector<double> errors, residuals, times;
};

double median(std::vector<double> values) {
  if (values.empty()) return kInf;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double seconds_of(Solver& solver, const Lcp& problem, Solution& s) {
  return rival::time_calls([] {}, [&] { solver.solve(problem, s); }, 0.02).seconds;
}

void study(const FacetStudy& plan) {
  std::vector<std::pair<std::string, Lcp>> problems;
  for (const std::string& file : plan.problems) problems.emplace_back(file, read_problem_file(file));
  if (problems.empty())
    for (const int contacts : plan.contacts)
      for (int seed = 1; seed <= plan.seeds; ++seed) {
        Random random(static_cast<std::uint64_t>(1000 * contacts + seed));
        const Known known = disc_contacts({.contacts = contacts, .freedoms = 6 * contacts, .mu = 0.3}, random);
        problems.emplace_back(std::to_string(contacts) + "-" + std::to_string(seed), known.problem);
      }
  std::ostringstream table;
  table << "problem,rows,sides,status,error,residual,seconds,disc_seconds\n";
  std::map<std::string, Sum> sums;
  std::vector<std::string> order;
  for (const auto& [name_of, problem] : problems) {
    const auto disc = make_solver("auto:tolerance=1e-12");
    disc->set_time_limit(plan.time);
    Solution exact;
    const double disc_seconds = seconds_of(*disc, problem, exact);
    if (!has_answer(exact.status)) {
      std::cerr << "facets: " << name_of << ": no answer with discs, left out\n";
      continue;
    }
    cones::Blocks blocks;
    Vector d;
    blocks.load(problem), blocks.scale(problem.A, d);
    const double data = d.cwiseProduct(problem.b).norm();
    const auto one = [&](const std::string& label, int sides, int turns) {
      const auto method = make_solver(plan.method);
      Facets pyramid(*method, sides, turns);
      pyramid.set_time_limit(plan.time), pyramid.set_proof_search(false);
      Solution s;
      const double seconds = seconds_of(pyramid, problem, s);
      if (sums.find(label) == sums.end()) order.push_back(label);
      Sum& sum = sums[label];
      ++sum.problems;
      double error = kInf, residual = kInf;
      if (pyramid.pyramid_status() == Status::solved) {
        error = d.cwiseProduct(s.w - exact.w).norm() / data, residual = independent_scale_free(problem, s.z);
        ++sum.answered;
        sum.errors.push_back(error), sum.residuals.push_back(residual), sum.times.push_back(seconds / disc_seconds);
      }
      table << std::quoted(name_of, '"', '"') << ',' << problem.size() << ',' << std::quoted(label) << ','
            << name(pyramid.pyramid_status()) << ',' << error << ',' << residual << ',' << seconds << ','
            << disc_seconds << '\n';
    };
    for (const int sides : plan.sides) one(std::to_string(sides), sides, 0);
    one("8, turned", 8, 40);
  }
  std::cout
      << "| sides | problems | answered | median error | largest error | median residual | time / time of discs |\n"
         "|---|---|---|---|---|---|---|\n"
      << std::setprecision(2);
  for (const std::string& label : order) {
    const Sum& sum = sums[label];
    std::cout << "| " << label << " | " << sum.problems << " | " << sum.answered << " | " << median(sum.errors) << " | "
              << (sum.errors.empty() ? kInf : *std::max_element(sum.errors.begin(), sum.errors.end())) << " | "
              << median(sum.residuals) << " | " << median(sum.times) << " |\n";
  }
  if (plan.output.empty()) return;
  std::filesystem::create_directories(plan.output);
  write_whole(plan.output / "facets.csv", table.str());
  write_whole(plan.output / "manifest.json", manifest().dump(2) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  FacetStudy plan;
  CLI::App app("Pyramids of 4, 8, 16, ... sides and Coulomb's cone: error and time");
  app.add_option("--output", plan.output, "folder for facets.csv and manifest.json; none: nothing is written");
  app.add_option("--problems", plan.problems, "files (.hdf5 of FCLIB, .json) instead of random problems");
  app.add_option("--sides", plan.sides, "")->check(CLI::Range(3, 1024))->capture_default_str();
  app.add_option("--contacts", plan.contacts, "of random problems")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--seeds", plan.seeds, "random problems a size")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--method", plan.method, "solver of the pyramids")->capture_default_str();
  app.add_option("--time-limit", plan.time, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  try {
    study(plan);
  } catch (const std::exception& error) {
    std::cerr << "facets: " << error.what() << '\n';
    return 1;
  }
}
