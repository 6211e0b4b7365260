#include <orthant/core/mechanics/spatial/polyhedron.h>

namespace orthant::spatial {

Polyhedron polyhedron(const std::vector<Triangle>& surface) {
  Polyhedron all;
  Vector3d mean(0, 0, 0);
  for (const Triangle& t : surface) mean += (t[0] + t[1] + t[2]) / (3 * static_cast<double>(surface.size()));
  Vector3d first(0, 0, 0);
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const Triangle& t : surface) {
    const Vector3d a = t[0] - mean, b = t[1] - mean, c = t[2] - mean, s = a + b + c;
    const double d = a.dot(b.cross(c));
    all.volume += d / 6, first += d / 24 * s;
    second += d / 120 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  if (!(all.volume > 0)) return all;
  const Vector3d off = first / all.volume;
  const Eigen::Matrix3d C = second / all.volume - off * off.transpose();
  all.centre = mean + off, all.inertia = C.trace() * Eigen::Matrix3d::Identity() - C;
  return all;
}

Polyhedron polyhedron(const Hull& hull) {
  std::vector<Triangle> surface;
  for (const Hull::Face& face : hull.faces) {
    const auto at = [&](std::size_t i) -> const Vector3d& {
      return hull.corners[static_cast<std::size_t>(face.corners[i])];
    };
    for (std::size_t i = 2; i < face.corners.size(); ++i) surface.push_back({at(0), at(i - 1), at(i)});
  }
  return polyhedron(surface);
}

}  // namespace orthant::spatial
