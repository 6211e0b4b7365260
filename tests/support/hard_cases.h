// tests/support/hard_cases.h — problems that break methods, with the distance of a z from their solutions.
//
// The known problems of the collection, their complete solution sets where these are not a single point, and larger
// ones of the same families. The answers are exact, or come from an independent computation named beside them.
#pragma once

#include <orthant/core/lcp/problems/collection.h>

#include <functional>
#include <string>
#include <vector>

namespace orthant {

struct HardCase {
  std::string name;
  Lcp problem;
  Answer answer = Answer::unique;
  double accuracy = 0;                           // of error(): what the conditioning allows a z correct to rounding
  double seconds = 5;                            // time limit: short where a method may use up any
  std::function<double(const Vector& z)> error;  // ‖z − nearest solution‖∞ / ‖that‖∞; empty where there is none
};

/// n ≤ 255: for every solver in every storage.
std::vector<HardCase> hard_cases();

/// Up to 10⁵ rows, in one storage: for the solvers that can.
std::vector<HardCase> large_cases();

}  // namespace orthant
