// integrators/step/underflow.h — underflow: remainders that fall below the range of normal numbers become 0.
//
// Motion in a plane leaves such remainders across it in space. A processor takes up to a hundred times as long with
// subnormal numbers: a third of the time of the slider-crank, unless it is turned in space.
#pragma once

#include <Eigen/Core>

#include <cmath>

namespace orthant {

/// Numbers below 1e-200 become 0.
inline void drop_underflow(Eigen::VectorXd& x) {
  for (double& value : x)
    if (std::abs(value) < 1e-200) value = 0;
}

}  // namespace orthant
