// experiments/python/results.h — orthant.Result: status, solution and effort of one solve.
#pragma once

#include <orthant/core/lcp/solution.h>
#include <orthant/solvers/iteration_log.h>

#include <pybind11/numpy.h>

#include <string>
#include <vector>

namespace orthant::python {

struct Result {
  std::string status;
  pybind11::array_t<double> z, w;
  pybind11::object certificate;
  double residual;
  pybind11::object residual_scale_free, residual_natural;  // None: no discs
  double rounding;
  int iterations;
  long factorizations;
  double seconds;
  std::string why_not, why;
  double cells;
  pybind11::object cell_search;
  std::vector<LogEntry> log;

  bool solved() const { return status == name(Status::solved); }
  std::string repr() const;
};

Result result_of(const Lcp& problem, const Solution& s, double seconds, std::string why_not, std::vector<LogEntry> log);

}  // namespace orthant::python
