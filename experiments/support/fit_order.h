// experiments/support/fit_order.h — observed order of convergence of an error that is a sawtooth in h.
//
// Impacts fall anywhere in a step, so error(h) jumps up and down and neighbouring halvings tell nothing. The worst
// error of each octave of h is regular: the order is the slope of its logarithm, by least squares.
#pragma once

#include <functional>
#include <vector>

namespace orthant {

struct Sample {
  double h = 0, error = 0;
};

struct Fit {
  double order = 0;
  double scatter = 0;         // standard deviation of ln(error) about the line: large means "this is no straight line"
  std::vector<Sample> worst;  // one per octave, at the step size where it was met; coarse to fine
};

/// Samples sorted into octaves of h from the largest down. Throws std::invalid_argument below two octaves, or when an
/// error is not positive and finite.
Fit fit_order(std::vector<Sample> samples);

struct Ladder {
  double coarsest = 1e-3;  // [s]
  int octaves = 5, steps_per_octave = 16;
  double duration = 0;  // > 0: each h is moved to the nearest one that divides it
};
std::vector<double> step_sizes(const Ladder& ladder);

/// Convenience: measures error(h) on the ladder.
Fit fit_order(const Ladder& ladder, const std::function<double(double)>& error);

}  // namespace orthant
