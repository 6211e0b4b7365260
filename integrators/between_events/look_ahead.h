// integrators/between_events/look_ahead.h — look-ahead: limit of the step length, so that the end of lasting contacts
// is not missed.
//
//   Forces and slips of lasting contacts are evaluated at a few instants of a step (contact_watch.h), and their normals
//   at its end. So within a step no body of a corner's or polygon's contact, and no wall, turns by more than half a
//   radian;
//   points of two discs (a disc and a polygon) move by no more than half the distance of their centres, corners of two
//   polygons by no more than half the thickness of the thinner one, and a journal by no more than half its clearance. A
//   point of a body moves at |ẋ| + |ω| r, r its distance from the centre of mass. Infinite where nothing of that kind
//   moves: contacts of points and discs with the ground cost no step. Open contacts need no such bound
//   (continuous_collision.h).
// Cost: O(contacts).
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

#include <span>

namespace orthant {

/// [s], of these contacts, at the velocities v [m/s, rad/s] and accelerations a (empty: not looked at); poses: those at
/// q.
double horizon(const System& system, std::span<const int> contacts, const Kinematics& poses, const Eigen::VectorXd& v,
               const Eigen::VectorXd& a);

}  // namespace orthant
