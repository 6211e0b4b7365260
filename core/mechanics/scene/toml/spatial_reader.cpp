// Spatial scenes from TOML: bodies, springs, loads, order of the tables.
#include "spatial_reader.h"

#include "reader.h"
#include "spatial_fields.h"

#include <orthant/core/mechanics/spatial/solid.h>
#include <cmath>

#include <cstdint>
#include <optional>

namespace orthant::scene_file {

namespace {

constexpr std::array<std::string_view, 2> kFrameNames = {"world", "body"};

}  // namespace

spatial::Scene SpatialReader::scene() {
  Fields top(root_, "", file_);
  double dimension = 3;
  top.need("dimension", dimension);
  top.maybe("gravity", scene_.gravity), top.maybe("duration", scene_.duration), top.maybe("step", scene_.step);
  top.maybe("assemble", scene_.assemble);
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
  each_element(top, kind, file_, given_name_, [&](Fields& fields, std::size_t i) {
    read(fields);
    fields.done();
    written_.resize(scene_.contacts.size(), {kind, i});
  });
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
  if (about && !turned) f.refuse("axis", *f.table().get("axis"), "left out, or given with \"angle\"");
  if (turned) b.orientation = quaternions::exponential(angle * axis).normalized();
  f.maybe("velocity", b.velocity), f.maybe("omega", b.omega);
  if (b.name.empty()) f.refuse("name", *f.table().get("name"), "of letters, digits, _ and -");
  ids_.emplace(b.name, scene_.body(b));
}

/// Mass and inertia of a homogeneous body from its shape, and from `mass` or `density`.
void SpatialReader::solid(Fields& f, const toml::table& table, spatial::Body& b) {
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
  if (names_mesh(g)) {
    if (solid) g.fail(table, "solid: must be one shape");
    const spatial::Polyhedron& whole = mesh(g).solid;
    solid = spatial::Solid{whole.volume, whole.inertia};
  }
  g.done();
  if (!solid) g.fail(table, "solid: must be {box = …}, sphere, ellipsoid, cylinder, capsule, cone or file");
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
  } else if (type == "drag") {
    spatial::DragLaw law;
    const BodyId body = body_of(f);
    if (body == kGround) f.refuse("body", *f.table().get("body"), "a body that moves");
    f.maybe("point", law.point), f.maybe("linear", law.linear), f.maybe("quadratic", law.quadratic);
    f.maybe("angular", law.angular), f.maybe("angular_quadratic", law.angular_quadratic);
    for (const auto& [key, value] :
         {std::pair{"linear", law.linear}, std::pair{"quadratic", law.quadratic}, std::pair{"angular", law.angular},
          std::pair{"angular_quadratic", law.angular_quadratic}})
      if (!(value >= 0 && std::isfinite(value))) f.refuse(key, *f.table().get(key), ">= 0");
    const auto parts = spatial::drag(name.empty() ? given_name_ : name, body, law);
    if (parts.empty()) f.fail(f.table(), "linear, quadratic, angular, angular_quadratic: must be at least one > 0");
    scene_.spring_set(parts);
  } else {
    f.refuse("type", *f.table().get("type"), "point, joint or drag");
  }
  springs_.resize(scene_.springs.size(), springs_.empty() ? 0 : springs_.back() + 1);
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
  const auto [kind, index] = error.kind == "contact"  ? written_[error.index]
                             : error.kind == "spring" ? std::pair{std::string_view(error.kind), springs_[error.index]}
                                                      : std::pair{std::string_view(error.kind), error.index};
  const toml::table& element = *root_.get(kind)->as_array()->get(index)->as_table();
  const toml::node* key = element.get(error.field == "moment" ? "torque" : error.field);
  return key != nullptr ? *key : element;
}

}  // namespace orthant::scene_file
