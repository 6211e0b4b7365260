// integrators/derivatives/spatial_row_slope.h — row slopes in space, by displacements and turns of the rows' bodies.
//
//   A pose changes by (δx, δφ): x + δx in the world, R exp δφ in the principal axes. These are the six coordinates of a
//   body in stacked vectors of changes, as velocities are (blocks.h); move() and between() have the same.
// All slopes are central differences of fourth order over 3e-6 m (rad), or over a hundredth of the way on which a
// contact's direction turns about, if that is less: a relative error of 1e-8 at the most.
#pragma once

#include <orthant/integrators/derivatives/row_slope.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace orthant {

/// Rows of a contact in a step's problem, and the motion of b's surface along each: normal, tangents, rolling about the
/// tangents, spinning.
struct SurfaceRows {
  static constexpr std::size_t kMost = 6;
  std::array<RowOf<Spatial>, kMost> rows;
  std::array<double, kMost> belt{};  // [m/s], [rad/s]
};
/// `axis`: the first tangent is that of perpendicular() as if its axis were this one, also where it jumps to another;
/// null: as it is.
/// Orthotropic friction has its own direction.
SurfaceRows surface_rows(const SystemOf<Spatial>& system, int contact, const KinematicsOf<Spatial>& at,
                         const Vector3d* axis = nullptr);
/// The coordinate axis that t1 of the contact is nearest to.
Vector3d tangent_axis(const SystemOf<Spatial>& system, int contact, const KinematicsOf<Spatial>& at);
/// Whether perpendicular() jumps at this normal: its two least components are equal within rounding.
bool tangents_jump(const Vector3d& normal);

struct SurfaceSlopes {
  std::array<RowSlopeOf<Spatial>, SurfaceRows::kMost> rows;
  std::vector<Slope> belt;  // of the places 0 … 5
};

/// [m, rad] On a way of this length the direction of a contact turns about: the clearance of a ball in a socket or of a
/// pin, the distance of two centres, the tilt of a rim. 0: a rim as good as parallel to its plane, on which no lowest
/// point is found; its points are taken as points of the body.
double turning_length(const SystemOf<Spatial>& system, int contact, const KinematicsOf<Spatial>& at);

/// Of all rows of a joint, of a contact, of one row. `at` is moved and put back.
void slopes_of(const spatial::Joint& joint, KinematicsOf<Spatial>& at, RowSlopeOf<Spatial>* slopes);
void slopes_of(const SystemOf<Spatial>& system, int contact, KinematicsOf<Spatial>& at, SurfaceSlopes& slopes);
void slope_of(const spatial::Coordinate& coordinate, KinematicsOf<Spatial>& at, RowSlopeOf<Spatial>& slope);

/// Of values of f(at, values), n at the most kMostValues, by the six coordinates of the bodies a and b:
/// take(place of the coordinate, derivatives).
class PoseDifferences {
 public:
  static constexpr std::size_t kMostValues = 84;
  static constexpr double kStep = 3e-6;  // [m, rad]
  using Values = std::array<double, kMostValues>;

  /// way: at the most kStep.
  template <class F, class Take> static void each(KinematicsOf<Spatial>& at, BodyId a, BodyId b, std::size_t n, F&& f,
                                                  Take&& take, double way = kStep) {
    Values ahead{}, behind{}, far_ahead{}, far_behind{}, slope{};
    for (const BodyId body : {a, b}) {
      if (body < 0) continue;
      spatial::Pose& pose = at.pose[static_cast<std::size_t>(body)];
      const spatial::Pose kept = pose;
      for (int c = 0; c < Spatial::kVelocities; ++c) {
        pose = shifted(kept, c, way), f(at, ahead);
        pose = shifted(kept, c, -way), f(at, behind);
        pose = shifted(kept, c, 2 * way), f(at, far_ahead);
        pose = shifted(kept, c, -2 * way), f(at, far_behind);
        for (std::size_t i = 0; i < n; ++i)
          slope[i] = (8 * (ahead[i] - behind[i]) - (far_ahead[i] - far_behind[i])) / (12 * way);
        take(Spatial::kVelocities * static_cast<Eigen::Index>(body) + c, slope);
      }
      pose = kept;
    }
  }

  /// The way of differences for a contact of this turning_length() > 0.
  static double way_of(double turning) { return std::min(kStep, 1e-2 * turning); }

 private:
  static spatial::Pose shifted(const spatial::Pose& pose, int coordinate, double by);
};

}  // namespace orthant
