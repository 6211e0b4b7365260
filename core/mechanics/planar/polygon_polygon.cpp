#include <orthant/core/mechanics/planar/polygon_polygon.h>

#include <cmath>
#include <limits>

namespace orthant {
namespace {

struct Side {  // one of the two polygons
  BodyId body;
  const Polygon& corners;
  const Exposure* exposed;
  const Pose& pose;
  Vector2d corner(std::size_t i) const { return pose.x + pose.turn(corners[i]); }
};

constexpr double kNone = -std::numeric_limits<double>::infinity();

struct Axis {
  double separation = kNone;
  std::size_t face = 0, nearest = 0;  // nearest: the other's corner
};

/// The neighbours of x leave face i free, and those of y the corner j for a face of the outward normal n.
bool admitted(const Side& x, std::size_t i, const Side& y, std::size_t j, const Vector2d& n) {
  return (x.exposed == nullptr || x.exposed->face[i].free) &&
         (y.exposed == nullptr || y.exposed->admits(j, -y.pose.turn_back(n)));
}

/// The face of x beyond which y lies farthest; of those admitted, if `free`.
Axis separating(const Side& x, const Side& y, bool free = false) {
  Axis best;
  for (std::size_t i = 0; i < x.corners.size(); ++i) {
    const Vector2d n = x.pose.turn(outward(x.corners, i)), n_y = y.pose.turn_back(n);
    const double offset = n.dot(y.pose.x - x.corner(i));
    Axis axis{std::numeric_limits<double>::infinity(), i, 0};
    for (std::size_t j = 0; j < y.corners.size(); ++j)
      if (const double s = offset + n_y.dot(y.corners[j]); s < axis.separation) axis.separation = s, axis.nearest = j;
    if (axis.separation > best.separation && (!free || admitted(x, i, y, axis.nearest, n))) best = axis;
  }
  return best;
}

/// [m] Pieces of a surface meet at a corner within this: what is as near to both has contacts with both.
double seam_width(const Side& x, std::size_t corner) {
  constexpr double kTie = 1e-10;  // of the shortest face
  return kTie * shortest_face(x.corners) + 2 * x.exposed->corner[corner].apart;
}

/// Some of face i of x is inside y.
bool crosses(const Side& x, std::size_t i, const Side& y) {
  const Vector2d from = x.corner(i), to = x.corner(next(x.corners, i));
  double low = 0, high = 1;
  for (std::size_t k = 0; k < y.corners.size(); ++k) {
    const Vector2d n = y.pose.turn(outward(y.corners, k)), at = y.corner(k);
    const double a = n.dot(from - at), b = n.dot(to - at);
    if (a > 0 && b > 0) return false;
    if (a > 0) low = std::max(low, a / (a - b));
    if (b > 0) high = std::min(high, a / (a - b));
  }
  return low <= high;
}

/// Corner j of y, the nearest to face i of x, is past an end of the face, where a neighbour goes on in its plane, and y
/// reaches into it. So is all of the face of y that lies flat against it.
bool past_flat_end(const Side& x, std::size_t i, const Side& y, std::size_t j) {
  if (x.exposed == nullptr) return false;
  const std::size_t end = next(x.corners, i), before = (j ? j : y.corners.size()) - 1;
  const Vector2d e = x.pose.turn(direction(x.corners, i));
  const auto at = [&](std::size_t corner) { return e.dot(y.corner(corner) - x.corner(i)); };
  double low = at(j), high = low;
  for (const std::size_t face : {j, before})
    if (const Vector2d d = y.pose.turn(direction(y.corners, face)); e.dot(d) < 0 && std::abs(cross(e, d)) <= kFlat)
      low = std::min(low, at(next(y.corners, face))), high = std::max(high, at(face));
  const double length = e.dot(x.corner(end) - x.corner(i));
  if (x.exposed->corner[i].flat && high < -seam_width(x, i)) return crosses(x, (i ? i : x.corners.size()) - 1, y);
  return x.exposed->corner[end].flat && low > length + seam_width(x, end) && crosses(x, end, y);
}

/// A neighbour's face that begins or ends at a convex corner of x, with y's nearest corner over it.
struct Beside {
  double separation = kNone;  // [m] of y from that face
  const Side *x = nullptr, *y = nullptr;
  std::size_t corner = 0, nearest = 0;  // of x, of y
  Vector2d normal{0, 0};                // in x's frame
  bool reached = false;                 // y reaches into the neighbour, which has a contact of that gap or a larger one
};

/// The one beyond which y lies farthest.
Beside beside(const Side& x, const Side& y) {
  Beside best;
  if (x.exposed == nullptr) return best;
  for (std::size_t i = 0; i < x.corners.size(); ++i) {
    const Exposure::Cone& cone = x.exposed->corner[i];
    if (!cone.convex) continue;
    for (const bool ends : {true, false}) {
      const std::size_t own = ends ? (i ? i : x.corners.size()) - 1 : i;
      Beside one{std::numeric_limits<double>::infinity(), &x, &y, i, 0, ends ? cone.from : cone.to};
      if (one.normal.dot(x.exposed->face[own].normal) > 1 - 1e-9) continue;
      const Vector2d n = x.pose.turn(one.normal);
      for (std::size_t j = 0; j < y.corners.size(); ++j)
        if (const double s = n.dot(y.corner(j) - x.corner(i)); s < one.separation) one.separation = s, one.nearest = j;
      const double along = perp(n).dot(y.corner(one.nearest) - x.corner(i)), width = seam_width(x, i);
      if ((ends ? along : -along) > width || one.separation - width <= best.separation) continue;
      one.separation -= width, one.reached = crosses(x, own, y);
      best = one;
    }
  }
  return best;
}

CornerWall corner_face(const Side& c, std::size_t corner, const Side& f, std::size_t face) {
  return {{}, c.body, c.corners[corner], f.body, f.corners[face], outward(f.corners, face), {}};
}
DiscDisc corner_corner(const Side& x, std::size_t i, const Side& y, std::size_t j) {
  return {{}, x.body, x.corners[i], 0, y.body, y.corners[j], 0, {}};
}

double shorter_face(const Side& x, const Side& y) {
  return std::min(shortest_face(x.corners), shortest_face(y.corners));
}

/// A corner off the ends of a face, which it does not meet: open, with the face's normal.
CornerWall off_face(const Side& c, std::size_t corner, const Side& f, std::size_t face, double aside = kAside) {
  CornerWall wall = corner_face(c, corner, f, face);
  wall.wall_point -= aside * shorter_face(c, f) * wall.normal;
  return wall;
}
/// Whether off_face() is open at that separation.
bool near_face(double separation, const Side& x, const Side& y) {
  return separation > -kAside / 2 * shorter_face(x, y);
}

/// How far aside off_face() is open, however deep the polygons overlap.
double farther(const Side& x, const Side& y) {
  double size = 0;
  for (const Side* side : {&x, &y})
    for (const Vector2d& corner : side->corners) size += (corner - side->corners.front()).norm();
  return size / shorter_face(x, y);
}

struct End {  // of a face, at a corner, with the neighbouring face there
  std::size_t face, corner, adjacent;
};
End end_of(const Side& s, std::size_t face, bool last) {
  const std::size_t n = s.corners.size();
  return last ? End{face, next(s.corners, face), next(s.corners, face)} : End{face, face, (face ? face : n) - 1};
}

/// Two faces end to end, flush: open, with the normal of the surface that one of the two passes along. That is not one
/// of covered faces, nor, where they lie apart, of these two; at a common corner it is taken for that of the longer
/// ones.
Touch end_to_end(const Side& x, const End& ex, const Side& y, const End& ey, double separation, double graze) {
  const auto free = [](const Side& s, std::size_t face) { return s.exposed == nullptr || s.exposed->face[face].free; };
  const auto length = [](const Side& s, std::size_t face) {
    return (s.corners[next(s.corners, face)] - s.corners[face]).norm();
  };
  const auto beyond = [](const Side& f, std::size_t face, const Vector2d& p) {
    return f.pose.turn(outward(f.corners, face)).dot(p - f.corner(face));
  };
  const bool these = free(x, ex.face) && free(y, ey.face), others = free(x, ex.adjacent) && free(y, ey.adjacent);
  const bool longer = length(x, ex.face) + length(y, ey.face) > length(x, ex.adjacent) + length(y, ey.adjacent);
  if (these != others ? these : separation <= graze && longer) return off_face(y, ey.corner, x, ex.face);
  const double over_x = beyond(x, ex.adjacent, y.corner(ey.corner)),
               over_y = beyond(y, ey.adjacent, x.corner(ex.corner));
  if (!near_face(std::max(over_x, over_y), x, y)) return off_face(y, ey.corner, x, ex.face);
  return over_x > over_y ? off_face(y, ey.corner, x, ex.adjacent) : off_face(x, ex.corner, y, ey.adjacent);
}

/// Corner i of x and corner j of y, which lie apart. Where the neighbours leave no such corner: off x's face.
Touch corners_apart(const Side& x, std::size_t face, std::size_t i, const Side& y, std::size_t j) {
  const auto free = [](const Side& s, std::size_t corner, const Vector2d& d) {
    if (s.exposed == nullptr) return true;
    const double far = d.norm();
    return far > 0 && s.exposed->points_to(corner, s.pose.turn_back(d / far));
  };
  const Vector2d d = y.corner(j) - x.corner(i);
  if (free(x, i, d) && free(y, j, -d)) return corner_corner(y, j, x, i);
  return off_face(y, j, x, face);
}

}  // namespace

Touch touch(const Kinematics& k, const Placed& a, const Placed& b, int point) {
  const Side side_a{a.body, a.corners, a.exposed, k.at(a.body)}, side_b{b.body, b.corners, b.exposed, k.at(b.body)};
  Axis from_a = separating(side_a, side_b), from_b = separating(side_b, side_a);
  bool on_a = from_a.separation > from_b.separation;
  if (a.exposed != nullptr || b.exposed != nullptr) {
    const bool most_on_a = on_a;
    const Axis most = on_a ? from_a : from_b;
    from_a = separating(side_a, side_b, true), from_b = separating(side_b, side_a, true);
    on_a = from_a.separation > from_b.separation;
    const Axis& free = on_a ? from_a : from_b;
    const Side &f = on_a ? side_a : side_b, &c = on_a ? side_b : side_a;
    const Side &covered = most_on_a ? side_a : side_b, &other = most_on_a ? side_b : side_a;
    if (free.separation == kNone) return off_face(c, 0, f, 0, kCovered);
    if (most.separation > free.separation && most.separation > 0) {
      if (near_face(free.separation, c, f)) return off_face(c, free.nearest, f, free.face);
      return corner_face(other, most.nearest, covered, most.face);
    }
    if (most.separation > free.separation) {
      const Beside of_a = beside(side_a, side_b), of_b = beside(side_b, side_a);
      const Beside& next_to = of_a.separation > of_b.separation ? of_a : of_b;
      const bool nearer = next_to.separation > free.separation;
      if (nearer && !next_to.reached && point == 0)
        return CornerWall{{},
                          next_to.y->body,
                          next_to.y->corners[next_to.nearest],
                          next_to.x->body,
                          next_to.x->corners[next_to.corner],
                          next_to.normal,
                          {}};
      if (nearer || past_flat_end(f, free.face, c, free.nearest))
        return off_face(other, most.nearest, covered, most.face,
                        near_face(most.separation, other, covered) ? kAside : farther(other, covered));
    }
  }
  const Side &x = on_a ? side_a : side_b, &y = on_a ? side_b : side_a;
  const Axis& axis = on_a ? from_a : from_b;

  // y's face at its nearest corner, turned to the reference: it runs against it.
  const std::size_t i = axis.face, here = axis.nearest, before = (here ? here : y.corners.size()) - 1;
  const Vector2d e = x.pose.turn(direction(x.corners, i));
  const auto along = [&](std::size_t face) { return e.dot(y.pose.turn(direction(y.corners, face))); };
  const bool starts_here = along(here) < along(before);
  const std::size_t j = starts_here ? here : before, i_end = next(x.corners, i), j_end = next(y.corners, j);

  const bool high_along_a = (point & 1) == static_cast<int>((i + j) & 1), high = on_a == high_along_a;
  const double length = e.dot(x.corner(i_end) - x.corner(i));
  const double y_high = e.dot(y.corner(j) - x.corner(i)), y_low = e.dot(y.corner(j_end) - x.corner(i));
  const std::size_t y_corner = high ? j : j_end;  // at the end wanted

  const double tilt = std::abs(cross(e, y.pose.turn(direction(y.corners, j))));
  if (tilt > kFlat || along(j) > 0) {
    const double at = high ? y_high : y_low;
    if (y_corner == here && axis.separation > 0 && (at < 0 || at > length))
      return corners_apart(x, i, at < 0 ? i : i_end, y, here);
    return corner_face(y, y_corner, x, i);
  }
  const double graze = kFlush * std::min(length, y_high - y_low);
  const bool past = y_low > length - graze, short_of = y_high < graze;
  if (axis.separation > -graze && ((past && y_low < length + graze) || (short_of && y_high > -graze)))
    return end_to_end(x, end_of(x, i, past), y, end_of(y, j, past), axis.separation, graze);
  if (past || short_of) {  // side by side they are not
    if (axis.separation > 0) return past ? corners_apart(x, i, i_end, y, j_end) : corners_apart(x, i, i, y, j);
    return corner_face(y, here, x, i);
  }
  if (high) return y_high <= length ? corner_face(y, j, x, i) : corner_face(x, i_end, y, j);
  return y_low >= 0 ? corner_face(y, j_end, x, i) : corner_face(x, i, y, j);
}

}  // namespace orthant
