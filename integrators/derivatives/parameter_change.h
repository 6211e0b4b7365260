// integrators/derivatives/parameter_change.h — parameters of a run, and which parts of the scene each one changes.
//
//   Scenes at value + k step show the parts that change: k = ±1, ±2; k = 0 … 3 or −3 … 0 where the scene exists on one
//   side only (one-sided). The step is relative_step |value| (1e-2 in place of 0) where that resolves the change of
//   these parts at the start, at several times of the run: where two orders of the difference agree, and rounding is
//   small. Else it is 10ⁿ times that, the best n.
//   Parameters that enter the equations linearly (masses, weights, μ, e, e_T, belts, bounds of dry friction) have one
//   derivative for the whole run. Elements with other geometry or other laws in time are listed: in each step only
//   these are evaluated, four times.
//   Loads that change the times of their breakpoints: those of the other scenes are moved to where the scene has them,
//   and each piece of the factor goes on up to there, by extrapolation. Then differences are those of one piece.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace orthant {

template <class Space> struct RunParameterOf {
  using Scene = typename ElementsOf<Space>::Scene;
  std::string name;
  double value = 0;
  std::function<Scene(double)> scene;  // at another value; empty: none of the scene
  /// Entry of the initial (q, v), 0 … 2 dof − 1, that it is; −1: none. In space six of each body: displacement and
  /// turn, both in the world and about its axes (angular velocity in the world stays), then velocity and angular
  /// velocity in the world.
  Eigen::Index start = -1;
};
using RunParameter = RunParameterOf<Planar>;

template <class Space> struct ParameterChangeOf {
  using System = SystemOf<Space>;
  struct Law {
    int contact;
    double mu, e, e_t, mu_static, belt;
    double rolling = 0, spinning = 0;  // in space
  };
  Eigen::VectorXd mass, weight;                                  // dof; empty: unchanged. In space without inertia
  std::vector<Law> laws;                                         // of the contacts that change theirs
  std::vector<std::pair<int, double>> bounds;                    // of dry frictions
  std::vector<int> joints, contacts, springs, frictions, loads;  // with other geometry, laws in time or forces
  std::vector<std::pair<int, Eigen::Matrix3d>> inertia;          // in space: bodies, in their axes
  Eigen::VectorXd start_q, start_v;                              // of the scenes' initial states; dof
  std::vector<std::pair<double, double>> knots;                  // breakpoints that move: time, its derivative [s]
  std::vector<std::pair<double, double>> drive_knots;            // likewise, of the tables of drives
  bool moves_drive = false;                                      // the times of a drive's table change
  double step = 0;
  int side = 0;                             // ±1: the scenes lie on this side only
  std::array<int, 4> places{-2, -1, 1, 2};  // k
  std::array<double, 4> weights{1. / 12, -8. / 12, 8. / 12, -1. / 12};
  std::array<std::unique_ptr<System>, 4> at;  // null: no parameter of the scene

  bool of_scene() const { return at[0] != nullptr; }
  const System& other() const { return *at[2]; }

  /// f(system, values) fills n values: their derivatives, by differences of fourth order, of third order of one side.
  template <std::size_t n, class F> std::array<double, n> derivative(F&& f) const {
    std::array<double, n> sum{}, values{};
    for (std::size_t k = 0; k < 4; ++k) {
      values = {};
      f(*at[k], values);
      for (std::size_t i = 0; i < n; ++i) sum[i] += weights[k] * values[i];
    }
    for (double& x : sum) x /= step;
    return sum;
  }
};
using ParameterChange = ParameterChangeOf<Planar>;

/// duration: of the run [s]. Throws std::invalid_argument where no scene lies on either side of the value, where no
/// step resolves the change, and for a place of the start that is none.
template <class Space> ParameterChangeOf<Space> changes_of(const RunParameterOf<Space>& parameter,
                                                           const SystemOf<Space>& system, double duration,
                                                           double relative_step = 1e-3);

/// One flag a contact: it has no friction, and a parameter gives it some (μ = 0, the least it can be). Empty: there is
/// none.
template <class Space>
std::vector<char> begun_frictions(std::type_identity_t<std::span<const ParameterChangeOf<Space>>> changes,
                                  const SystemOf<Space>& system);

/// In words: parameters whose scenes lie on one side of the value only. Empty: there is none.
template <class Space>
std::vector<std::string> one_sided_in_words(const std::vector<RunParameterOf<Space>>& parameters,
                                            const std::vector<ParameterChangeOf<Space>>& changes);

/// In words: parameters that move a breakpoint which a fixed step evaluates, to another piece of its table. loads,
/// drives: the places in each step where they are evaluated, of its length. Empty: there is none.
template <class Space>
std::vector<std::string> evaluated_knots_in_words(const std::vector<RunParameterOf<Space>>& parameters,
                                                  const std::vector<ParameterChangeOf<Space>>& changes, double step,
                                                  double duration, std::span<const double> loads,
                                                  std::span<const double> drives);

/// Whether all elements are alike, at the start and at three times: of scenes that differ in how they are written.
template <class Space> bool same_elements(const SystemOf<Space>& one, const SystemOf<Space>& other);

}  // namespace orthant
