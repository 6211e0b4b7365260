// Contacts of a spatial scene file.
#include "spatial_fields.h"

#include <orthant/core/lcp/problem.h>
#include <orthant/core/mechanics/spatial/height_field.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

namespace orthant::scene_file {

namespace {

void read_spatial_law(Fields& f, ContactLaw& law) {
  f.maybe("mu", law.mu), f.maybe("e_n", law.e), f.maybe("e_t", law.e_t), f.maybe("mu_static", law.mu_static);
  f.maybe("rolling", law.surface.rolling), f.maybe("spinning", law.surface.spinning);
}

/// Keys of listed contacts only: friction by direction, a surface that moves.
void read_surface(Fields& f, ContactLaw& law) {
  SurfaceLaw& s = law.surface;
  const bool across = f.maybe("mu_across", s.mu_across), along = f.direction("direction", s.direction);
  if (across != along) f.miss(across ? "direction" : "mu_across");
  if (const toml::table* table = f.inner("surface")) {
    Fields g = f.fields("surface", *table);
    g.maybe("velocity", s.velocity), g.maybe("omega", s.omega), g.maybe("centre", s.centre);
    g.done();
  }
}

void read_contact_law(Fields& f, ContactLaw& law) { read_spatial_law(f, law), read_surface(f, law); }

/// Refuses a terrain with cells that have no volume in double precision, by the number that is too large.
void examine_cells(const Fields& f, const spatial::HeightField& field) {
  constexpr double kMostRatio = 1e8, kMostLength = 1e60;
  const double least = std::min({field.dx, field.dy, field.depth}), most = std::min(kMostRatio * least, kMostLength);
  const std::string rule =
      "at most " + detail::text_of(most) + " m, " +
      (most < kMostLength ? "1e8 times the least of spacing and depth: the cells have no volume in "
                            "double precision otherwise"
                          : "the largest length whose powers are finite");
  const auto require = [&](bool good, const char* key) {
    if (good) return;
    const toml::node* node = f.table().get(key);
    f.refuse(key, node != nullptr ? *node : f.table(), rule);
  };
  require(std::max(field.dx, field.dy) <= most, "spacing"), require(field.depth <= most, "depth");
  require(field.origin.cwiseAbs().maxCoeff() <= most, "origin");
  const toml::array& rows = *f.table().get("heights")->as_array();
  for (Index i = 0; i < field.heights.rows(); ++i)
    for (Index j = 0; j < field.heights.cols(); ++j)
      if (!(std::abs(field.heights(i, j)) <= most))
        f.refuse("heights", *rows[static_cast<std::size_t>(i)].as_array()->get(static_cast<std::size_t>(j)), rule);
}

}  // namespace

template <class T> void SpatialReader::wall(Fields& f, T& c) const {
  c.a = body_of(f);
  const toml::table* table = f.inner("wall");
  if (table == nullptr) f.fail(f.table(), "missing key \"wall\"");
  Fields w = f.fields("wall", *table);
  half_space(w, c);
  w.done();
  read_contact_law(f, c.law);
}

template <class T> void SpatialReader::half_space(Fields& w, T& c) const {
  if (const toml::node* node = w.find("body", Form::word)) c.b = id(w, "body", *node);
  w.maybe("point", c.plane_point);
  if (!w.direction("normal", c.normal, true)) w.miss("normal");
}

template <class Read> void SpatialReader::each_table(Fields& f, std::string_view key, Read&& read) const {
  const toml::node* node = f.find(key, Form::tables);
  if (node == nullptr) return;
  const toml::array* tables = node->as_array();
  const auto refuse = [&](const toml::node& wrong) { f.refuse(key, wrong, "a list of tables {…}"); };
  if (tables == nullptr) refuse(*node);
  for (std::size_t i = 0; i < tables->size(); ++i) {
    const toml::table* table = tables->get(i)->as_table();
    if (table == nullptr) refuse(*tables->get(i));
    Fields g = f.fields(std::string(key) + "[" + std::to_string(i) + "]", *table);
    read(g);
    g.done();
  }
}

/// A terrain: `heights`, `spacing`, `origin`, `depth`.
void SpatialReader::height_field(Fields& f, spatial::Collision& c) const {
  constexpr std::size_t kMostCells = 1000000;
  spatial::HeightField field;
  std::vector<std::vector<double>> rows;
  f.need("heights", rows);
  const BodyId body = body_of(f);
  const auto refuse = [&](const char* key, const char* rule) { f.refuse(key, *f.table().get(key), rule); };
  const std::size_t columns = rows.empty() ? 0 : rows.front().size();
  const bool even = std::all_of(rows.begin(), rows.end(), [&](const auto& row) { return row.size() == columns; });
  if (rows.size() < 2 || columns < 2 || !even) refuse("heights", "rows of the same length, at least 2 × 2 numbers");
  if (rows.size() * columns > kMostCells) refuse("heights", "at most 1e6 numbers");
  Eigen::Vector2d spacing(1, 1);
  if (f.maybe("spacing", spacing) && !(spacing.minCoeff() > 0)) refuse("spacing", "two lengths > 0");
  if (f.maybe("depth", field.depth) && !(field.depth > 0)) refuse("depth", "> 0");
  f.maybe("origin", field.origin);
  field.dx = spacing.x(), field.dy = spacing.y();
  field.heights.resize(static_cast<Index>(rows.size()), static_cast<Index>(columns));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < columns; ++j) field.heights(static_cast<Index>(i), static_cast<Index>(j)) = rows[i][j];
  examine_cells(f, field);
  for (spatial::Shape& prism : spatial::shapes_of(field, body)) c.shapes.push_back(std::move(prism));
}

/// A sphere: `radius`, `centre`; a capsule: `radius`, `ends`; a box: `size`, `centre`; a polytope: `corners` or `file`.
void SpatialReader::shape(Fields& f, spatial::Collision& c) {
  if (f.table().contains("heights") || f.table().contains("spacing")) return height_field(f, c);
  spatial::Shape s{.body = kGround, .corners = {}};
  s.body = body_of(f);
  Vector3d size(0, 0, 0), centre(0, 0, 0);
  const bool box = f.maybe("size", size), ends = f.maybe("ends", s.corners), of_mesh = names_mesh(f);
  const bool polytope = f.maybe("corners", s.corners) || of_mesh;
  if (box + ends + polytope > 1 || (of_mesh && f.table().contains("corners")))
    f.fail(f.table(), "size, ends, corners, file: must be one of them, or radius alone: a sphere");
  if (!box && !ends && !polytope && !f.table().contains("radius"))
    f.fail(f.table(), "missing key \"radius\", \"size\", \"ends\", \"corners\", \"file\" or \"heights\"");
  if (of_mesh) s.corners = mesh_corners(f);
  if (box || (!ends && !polytope)) f.maybe("centre", centre);
  if (box && !(size.minCoeff() > 0)) f.refuse("size", *f.table().get("size"), "three lengths > 0");
  if (ends && s.corners.size() != 2) f.refuse("ends", *f.table().get("ends"), "two points [[x, y, z], [x, y, z]]");
  if (polytope && s.corners.size() < 4)
    f.refuse("corners", *f.table().get("corners"), "at least four points [x, y, z]");
  if (box)
    for (const Vector3d& corner : spatial::box_corners(size / 2)) s.corners.push_back(centre + corner);
  if (!box && !ends && !polytope) s.corners = {centre};
  if (!box && !polytope) f.need("radius", s.radius);
  c.shapes.push_back(s);
}

/// `apart`: pairs of bodies that do not meet.
void SpatialReader::apart(Fields& f, spatial::Collision& c) const {
  const toml::node* node = f.find("apart");
  if (node == nullptr) return;
  const toml::array* pairs = node->as_array();
  const auto refuse = [&](const toml::node& wrong) {
    f.refuse("apart", wrong, "a list of pairs of bodies [[\"first\", \"second\"], …]");
  };
  if (pairs == nullptr) refuse(*node);
  for (std::size_t i = 0; i < pairs->size(); ++i) {
    const toml::array* pair = pairs->get(i)->as_array();
    if (pair == nullptr || pair->size() != 2) refuse(*pairs->get(i));
    c.apart.emplace_back(id(f, "apart", *pair->get(0)), id(f, "apart", *pair->get(1)));
  }
}

void SpatialReader::collision(Fields& f) {
  spatial::Collision c{.name = given_name_, .shapes = {}, .law = {}};
  std::string name;
  if (f.maybe("name", name)) c.name = name;
  f.maybe("neighbours", c.neighbours), read_spatial_law(f, c.law);
  each_table(f, "shapes", [&](Fields& g) { shape(g, c); });
  apart(f, c);
  std::vector<spatial::SpherePlane> walls;
  each_table(f, "walls", [&](Fields& g) { half_space(g, walls.emplace_back()); });
  if (walls.empty() && std::all_of(c.shapes.begin(), c.shapes.end(),
                                   [&](const spatial::Shape& s) { return s.body == c.shapes.front().body; }))
    f.fail(f.table(), "shapes: must be of two bodies at least, or there must be walls: nothing can meet");
  int count = 0;
  for (spatial::SpherePlane wall : walls)
    for (const spatial::Shape& s : c.shapes) {
      if (s.body == wall.b) continue;
      wall.name = c.name + "_wall_" + std::to_string(++count), wall.a = s.body, wall.law = c.law;
      for (const spatial::SpherePlane& one : spatial::shape_plane(wall, s)) scene_.contact(one);
    }
  scene_.collision(c);
}

void SpatialReader::contact(Fields& f) {
  std::string type, name;
  f.need("type", type), f.maybe("name", name);
  if (name.empty()) name = given_name_;
  if (type == "sphere-wall") {
    spatial::SpherePlane c{.name = name};
    wall(f, c), f.maybe("centre", c.centre), f.need("radius", c.radius);
    if (!(c.radius > 0)) f.refuse("radius", *f.table().get("radius"), "> 0");
    scene_.contact(c);
  } else if (type == "corner-wall") {
    spatial::SpherePlane c{.name = name, .radius = 0};
    wall(f, c), f.maybe("point", c.centre);
    scene_.contact(c);
  } else if (type == "box-wall") {
    spatial::SpherePlane c{.name = name};
    Vector3d size(1, 1, 1);
    wall(f, c), f.need("size", size);
    if (!(size.minCoeff() > 0)) f.refuse("size", *f.table().get("size"), "three lengths > 0");
    scene_.contact_set(spatial::corners_plane(c, spatial::box_corners(size / 2)));
  } else if (type == "polytope-wall") {
    spatial::SpherePlane c{.name = name};
    std::vector<Vector3d> corners;
    wall(f, c);
    if (names_mesh(f)) {
      if (f.table().contains("corners")) f.fail(f.table(), "corners, file: must be one of them");
      corners = mesh_corners(f);
    } else {
      if (!f.maybe("corners", corners)) f.fail(f.table(), "missing key \"corners\" or \"file\"");
      if (corners.empty()) f.refuse("corners", *f.table().get("corners"), "at least one point [x, y, z]");
    }
    for (auto corner = corners.begin(); corner != corners.end(); ++corner)
      if (std::find(corners.begin(), corner, *corner) != corner)
        f.fail(f.table(), "corners: must be different points, point " + std::to_string(corner - corners.begin() + 1) +
                              " is an earlier one");
    scene_.contact_set(spatial::corners_plane(c, corners));
  } else if (type == "rim-wall" || type == "cylinder-wall" || type == "cone-wall") {
    rims(f, type, name);
  } else if (type == "ellipsoid-wall") {
    spatial::EllipsoidPlane c{.name = name};
    wall(f, c), f.maybe("centre", c.centre), f.need("semi_axes", c.semi_axes);
    if (f.maybe("orientation", c.orientation) && c.orientation.isZero(0))
      f.refuse("orientation", *f.table().get("orientation"), "a quaternion [w, x, y, z], not zero");
    c.orientation.normalize();
    scene_.contact(c);
  } else if (type == "sphere-sphere" || type == "socket" || type == "sphere-bush") {
    const auto read = [&](auto c) {
      points_of(f, c), f.maybe("centre_a", c.centre_a), f.maybe("centre_b", c.centre_b);
      if constexpr (requires { c.axis_b; })
        if (!f.direction("axis_b", c.axis_b, true)) f.miss("axis_b");
      f.need("radius_a", c.radius_a), f.need("radius_b", c.radius_b), read_contact_law(f, c.law);
      scene_.contact(c);
    };
    if (type == "socket")
      read(spatial::Socket{.name = name});
    else if (type == "sphere-bush")
      read(spatial::SphereBush{.name = name});
    else
      read(spatial::SphereSphere{.name = name});
  } else if (type == "pin-bush") {
    pin_bush(f, name);
  } else if (type == "block-channel") {
    block_channel(f, name);
  } else if (type == "limit") {
    limit(f, name);
  } else if (type == "backlash") {
    backlash(f, name);
  } else if (type == "rope") {
    spatial::Span span;
    spatial::Limit c{.name = name, .side = spatial::Limit::Side::upper};
    points_of(f, span), f.maybe("e_n", c.law.e), f.need("length", c.bound);
    if (!(c.bound > 0)) f.refuse("length", *f.table().get("length"), "> 0");
    c.of = span;
    scene_.contact(c);
  } else {
    f.refuse("type", *f.table().get("type"),
             "sphere-wall, corner-wall, box-wall, polytope-wall, rim-wall, cylinder-wall, cone-wall, ellipsoid-wall, "
             "sphere-sphere, socket, pin-bush, sphere-bush, block-channel, backlash, limit or rope");
  }
}

/// The rims are those of the shorter one.
void SpatialReader::pin_bush(Fields& f, const std::string& name) {
  spatial::PinBush c{.name = name};
  points_of(f, c), axes_of(f, c), f.maybe("centre_a", c.centre_a), f.maybe("centre_b", c.centre_b);
  f.need("radius_a", c.radius_a), f.need("radius_b", c.radius_b), read_contact_law(f, c.law);
  double pin = kInf, bush = kInf;
  const bool of_pin = f.maybe("length_a", pin), of_bush = f.maybe("length_b", bush);
  if (!of_pin && !of_bush) f.fail(f.table(), "missing key \"length_a\" or \"length_b\"");
  for (const auto& [key, given, length] : {std::tuple{"length_a", of_pin, pin}, std::tuple{"length_b", of_bush, bush}})
    if (given && !(length > 0 && length < kInf)) f.refuse(key, *f.table().get(key), "> 0");
  c.rim_of_pin = pin <= bush;
  scene_.contact_set(spatial::pin_in_bush(c, std::min(pin, bush)));
}

void SpatialReader::block_channel(Fields& f, const std::string& name) {
  spatial::BlockChannel c{.name = name};
  points_of(f, c), f.maybe("centre_a", c.centre_a), f.maybe("centre_b", c.centre_b);
  if (!f.direction("axis", c.axis)) f.miss("axis");
  if (!f.direction("up", c.up)) f.miss("up");
  if (std::abs(c.axis.dot(c.up)) > 1e-9) f.refuse("up", *f.table().get("up"), "at right angles to axis");
  f.need("size", c.size), f.need("width", c.width), f.need("height", c.height), orientation_of(f, c);
  if (f.table().get("orientation") == nullptr) {  // the block's edges are along the channel's in the initial poses
    const spatial::Matrix3d to_channel = (spatial::Matrix3d() << c.axis, c.up.cross(c.axis), c.up).finished();
    const Eigen::Quaterniond edges(initial_.at(c.a).R.transpose() * initial_.at(c.b).R * to_channel);
    c.orientation = {edges.w(), edges.x(), edges.y(), edges.z()};
    c.orientation.normalize();
  }
  if (!(c.size.minCoeff() > 0)) f.refuse("size", *f.table().get("size"), "three lengths > 0");
  if (!(c.width >= c.size.y())) f.refuse("width", *f.table().get("width"), ">= the block's");
  if (!(c.height >= c.size.z())) f.refuse("height", *f.table().get("height"), ">= the block's");
  read_contact_law(f, c.law);
  scene_.contact_set(spatial::block_in_channel(c));
}

/// A circle; the two rims of a cylinder about its centre; the rim of a cone's base, and its apex at height along axis.
void SpatialReader::rims(Fields& f, const std::string& type, const std::string& name) {
  spatial::RimPlane c{.name = name};
  double height = 0;
  wall(f, c), f.maybe("centre", c.centre), f.direction("axis", c.axis), f.need("radius", c.radius);
  if (type == "rim-wall") {
    f.maybe("tube", c.tube);
    return scene_.contact(c);
  }
  f.need("height", height);
  if (!(height > 0)) f.refuse("height", *f.table().get("height"), "> 0");
  if (type == "cone-wall") {
    scene_.contact_set(spatial::standing_rim(c));
    return scene_.contact(
        spatial::SpherePlane{name + "_4", c.a, c.centre + height * c.axis, 0, c.b, c.plane_point, c.normal, c.law});
  }
  const Vector3d half = height / 2 * c.axis, centre = c.centre;
  c.centre = centre - half, scene_.contact_set(spatial::standing_rim(c, 1));
  c.centre = centre + half, scene_.contact_set(spatial::standing_rim(c, 4));
}

void SpatialReader::limit(Fields& f, const std::string& name) {
  spatial::Limit c{.name = name, .of = coordinate(f)};
  f.maybe("e_n", c.law.e);
  double lower = 0, upper = 0;
  const bool below = f.maybe("lower", lower), above = f.maybe("upper", upper);
  if (!below && !above) f.fail(f.table(), "missing key \"lower\" or \"upper\"");
  if (below && above && lower >= upper) f.refuse("lower", *f.table().get("lower"), "less than upper");
  const bool both = below && above && c.of.angle();
  if (both && upper - lower >= 2 * std::numbers::pi)
    f.refuse("upper", *f.table().get("upper"), "less than a full turn above lower: an angle is known up to full turns");
  const auto add = [&](spatial::Limit::Side side, double bound, const char* suffix) {
    spatial::Limit one = c;
    one.side = side, one.bound = bound;
    if (both) one.beyond = (lower + upper) / 2 - bound;
    if (below && above) one.name += suffix;
    scene_.contact(one);
  };
  if (below) add(spatial::Limit::Side::lower, lower, "_lower");
  if (above) add(spatial::Limit::Side::upper, upper, "_upper");
}

/// The flanks are as far from the teeth in between on both sides at the start. With a radius it is that of a rack.
void SpatialReader::backlash(Fields& f, const std::string& name) {
  const spatial::Gear gear = gear_of(f, f.table().get("radius") != nullptr, {});
  double play = 0;
  ContactLaw law;
  f.need("play", play), f.maybe("e_n", law.e);
  scene_.contact_set(spatial::meshing(name, gear, play, law));
}

}  // namespace orthant::scene_file
