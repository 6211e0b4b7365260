// Joints of a planar scene file.
#include "reader.h"

namespace orthant::scene_file {

void Reader::joint(Fields& f) {
  std::string type, name;
  f.need("type", type), f.maybe("name", name);
  if (type == "revolute") {
    Revolute j{.name = name};
    points_of(f, j);
    scene_.joint(j);
  } else if (type == "prismatic") {
    Prismatic j{.name = name};
    points_of(f, j), f.direction("axis", j.axis);
    if (!f.maybe("angle", j.angle)) j.angle = initial_angle(j.b, j.a);
    scene_.joint(j);
  } else if (type == "fixed") {
    Fixed j{.name = name};
    points_of(f, j);
    if (!f.maybe("angle", j.angle)) j.angle = initial_angle(j.a, j.b);
    scene_.joint(j);
  } else if (type == "distance") {
    Distance j{.name = name};
    points_of(f, j);
    if (!f.maybe("length", j.length)) j.length = initial_length(j);
    scene_.joint(j);
  } else if (type == "drive") {
    Drive j{name, coordinate(f), {}};
    const bool placed = time_law(f, j.law);
    if (!placed) j.law.offset = j.of.value(initial_) - j.law.value(0);
    scene_.joint(j);
  } else if (type == "relation") {
    relation(f, name.empty() ? given_name_ : name);
  } else if (type == "gear") {
    gear(f, name.empty() ? given_name_ : name);
  } else {
    f.refuse("type", *f.table().get("type"), "revolute, prismatic, fixed, distance, drive, relation or gear");
  }
}

bool Reader::time_law(Fields& f, TimeLaw& law) {
  const bool placed = f.maybe("offset", law.offset);
  f.maybe("rate", law.rate_of_change), f.maybe("amplitude", law.amplitude);
  f.maybe("omega", law.omega), f.maybe("phase", law.phase);
  if (const toml::table* table = f.inner("table")) {
    Fields g = f.fields("table", *table);
    const auto [times, values] = points_in_time(g);
    try {
      law.table = Spline(times, values);
    } catch (const std::invalid_argument& error) {
      g.fail(*table, "table." + std::string(error.what()));
    }
    g.done();
  }
  return placed;
}

Coordinate Reader::coordinate(Fields& f) const {
  const toml::node* joint = f.find("joint", Form::word);
  const toml::node* of = f.find("of", Form::word);
  if (joint != nullptr && of != nullptr) f.refuse("of", *of, "left out where \"joint\" says what is meant");
  if (joint != nullptr) return free_at(f, *joint);
  if (of == nullptr) f.fail(f.table(), "missing key \"joint\" or \"of\"");
  const auto kind = of->value_exact<std::string>();
  if (kind == "angle") {
    Angle c;
    bodies_of(f, c);
    return c;
  }
  if (kind == "slide") {
    Slide c;
    points_of(f, c), f.direction("axis", c.axis);
    return c;
  }
  if (kind != "distance") f.refuse("of", *of, "angle, slide or distance");
  Span c;
  points_of(f, c);
  return c;
}

Coordinate Reader::free_at(const Fields& f, const toml::node& joint) const {
  const auto name = joint.value_exact<std::string>();
  for (const Joint& one : scene_.joints) {
    if (!name || std::visit([](const auto& j) { return j.name; }, one) != *name) continue;
    if (const auto* pin = std::get_if<Revolute>(&one)) return Angle{pin->a, pin->b};
    if (const auto* rail = std::get_if<Prismatic>(&one))
      return Slide{rail->a, rail->b, rail->point_a, rail->point_b, rail->axis};
    f.refuse("joint", joint, "a revolute or prismatic joint: others leave nothing free to name");
  }
  f.refuse("joint", joint, "the name of a joint written before");
}

}  // namespace orthant::scene_file
