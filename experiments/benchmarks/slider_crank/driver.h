// experiments/benchmarks/slider_crank/driver.h — driver base of all slider-crank rivals: parameters, calls, answer.
//
//   DRIVER                     prints a line for each method: name, then what its setting is: step [s] or tolerance
//   DRIVER METHOD MU E SETTING runs 0.2 s and prints: theta1 [rad], seconds of the run alone, steps, a note
//
//   The scene: core/scenes/slider_crank.h. Timed is the loop over steps, processor time, once the model is built.
#pragma once

#include "../../support/clock.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace rival {

constexpr double l1 = 0.153, l2 = 0.306, a = 0.05, b = 0.025, clearance = 0.001;             // [m]
constexpr double m1 = 0.038, m2 = 0.038, m3 = 0.076, J1 = 7.4e-5, J2 = 5.9e-4, J3 = 2.7e-6;  // [kg], [kg m²]
constexpr double g = 9.81, omega1 = 150, omega2 = -75, duration = 0.2;
constexpr double wall = b + clearance;  // y = ± wall

struct Motion {
  double theta1 = NAN;
  long steps = 0;
  std::string note;
};

struct Method {
  const char *name, *setting;
  std::function<std::function<Motion()>(double mu, double e, double setting)> build;  // then run, which is timed
};

/// main(), in full.
inline int drive(int argc, char** argv, const std::vector<Method>& methods) try {
  if (argc == 5)
    for (const Method& method : methods)
      if (std::strcmp(method.name, argv[1]) == 0) {
        const auto run = method.build(std::atof(argv[2]), std::atof(argv[3]), std::atof(argv[4]));
        const double begin = processor_time();
        const Motion motion = run();
        const double seconds = processor_time() - begin;
        std::printf("%.17g %.9g %ld %s\n", motion.theta1, seconds, motion.steps, motion.note.c_str());
        return 0;
      }
  for (const Method& method : methods) std::printf("%s %s\n", method.name, method.setting);
  return argc == 1 ? 0 : 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

}  // namespace rival
