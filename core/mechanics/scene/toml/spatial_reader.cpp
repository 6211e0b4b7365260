#include "spatial_reader.h"

#include "reader.h"

#include <orthant/core/lcp/problem.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <optional>
#include <tuple>

namespace orthant::scene_file {

namespace {

constexpr std::array<std::string_view, 2> kFrameNames = {"world", "body"};

/// A unit vector at right angles to u, next to `near` where that is not along u.
Vector3d square_to(const Vector3d& u, const Vector3d& near) {
  const Vector3d left = near - u.dot(near) * u;
  return left.norm() > 1e-9 ? Vector3d(left.normalized()) : spatial::perpendicular(u);
}

void read_law(Fields& f, ContactLaw& law) {
  f.maybe("mu", law.mu), f.maybe("e_n", law.e), f.maybe("e_t", law.e_t), f.maybe("mu_static", law.mu_static);
  f.maybe("rolling", law.surface.rolling), f.maybe("spinning", law.surface.spinning);
}

/// What listed contacts have besides: friction by direction, a surface that moves.
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

void read_contact_law(Fields& f, ContactLaw& law) { read_law(f, law), read_surface(f, law); }

}  // namespace

spatial::Scene SpatialReader::scene() {
  Fields top(root_, "", file_);
  double dimension = 3;
  top.need("dimension", dimension);
  top.maybe("gravity", scene_.gravity), top.maybe("duration", scene_.duration), top.maybe("step", scene_.step);
  top.choice("restitution", scene_.restitution, kRestitutionNames);
  top.choice("impacts", scene_.impacts, kImpactsNames);
  each(top, "body", [&](Fields& f) { body(f); });
  pose_bodies();
  each(top, "joint", [&](Fields& f) { joint(f); });
  each(top, "contact", [&](Fields& f) { contact(f); });
  each(top, "collision", [&](Fields& f) { collision(f); });
  each(top, "friction", [&](Fields& f) { friction(f); });
  each(top, "spring", [&](Fields& f) { spring(f); });
  each(top, "load", [&](Fields& f) { load(f); });
  top.done();
  try {
    spatial::check(scene_);
  } catch (const SceneError& error) {
    throw std::invalid_argument(place(find(error), file_) + ": " + error.what());
  }
  return std::move(scene_);
}

template <class Read> void SpatialReader::each(Fields& top, std::string_view kind, Read&& read) {
  const toml::node* list = top.find(kind, Form::tables);
  if (list == nullptr) return;
  if (!list->is_array()) top.refuse(kind, *list, "a list of tables [[" + std::string(kind) + "]]");
  const toml::array& elements = *list->as_array();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const toml::table* table = elements.get(i)->as_table();
    if (table == nullptr) top.refuse(kind, *elements.get(i), "a table");
    given_name_ = name_of(*table, kind, i);
    Fields fields(*table, std::string(kind) + " " + in_quotes(given_name_) + ": ", file_);
    read(fields);
    fields.done();
    written_.resize(scene_.contacts.size(), {kind, i});
  }
}

void SpatialReader::body(Fields& f) {
  spatial::Body b;
  f.need("name", b.name);
  if (const toml::table* table = f.inner("solid")) {
    solid(f, *table, b);
  } else {
    f.need("mass", b.mass), f.need("inertia", b.inertia);
  }
  f.maybe("position", b.position);
  const bool written = f.maybe("orientation", b.orientation);
  if (written && b.orientation.isZero(0))
    f.refuse("orientation", *f.table().get("orientation"), "a quaternion [w, x, y, z], not zero");
  b.orientation.normalize();
  Vector3d axis(0, 0, 1);
  double angle = 0;
  const bool turned = f.maybe("angle", angle), about = f.direction("axis", axis);
  if (written && (turned || about))
    f.refuse("orientation", *f.table().get("orientation"), "left out where \"angle\" and \"axis\" are given");
  if (turned) b.orientation = quaternions::exponential(angle * axis).normalized();
  f.maybe("velocity", b.velocity), f.maybe("omega", b.omega);
  if (b.name.empty()) f.refuse("name", *f.table().get("name"), "of letters, digits, _ and -");
  ids_.emplace(b.name, scene_.body(b));
}

/// Mass and inertia of a homogeneous body from its shape, and from `mass` or `density`.
void SpatialReader::solid(Fields& f, const toml::table& table, spatial::Body& b) const {
  Fields g = f.fields("solid", table);
  std::optional<spatial::Solid> solid;
  const auto positive = [&](const char* key, double least) {
    if (!(least > 0)) g.refuse(key, *table.get(key), "of lengths > 0");
    if (solid) g.fail(table, "solid: must be one shape");
  };
  Vector3d size(0, 0, 0);
  Vector2d round(0, 0);
  double radius = 0;
  if (g.maybe("box", size)) positive("box", size.minCoeff()), solid = spatial::box(size);
  if (g.maybe("ellipsoid", size)) positive("ellipsoid", size.minCoeff()), solid = spatial::ellipsoid(size);
  if (g.maybe("sphere", radius)) positive("sphere", radius), solid = spatial::sphere(radius);
  for (const auto& [key, make] : {std::pair{"cylinder", &spatial::cylinder}, std::pair{"capsule", &spatial::capsule},
                                  std::pair{"cone", &spatial::cone}})
    if (g.maybe(key, round)) positive(key, round.minCoeff()), solid = make(round.x(), round.y());
  g.done();
  if (!solid) g.fail(table, "solid: must be {box = …}, sphere, ellipsoid, cylinder, capsule or cone");
  double density = 0;
  const bool has_density = f.maybe("density", density);
  if (has_density == f.maybe("mass", b.mass)) f.fail(f.table(), "solid: needs either \"mass\" or \"density\"");
  if (has_density) {
    if (!(density > 0)) f.refuse("density", *f.table().get("density"), "> 0");
    b.mass = density * solid->volume;
  }
  b.inertia = b.mass * solid->inertia;
}

void SpatialReader::pose_bodies() {
  for (const spatial::Body& b : scene_.bodies) {
    const Eigen::Matrix3d R = quaternions::matrix_of(b.orientation);
    initial_.pose.push_back({b.position, R, R});
  }
  initial_.pose.emplace_back();
}

BodyId SpatialReader::id(const Fields& f, std::string_view key, const toml::node& node) const {
  const auto name = node.value_exact<std::string>();
  if (name && *name == "ground") return kGround;
  const auto found = name ? ids_.find(*name) : ids_.end();
  if (found == ids_.end()) {
    std::vector<std::string> names{"ground"};
    for (const spatial::Body& b : scene_.bodies) names.push_back(b.name);
    f.refuse(key, node, "the name of a body: " + join(names));
  }
  return found->second;
}

BodyId SpatialReader::body_of(Fields& f) const {
  std::string unused;
  f.need("body", unused);
  return id(f, "body", *f.table().get("body"));
}

template <class T> void SpatialReader::points_of(Fields& f, T& x) const {
  const toml::node* node = f.find("bodies", Form::bodies, true);
  if (node == nullptr) f.fail(f.table(), "missing key \"bodies\"");
  const toml::array* names = node->as_array();
  if (names == nullptr || names->size() != 2) f.refuse("bodies", *node, "two names [\"first\", \"second\"]");
  x.a = id(f, "bodies", *names->get(0)), x.b = id(f, "bodies", *names->get(1));
  if constexpr (requires { x.point_a; }) f.maybe("point_a", x.point_a), f.maybe("point_b", x.point_b);
}

/// `axis` in a's frame, `axis_b` in b's: left out, it is the same direction in the initial poses.
template <class T> void SpatialReader::axes_of(Fields& f, T& x) const {
  if (!f.direction("axis", x.axis_a, true)) f.miss("axis");
  if (!f.direction("axis_b", x.axis_b))
    x.axis_b = initial_.at(x.b).turn_back(initial_.at(x.a).turn(x.axis_a)).normalized();
}

/// `angle` [rad] in the initial poses; 0.
template <class T> void SpatialReader::angle_of(Fields& f, T& x) const {
  double angle = 0;
  f.maybe("angle", angle);
  const Vector3d u = initial_.at(x.a).turn(x.axis_a), from = spatial::perpendicular(x.axis_a);
  const Vector3d world = Eigen::AngleAxisd(angle, u) * initial_.at(x.a).turn(from);
  x.reference_a = from, x.reference_b = square_to(x.axis_b, initial_.at(x.b).turn_back(world));
}

/// `orientation` of b in a; left out, that of the initial poses.
template <class T> void SpatialReader::orientation_of(Fields& f, T& x) const {
  const auto of = [&](BodyId b) {
    return b < 0 ? Eigen::Vector4d(1, 0, 0, 0) : scene_.bodies[static_cast<std::size_t>(b)].orientation;
  };
  if (!f.maybe("orientation", x.orientation))
    x.orientation = quaternions::product(quaternions::inverse(of(x.a)), of(x.b));
  if (x.orientation.isZero(0))
    f.refuse("orientation", *f.table().get("orientation"), "a quaternion [w, x, y, z], not zero");
  x.orientation.normalize();
}

void SpatialReader::joint(Fields& f) {
  std::string type, name;
  f.need("type", type), f.maybe("name", name);
  if (type == "spherical") {
    spatial::Spherical j{.name = name};
    points_of(f, j);
    scene_.joint(j);
  } else if (type == "revolute") {
    spatial::Revolute j{.name = name};
    points_of(f, j), axes_of(f, j), angle_of(f, j);
    scene_.joint(j);
  } else if (type == "cylindrical") {
    spatial::Cylindrical j{.name = name};
    points_of(f, j), axes_of(f, j), angle_of(f, j);
    scene_.joint(j);
  } else if (type == "screw") {
    spatial::Screw j{.name = name};
    points_of(f, j), axes_of(f, j), angle_of(f, j), f.need("pitch", j.pitch);
    j.offset = j.displacement().value(initial_) - j.pitch / (2 * std::numbers::pi) * j.angle().value(initial_);
    scene_.joint(j);
  } else if (type == "gear" || type == "rack") {
    gear(f, type, name);
  } else if (type == "universal") {
    spatial::Universal j{.name = name};
    points_of(f, j);
    if (!f.direction("axis", j.axis_a, true)) f.miss("axis");
    if (!f.direction("axis_b", j.axis_b, true)) f.miss("axis_b");
    scene_.joint(j);
  } else if (type == "planar") {
    spatial::PlaneJoint j{.name = name};
    points_of(f, j), axes_of(f, j);
    scene_.joint(j);
  } else if (type == "prismatic") {
    spatial::Prismatic j{.name = name};
    points_of(f, j), orientation_of(f, j);
    if (!f.direction("axis", j.axis, true)) f.miss("axis");
    scene_.joint(j);
  } else if (type == "fixed") {
    spatial::Fixed j{.name = name};
    points_of(f, j), orientation_of(f, j);
    scene_.joint(j);
  } else if (type == "point-in-plane") {
    spatial::PointInPlane j{.name = name};
    points_of(f, j);
    if (!f.direction("axis", j.axis, true)) f.miss("axis");
    scene_.joint(j);
  } else if (type == "point-on-line") {
    spatial::PointOnLine j{.name = name};
    points_of(f, j);
    if (!f.direction("axis", j.axis, true)) f.miss("axis");
    scene_.joint(j);
  } else if (type == "distance") {
    spatial::Distance j{.name = name};
    points_of(f, j);
    if (!f.maybe("length", j.length)) j.length = spatial::Span{j.a, j.b, j.point_a, j.point_b}.value(initial_);
    scene_.joint(j);
  } else if (type == "drive") {
    spatial::Drive j{name, coordinate(f), {}};
    if (!Reader::time_law(f, j.law)) j.law.offset = j.of.value(initial_) - j.law.value(0);
    scene_.joint(j);
  } else {
    f.refuse("type", *f.table().get("type"),
             "spherical, revolute, prismatic, cylindrical, screw, universal, planar, fixed, distance, point-in-plane, "
             "point-on-line, gear, rack or drive");
  }
}

/// Two coordinates in a ratio: of `joints`, or of `bodies` about (rack: the second one along) axes of the ground.
void SpatialReader::gear(Fields& f, const std::string& type, const std::string& name) {
  const bool rack = type == "rack";
  const toml::node* joints = f.find("joints");
  const auto two = [&] {
    const toml::array* names = joints->as_array();
    if (names == nullptr || names->size() != 2) f.refuse("joints", *joints, "two names [\"first\", \"second\"]");
    return std::pair{free_of(f, "joints", *names->get(0), "angle"),
                     free_of(f, "joints", *names->get(1), rack ? "displacement" : "angle")};
  };
  const auto [first, second] = joints != nullptr ? two() : turning(f, rack);
  double ratio = 0;
  if (rack) {
    f.need("radius", ratio);
    if (!first.angle() || second.angle()) f.fail(f.table(), "must be an angle, then a displacement");
  } else if (const toml::node* node = f.find("teeth")) {
    const toml::array* teeth = node->as_array();
    const auto number = [&](std::size_t i) {
      const auto value =
          teeth != nullptr && teeth->size() == 2 ? teeth->get(i)->value_exact<std::int64_t>() : std::nullopt;
      if (!value || *value == 0 || std::abs(*value) > 1000)
        f.refuse("teeth", *node, "two whole numbers from 1 to 1000, one < 0 for a wheel with inner teeth");
      return static_cast<double>(*value);
    };
    ratio = -number(0) / number(1);
    if (f.find("ratio") != nullptr) f.fail(f.table(), "ratio, teeth: must be one of them");
  } else {
    f.need("ratio", ratio);
  }
  try {
    spatial::Gear j(name, first, second, ratio);
    j.offset = j.value(initial_);
    scene_.joint(j);
  } catch (const std::invalid_argument& error) {
    f.fail(f.table(), error.what());
  }
}

std::pair<spatial::Coordinate, spatial::Coordinate> SpatialReader::turning(Fields& f, bool rack) const {
  if (f.find("bodies") == nullptr) f.fail(f.table(), "missing key \"joints\" or \"bodies\"");
  spatial::Angle pair;
  points_of(f, pair);
  Vector3d axis(0, 0, 1), other(0, 0, 1);
  if (!f.direction("axis", axis)) f.miss("axis");
  if (!f.direction("axis_b", other)) {
    if (rack) f.miss("axis_b");
    other = axis;
  }
  const auto about = [&](BodyId body, const Vector3d& u) {
    spatial::Angle c{.a = kGround, .b = body, .axis_a = u, .axis_b = initial_.at(body).turn_back(u).normalized()};
    c.reference_a = spatial::perpendicular(u);
    c.reference_b = square_to(c.axis_b, initial_.at(body).turn_back(c.reference_a));
    return c;
  };
  const spatial::Coordinate first = about(pair.a, axis);
  if (!rack) return {first, about(pair.b, other)};
  return {first, spatial::Slide{.a = kGround, .b = pair.b, .axis = other}};
}

spatial::Coordinate SpatialReader::coordinate(Fields& f) const {
  const toml::node* joint = f.find("joint", Form::word);
  const toml::node* of = f.find("of", Form::word);
  if (joint != nullptr) return free_at(f, *joint);
  if (of == nullptr) f.fail(f.table(), "missing key \"joint\" or \"of\"");
  const auto kind = of->value_exact<std::string>();
  if (kind == "slide") {
    spatial::Slide c;
    points_of(f, c);
    if (!f.direction("axis", c.axis, true)) f.miss("axis");
    return c;
  }
  if (kind != "distance" && kind != "angle")
    f.refuse("of", *of, joint != nullptr ? "angle or displacement" : "angle, slide or distance");
  if (kind == "angle") {
    spatial::Angle c;
    points_of(f, c), axes_of(f, c);
    const Vector3d from = spatial::perpendicular(c.axis_a);
    c.reference_a = from;
    c.reference_b = square_to(c.axis_b, initial_.at(c.b).turn_back(initial_.at(c.a).turn(from)));
    return c;
  }
  spatial::Span c;
  points_of(f, c);
  return c;
}

/// The free coordinate of a joint; cylindrical joints and screws have two, `of` says which.
spatial::Coordinate SpatialReader::free_at(Fields& f, const toml::node& joint) const {
  const toml::node* of = f.find("of", Form::word);
  const auto kind = of != nullptr ? of->value_exact<std::string>() : std::nullopt;
  const auto [coordinate, has_both] = coordinate_of(f, "joint", joint, kind.value_or(""));
  if (!has_both && of != nullptr) f.refuse("of", *of, "left out where \"joint\" says what is meant");
  return coordinate;
}

spatial::Coordinate SpatialReader::free_of(const Fields& f, std::string_view key, const toml::node& joint,
                                           std::string_view kind) const {
  return coordinate_of(f, key, joint, kind).first;
}

std::pair<spatial::Coordinate, bool> SpatialReader::coordinate_of(const Fields& f, std::string_view key,
                                                                  const toml::node& joint,
                                                                  std::string_view kind) const {
  const auto name = joint.value_exact<std::string>();
  for (const spatial::Joint& one : scene_.joints) {
    if (!name || std::visit([](const auto& j) { return j.name; }, one) != *name) continue;
    const auto of_two = [&](const auto& both) -> std::pair<spatial::Coordinate, bool> {
      if (kind == "angle") return {both.angle(), true};
      if (kind == "displacement") return {both.displacement(), true};
      f.fail(f.table(), "of: must be angle or displacement: a cylindrical joint or a screw has both");
    };
    if (const auto* both = std::get_if<spatial::Cylindrical>(&one)) return of_two(*both);
    if (const auto* both = std::get_if<spatial::Screw>(&one)) return of_two(*both);
    if (const auto* pin = std::get_if<spatial::Revolute>(&one)) return {pin->angle(), false};
    if (const auto* rail = std::get_if<spatial::Prismatic>(&one)) return {rail->displacement(), false};
    if (const auto* line = std::get_if<spatial::PointOnLine>(&one)) return {line->displacement(), false};
    f.refuse(key, joint, "a revolute, prismatic, cylindrical, screw or point-on-line joint: others have no coordinate");
  }
  f.refuse(key, joint, "the name of a joint written before");
}

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

/// A sphere: `radius`, `centre`; a capsule: `radius`, `ends`; a box: `size`, `centre`; a polytope: `corners`.
void SpatialReader::shape(Fields& f, spatial::Collision& c) const {
  spatial::Shape s{.body = kGround, .corners = {}};
  s.body = body_of(f);
  Vector3d size(0, 0, 0), centre(0, 0, 0);
  const bool box = f.maybe("size", size), ends = f.maybe("ends", s.corners), polytope = f.maybe("corners", s.corners);
  if (static_cast<int>(box) + static_cast<int>(ends) + static_cast<int>(polytope) > 1)
    f.fail(f.table(), "size, ends, corners: must be one of them, or radius alone: a sphere");
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
  f.maybe("neighbours", c.neighbours), read_law(f, c.law);
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
    wall(f, c), f.need("corners", corners);
    if (corners.empty()) f.refuse("corners", *f.table().get("corners"), "at least one point [x, y, z]");
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
  } else if (type == "sphere-sphere" || type == "socket") {
    const auto read = [&](auto c) {
      points_of(f, c), f.maybe("centre_a", c.centre_a), f.maybe("centre_b", c.centre_b);
      f.need("radius_a", c.radius_a), f.need("radius_b", c.radius_b), read_contact_law(f, c.law);
      scene_.contact(c);
    };
    type == "socket" ? read(spatial::Socket{.name = name}) : read(spatial::SphereSphere{.name = name});
  } else if (type == "pin-bush") {
    pin_bush(f, name);
  } else if (type == "block-channel") {
    block_channel(f, name);
  } else if (type == "limit") {
    limit(f, name);
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
             "sphere-sphere, socket, pin-bush, block-channel, limit or rope");
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

void SpatialReader::friction(Fields& f) {
  spatial::JointFriction friction;
  f.maybe("name", friction.name);
  friction.of = coordinate(f);
  f.need("bound", friction.bound);
  scene_.friction(friction);
}

void SpatialReader::spring(Fields& f) {
  std::string type, name;
  f.need("type", type), f.maybe("name", name);
  if (type == "point") {
    spatial::PointSpring s{.name = name};
    points_of(f, s), f.maybe("stiffness", s.stiffness), f.maybe("damping", s.damping);
    if (!f.maybe("rest", s.rest)) s.rest = spatial::Span{s.a, s.b, s.point_a, s.point_b}.value(initial_);
    scene_.spring(s);
  } else if (type == "joint") {
    spatial::JointSpring s{.name = name, .of = coordinate(f)};
    f.maybe("stiffness", s.stiffness), f.maybe("damping", s.damping);
    if (!f.maybe("rest", s.rest)) s.rest = s.of.value(initial_);
    scene_.spring(s);
  } else {
    f.refuse("type", *f.table().get("type"), "point or joint");
  }
}

void SpatialReader::load(Fields& f) {
  spatial::Load l;
  f.maybe("name", l.name);
  l.body = body_of(f), f.maybe("point", l.point), f.maybe("force", l.force), f.maybe("torque", l.moment);
  f.choice("frame", l.frame, kFrameNames);
  if (const toml::table* table = f.inner("factor")) {
    Fields g = f.fields("factor", *table);
    Reader::set_factor(g, l.factor, l.breakpoints, l.omega);
    g.done();
  }
  scene_.load(l);
}

const toml::node& SpatialReader::find(const SceneError& error) const {
  if (error.kind.empty()) {
    const toml::node* key = root_.get(error.field);
    return key != nullptr ? *key : root_;
  }
  const auto [kind, index] =
      error.kind == "contact" ? written_[error.index] : std::pair{std::string_view(error.kind), error.index};
  const toml::table& element = *root_.get(kind)->as_array()->get(index)->as_table();
  const toml::node* key = element.get(error.field == "moment" ? "torque" : error.field);
  return key != nullptr ? *key : element;
}

}  // namespace orthant::scene_file
