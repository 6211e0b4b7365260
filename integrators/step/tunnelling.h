// integrators/step/tunnelling.h — tunnelling detection: bodies that pass through each other within one step.
//
//   Gaps are evaluated at the start and the end of a step. Two shapes have passed through each other if their gap is
//   smaller on the way between than at both ends, and than 0, by 1/20 of the thinner one; or if they overlap by that at
//   the end and the contact's normal has turned round since they met, or since the start where they overlapped already:
//   it would push them out on the wrong side, or on none in the very middle. The gap is followed along the way, no
//   farther at a time than it is wide or than 1/16 of the thinner one: a passage deeper than the ends by 1/12 of that
//   is detected. Of two polygons it is the smaller one of their two points' gaps, which change places on the way. The
//   way: centres of mass go straight, or about the ground's pin that holds the body; angles grow evenly, by
//   several turns as well.
//   Half-planes, bearings and bounds of angles and slides need no detection: the gap stays negative beyond them.
// Cost: nothing where no shapes meet; O(bodies) a step while all move less than a fifth of the thinnest shape in it.
// Limit: a passage of less than that depth, or on another path, is not reported.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

#include <vector>

namespace orthant {

/// `body` moved farther than the other one. width = 0: none.
struct Passage {
  BodyId body = kGround, other = kGround;
  double moved = 0, width = 0;  // [m] in the step, at its rim; of the thinner shape
};

class TunnellingDetector {
 public:
  explicit TunnellingDetector(const System& system);

  /// The first of the pairs, listed or in terms.pairs, that passed between q and q_end; terms.gap is at q_end.
  Passage find(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms) {
    return any() ? look(q, q_end, terms) : Passage{};
  }

 private:
  struct Shapes {
    int contact;
    double width;  // [m] of the thinner one
  };
  struct Pin {  // in the ground
    bool is = false;
    Vector2d place{0, 0}, point{0, 0};  // [m] in the ground's frame; in the body's
  };
  bool any() const { return !listed_.empty() || !width_.empty(); }
  Passage look(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms);
  bool passed(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms, const Shapes& pair, BodyId a,
              BodyId b, double way);
  double gap(const std::vector<Pair>& pairs, int contact) const;  // [m] at at_

  double way_of(BodyId body, const Eigen::VectorXd& q, const Eigen::VectorXd& q_end) const;
  void place(BodyId body, const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, double s);

  const System& system_;
  std::vector<Pin> pin_;  // of each body
  std::vector<Shapes> listed_;
  std::vector<std::vector<double>> width_;  // of each shape of each collision [m]
  std::vector<double> reach_;               // of each body: its shapes' farthest point [m]
  std::vector<double> way_;
  double least_;  // [m]
  Kinematics at_;
};

}  // namespace orthant
