// experiments/sweep/drift.h — drift of conserved quantities: the largest deviations from the start so far.
//
//   energy   |E − E₀| [J]
//   momentum |Σ m v − P₀| [N s],  spin |Σ m (x × v) + J ω − L₀| [N m s] about the origin; of isolated systems: no
//                                 gravity,
//            no load, drive or coordinate law, and nothing that holds or touches the ground. Else NaN.
// That energy falls where there is friction or e < 1 is no fault: which of the figures must be zero is for the reader.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

namespace orthant {

class Drift {
 public:
  explicit Drift(const System& system);
  /// The first state is the start.
  void add(const State& x);

  double energy() const { return energy_; }
  double momentum() const { return momentum_; }
  double spin() const { return spin_; }

 private:
  const System& system_;
  bool started_ = false;
  double energy_0_ = 0, energy_ = 0, momentum_, spin_;
  Eigen::Vector3d start_{0, 0, 0};  // P, L
};

}  // namespace orthant
