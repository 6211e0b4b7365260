// integrators/step/polygon_points.h — contact points of two polygons, both of them, and the test whether the overlap of
// their faces ends.
//
//   The two points are the ends of the overlap of two faces (polygon_polygon.h). Where a corner slides off a face's
//   edge the overlap's length s goes to zero, and with it the difference d of the two gaps: d = α s with the faces'
//   tilt α. The second point then comes into contact without an impact. Where a tilted polygon falls flat, α goes to
//   zero, and the second point strikes. By their rates the overlap ends first where
//     ṡ < 0 and 2 ṡ/s < ḋ/d                                                                                    (1)
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

#include <array>
#include <optional>

namespace orthant {

/// Of the two polygons that the contact stands for, the point itself and the other one, at these poses; none: others.
std::optional<std::array<Touch, 2>> polygon_points(const System& system, const std::vector<Pair>& pairs, int contact,
                                                   const Kinematics& at);

/// Whether the overlap ends before the second point, which is shallower by d > 0 and comes nearer, is as deep as the
/// first: (1) at the velocities v, with the rate ḋ.
bool overlap_ends(const std::array<Touch, 2>& points, const Kinematics& at, const Eigen::VectorXd& v, double d,
                  double d_rate);

}  // namespace orthant
