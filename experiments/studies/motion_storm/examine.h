// experiments/studies/motion_storm/examine.h — a recorded run and what is measured of it, row by row and between rows.
#pragma once

#include "experiments/studies/motion_storm/measure_of.h"
#include "experiments/studies/motion_storm/trace.h"

#include <string>
#include <vector>

namespace orthant::motion_storm {

inline constexpr double kPassed = 0.2;  // of the thinner shape: deeper is a passage

/// The worst of a trace up to `until` [s], each with the element and the time in words.
struct Figures {
  struct Worst {
    double value = 0;
    std::string where;
  };
  bool finite = true;
  Worst joint;         // [m, rad] residual
  double overlap = 0;  // [m, rad] in the first row
  Worst depth;         // [m, rad] penetration beyond that of the first row
  Worst depth_share;   // of the penetration, in what depth_allowed() allows it
  Worst passed;        // how much deeper on the straight way between two rows than at its ends, less slack; in widths
  Worst gain;          // [J] energy that neither loads nor belts nor the run's reported rises account for
  long passages = 0;   // intervals between rows in which two shapes pass by more than kPassed
  double energy = 0;   // [J] its scale: largest kinetic energy and range of potential energy
  double speed = 0;    // [m/s] the largest of a point of a body
  double size = 0;     // [m] of the bodies and of the room that they move in
};

struct Allowance {
  double step = 0;   // [s] h > 0: of a scheme of fixed step, which may err by some h v; 0: only `share` counts
  double share = 0;  // of the size: gaps that a scheme of this tolerance may leave
};

Figures examine(const Scene& scene, const Trace& trace, const Allowance& allowed,
                double until = std::numeric_limits<double>::infinity());
Figures examine(const spatial::Scene& scene, const Trace& trace, const Allowance& allowed,
                double until = std::numeric_limits<double>::infinity());

/// The largest difference of coordinates at the times of the coarser one of two traces, up to the time that both reach:
/// places in sizes, angles (of rotations, in space) in rad.
template <class Space = Planar>
double difference(const std::vector<State>& a, const std::vector<State>& b, double size);

}  // namespace orthant::motion_storm
