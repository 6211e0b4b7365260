// experiments/studies/verdict_storm/problems.h — random problems of every kind on which solvers failed, n = 1 … 40.
//
//   Problem k of a seed is the same on every machine and does not depend on the others. Small n are more frequent;
//   dense and sparse storage take turns. Where an answer is known by construction it comes along.
#pragma once

#include <orthant/core/lcp/problems/collection.h>

#include <optional>
#include <span>
#include <string_view>

namespace orthant {

struct StormProblem {
  std::string_view kind;
  Lcp problem;
  std::optional<Answer> answer;  // empty: unknown
};

StormProblem storm_problem(std::uint64_t seed, std::uint64_t k);

/// The names of all kinds.
std::span<const std::string_view> storm_kinds();

}  // namespace orthant
