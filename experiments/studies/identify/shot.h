// experiments/studies/identify/shot.h — billiard shot: speed, direction and spin of the cue ball that bring two balls
// to given places.
//
//   In space (bank shot): the cue ball slides on the cloth, turns into rolling, bounces off a cushion, and strikes ball
//   2. Parameters: speed [m/s], direction [rad], follow and side spin [rad/s]. Aims: x and y of both balls at the end.
//   In the plane of the paper (draw shot): a vertical plane, the ball is a disc with 2/5 m r², ball 2 comes back from
//   the cushion. Parameters: speed, follow spin. Aims: x of both balls.
//   Motions by event-driven. The derivatives of places by parameters are in the plane those of the motion itself
//   (motion_tangent.h). In space the library has none: central differences of whole runs, in which the events stay the
//   same, take their place.
#pragma once

#include <orthant/core/mechanics/dynamics/state.h>
#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/solvers/solver.h>

#include <Eigen/Core>

#include <memory>
#include <string>
#include <vector>

namespace orthant {

/// By parameters in SI units, see above.
Scene draw_shot(const Eigen::VectorXd& parameters);
spatial::Scene bank_shot(const Eigen::VectorXd& parameters);

class Shot {
 public:
  explicit Shot(int dimension);  // 2, 3

  std::vector<std::string> names;    // of the parameters
  Eigen::VectorXd start, low, high;  // a guess, bounds; SI units
  Eigen::VectorXd unit;              // the size of a change, likewise
  Eigen::VectorXd aim;               // [m]

  /// Places of the balls less the aim [m], of parameters in units of `unit`. Throws std::runtime_error for a run that
  /// fails.
  Eigen::VectorXd miss(const Eigen::VectorXd& x);
  /// And J, their derivatives by x.
  Eigen::VectorXd miss(const Eigen::VectorXd& x, Eigen::MatrixXd& J);
  /// Newton's method from x until |miss| <= enough [m], with shorter steps where it would grow. Throws
  /// std::runtime_error where no step makes it smaller.
  void by_newton(Eigen::VectorXd& x, double enough);

  int runs = 0, tangents = 0;  // of motions without derivatives; with

 private:
  Eigen::VectorXd places(const State& x) const;
  int dimension_;
  double duration_;  // [s]
  std::unique_ptr<Solver> solver_;
};

}  // namespace orthant
