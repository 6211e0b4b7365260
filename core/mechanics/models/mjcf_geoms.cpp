// Shapes of MJCF: geoms with their sizes, and the mass that they give their body.
#include <orthant/core/mechanics/models/mjcf_reader.h>
#include <orthant/core/mechanics/spatial/inertia.h>
#include <orthant/core/mechanics/spatial/rotation.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>

namespace orthant::models {

void MjcfReader::geom(const Styled& e, int number, const Place& at) {
  constexpr std::array<std::string_view, 8> kTypes = {"plane",     "hfield",   "sphere", "capsule",
                                                      "ellipsoid", "cylinder", "box",    "mesh"};
  const Found type_found = e.find("type"), mesh = e.find("mesh");
  const std::string_view type = kTypes[type_found ? choice_of(*type_found.element, *type_found.attribute, kTypes) : 2];
  if (type == "hfield") {
    model_.notes.push_back("not taken: " + e.element().place() + ": a height field");
    return;
  }
  if (mesh && type != "mesh")
    refuse(*mesh.element, *mesh.attribute, "left out, or type mesh: nothing is fitted to meshes");
  ModelShape s;
  if (const Attribute a = e.element().find("name")) s.name = a->value;
  spatial::Polyhedron solid;
  sized(e, type, mesh, s, solid);
  s.at = at * s.at;
  if (s.kind == ModelShape::Kind::polytope) {
    solid.centre = s.at * solid.centre, solid.inertia = s.at.R * solid.inertia * s.at.R.transpose();
    for (Vector3d& p : s.corners) p = s.at * p;
  } else {
    solid.centre = s.at.p, solid.inertia = s.at.R * solid.inertia * s.at.R.transpose();
  }
  const double group = e.number("group", 0), density = e.not_negative("density", 1000);
  const Found given = e.find("mass");
  ModelLink& link = model_.links[static_cast<std::size_t>(number)];
  if (geoms_count_ && s.kind != ModelShape::Kind::plane && group >= groups_.first && group <= groups_.second) {
    const double mass = given ? number_of(*given.element, *given.attribute) : density * solid.volume;
    if (mass < 0) refuse(*given.element, *given.attribute, ">= 0");
    add_mass(link, mass, solid.centre, mass * solid.inertia);
  }
  s.mu = 1;
  if (const Found f = e.find("friction")) {
    s.mu = numbers_of(*f.element, *f.attribute, 1, 3)[0];
    if (s.mu < 0) refuse(*f.element, *f.attribute, ">= 0");
  }
  if (const Found f = e.find("condim")) {
    constexpr std::array<std::string_view, 4> kDimensions = {"1", "3", "4", "6"};
    const std::size_t dimension = choice_of(*f.element, *f.attribute, kDimensions);
    s.slippery = dimension == 0;
    if (dimension > 1) ++torsion_;
  }
  const auto mask = [&](const char* name) {
    const double x = e.number(name, 1);
    if (x != std::floor(x) || x < 0 || x > 4294967295.0)
      refuse(e.element(), std::string(name) + ": must be a bit mask");
    return static_cast<unsigned>(x);
  };
  s.type = mask("contype"), s.affinity = mask("conaffinity");
  if (!contacts_) s.type = s.affinity = 0;
  if (s.kind == ModelShape::Kind::plane && number > 0) {
    for (int up = number; up > 0; up = model_.links[static_cast<std::size_t>(up)].parent)
      if (!model_.links[static_cast<std::size_t>(up)].joints.empty())
        refuse(e.element(), "type = 'plane': must be in a body that cannot move");
  }
  if (s.kind != ModelShape::Kind::polytope || !s.corners.empty()) link.shapes.push_back(std::move(s));
}

void MjcfReader::sized(const Styled& e, std::string_view type, const Found& mesh, ModelShape& s,
                       spatial::Polyhedron& solid) {
  using Kind = ModelShape::Kind;
  const Found size = e.find("size"), ends = e.find("fromto");
  if (type == "mesh") {
    if (!mesh) refuse(e.element(), "missing attribute mesh");
    const MeshHull& hull = mesh_named(*mesh.element, *mesh.attribute);
    s.kind = Kind::polytope, s.at = frame(e), s.corners = hull.corners, solid = hull.solid;
    return;
  }
  std::vector<double> x;
  if (size) x = numbers_of(*size.element, *size.attribute, 1, 3);
  if (type == "plane") {
    s.kind = Kind::plane, s.at = frame(e);
    return;
  }
  double length = 0;
  if (ends) {
    if (type == "sphere") refuse(*ends.element, *ends.attribute, "of a capsule, cylinder, ellipsoid or box");
    const auto p = numbers_of(*ends.element, *ends.attribute, 6, 6);
    const Vector3d from(p[0], p[1], p[2]), to(p[3], p[4], p[5]);
    length = (to - from).norm();
    if (!(length > 1e-12)) refuse(*ends.element, *ends.attribute, "two different points");
    s.at = {towards((to - from).normalized()), (from + to) / 2};
  } else {
    s.at = frame(e);
  }
  const bool round = type == "capsule" || type == "cylinder";
  const std::size_t wanted = type == "sphere" || ends ? 1 : round ? 2 : 3;
  if (x.size() < wanted)
    refuse(e.element(), "size: must be " + std::to_string(wanted) + (wanted == 1 ? " number" : " numbers"));
  for (std::size_t i = 0; i < wanted; ++i)
    if (!(x[i] > 0)) refuse(*size.element, *size.attribute, "> 0");
  spatial::Solid of;
  if (type == "sphere") {
    s.kind = Kind::sphere, s.size = {x[0], 0, 0}, of = spatial::sphere(x[0]);
  } else if (round) {
    s.kind = type == "capsule" ? Kind::capsule : Kind::cylinder;
    s.size = {x[0], ends ? length : 2 * x[1], 0};
    of = type == "capsule" ? spatial::capsule(s.size.x(), s.size.y()) : spatial::cylinder(s.size.x(), s.size.y());
  } else {
    const Vector3d half = ends ? Vector3d(x[0], x[0], length / 2) : Vector3d(x[0], x[1], x[2]);
    const bool box = type == "box";
    s.kind = box ? Kind::box : Kind::ellipsoid, s.size = box ? Vector3d(2 * half) : half;
    of = box ? spatial::box(s.size) : spatial::ellipsoid(half);
  }
  solid.volume = of.volume, solid.inertia = of.inertia;
}

}  // namespace orthant::models
