// core/mechanics/dynamics/redundancy.h — redundant joint rows: permanent, or only in this (singular) pose.
//
//   Rows of G M^(-1/2), each of length 1, in the order of the scene. The rows before row i are removed from it
//   (Gram-Schmidt, twice). Row i is dependent if the remainder is shorter than 3e-7, as in basic_system.h. It repeats
//   the rows with which it has a combination of zero.
//   In a singular pose some rows are dependent that are independent elsewhere. To distinguish the two, the mechanism is
//   moved by some 0.1 rad along a motion that its joints allow (a fixed random one) and analysed again. A row that is
//   dependent in both poses is redundant permanently; a row that is dependent only here makes the pose singular.
// Cost: O(rows² dof), twice. Limits: a mechanism that cannot move is analysed in its one pose, and its dependent rows
// count as redundant.
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

/// How far `rank` of the joints' rows at q, each of length 1 in the metric of M⁻¹, are from dependence: the least pivot
/// of a pivoted QR factorization, which does not depend on the order of the rows. 0: fewer are independent.
template <class Space> double pivoted_independence(const SystemOf<Space>& system, const Eigen::VectorXd& q, int rank);

/// In words, joint by joint: 'row angle of joint "b" repeats (contradicts) what joints "a", "c" already say'. Names the
/// joints with load-dependent friction whose load is therefore undetermined. Empty: no row is dependent.
template <class Space> std::string describe(const Redundancy& redundancy, const SystemOf<Space>& system);

}  // namespace orthant
