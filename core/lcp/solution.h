// core/lcp/solution.h — solution and status of a solve.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <string_view>

namespace orthant {

enum class Status {
  not_run,
  solved,           // certify() accepted z
  infeasible,       // certify() accepted `certificate` as a proof that no z satisfies w ≥ 0 within the bounds
  ray,              // the method ended on a ray: proves nothing by itself
  iteration_limit,  // iterations used up
  time_limit,       // the time given is over
  cancelled,        // the caller raised the flag
  stalled,          // no further progress, residual above the tolerance
  unsupported,      // the problem is not of the method's kind: why_not() says why
  numerical_error,  // lost to rounding: not finite, or |z| so large that w cannot be known
};
std::string_view name(Status status);

struct Solution {  // reuse it: the second solve of a size allocates nothing
  Status status = Status::not_run;
  double residual =
      kInf;  // max_i d_i |z_i − clamp(z_i − w_i / d_i, lo_i, hi_i)|, d_i = max(1, max_j |A_ji|)  [units of w]
  double rounding = 0;  // ρ = ε max_i (|b_i| + Σ_j |A_ij z_j|): w cannot be known below it            [units of w]
  int iterations = 0;
  long factorizations = 0;     // of matrices, by the library's own methods (effort.h)
  double factorized_rows = 0;  // their rows in all: over n, the same in units of a whole matrix
  Vector z, w;                 // n; w = A z + b recomputed from the caller's data
  Vector certificate;          // n: u that proves infeasibility (or the ray's direction, a hint); else empty
};

}  // namespace orthant
