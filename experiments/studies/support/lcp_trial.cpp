#include "experiments/studies/support/lcp_trial.h"

#include "experiments/studies/support/independent_judge.h"
#include "experiments/support/clock.h"

#include <orthant/core/lcp/judge/cells.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace orthant {
namespace {

/// The last three kinds of events, in the order in which each was last seen. Events with numbers are cut before them;
/// entries without one are the method's plain iterations.
std::string stages_of(const IterationLog& log) {
  std::vector<std::string> stages;
  for (auto entry = log.rbegin(); entry != log.rend() && stages.size() < 3; ++entry) {
    std::string event = entry->event;
    if (event.find_first_of("0123456789") != std::string::npos) event = event.substr(0, event.find(':'));
    if (event.empty()) event = "iterations";
    if (std::ranges::count(stages, event) == 0) stages.push_back(event);
  }
  std::string text;
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) text += (text.empty() ? "" : " > ") + *stage;
  return text;
}

}  // namespace

void judge_solution(const Lcp& problem, const Vector& z, Trial& t) {
  const auto [residual, size] = achieved(problem, z);
  const double scale = 1 + problem.b.lpNorm<Eigen::Infinity>();
  t.residual = residual;
  t.rounding = std::numeric_limits<double>::epsilon() * size;
  t.holds = residual <= std::max(1e-10 * scale, std::min(20 * t.rounding, 1e-4 * scale));
}

Trial try_solver(const Lcp& problem, const std::string& spec, double time_limit) {
  constexpr double kEnough = 0.1;  // [s]
  Trial t;
  const auto solver = make_solver(spec);
  solver->set_time_limit(time_limit);
  Solution s;
  IterationLog log;
  solver->set_log(&log);
  const double begin = rival::processor_time();
  solver->solve(problem, s);
  const double first = rival::processor_time() - begin;
  solver->set_log(nullptr);
  t.stages = stages_of(log);
  if (s.status == Status::unsupported) t.note = solver->refusal(problem);
  // The logged run counts only when it is the only one.
  const double left = std::min(kEnough, time_limit - first);
  rival::Timing timing{first, 1};
  if (first < left && s.status != Status::unsupported)
    timing = rival::time_calls([] {}, [&] { solver->solve(problem, s); }, left);
  t.status = name(s.status);
  t.iterations = s.iterations;
  t.runs = timing.runs;
  t.seconds = timing.seconds;
  judge_solution(problem, s.z, t);
  if (s.status == Status::infeasible)
    t.holds = s.cells.empty() ? independent_proof(problem, s.certificate) : no_cell_has_a_solution(problem, s.cells);
  return t;
}

std::string to_text(const Trial& t) {
  return nlohmann::json{t.status, t.iterations, t.runs, t.seconds, t.residual, t.rounding, t.holds, t.stages, t.note}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Trial trial_from_text(const std::string& text) {
  const auto json = nlohmann::json::parse(text);
  const auto number = [&](std::size_t i) { return json[i].is_null() ? kInf : json[i].get<double>(); };
  return {json[0], json[1], json[2], number(3), number(4), number(5), json[6], json[7], json[8]};
}

const char* name(Result result) {
  constexpr const char* kNames[kResults] = {"certified", "refused", "failed", "wrong", "crashed", "late", "skipped"};
  return kNames[static_cast<int>(result)];
}

Result judge(const Trial& t, std::optional<Answer> answer) {
  const bool solvable = answer == Answer::unique || answer == Answer::one_of;
  if (t.status == name(Status::solved) || t.status == name(Status::rounded))
    return t.holds && (solvable || !answer) ? Result::certified : Result::wrong;
  if (t.status == name(Status::infeasible))
    return t.holds && (answer == Answer::infeasible || answer == Answer::none || !answer) ? Result::certified
                                                                                          : Result::wrong;
  if (t.status == name(Status::unsupported)) return Result::refused;
  if (t.status == "skipped") return Result::skipped;
  if (t.status == "killed") return Result::late;
  const bool crashed = t.status == "crashed" || t.status == "exception";
  return crashed ? Result::crashed : Result::failed;
}

}  // namespace orthant
