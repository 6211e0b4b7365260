// core/lcp/solution.h — solution of a problem, a method's claim about it, and the judge's status.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

/// A method's own account of its run. Only the judge (judge/certify.h) turns it into a status.
enum class Claim {
  candidate,        // z may be a solution: please judge
  ray,              // ended on a ray; its direction, if known, is in Solution::ray
  exhausted,        // every cell searched, none has a solution: Solution::cells
  iteration_limit,  // the others: as the status of the same name
  time_limit,
  cancelled,
  stalled,
  unsupported,
  numerical_error,
};

enum class Status {
  not_run,
  solved,      // every row's violation is at most the tolerance times its data
  rounded,     // rows miss solved, by at most 20 units in the last place of their terms: no z is known to be better
  infeasible,  // `certificate` or `cells` proves that there is no solution
  ray,         // the method ended on a ray: proves nothing by itself
  iteration_limit,  // iterations used up
  time_limit,       // the time given is over
  cancelled,        // the caller raised the flag
  stalled,          // no further progress, a violation above the tolerance
  unsupported,      // the problem is not of the method's kind: why_not() says why
  numerical_error,  // lost to rounding: not finite
};
std::string_view name(Status status);
Status status_of(Claim claim);  // of a claim that no judge confirms; candidate: stalled

/// True for solved and rounded: z can be used.
inline bool has_answer(Status status) { return status == Status::solved || status == Status::rounded; }

/// The row that stands most in the way of `solved`.
struct Miss {
  enum class Against { inside, lower, upper, outside, jacobian, cone, underflow };
  Index row = -1;  // −1: none does
  Against against = Against::inside;
  // v_i and its limit [units of w]; the limit over the row's data. jacobian: how far F's change along z is from J's.
  // cone: of the contact with the normal row `row`, by the law of its disc. underflow: F and J vanish for want of
  // smaller doubles; by: F at the last point next to z at which they do not.
  double by = 0, allowed = 0, tolerance = 0;
};

/// A class of cells without a solution (judge/cells.h): sides of the first rows in the order of decision, and why.
struct Cell {
  enum class Why : std::int8_t { from_lower, to_upper, w, equation, within, polyhedron };
  std::vector<signed char> sides;       // −1 lower, 0 inside, 1 upper
  std::vector<std::int16_t> expressed;  // by each equation: an entry of z; −1: it left none
  Why why = Why::w;
  int row = 0;  // of the form
};

struct Solution {  // reuse it: the second solve of a size allocates nothing
  Status status = Status::not_run;
  double residual = kInf;  // max_i v_i, how far w_i is from what z_i allows (judge/certify.h)        [units of w]
  double rounding = 0;     // ε max_i (|b_i| + Σ_j |A_ij z_j|): a last digit of the terms of w        [units of w]
  Miss miss;
  bool coarse = false;  // rounded, but w is wrong in its first digits: another z may be better (judge/certify.h)
  int iterations = 0;
  long factorizations = 0;     // of matrices, by the library's own methods (factorization_count.h)
  double factorized_rows = 0;  // their rows in all: over n, the same in units of a whole matrix
  Vector z, w;                 // n; w = A z + b recomputed from the caller's data
  Vector certificate;       // n: u, or nearest to the exact u, that proves infeasibility (judge/certify.h); else empty
  std::vector<Cell> cells;  // all, searched: proves infeasibility; else empty
  Vector ray;               // n: direction in which the method ended, a hint that proves nothing; else empty
};

/// The same of a miss: "row 12 misses by …".
std::string words_of(const Miss& miss);

/// Reason in one line why the status is not solved, as far as z shows it: "row 12 misses by 3e-9, inside its bounds;
/// 1e-10 of its data is 4e-13". Empty for solved.
std::string why(const Solution& solution);

}  // namespace orthant
