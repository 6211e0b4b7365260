// integrators/derivatives/parameter_change.h — parameters of a run, and which parts of the scene each one changes.
//
//   Scenes at value + k step, k = ±1, ±2, show the parts that change; step = 1e-3 |value|, or 1e-5 at 0. Parameters
//   that enter the equations linearly (masses, weights, μ, e, e_T, belts, bounds of dry friction) have one derivative
//   for the whole run. Elements with other geometry or other laws in time are listed: in each step only these are
//   evaluated, four times.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace orthant {

struct RunParameter {
  std::string name;
  double value = 0;
  std::function<Scene(double)> scene;  // at another value; empty: none of the scene
  Eigen::Index start = -1;             // entry of the initial (q, v), 0 … 2 dof − 1, that it is; −1: none
};

struct ParameterChange {
  struct Law {
    int contact;
    double mu, e, e_t, mu_static, belt;
  };
  Eigen::VectorXd mass, weight;                                  // dof; empty: unchanged
  std::vector<Law> laws;                                         // of the contacts that change theirs
  std::vector<std::pair<int, double>> bounds;                    // of dry frictions
  std::vector<int> joints, contacts, springs, frictions, loads;  // with other geometry, laws in time or forces
  Eigen::VectorXd start_q, start_v;                              // of the scenes' initial states; dof
  double step = 0;
  std::array<std::unique_ptr<System>, 4> at;  // k = −2, −1, 1, 2; null: no parameter of the scene

  bool of_scene() const { return at[0] != nullptr; }

  /// f(system, values) fills n values: their derivatives, by differences of fourth order.
  template <std::size_t n, class F> std::array<double, n> derivative(F&& f) const {
    std::array<double, n> sum{}, values{};
    constexpr double kWeights[] = {1, -8, 8, -1};
    for (std::size_t k = 0; k < 4; ++k) {
      values = {};
      f(*at[k], values);
      for (std::size_t i = 0; i < n; ++i) sum[i] += kWeights[k] * values[i];
    }
    for (double& x : sum) x /= 12 * step;
    return sum;
  }
};

/// Throws std::invalid_argument for a parameter at the end of its range, where no scene lies on one side, and for a
/// place of the start that is none.
ParameterChange changes_of(const RunParameter& parameter, const System& system, double relative_step = 1e-3);

}  // namespace orthant
