#include "experiments/studies/verdict_storm/verdicts.h"

#include "experiments/studies/verdict_storm/cone_judge.h"
#include "experiments/studies/verdict_storm/disc_problems.h"
#include "experiments/studies/verdict_storm/exact_judge.h"

#include <orthant/core/lcp/judge/cells.h>
#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <optional>

namespace orthant {
namespace {

constexpr Index kEnumerated = 8;      // rows up to which the exact set of solutions is looked up
constexpr double kTolerance = 1e-10;  // the largest default of all solvers
// Of |u|ᵀ|b|. Planted solutions satisfy their problem up to rounding of b. Exactly, the data may contradict each other.
constexpr double kConstructed = 1e-13;
// Hopeless problems end slowly: 85 % of a storm's time went into what comes after the first 5 ms of a solve, a third of
// the rest into what comes after 2 ms.
constexpr double kBrief = 0.002;        // [s] a solve at most, but in every
constexpr std::uint64_t kPatient = 41;  // turn of all kinds; odd, as solvers are new in the even ones

bool small_integers(const Lcp& p) {
  const auto small = [](double x) { return x == std::floor(x) && std::abs(x) <= 1e6; };
  DenseMatrix A;
  to_dense(p.A, A);
  return p.size() <= kEnumerated && std::all_of(A.data(), A.data() + A.size(), small) &&
         std::all_of(p.b.begin(), p.b.end(), small) && Enumerate().why_not(p).empty();
}

std::size_t exact_solutions(const Lcp& p) {
  const SolutionSet set = enumerate_solutions(p);
  return set.isolated.size() + set.faces.size();
}

/// One problem's verdicts: a z or a proof of several solvers is examined once.
class Verdicts {
 public:
  explicit Verdicts(const StormProblem& p) : p_(p) {}

  StormResult judge(const Solution& s, double seconds, double most_seconds, std::string& why, StormTally::Row& row) {
    if (seconds > most_seconds) {
      why = std::to_string(seconds) + " s";
      return StormResult::late;
    }
    if (has_answer(s.status)) return solved(s, why, row);
    if (s.status == Status::infeasible) return infeasible(s, why, row);
    if (s.status == Status::unsupported) return StormResult::refused;
    if (s.status != Status::not_run && s.residual == s.residual) return StormResult::failed;
    why = "status " + std::string(name(s.status)) + ", residual " + std::to_string(s.residual);
    return StormResult::wrong;
  }

 private:
  template <class Examine>
  const Finding& look(std::vector<std::pair<Vector, Finding>>& seen, const Vector& x, const Examine& examine) {
    for (const auto& [known, finding] : seen)
      if (known == x) return finding;
    return seen.emplace_back(x, examine()).second;
  }

  StormResult solved(const Solution& s, std::string& why, StormTally::Row& row) {
    const bool rounded = s.status == Status::rounded;
    const Finding& f = look(rounded ? roundings_ : solutions_, s.z,
                            [&] { return examine_solution(p_.problem, s.z, kTolerance, s.status); });
    if (!f.holds)
      why = f.why;
    else if (!rounded && (p_.answer == Answer::infeasible || p_.answer == Answer::none))
      why = "there is no solution, by construction";
    else if (!rounded && none())
      why = "there is no solution: all cells were searched";
    if (!why.empty()) return StormResult::wrong;
    row.error = std::max(row.error, f.error);
    return rounded ? StormResult::rounded : StormResult::solved;
  }

  StormResult infeasible(const Solution& s, std::string& why, StormTally::Row& row) {
    if (!s.cells.empty()) {  // by another search than the one that the proof came from
      if (!no_cell_has_a_solution(p_.problem, s.cells))
        why = "the cells are no proof";
      else if (p_.answer && p_.answer != Answer::none && p_.answer != Answer::infeasible)
        why = "there is a solution, by construction";
      ++row.exact;
      return why.empty() ? StormResult::infeasible : StormResult::wrong;
    }
    const Finding& f = look(proofs_, s.certificate, [&] { return examine_proof(p_.problem, s.certificate); });
    if (!f.holds)
      why = f.why;
    else if (p_.answer && p_.answer != Answer::infeasible && f.margin > kConstructed)
      why = "there is no proof, by construction";
    if (!why.empty()) return StormResult::wrong;
    ++(f.error == 0 ? row.exact : row.rounded);
    return StormResult::infeasible;
  }

  /// No exact solution exists, of a problem whose numbers are small integers: no rounding has made it so.
  bool none() {
    if (!none_) none_ = small_integers(p_.problem) && exact_solutions(p_.problem) == 0;
    return *none_;
  }

  const StormProblem& p_;
  std::vector<std::pair<Vector, Finding>> solutions_, roundings_, proofs_;
  std::optional<bool> none_;
};

struct Trial {
  std::unique_ptr<Solver> solver;
  Solution solution;

  explicit Trial(const std::string& spec) : solver(make_solver(spec)) {}

  double solve(const Lcp& problem, double time_limit) {  // [s] of the processor: other programs make no solver late
    solver->set_time_limit(time_limit);
    const std::clock_t begin = std::clock();
    solver->solve(problem, solution);
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  }
};

}  // namespace

void StormTally::add(const StormTally& other) {
  for (const auto& [key, more] : other.rows) {
    Row& row = rows[key];
    for (std::size_t i = 0; i < row.count.size(); ++i) row.count[i] += more.count[i];
    row.error = std::max(row.error, more.error);
    row.exact += more.exact, row.rounded += more.rounded;
  }
  faults.insert(faults.end(), other.faults.begin(), other.faults.end());
}

std::vector<StormSolver> storm_solvers() {
  std::vector<StormSolver> all;
  for (const SolverEntry& entry : solvers()) {
    StormSolver solver{std::string(entry.name)};
    if (entry.name == "ipopt") solver.every = 100;
    if (entry.name == "nlopt") solver.every = 100;
    if (entry.name == "enumerate") solver.every = 5, solver.largest = 8;
    all.push_back(solver);
  }
  return all;
}

std::vector<StormSolver> disc_solvers() {
  std::vector<StormSolver> all;
  for (const char* spec : {"auto", "prox", "prox:path=true", "newton-ac", "newton-ac:map=jean-moreau", "newton-min",
                           "newton-fb", "admm", "apgd", "pgs", "psor", "sgs", "interior-point"})
    all.push_back({spec});
  return all;
}

namespace {
std::span<const std::string_view> kinds_of(const StormChoice& choice) {
  return choice.discs ? disc_kinds() : storm_kinds();
}
}  // namespace

StormProblem problem_of(const StormChoice& choice, std::uint64_t k) {
  return choice.discs ? disc_problem(choice.seed, k) : storm_problem(choice.seed, k);
}

namespace {

constexpr double kRestated = 1e-8;  // of an answer within 1e-10, restated: half a z, and μ up to 1e6

/// Why the claims of a solver on a problem and on the same in other words contradict; empty: they do not.
std::string contradiction(const Lcp& p, const Solution& s, Trial& runner, double limit, std::uint64_t k) {
  Random random(k + 1);
  const Restatement restated = restate(p, random);
  if (s.status == Status::solved) {
    const Vector image = restated.of_z * s.z;
    const Finding finding = examine_cones(restated.problem, image, kRestated, Status::solved);
    if (!finding.holds) return "restated, the same z: " + finding.why;
    Solution same;
    same.z = image, same.w.resize(image.size());
    ConeJudge judge;
    if (!judge.passes(restated.problem, kRestated, same) || judge.rounded())
      return "restated, the judge refuses the same z";
  }
  const bool solved = s.status == Status::solved, infeasible = s.status == Status::infeasible;
  runner.solve(restated.problem, limit);
  const Solution& again = runner.solution;
  if (again.status == Status::solved) {
    const Finding finding = examine_cones(restated.problem, again.z, kTolerance, Status::solved);
    if (!finding.holds) return "restated: " + finding.why;
  }
  if ((solved && again.status == Status::infeasible) || (infeasible && again.status == Status::solved))
    return std::string(name(s.status)) + ", restated " + std::string(name(again.status));
  return {};
}

}  // namespace

std::vector<std::size_t> solvers_of(const StormChoice& choice, std::uint64_t k) {
  const std::uint64_t kinds = kinds_of(choice).size(), turn = k / kinds;
  std::vector<std::size_t> always, dealt;
  for (std::size_t i = 0; i < choice.solvers.size(); ++i)
    (choice.solvers_each == 0 || choice.solvers[i].spec == "auto" ? always : dealt).push_back(i);
  if (!dealt.empty()) {
    const std::uint64_t turns = (dealt.size() + choice.solvers_each - 1) / choice.solvers_each;  // of a deal
    Random random((choice.seed * 0x9e3779b97f4a7c15u + turn / turns) * kinds + k % kinds);
    for (std::size_t i = dealt.size(); i-- > 1;)
      std::swap(dealt[i], dealt[static_cast<std::size_t>(random.integer(0, static_cast<int>(i)))]);
    const std::size_t begin = turn % turns * choice.solvers_each;
    for (std::size_t i = begin; i < std::min(begin + choice.solvers_each, dealt.size()); ++i)
      always.push_back(dealt[i]);
  }
  std::erase_if(always, [&](std::size_t i) { return turn % static_cast<std::uint64_t>(choice.solvers[i].every) != 0; });
  std::ranges::sort(always);
  return always;
}

StormTally storm(const StormChoice& choice, std::uint64_t first, std::uint64_t count) {
  StormTally tally;
  std::vector<std::unique_ptr<Trial>> runners(choice.solvers.size());  // made when first needed
  for (std::uint64_t k = first; k < first + count; ++k) {
    const StormProblem p = problem_of(choice, k);
    Verdicts verdicts(p);
    const auto turn = k / kinds_of(choice).size();
    if (turn % 2 == 0)  // both have faults of their own: solvers that are new, and that were used
      for (auto& runner : runners) runner.reset();
    const double limit = turn % kPatient == 0 ? choice.time_limit : std::min(kBrief, choice.time_limit);
    for (const std::size_t i : solvers_of(choice, k)) {
      const StormSolver& each = choice.solvers[i];
      if (p.problem.size() > each.largest) continue;
      StormTally::Row& row = tally.rows[{std::string(p.kind), each.spec}];
      std::string why;
      StormResult result = StormResult::crashed;
      try {
        if (!runners[i]) runners[i] = std::make_unique<Trial>(each.spec);
        const double seconds = runners[i]->solve(p.problem, limit);
        result = verdicts.judge(runners[i]->solution, seconds, limit + choice.grace, why, row);
        if (choice.discs && why.empty() && (turn + i) % 8 == 0 && can_be_restated(p.problem)) {
          const Solution said = runners[i]->solution;
          why = contradiction(p.problem, said, *runners[i], limit, k);
          if (!why.empty()) result = StormResult::wrong;
        }
      } catch (const std::exception& error) {
        why = error.what();
      }
      ++row.count[static_cast<std::size_t>(result)];
      if (!why.empty())
        tally.faults.push_back(
            {k, std::string(p.kind), each.spec, std::string(kStormResults[static_cast<std::size_t>(result)]), why});
    }
  }
  return tally;
}

StormResult storm_one(const Lcp& problem, std::optional<Answer> answer, const std::string& spec,
                      const StormChoice& choice, std::string& why) {
  const StormProblem p{"", problem, answer};
  StormTally::Row row;
  try {
    Trial runner(spec);
    const double seconds = runner.solve(problem, choice.time_limit);
    return Verdicts(p).judge(runner.solution, seconds, choice.time_limit + choice.grace, why, row);
  } catch (const std::exception& error) {
    why = error.what();
    return StormResult::crashed;
  }
}

std::string to_text(const StormTally& tally) {
  constexpr double kMostError = std::numeric_limits<double>::max();  // JSON has no ∞
  nlohmann::json json = {{"rows", nlohmann::json::array()}, {"faults", nlohmann::json::array()}};
  for (const auto& [key, row] : tally.rows)
    json["rows"].push_back({key.first, key.second, row.count, std::min(row.error, kMostError), row.exact, row.rounded});
  for (const StormFault& f : tally.faults) json["faults"].push_back({f.k, f.kind, f.solver, f.what, f.why});
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

StormTally storm_tally_from_text(const std::string& text) {
  const auto json = nlohmann::json::parse(text);
  StormTally tally;
  for (const auto& row : json.at("rows"))
    tally.rows[{row.at(0), row.at(1)}] = {row.at(2), row.at(3), row.at(4), row.at(5)};
  for (const auto& f : json.at("faults")) tally.faults.push_back({f.at(0), f.at(1), f.at(2), f.at(3), f.at(4)});
  return tally;
}

}  // namespace orthant
