#include <orthant/core/mechanics/spatial/exposure.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace orthant::spatial {
namespace {

constexpr double kOnFace = 1e-9;   // of the size
constexpr double kSmooth = 1e-6;   // sine of the tilt of two faces that are one surface
constexpr double kAgainst = 1e-6;  // 1 + cosine of two faces that lie against each other

struct HullBox {
  Vector3d low, high;
  explicit HullBox(const Hull& hull) : low(hull.corners.front()), high(low) {
    for (const Vector3d& corner : hull.corners) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
    low.array() -= kOnFace * hull.size, high.array() += kOnFace * hull.size;
  }
  bool meets(const HullBox& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

const Vector3d& corner_of(const Hull& hull, int i) { return hull.corners[static_cast<std::size_t>(i)]; }
const Hull::Face& face_of(const Hull& hull, int i) { return hull.faces[static_cast<std::size_t>(i)]; }

/// Marks the faces of `hull` that lie in or on `other` with all their corners, and the edges of these.
void cover(Hull& hull, const Hull& other) {
  for (Hull::Face& one : hull.faces) {
    const bool inside = std::all_of(one.corners.begin(), one.corners.end(),
                                    [&](int i) { return other.depth_of(corner_of(hull, i)) <= kOnFace * hull.size; });
    if (!inside) continue;
    one.covered = hull.any_covered = true;
    for (const int e : one.edges) hull.edges[static_cast<std::size_t>(e)].covered = true;
  }
}

/// Whether p lies on the face.
bool lies_on(const Hull& hull, const Hull::Face& on, const Vector3d& p, double most) {
  if (std::abs(on.normal.dot(p) - on.offset) > most) return false;
  for (std::size_t i = 0; i < on.corners.size(); ++i) {
    const Vector3d& from = corner_of(hull, on.corners[i]);
    const Vector3d along = corner_of(hull, on.corners[(i + 1) % on.corners.size()]) - from;
    if (along.cross(on.normal).normalized().dot(p - from) > most) return false;
  }
  return true;
}

/// The covered edge e of `hull` is a ridge where it borders on a free face of `other`.
void find_ridge(const Hull& hull, Hull::Edge& e, const Hull& other) {
  const bool left_is_free = !face_of(hull, e.left).covered;
  const Hull::Face &own = face_of(hull, left_is_free ? e.left : e.right),
                   &hidden = face_of(hull, left_is_free ? e.right : e.left);
  const Vector3d &from = corner_of(hull, e.from), &to = corner_of(hull, e.to), along = (to - from).normalized();
  const double most = kOnFace * std::max(hull.size, other.size);
  for (const Hull::Face& theirs : other.faces) {
    if (theirs.covered || theirs.normal.dot(hidden.normal) < kAgainst - 1) continue;
    if (!lies_on(other, theirs, from, most) || !lies_on(other, theirs, to, most)) continue;
    Vector3d away(0, 0, 0);
    for (const int i : theirs.corners) away += corner_of(other, i) - from;
    away = (away - along * along.dot(away)).normalized();
    if (!(own.normal.dot(away) < -kSmooth)) continue;
    e.covered = false, e.beyond = away;
    (left_is_free ? e.right_normal : e.left_normal) = theirs.normal;
    return;
  }
}

/// Of each polytope the others whose boxes meet its own, ascending.
std::vector<std::vector<std::size_t>> neighbours_of(std::span<Hull* const> hulls) {
  std::vector<HullBox> boxes;
  for (const Hull* hull : hulls) boxes.emplace_back(*hull);
  std::vector<std::size_t> order(hulls.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return boxes[i].low.x() < boxes[j].low.x(); });
  std::vector<std::vector<std::size_t>> near(hulls.size());
  for (auto i = order.begin(); i != order.end(); ++i)
    for (auto j = i + 1; j != order.end() && boxes[*j].low.x() <= boxes[*i].high.x(); ++j)
      if (boxes[*i].meets(boxes[*j])) near[*i].push_back(*j), near[*j].push_back(*i);
  for (std::vector<std::size_t>& all : near) std::sort(all.begin(), all.end());
  return near;
}

}  // namespace

void expose(std::span<Hull* const> hulls) {
  const auto near = neighbours_of(hulls);
  for (std::size_t i = 0; i < hulls.size(); ++i)
    for (const std::size_t j : near[i]) cover(*hulls[i], *hulls[j]);
  for (std::size_t i = 0; i < hulls.size(); ++i)
    for (Hull::Edge& e : hulls[i]->edges)
      if (e.covered && face_of(*hulls[i], e.left).covered != face_of(*hulls[i], e.right).covered)
        for (const std::size_t j : near[i])
          if (e.covered) find_ridge(*hulls[i], e, *hulls[j]);
}

}  // namespace orthant::spatial
