#include "lcp_trial.h"

#include "independent_judge.h"

#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <ctime>

namespace orthant {
namespace {

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

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
  t.holds = residual <= std::max(1e-10 * scale, 20 * t.rounding) && t.rounding <= 1e-6 * scale;
}

Trial try_solver(const Lcp& problem, const std::string& spec, double time_limit) {
  constexpr double kEnough = 0.1;  // [s]
  constexpr double kShort = 2e-5;  // [s] below it calls are timed in a row: the clock takes a part of a microsecond
  constexpr int kMostRuns = 5;
  Trial t;
  const auto solver = make_solver(spec);
  solver->set_time_limit(time_limit);
  Solution s;
  std::vector<double> times;
  const auto begin = std::chrono::steady_clock::now();
  const auto run = [&](int calls) {
    const double start = processor_time();
    for (int k = 0; k < calls; ++k) solver->solve(problem, s);
    times.push_back((processor_time() - start) / calls);
  };
  IterationLog log;
  solver->set_log(&log);
  run(1);
  solver->set_log(nullptr);
  t.stages = stages_of(log);
  if (s.status == Status::unsupported) t.note = solver->why_not(problem);
  const double first = times[0];
  if (first < kEnough && s.status != Status::unsupported) {
    const auto spent = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
    times.clear();  // the logged run only counts when it is the only one
    run(1);
    const int calls = times[0] < kShort ? static_cast<int>(kShort / std::max(times[0], 1e-7)) + 1 : 1;
    if (calls > 1) times.clear();
    double sum = times.empty() ? 0 : times[0];
    for (; static_cast<int>(times.size()) < kMostRuns && sum < kEnough && spent() + first < time_limit;
         sum += calls * times.back())
      run(calls);
  }
  t.status = name(s.status);
  t.iterations = s.iterations;
  t.runs = static_cast<int>(times.size());
  std::ranges::nth_element(times, times.begin() + t.runs / 2);
  t.seconds = times[static_cast<std::size_t>(t.runs / 2)];
  judge_solution(problem, s.z, t);
  if (s.status == Status::infeasible) t.holds = independent_proof(problem, s.certificate);
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
  constexpr const char* kNames[kResults] = {"certified", "refused", "failed", "wrong", "crashed", "skipped"};
  return kNames[static_cast<int>(result)];
}

Result judge(const Trial& t, std::optional<Answer> answer) {
  const bool solvable = answer == Answer::unique || answer == Answer::one_of;
  if (t.status == name(Status::solved)) return t.holds && (solvable || !answer) ? Result::certified : Result::wrong;
  if (t.status == name(Status::infeasible))
    return t.holds && (answer == Answer::infeasible || !answer) ? Result::certified : Result::wrong;
  if (t.status == name(Status::unsupported)) return Result::refused;
  if (t.status == "skipped") return Result::skipped;
  const bool crashed = t.status == "crashed" || t.status == "killed" || t.status == "exception";
  return crashed ? Result::crashed : Result::failed;
}

}  // namespace orthant
