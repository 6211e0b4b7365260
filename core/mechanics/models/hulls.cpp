#include <orthant/core/mechanics/models/hulls.h>
#include <orthant/core/support/options.h>

#include <cmath>
#include <stdexcept>

namespace orthant::models {

MeshHull hull_of_mesh(Mesh mesh, const Vector3d& scale, const std::string& who) {
  for (Vector3d& p : mesh.points) p = p.cwiseProduct(scale);
  for (spatial::Triangle& t : mesh.surface) {
    for (Vector3d& p : t) p = p.cwiseProduct(scale);
    if (scale.prod() < 0) std::swap(t[1], t[2]);
  }
  for (const Vector3d& p : mesh.points)
    if (!(p.cwiseAbs().maxCoeff() < 1e100))
      throw std::invalid_argument(who + ": points: must be less than 1e100 m away");
  MeshHull result;
  spatial::FittedHull fit;
  try {
    fit = spatial::fit_hull(mesh.points);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(who + ": its points " + error.what());
  }
  result.corners = fit.hull.corners;
  const spatial::Polyhedron hull = spatial::polyhedron(fit.hull);
  const bool is_closed = closed(mesh);
  if (is_closed) result.solid = spatial::polyhedron(mesh.surface);
  const bool inside_out = is_closed && result.solid.volume < 0;
  const bool whole = result.solid.volume > 0 && result.solid.volume <= 1.001 * hull.volume + fit.outside * hull.volume;
  if (!whole) result.solid = hull;
  constexpr double kConvex = 1e-3;  // of the hull's volume
  if (fit.outside > 0)
    result.note = who + ": a hull of " + std::to_string(result.corners.size()) + " corners, up to " +
                  detail::text_of(static_cast<float>(fit.outside)) + " m of the mesh outside";
  else if (!whole && !mesh.surface.empty())
    result.note = who +
                  (inside_out  ? ": the surface is inside out (corners clockwise, seen from outside)"
                   : is_closed ? ": the surface overlaps itself"
                               : ": the surface is not closed") +
                  ": taken as its convex hull";
  else if (whole && result.solid.volume < (1 - kConvex) * hull.volume)
    result.note = who + ": is not convex: meets others as its convex hull, " +
                  detail::text_of(std::round(100 * (hull.volume / result.solid.volume - 1))) + " % more volume";
  return result;
}

const MeshHull& MeshHulls::get(const XmlElement& element, const XmlAttribute& attribute, const Vector3d& scale,
                               const std::filesystem::path& below) {
  const std::filesystem::path file = files_.find(element, attribute, attribute.value, below);
  std::string key = file.string();
  for (const double s : scale) key += " " + detail::text_of(s);
  const auto known = hulls_.find(key);
  if (known != hulls_.end()) return known->second;
  const std::string who = file.filename().string();
  try {
    const std::string bytes = files_.read(element, attribute, file, kLargestMesh);
    Mesh mesh = read_mesh(bytes, who);
    if (mesh.points.empty()) {
      return hulls_.emplace(key, MeshHull{{}, {}, "not taken: mesh " + who + ": must be STL or OBJ"}).first->second;
    }
    return hulls_.emplace(key, hull_of_mesh(std::move(mesh), scale, who)).first->second;
  } catch (const std::invalid_argument& error) {
    if (std::string_view(error.what()).starts_with(element.file)) throw;
    refuse(element, error.what());
  }
}

std::vector<std::string> MeshHulls::notes() const {
  std::vector<std::string> all;
  for (const auto& [key, hull] : hulls_)
    if (!hull.note.empty()) all.push_back(hull.note);
  return all;
}

}  // namespace orthant::models
