// experiments/sweep/drift.h — drift of conserved quantities: the largest deviations from the start so far.
//
//   energy   |E − E₀| [J]
//   momentum |Σ m v − P₀| [N s],  spin |Σ m (x × v) + J ω − L₀| [N m s] about the origin; of isolated systems: no
//            gravity, no load, drive or coordinate law, and nothing that holds or touches the ground. Else NaN.
// That energy falls where there is friction or e < 1 is no fault: which of the figures must be zero is for the reader.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

namespace orthant {

/// Linear and angular momentum about the origin; in the plane their parts x, y and about z.
struct Momenta {
  Eigen::Vector3d linear{0, 0, 0}, angular{0, 0, 0};
};

template <class Space> class Drift {
 public:
  explicit Drift(const SystemOf<Space>& system);
  /// The first state is the start.
  void add(const State& x);

  double energy() const { return energy_; }
  double momentum() const { return momentum_; }
  double spin() const { return spin_; }

 private:
  const SystemOf<Space>& system_;
  bool started_ = false;
  double energy_0_ = 0, energy_ = 0, momentum_, spin_;
  Momenta start_;
};

}  // namespace orthant
