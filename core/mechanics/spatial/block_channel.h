// core/mechanics/spatial/block_channel.h — prismatic joint with clearance: a block in a channel.
//   A box of body a between two pairs of walls of body b. Each of its eight corners may touch the wall on its side of
//   either pair: 16 corners against half-spaces (sphere_plane.h), exact as long as the block is turned by less than a
//   quarter turn against the channel. The channel has no ends: those are limits on a Slide.
#pragma once

#include <orthant/core/mechanics/spatial/sphere_plane.h>

#include <string>
#include <vector>

namespace orthant::spatial {

struct BlockChannel {
  std::string name;
  BodyId a = kGround;                       // the block
  Vector3d centre_a{0, 0, 0};               // [m] in a's frame
  Eigen::Vector4d orientation{1, 0, 0, 0};  // quaternion, the block's edges → a's frame
  Vector3d size{1, 1, 1};                   // [m] > 0: along the channel, across, up
  BodyId b = kGround;                       // the channel
  Vector3d centre_b{0, 0, 0};               // [m] of its cross-section, in b's frame
  Vector3d axis{1, 0, 0}, up{0, 0, 1};      // unit vectors at right angles, in b's frame
  double width = 1.001, height = 1.001;     // [m] between the walls; not less than the block's
  ContactLaw law;
};

/// Names: NAME_1 … NAME_16: of each corner the wall across, then the one above or below.
inline std::vector<SpherePlane> block_in_channel(const BlockChannel& c) {
  const Matrix3d R = quaternions::matrix_of(c.orientation);
  const Vector3d across = c.up.cross(c.axis);
  std::vector<SpherePlane> all;
  for (const Vector3d& corner : box_corners(c.size / 2))
    for (const int wall : {1, 2}) {
      const Vector3d outwards = corner[wall] < 0 ? Vector3d(wall == 1 ? -across : -c.up) : wall == 1 ? across : c.up;
      const Vector3d on_wall = c.centre_b + (wall == 1 ? c.width : c.height) / 2 * outwards;
      all.push_back({c.name + "_" + std::to_string(all.size() + 1), c.a, c.centre_a + R * corner, 0, c.b, on_wall,
                     -outwards, c.law});
    }
  return all;
}

}  // namespace orthant::spatial
