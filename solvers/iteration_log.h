// solvers/iteration_log.h — iteration log: the steps of a solver as data, on request.
#pragma once

#include <string>
#include <vector>

namespace orthant {

struct LogEntry {
  int iteration = 0;
  double merit = 0;   // what the method drives to zero, in its own measure
  double step = 0;    // length of the step taken, 0 where there is none
  std::string event;  // in words: "pivot: z3 enters, w1 leaves", "restart", "long double"
};
using IterationLog = std::vector<LogEntry>;

}  // namespace orthant
