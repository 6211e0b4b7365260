// Contact points on flush tiles in space: those of the one face that the tiles make.
#include <orthant/core/mechanics/spatial/collision.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace orthant;

namespace {

constexpr double kWide = 4;  // [m] of the floor

/// A box of half sizes `half`, of `parts` × `parts` flush pieces, over a floor of nx × ny boxes with tops at z = 0.
spatial::Collision over_tiles(const Vector3d& half, int nx, int ny, int parts = 1) {
  spatial::Collision c{.name = "floor", .shapes = {}, .law = {}};
  const Vector3d part(half.x() / parts, half.y() / parts, half.z());
  for (int i = 0; i < parts; ++i)
    for (int j = 0; j < parts; ++j) {
      spatial::Shape piece{0, spatial::box_corners(part), 0};
      for (Vector3d& p : piece.corners)
        p += Vector3d((2 * i + 1) * part.x() - half.x(), (2 * j + 1) * part.y() - half.y(), 0);
      c.shapes.push_back(piece);
    }
  const Vector3d size(kWide / nx, kWide / ny, 1);
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      spatial::Shape tile{kGround, spatial::box_corners(size / 2), 0};
      for (Vector3d& p : tile.corners)
        p += Vector3d((i + 0.5) * size.x() - kWide / 2, (j + 0.5) * size.y() - kWide / 2, -0.5);
      c.shapes.push_back(tile);
    }
  spatial::set_hulls(c);
  return c;
}

/// Places on the box of the points with a gap of at most `most`, without those that are there already.
std::vector<spatial::TouchPoint> points_below(const spatial::Collision& c, const spatial::Pose& at, double most) {
  std::vector<spatial::TouchPoint> all;
  const auto look = [&](const spatial::Shape& piece, const spatial::Shape& tile) {
    if (piece.body != 0 || tile.body != kGround) return;
    const spatial::TouchPoints points = touch(at, piece, {}, tile);
    for (int k = 0; k < points.count; ++k) {
      const spatial::TouchPoint p = points.at(k);
      const auto same = [&](const spatial::TouchPoint& q) { return (q.on_a - p.on_a).norm() < 1e-9; };
      if (p.gap <= most && std::none_of(all.begin(), all.end(), same)) all.push_back(p);
    }
  };
  for (const spatial::Shape& piece : c.shapes)
    for (const spatial::Shape& tile : c.shapes) look(piece, tile);
  return all;
}

/// Faces that are parallel to 1e-6 rad stand for each other.
bool same_points(const std::vector<spatial::TouchPoint>& x, const std::vector<spatial::TouchPoint>& y,
                 double normals = 3e-6) {
  return x.size() == y.size() && std::all_of(x.begin(), x.end(), [&](const spatial::TouchPoint& p) {
           return std::any_of(y.begin(), y.end(), [&](const spatial::TouchPoint& q) {
             return (p.on_a - q.on_a).norm() < 1e-9 && (p.n - q.n).norm() < normals &&
                    std::abs(p.gap - q.gap) < 1e-9 + normals * normals;
           });
         });
}

}  // namespace

TEST_CASE("a box over flush tiles has the contact points that it has over one tile, flat, on an edge or on a corner") {
  Random random(5);
  int overlapping = 0, differ = 0, several = 0, of_pieces = 0;
  for (int round = 0; round < 60; ++round) {
    const Vector3d half(random.uniform(0.05, 0.4), random.uniform(0.05, 0.4), random.uniform(0.05, 0.2));
    const spatial::Collision one = over_tiles(half, 1, 1),
                             many = over_tiles(half, random.integer(2, 12), random.integer(1, 12)),
                             pieces = over_tiles(half, random.integer(1, 8), random.integer(1, 8), 2);
    for (int i = 0; i < 40; ++i) {
      const double yaw = random.integer(0, 3) == 0 ? 0 : random.uniform(-3, 3);
      const double tilt = random.integer(0, 4) == 0 ? 0 : std::pow(10, random.uniform(-7, -0.2));
      const double about = random.integer(0, 1) == 0 ? 0 : random.uniform(-3, 3);
      spatial::Pose at;
      at.R = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix() *
             Eigen::AngleAxisd(tilt, Vector3d(std::cos(about), std::sin(about), 0)).toRotationMatrix();
      double lowest = 0;
      for (const Vector3d& p : spatial::box_corners(half)) lowest = std::min(lowest, at.turn(p).z());
      const double x = random.uniform(-1, 1), depth = std::pow(10, random.uniform(-8, -2.5));
      at.x = {x, random.uniform(-1, 1), -lowest - depth};
      const auto alone = points_below(one, at, 0), together = points_below(many, at, 0);
      ++overlapping, several += alone.size() > 1, differ += !same_points(alone, together);
      of_pieces += !same_points(alone, points_below(pieces, at, 0), 0.03);  // of the box or the floor
    }
  }
  CHECK(several > overlapping / 4);
  CHECK(differ == 0);
  CHECK(of_pieces <= overlapping / 100);
}
