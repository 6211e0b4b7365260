// experiments/studies/support/lcp_trial.h — LCP trial: one solver on one problem; its claim, the check of it, its cost.
#pragma once

#include <orthant/core/lcp/problems/collection.h>

#include <optional>
#include <string>

namespace orthant {

struct Trial {
  std::string status = "skipped";  // the solver's claim, or: crashed, killed, exception, skipped
  int iterations = 0, runs = 0;
  double seconds = kInf;   // processor time of a solve, the median of `runs`
  double residual = kInf;  // as independent_judge.h measures it                                      [units of w]
  double rounding = kInf;  // ρ                                                                       [units of w]
  bool holds = false;  // r ≤ 1e-10 (1 + ‖b‖∞), or r ≤ 20 ρ and 1e-4 (1 + ‖b‖∞); claimed infeasible: the proof does
  std::string stages;  // what the iteration log says happened, the last stage last: "crash > on trust"; fast paths too
  std::string note;    // why refused, the signal, the exception
};

/// Solves once with the iteration log on; a solve shorter than 0.1 s is repeated without it, the solver object reused,
/// as time_calls() of benchmarks/clock.h does for all, never past the time limit [s].
Trial try_solver(const Lcp& problem, const std::string& spec, double time_limit);

/// Residual, rounding and whether a solution holds, of a z.
void judge_solution(const Lcp& problem, const Vector& z, Trial& trial);

std::string to_text(const Trial& trial);
Trial trial_from_text(const std::string& text);

/// certified   an acceptable solution, or the proof that there is none
/// refused     the solver said beforehand that it does not take the problem
/// failed      no answer, and none claimed
/// wrong       a claim that does not hold
/// crashed     ended by a signal or by an exception
/// late        ended by us, half as long again after its time was over
/// skipped     out of time on a smaller problem of the kind
enum class Result { certified, refused, failed, wrong, crashed, late, skipped };
inline constexpr int kResults = 7;
const char* name(Result result);

/// `answer`: the known answer of the problem; empty: none.
Result judge(const Trial& trial, std::optional<Answer> answer);

}  // namespace orthant
