// integrators/step/tunnelling.h — bodies that pass through each other within one step, and that no scheme of fixed step sees.
//
//   Gaps are looked at where a step begins and ends. Two shapes that are apart there, but not on the straight way between
//   (angles likewise), have passed through each other: their gap is followed along the way, no farther at a time than it is
//   wide or than 1/16 of the thinner one, and is less than −1/20 of that somewhere. Half-planes cannot be passed unseen.
// Cost: nothing where no shapes meet; O(bodies) a step while all move less than a quarter of the thinnest shape in it.
// Limit: what passes by at less than that depth, or goes another way than straight, is not told.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

#include <vector>

namespace orthant {

/// `body` moved farther than the other one. width = 0: none.
struct Passage {
  BodyId body = kGround, other = kGround;
  double moved = 0, width = 0;  // [m] in the step, at its rim; of the thinner shape
};

class Passing {
 public:
  explicit Passing(const System& system);

  /// The first of the pairs, listed or in terms.pairs, that passed between q and q_end; terms.gap is at q_end.
  Passage find(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms) {
    return any() ? look(q, q_end, terms) : Passage{};
  }

 private:
  struct Shapes {
    int contact;
    double width;  // [m] of the thinner one
  };
  bool any() const { return !listed_.empty() || !width_.empty(); }
  Passage look(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms);
  bool passed(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms, const Shapes& pair, BodyId a,
              BodyId b, double way);

  const System& system_;
  std::vector<Shapes> listed_;
  std::vector<std::vector<double>> width_;  // of each shape of each collision [m]
  std::vector<double> reach_;               // of each body: its shapes' farthest point [m]
  std::vector<double> way_;
  double least_;  // [m]
  Kinematics at_;
};

}  // namespace orthant
