// core/mechanics/dynamics/redundancy.h — linearly dependent joint rows, permanent or only in this (singular) pose.
//
//   Rows of G M^(-1/2), each of length 1, taken in the order of the scene: row i is dependent when what is left of it,
//   the rows before it taken out (Gram-Schmidt, twice), is shorter than 3e-7, as in basic_system.h. It repeats the
//   rows with which it has a combination of zero.
//   In a singular pose rows are dependent that are not so elsewhere. To tell the two apart the mechanism is moved on by
//   some 0.1 rad along a motion that its joints allow (a fixed random one) and looked at again: a row that is dependent
//   in both poses is redundant permanently, one that is so only here makes the pose singular.
// Cost: O(rows² dof), twice. Limits: a mechanism that cannot move is looked at in its one pose, and called redundant.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <string>
#include <vector>

namespace orthant {

struct Redundancy {
  struct Repeat {
    int row = 0;               // in the order of the scene's joints
    std::vector<int> repeats;  // earlier rows
    bool permanent = true;     // false: in this pose only
    bool contradicts = false;  // asks for another place or rate than they do: no motion can give both
  };
  int rows = 0, rank = 0;  // of the joints here
  int dof = 0;             // of the motion here: coordinates less rank
  std::vector<Repeat> dependent;

  bool redundant() const;  // permanently
  bool singular() const;
};

/// Looks at the joints at the coordinates q.
template <class Space> Redundancy find_redundancy(const SystemOf<Space>& system, const Eigen::VectorXd& q);

/// In words, joint by joint: 'row angle of joint "b" repeats (contradicts) what joints "a", "c" already say', and whose
/// load is not determined by that, where friction depends on it; empty: nothing to say.
template <class Space> std::string describe(const Redundancy& redundancy, const SystemOf<Space>& system);

}  // namespace orthant
