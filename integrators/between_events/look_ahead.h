// integrators/between_events/look_ahead.h — how far a step may look ahead and still see every contact that is made on the way.
//
//   A gap is looked at at a step's end, or along a polynomial. Discs that pass through each other, and corners that turn by
//   a revolution, would show neither. So within a step no body of a corner's or polygon's contact, and no wall, turns by more
//   than half a radian; two discs (a disc and a polygon) move by no more than half the distance of their centres, corners of
//   two polygons by no more than what separates these, or half the thickness of the thinner one, and a journal by no more
//   than half its clearance. Infinite where nothing of that kind moves: contacts of
//   points and discs with the ground cost no step.   O(contacts).
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

namespace orthant {

/// [s], at the velocities v [m/s, rad/s] and accelerations a (empty: not looked at); poses: those at q.
double horizon(const System& system, const Kinematics& poses, const Eigen::VectorXd& v, const Eigen::VectorXd& a);

}  // namespace orthant
