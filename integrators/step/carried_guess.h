// integrators/step/carried_guess.h — first guess of a step's impulses: what each contact bore in the step before.
//
// Rows of z move where contacts close and open. A contact is known again by what touches: its number among the listed
// ones, or its pair of shapes and its point. One that was open begins with 0.
#pragma once

#include <orthant/integrators/checkpoint.h>
#include <orthant/integrators/step/step_problem.h>

#include <vector>

namespace orthant {

class CarriedGuess {
 public:
  /// z: the last solution, in and out: a guess for the problem that was collected from these terms. O(contacts).
  void fit(const StepProblemOf<Spatial>& problem, const TermsOf<Spatial>& terms, Eigen::Index listed, Vector& z);
  void remember(CheckpointData& memory) { memory(last_); }

 private:
  struct Place {
    Pair key;
    int normal = -1, tangent = -1;  // first rows; −1: none
    auto operator<=>(const Place&) const = default;
  };
  std::vector<Place> last_, now_;  // by keys, ascending
  Vector was_;
};

}  // namespace orthant
