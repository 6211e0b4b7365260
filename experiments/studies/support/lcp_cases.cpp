#include "experiments/studies/support/lcp_cases.h"

#include "experiments/runs/problem_file.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <filesystem>

namespace orthant {
namespace {

constexpr std::size_t kSteps = 6;  // recorded of each run

bool depends_on_seed(const Family& f) {
  const auto text = [&](std::uint64_t seed) { return to_json(f.make(f.sizes[0], f.hardness[0], seed).problem); };
  return text(1) != text(2);
}

void add_family(const Family& f, const LcpCaseChoice& choice, std::vector<LcpCase>& cases) {
  const int seeds = choice.seeds > 1 && depends_on_seed(f) ? choice.seeds : 1;
  for (const Index size : f.sizes) {
    if (size > choice.largest || (choice.smallest_only && size > f.sizes[0])) break;
    for (const double hardness : f.hardness)
      for (int seed = 1; seed <= seeds; ++seed) {
        std::string name = std::string(f.name) + "-" + std::to_string(size);
        if (f.hardness.size() > 1) name += "-" + detail::text_of(hardness);
        if (seeds > 1) name += "-" + std::to_string(seed);
        const auto number = static_cast<std::uint64_t>(seed);
        cases.push_back({std::string(f.name), std::move(name), size, hardness, number, std::string(f.matrix), f.answer,
                         [&f, size, hardness, number] { return f.make(size, hardness, number).problem; }});
      }
  }
}

void add(std::string family, std::string name, Lcp problem, std::optional<Answer> answer, std::vector<LcpCase>& cases) {
  const Index size = problem.size();
  cases.push_back(
      {std::move(family), std::move(name), size, 0, 0, "", answer, [problem = std::move(problem)] { return problem; }});
}

/// Problems of both forms of the step, evenly spread over those of a run.
void add_steps(const std::string& scene, std::vector<LcpCase>& cases) {
  const System system(make_scene(scene));
  const std::string name = std::filesystem::path(scene).stem().string();
  for (const std::string form : {"reduced", "full"}) {
    const auto integrator = make_integrator("moreau-jean:form=" + form, system);
    const auto solver = make_solver("lemke");
    std::vector<Lcp> problems;
    const double step = system.scene().step, duration = std::min(system.scene().duration, 2000 * step);
    simulate(*integrator, *solver, {.step = step, .duration = duration}, [&](const RunSample& moment) {
      if (moment.report.lcp_rows > 0) problems.push_back(integrator->problem());
    });
    const std::size_t count = std::min(kSteps, problems.size());
    for (std::size_t k = 0; k < count; ++k)
      add("steps", name + "-" + form + "-" + std::to_string(k + 1), problems[k * problems.size() / count],
          Answer::one_of, cases);
  }
}

}  // namespace

std::vector<LcpCase> lcp_cases(const LcpCaseChoice& choice) {
  const auto wanted = [&](std::string_view name) {
    return choice.families.empty() || std::ranges::count(choice.families, name) > 0;
  };
  for (const std::string& name : choice.families)
    if (find_family(name) == nullptr && name != "known" && name != "steps") {
      std::string names;
      for (const Family& f : families()) names += std::string(f.name) + ", ";
      throw std::invalid_argument("family '" + name + "': must be one of " + names + "known, steps");
    }
  std::vector<LcpCase> cases;
  for (const Family& f : families())
    if (wanted(f.name)) add_family(f, choice, cases);
  if (wanted("known"))
    for (Known& k : known_problems()) add("known", k.name, std::move(k.problem), k.answer, cases);
  if (wanted("steps"))
    for (const std::string& scene : choice.scenes) add_steps(scene, cases);
  for (const std::string& file : choice.problems) add("file", file, read_problem_file(file), std::nullopt, cases);
  std::ranges::stable_sort(cases, {}, &LcpCase::size);
  return cases;
}

std::string group(const LcpCase& c, const Lcp& problem) {
  if (c.family == "file") return "own";
  if (c.answer == Answer::infeasible || c.answer == Answer::none) return "infeasible";
  const bool written_out = c.family == "friction" || c.family == "glocker";  // friction as a pure LCP
  if (!problem.friction.empty() || written_out) return "friction";
  const std::string_view kind(c.matrix);
  if (kind.starts_with("SPD") || kind.starts_with("PD")) return "definite";
  if (kind.starts_with("PSD")) return "semidefinite";
  if (kind.starts_with("K")) return "grid";
  if (kind == "P") return "P-matrix";
  return "other";
}

}  // namespace orthant
