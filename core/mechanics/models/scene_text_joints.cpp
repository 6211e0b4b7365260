// Joints of a model's scene: a stack of hinges and slides in one of the scene's forms, limits, springs, ties.
#include <orthant/core/mechanics/models/attributes.h>
#include <orthant/core/mechanics/models/scene_text.h>
#include <orthant/core/mechanics/models/toml_values.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant::models {
namespace {

constexpr double kSquare = 1e-9;  // [1] cosine of directions at right angles
constexpr double kSame = 1e-9;    // [m] of anchors that are one point, per metre
constexpr double kFullTurn = 2 * std::numbers::pi;

bool parallel_to(const Vector3d& u, const Vector3d& w) { return u.cross(w).norm() <= kSquare; }
bool square(const Vector3d& u, const Vector3d& w) { return std::abs(u.dot(w)) <= kSquare; }

}  // namespace

/// One function: the forms, tried in order, write the same keys.
void SceneText::joints(const Carrier& c) {
  using Kind = ModelJoint::Kind;
  const ModelLink& link = model_.links[static_cast<std::size_t>(c.link)];
  const Carrier& a = carriers_[static_cast<std::size_t>(c.parent)];
  const Place at = in_carrier_[static_cast<std::size_t>(std::max(0, link.parent))] * link.at;  // zero motion, in a
  const auto& all = link.joints;
  std::vector<const ModelJoint*> slides, hinges;
  bool slides_first = true;
  for (const ModelJoint& j : all) {
    if (j.kind == Kind::slide) slides_first = slides_first && hinges.empty(), slides.push_back(&j);
    if (j.kind == Kind::hinge) hinges.push_back(&j);
  }
  const std::size_t others = all.size() - slides.size() - hinges.size();
  const auto in_a = [&](const Vector3d& direction) { return Vector3d(at.R * direction); };
  const std::string bodies = "bodies = " + pair_of(a.name, c.name) + "\n";
  const auto points = [&](const Vector3d& anchor, const Vector3d& shift) {
    return "point_a = " + list(Vector3d(from_centre(a, at * anchor) + shift)) +
           "\npoint_b = " + list(Vector3d(from_centre(c, anchor))) + "\n";
  };
  const auto begin = [&](const char* type, const std::string& name) {
    const std::string own = joint_names_.take(name, "joint_" + c.name);
    joints_ += "\n[[joint]]\ntype = \"" + std::string(type) + "\"\nname = " + in_quotes(own) + "\n" + bodies;
    return "joint = " + in_quotes(own) + "\n";
  };
  const auto axes = [&](const Vector3d& axis) {
    return "axis = " + list(in_a(axis)) + "\naxis_b = " + list(axis) + "\n";
  };
  const auto turns = [](const ModelJoint& j) {  // full ones: a joint in space starts with less than half a turn
    return std::abs(j.start) > kFullTurn / 2 ? kFullTurn * std::round(j.start / kFullTurn) : 0.0;
  };
  const auto start = [&](const ModelJoint& j) {
    const double angle = j.start - turns(j);
    return angle == 0 ? "" : "angle = " + number(angle) + "\n";
  };
  const auto angle_to = [&](const ModelJoint& j, const Vector3d& axis) {
    return CoordinateKeys{"of = \"angle\"\n" + bodies + axes(axis), true, j.start};
  };
  const auto one_anchor = [&] {
    return std::all_of(hinges.begin(), hinges.end(), [&](const ModelJoint* j) {
      return (j->anchor - hinges[0]->anchor).norm() <= kSame * std::max(1.0, j->anchor.norm());
    });
  };
  const auto euler = [&] {  // three hinges that reach every orientation
    return hinges.size() == 3 && square(hinges[0]->axis, hinges[1]->axis) && square(hinges[1]->axis, hinges[2]->axis) &&
           one_anchor();
  };
  const auto independent = [&] {
    return slides.size() == 3 && std::abs(slides[0]->axis.cross(slides[1]->axis).dot(slides[2]->axis)) > 1e-3;
  };
  if (all.empty()) {  // a link that is kept
    begin("fixed", link.name + "_fixed");
    joints_ += points(Vector3d::Zero(), Vector3d::Zero());
  } else if (all.size() == 1) {
    const ModelJoint& j = all[0];
    if (j.kind == Kind::hinge) {
      const std::string keys = begin("revolute", j.name);
      joints_ += points(j.anchor, Vector3d::Zero()) + axes(j.axis) + start(j);
      along(c, j, CoordinateKeys{keys, true, turns(j)});
    } else if (j.kind == Kind::slide) {
      const std::string keys = begin("prismatic", j.name);
      joints_ += points(j.anchor, -j.reference * in_a(j.axis)) + "axis = " + list(in_a(j.axis)) + "\n";
      along(c, j, CoordinateKeys{keys, false, 0});
    } else {
      if (j.kind != Kind::free) begin(j.kind == Kind::ball ? "spherical" : "planar", j.name);
      if (j.kind == Kind::ball) joints_ += points(j.anchor, Vector3d::Zero());
      if (j.kind == Kind::planar) joints_ += points(j.anchor, Vector3d::Zero()) + axes(j.axis);
      along(c, j, {});
    }
  } else if (others == 0 && slides.size() == 1 && hinges.size() == 1 && parallel_to(slides[0]->axis, hinges[0]->axis)) {
    const ModelJoint &s = *slides[0], &h = *hinges[0];
    const double sense = s.axis.dot(h.axis) < 0 ? -1 : 1;
    const std::string keys = begin("cylindrical", h.name);
    joints_ += points(h.anchor, -s.reference * in_a(s.axis)) + axes(h.axis) + start(h);
    along(c, h, CoordinateKeys{keys + "of = \"angle\"\n", true, turns(h)});
    if (sense > 0)
      along(c, s, CoordinateKeys{keys + "of = \"displacement\"\n", false, 0});
    else
      along(c, s, slide_keys(bodies, points(h.anchor, -s.reference * in_a(s.axis)), in_a(s.axis)));
  } else if (others == 0 && slides.size() == 2 && hinges.size() == 1 && slides_first &&
             square(slides[0]->axis, hinges[0]->axis) && square(slides[1]->axis, hinges[0]->axis) &&
             slides[0]->axis.cross(slides[1]->axis).norm() > 1e-3) {
    begin("planar", hinges[0]->name);
    joints_ += points(hinges[0]->anchor, Vector3d::Zero()) + axes(hinges[0]->axis);
    const bool rectangular = square(slides[0]->axis, slides[1]->axis);
    for (const ModelJoint* s : slides)
      along(c, *s,
            rectangular ? slide_keys(bodies, points(hinges[0]->anchor, -s->reference * in_a(s->axis)), in_a(s->axis))
                        : CoordinateKeys{});
    along(c, *hinges[0], angle_to(*hinges[0], hinges[0]->axis));
  } else if (others == 0 && slides.empty() && hinges.size() == 2 && square(hinges[0]->axis, hinges[1]->axis) &&
             one_anchor()) {
    // The first axis stands in a, the second one in c.
    begin("universal", hinges[0]->name);
    joints_ += points(hinges[0]->anchor, Vector3d::Zero()) + "axis = " + list(in_a(hinges[0]->axis)) +
               "\naxis_b = " + list(hinges[1]->axis) + "\n";
    for (const ModelJoint* h : hinges) along(c, *h, {});
  } else if (others == 0 && slides.empty() && euler()) {
    begin("spherical", hinges[0]->name);
    joints_ += points(hinges[0]->anchor, Vector3d::Zero());
    for (const ModelJoint* h : hinges) along(c, *h, {});
  } else if (independent() && ((others == 0 && slides_first && euler()) ||
                               (others == 1 && hinges.empty() && all.back().kind == Kind::ball))) {
    for (const ModelJoint& j : all) along(c, j, {});
  } else {
    refuse(*link.element,
           "has " + std::to_string(all.size()) +
               " joints: must be one, or a hinge and a slide along one axis, two slides and a hinge across them, two "
               "or three hinges through one point at right angles, or three slides and a ball");
  }
}

CoordinateKeys SceneText::slide_keys(const std::string& bodies, const std::string& points, const Vector3d& axis) {
  return {"of = \"slide\"\n" + bodies + points + "axis = " + list(axis) + "\n", false, 0};
}

void SceneText::along(const Carrier& c, const ModelJoint& j, const CoordinateKeys& of) {
  const auto named = [&](Names& names, const char* suffix) {
    return "name = " + in_quotes(names.take(j.name + suffix, c.name + suffix)) + "\n";
  };
  if (of.keys.empty()) {
    std::string left;
    const auto add = [&](bool there, const char* what) {
      if (there) left += (left.empty() ? "" : ", ") + std::string(what);
    };
    add(j.lower || j.upper, "limits"), add(j.damping != 0, "damping"), add(j.friction != 0, "friction");
    add(j.stiffness != 0, "stiffness");
    if (!left.empty()) note("not taken: " + left + " of joint " + j.name + ", which has no coordinate of its own");
    return;
  }
  if (of.angle && j.lower && j.upper && *j.upper - *j.lower >= kFullTurn) {
    note("not taken: limits of joint " + j.name + ", a full turn or more apart");
  } else if (j.lower || j.upper) {
    contacts_ += "\n[[contact]]\ntype = \"limit\"\n" + named(contact_names_, "_limit") + of.keys;
    if (j.lower) contacts_ += "lower = " + number(*j.lower - of.offset) + "\n";
    if (j.upper) contacts_ += "upper = " + number(*j.upper - of.offset) + "\n";
  }
  if (j.friction > 0)
    frictions_ +=
        "\n[[friction]]\n" + named(friction_names_, "_friction") + of.keys + "bound = " + number(j.friction) + "\n";
  if (j.damping > 0 || j.stiffness > 0) {
    springs_ += "\n[[spring]]\ntype = \"joint\"\n" + named(spring_names_, "_spring") + of.keys;
    if (j.stiffness > 0)
      springs_ += "stiffness = " + number(j.stiffness) + "\nrest = " + number(j.rest - of.offset) + "\n";
    if (j.damping > 0) springs_ += "damping = " + number(j.damping) + "\n";
  }
}

void SceneText::add_tie(const ModelTie& tie) {
  const auto i = static_cast<std::size_t>(tie.first), k = static_cast<std::size_t>(tie.second);
  const Carrier &a = carrier(i), &b = carrier(k);
  if (carrier_of_[i] == carrier_of_[k]) {
    note("not taken: " + tie.element->place() + ", within one body");
    return;
  }
  const std::string name = joint_names_.take(tie.name, "tie_" + a.name + "_" + b.name);
  joints_ += "\n[[joint]]\ntype = \"" + std::string(tie.whole ? "fixed" : "spherical") +
             "\"\nname = " + in_quotes(name) + "\nbodies = " + pair_of(a.name, b.name) + "\n";
  Vector3d point_a = in_carrier_[i] * tie.anchor, point_b = b.world.inverse() * (a.world * point_a);
  if (tie.whole) {
    point_a = in_carrier_[i].p, point_b = b.world.inverse() * (a.world * point_a);
    if (tie.relative) {
      const Place frame = in_carrier_[i] * *tie.relative * in_carrier_[k].inverse();  // b's in a's
      point_b = in_carrier_[k].p, point_a = frame * point_b;
      joints_ += "orientation = " + list(quaternion_of(frame.R)) + "\n";
    }
  }
  joints_ += "point_a = " + list(from_centre(a, point_a)) + "\npoint_b = " + list(from_centre(b, point_b)) + "\n";
}

}  // namespace orthant::models
