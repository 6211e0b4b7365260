// integrators/step/turn_watch.h — turns counted over a motion: angles in space that springs, limits and teeth read.
//
//   A coordinate's angle is known up to full turns (coordinate.h). A spring takes it the shorter way round from its
//   rest, a limit within half a turn of its bound or of the middle between two. Both are right as long as the angle c,
//   which starts in (−π, π], keeps |c − middle| < π. The watch follows c from state to state, by the nearest value to
//   c + h (ċ_0 + ċ_1) / 2, and says where that ends. Teeth with play (backlash.h) know theirs up to a gear's period:
//   the same with that for the full turn.
// Cost: nothing without such springs, limits and teeth; else poses, and an angle and a rate of each.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/integrators/checkpoint.h>

#include <string>
#include <variant>
#include <vector>

namespace orthant {

class TurnWatch {
 public:
  /// most: [rad] of a turn between two states that can be told.
  TurnWatch(const SystemOf<Spatial>& system, double most);

  bool empty() const { return turns_.empty(); }

  /// The next state; the first one is the start. False: why() names the angle that cannot be followed from there on.
  bool follow(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  const std::string& why() const { return why_; }

  /// The next state is a start.
  void restart() { any_ = false; }
  void remember(CheckpointData& memory) {
    memory(any_, t_);
    for (Turn& turn : turns_) memory(turn.value, turn.rate);
  }

 private:
  struct Turn {
    std::string name;  // of the spring or limit, and of its joint; of teeth
    std::variant<spatial::Angle, spatial::Gear> of;
    double middle = 0;           // [rad]
    double period = 0;           // [rad; m of a rack]
    double value = 0, rate = 0;  // [rad, rad/s]
  };
  void add(std::string name, const spatial::Coordinate& of, double middle);

  const SystemOf<Spatial>& system_;
  double most_;
  std::vector<Turn> turns_;
  KinematicsOf<Spatial> at_;
  bool any_ = false;
  double t_ = 0;  // [s]
  std::string why_;
};

}  // namespace orthant
