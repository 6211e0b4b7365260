#include <orthant/core/mechanics/spatial/hull.h>

#include <orthant/core/mechanics/spatial/geometry.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>

namespace orthant::spatial {
namespace {

constexpr double kFlat = 1e-9;        // of the size: points of one plane
constexpr double kMostLength = 1e60;  // [m] its fourth power is finite, that of its inverse is normal

/// The points of a plane's face, those between two others of its rim left out, counter-clockwise about its normal.
std::vector<int> rim_of(const std::vector<Vector3d>& points, const std::vector<int>& on, const Vector3d& normal,
                        double flat) {
  const Vector3d u = perpendicular(normal), w = normal.cross(u);
  std::vector<int> order = on;
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    const Vector3d &p = points[static_cast<std::size_t>(i)], &r = points[static_cast<std::size_t>(j)];
    const double x = u.dot(p - r);
    return std::abs(x) > flat ? x < 0 : w.dot(p - r) < 0;
  });
  // Andrew's monotone chain: the lower half from left to right, the upper one back.
  std::vector<int> rim;
  const auto turn_of = [&](int i, int j, int k) {
    const Vector3d& p = points[static_cast<std::size_t>(i)];
    const Vector3d way = points[static_cast<std::size_t>(j)] - p, next = points[static_cast<std::size_t>(k)] - p;
    return normal.dot(way.cross(next)) / std::max(way.norm(), flat);
  };
  const auto chain = [&](auto from, auto to) {
    const std::size_t start = rim.size();
    for (auto i = from; i != to; ++i) {
      while (rim.size() >= start + 2 && turn_of(rim[rim.size() - 2], rim.back(), *i) <= flat) rim.pop_back();
      rim.push_back(*i);
    }
    rim.pop_back();  // where the other half begins
  };
  chain(order.begin(), order.end());
  chain(order.rbegin(), order.rend());
  return rim;
}

/// Columns: principal directions of the points about their mean, by ascending spread.
Eigen::Matrix3d spread_of(const std::vector<Vector3d>& points) {
  Vector3d mean(0, 0, 0);
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) sum += (p - mean) * (p - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors();
}

/// Of each of 26 directions, and of the points' principal directions, the farthest point: each once.
std::vector<Vector3d> extreme_points(const std::vector<Vector3d>& points) {
  std::vector<Vector3d> directions;
  for (int i = 0; i < 27; ++i)
    if (i != 13) directions.emplace_back(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
  const Eigen::Matrix3d own = spread_of(points);
  for (int i = 0; i < 3; ++i) directions.insert(directions.end(), {own.col(i), -own.col(i)});
  std::set<std::size_t> kept;
  for (const Vector3d& d : directions) {
    const auto nearer = [&](const Vector3d& p, const Vector3d& q) { return d.dot(p) < d.dot(q); };
    kept.insert(static_cast<std::size_t>(std::max_element(points.begin(), points.end(), nearer) - points.begin()));
  }
  std::vector<Vector3d> few;
  for (const std::size_t i : kept) few.push_back(points[i]);
  return few;
}

}  // namespace

double Hull::depth_of(const Vector3d& p) const {
  double most = faces.front().normal.dot(p) - faces.front().offset;
  for (const Face& face : faces) most = std::max(most, face.normal.dot(p) - face.offset);
  return most;
}

Hull hull_of(const std::vector<Vector3d>& points) {
  const auto n = static_cast<int>(points.size());
  if (n < 4 || points.size() > kMostHullPoints)
    throw std::invalid_argument("must be 4 to " + std::to_string(kMostHullPoints) + " points, are " +
                                std::to_string(n));
  Hull hull;
  Vector3d mean(0, 0, 0);
  for (const Vector3d& p : points) mean += p / n;
  for (const Vector3d& p : points) hull.size = std::max(hull.size, (p - mean).cwiseAbs().maxCoeff());
  double farthest = hull.size;
  for (const Vector3d& p : points) farthest = std::max(farthest, p.cwiseAbs().maxCoeff());
  if (hull.size > 0 && !(hull.size >= 1 / kMostLength && farthest <= kMostLength))
    throw std::invalid_argument("must span 1e-60 to 1e60 m, and lie within 1e60 m of the origin");
  const double flat = kFlat * hull.size;
  const auto at = [&](int i) -> const Vector3d& { return points[static_cast<std::size_t>(i)]; };
  std::vector<int> on;
  // Every plane through three points with all others on one side is a face's, found first by its first three points.
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        Vector3d normal = (at(j) - at(i)).cross(at(k) - at(i));
        if (normal.norm() <= flat * (at(j) - at(i)).norm()) continue;
        normal.normalize();
        double low = 0, high = 0;
        for (int l = 0; l < n && (low >= -flat || high <= flat); ++l) {  // most planes: until points lie on both sides
          const double height = normal.dot(at(l) - at(i));
          low = std::min(low, height), high = std::max(high, height);
        }
        if (low < -flat && high > flat) continue;
        if (low >= -flat && high <= flat) throw std::invalid_argument("must not lie in one plane");
        if (high > flat) normal = -normal;
        on.clear();
        for (int l = 0; l < n; ++l)
          if (std::abs(normal.dot(at(l) - at(i))) <= flat) on.push_back(l);
        const bool known = std::any_of(hull.faces.begin(), hull.faces.end(), [&](const Hull::Face& face) {
          return std::abs(face.normal.dot(at(i)) - face.offset) <= flat &&
                 std::abs(face.normal.dot(at(j)) - face.offset) <= flat &&
                 std::abs(face.normal.dot(at(k)) - face.offset) <= flat;
        });
        if (!known) hull.faces.push_back({normal, normal.dot(at(i)), rim_of(points, on, normal, flat), {}, false});
      }
  if (hull.faces.empty()) throw std::invalid_argument("must not lie in one plane or line");
  std::vector<int> number(points.size(), -1);
  for (const Hull::Face& face : hull.faces)
    for (const int i : face.corners) number[static_cast<std::size_t>(i)] = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (number[i] == 0) number[i] = static_cast<int>(hull.corners.size()), hull.corners.push_back(points[i]);
  for (Hull::Face& face : hull.faces)
    for (int& i : face.corners) i = number[static_cast<std::size_t>(i)];
  // Each edge is run through by its two faces, in the two directions.
  for (int f = 0; f < static_cast<int>(hull.faces.size()); ++f) {
    const std::vector<int>& rim = hull.faces[static_cast<std::size_t>(f)].corners;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const int from = rim[i], to = rim[(i + 1) % rim.size()];
      const auto twin = std::find_if(hull.edges.begin(), hull.edges.end(),
                                     [&](const Hull::Edge& e) { return e.from == to && e.to == from; });
      hull.faces[static_cast<std::size_t>(f)].edges.push_back(static_cast<int>(twin - hull.edges.begin()));
      if (twin == hull.edges.end())
        hull.edges.push_back({.from = from, .to = to, .left = f, .right = -1});
      else
        twin->right = f;
    }
  }
  if (std::any_of(hull.edges.begin(), hull.edges.end(), [](const Hull::Edge& e) { return e.right < 0; }))
    throw std::invalid_argument("must not lie almost in one plane or line");
  for (Hull::Edge& e : hull.edges) {
    e.left_normal = hull.faces[static_cast<std::size_t>(e.left)].normal;
    e.right_normal = hull.faces[static_cast<std::size_t>(e.right)].normal;
  }
  return hull;
}

FittedHull fit_hull(const std::vector<Vector3d>& points, std::size_t most) {
  if (points.size() < 4) return {hull_of(points)};
  const auto before = [](const Vector3d& p, const Vector3d& q) {
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  std::vector<Vector3d> all = points;
  std::sort(all.begin(), all.end(), before);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  most = std::clamp<std::size_t>(most, 4, kMostHullPoints);
  std::vector<Vector3d> corners = all.size() <= most ? all : extreme_points(all);
  if (corners.size() > most) corners.resize(most);
  FittedHull fit;
  while (true) {
    fit.hull = hull_of(corners);
    struct Beyond {
      double height;
      std::size_t point;
    };
    std::vector<Beyond> beyond;  // the farthest point of each face
    for (const Hull::Face& face : fit.hull.faces) {
      Beyond farthest{kFlat * fit.hull.size, all.size()};
      for (std::size_t i = 0; i < all.size(); ++i)
        if (const double height = face.normal.dot(all[i]) - face.offset; height > farthest.height)
          farthest = {height, i};
      if (farthest.point < all.size()) beyond.push_back(farthest);
    }
    std::sort(beyond.begin(), beyond.end(), [](const Beyond& p, const Beyond& q) {
      return p.height != q.height ? p.height > q.height : p.point < q.point;
    });
    fit.outside = beyond.empty() ? 0 : beyond.front().height;
    corners = fit.hull.corners;
    if (beyond.empty() || corners.size() >= most) return fit;
    // Half of the room at once: those added later see where the first ones leave points outside.
    const std::size_t room = most - corners.size(), end = corners.size() + (room + 1) / 2;
    std::set<std::size_t> taken;
    for (const Beyond& one : beyond)
      if (corners.size() < end && taken.insert(one.point).second) corners.push_back(all[one.point]);
  }
}

std::vector<Vector3d> flat_hull(const std::vector<Vector3d>& points) {
  if (points.size() < 3) return {};
  const Eigen::Matrix3d own = spread_of(points);
  double size = 0, width = 0;
  for (const Vector3d& p : points) {
    size = std::max(size, (p - points.front()).cwiseAbs().maxCoeff());
    width = std::max(width, std::abs(own.col(1).dot(p - points.front())));
  }
  if (width <= kFlat * size) return {};
  std::vector<int> on(points.size());
  std::iota(on.begin(), on.end(), 0);
  std::vector<Vector3d> rim;
  for (const int i : rim_of(points, on, own.col(0), kFlat * size)) rim.push_back(points[static_cast<std::size_t>(i)]);
  return rim;
}

}  // namespace orthant::spatial
