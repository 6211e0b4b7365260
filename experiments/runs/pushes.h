// experiments/runs/pushes.h — forces of searched collisions: which pairs pushed in a step, where, in which direction
//
//   A run's table has the sum of each collision alone; a view draws an arrow for each pair.
#pragma once

#include <orthant/integrators/simulate.h>

#include <vector>

namespace orthant {

struct Push {
  double t = 0;            // [s] end of the step
  Pair pair;               // which two shapes
  Vector2d point, normal;  // [m], of the world; what pushes the first body away
  double impulse = 0;      // [N s] > 0, of the step
};

class PushLog {
 public:
  static constexpr double kMostSteps = 20000;  // of runs whose pushes are logged: memory

  explicit PushLog(const System& system) : system_(system), terms_(system) {}

  /// Whether the run has any, and is recorded at each step: sums over steps do not know their pairs.
  static bool wanted(const System& system, const Clock& clock) {
    return system.contacts() > system.listed() && clock.every == 1 && clock.duration / clock.step <= kMostSteps;
  }
  /// Of more than half a million nothing is kept.
  void add(const RunSample& moment);

  const std::vector<Push>& pushes() const { return pushes_; }

 private:
  const System& system_;
  Terms terms_;
  std::vector<Push> pushes_;
  bool full_ = false;
};

}  // namespace orthant
