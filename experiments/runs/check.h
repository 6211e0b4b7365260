// experiments/runs/check.h — error estimate of a run by repetition: how many digits of its last state agree.
//
//   The run is repeated by its own scheme, and each coordinate and velocity at the end is compared:
//     adaptive, event-driven   rtol and atol a hundredth; where rounding leaves no room for that, a hundred times as
//                              large; and the other of the two: where friction is not unique, rounding decides, in
//                              each in its own way
//     fixed step h             h/2 and 2h/3, and adaptive at rtol = 1e-9 where it takes the scene: what all step sizes
//                              share (bodies that pass through each other, a relaxed law) shows there only; in space
//                              h/4, too
//   error = the largest difference, times 3 for h/2, 4 for 2h/3 (of a scheme of order 1, where its error is 2 and 3
//   times the difference), 1.5 for h/4 and 2 for a tolerance; never less than a floor, for runs may agree by
//   construction: 1e-12, or 2e-16 times the steps, of the largest coordinate or velocity of the same unit.
//   digits = ⌊−log10(error / |value|)⌋, 0 to 15: significant decimal digits of the value.
//   Limits: an error that all repetitions share is not seen. Each repetition may take 20 times as long as the run, and
//   10 s; one that fails or takes longer is not compared, and is named.
// Cost: adaptive and event-driven about three times the run, a fixed step 5 times.
#pragma once

#include <orthant/integrators/simulate.h>

#include <string>
#include <string_view>
#include <vector>

namespace orthant {

struct CheckedColumn {
  std::string name;  // as in trajectory_columns()
  double value = 0;
  double error = kInf;  // [the column's unit]; infinite: nothing was compared
  int digits = 0;
};

struct CheckedRun {
  std::string against;                 // the repetitions compared, in words
  std::string left_out;                // those that failed, and why; empty: none
  std::vector<CheckedColumn> columns;  // those of the bodies in a trajectory (trajectory.h)
};

/// Of a run of `system` that ended `solved`, by integrator and solver of these specs.
template <class Space> CheckedRun check_run(const SystemOf<Space>& system, std::string_view integrator,
                                            std::string_view solver, const Clock& clock, const Run& run);

}  // namespace orthant
