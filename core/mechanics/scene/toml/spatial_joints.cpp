// Joints of a spatial scene file.
#include "reader.h"
#include "spatial_fields.h"

#include <numbers>
#include <optional>
#include <tuple>

namespace orthant::scene_file {

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
    scene_.joint(gear_of(f, type == "rack", name));
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
spatial::Gear SpatialReader::gear_of(Fields& f, bool rack, const std::string& name) const {
  const toml::node* joints = f.find("joints");
  const auto two = [&] {
    const toml::array* names = joints->as_array();
    if (names == nullptr || names->size() != 2) f.refuse("joints", *joints, "two names [\"first\", \"second\"]");
    if (names->get(0)->value<std::string>() == names->get(1)->value<std::string>())
      f.refuse("joints", *joints, "two different joints");
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
    return j;
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

}  // namespace orthant::scene_file
