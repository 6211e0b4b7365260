#include "experiments/support/fit_order.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

std::vector<double> step_sizes(const Ladder& ladder) {
  std::vector<double> steps;
  for (int i = 0; i < ladder.octaves * ladder.steps_per_octave; ++i) {
    const double h = ladder.coarsest * std::exp2(-(i + 0.5) / ladder.steps_per_octave);
    steps.push_back(ladder.duration > 0 ? ladder.duration / std::round(ladder.duration / h) : h);
  }
  return steps;
}

Fit fit_order(std::vector<Sample> samples) {
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.h > b.h; });
  Fit fit;
  double octave_end = 0;
  for (const Sample& s : samples) {
    if (!(s.error > 0) || !std::isfinite(s.error))
      throw std::invalid_argument("fit_order: an error is not positive and finite");
    if (fit.worst.empty() || s.h <= octave_end * (1 + 1e-3)) {  // slack: a step moved to divide the duration
      if (fit.worst.empty()) octave_end = s.h;
      while (s.h <= octave_end * (1 + 1e-3)) octave_end /= 2;  // of a sparse list several at once
      fit.worst.push_back(s);
    } else if (s.error > fit.worst.back().error) {
      fit.worst.back() = s;
    }
  }
  const auto n = static_cast<double>(fit.worst.size());
  if (n < 2) throw std::invalid_argument("fit_order: needs samples in two octaves at least");
  double x = 0, y = 0, xx = 0, xy = 0, residual = 0;
  for (const Sample& s : fit.worst) x += std::log(s.h) / n, y += std::log(s.error) / n;
  for (const Sample& s : fit.worst) {
    xx += (std::log(s.h) - x) * (std::log(s.h) - x);
    xy += (std::log(s.h) - x) * (std::log(s.error) - y);
  }
  fit.order = xy / xx;
  for (const Sample& s : fit.worst) {
    const double off = std::log(s.error) - y - fit.order * (std::log(s.h) - x);
    residual += off * off;
  }
  fit.scatter = std::sqrt(residual / std::max(1.0, n - 2));
  return fit;
}

Fit fit_order(const Ladder& ladder, const std::function<double(double)>& error) {
  std::vector<Sample> samples;
  for (const double h : step_sizes(ladder)) samples.push_back({h, error(h)});
  return fit_order(std::move(samples));
}

}  // namespace orthant
