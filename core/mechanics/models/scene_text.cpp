// A model as a scene in space: bodies from links, joints from stacks of joints, collisions from shapes; as TOML.
#include <orthant/core/mechanics/models/attributes.h>
#include <orthant/core/mechanics/models/model.h>
#include <orthant/core/mechanics/spatial/collision.h>
#include <orthant/core/mechanics/spatial/rotation.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

namespace orthant::models {
namespace {

constexpr std::size_t kMostShapes = 2000;
constexpr int kSides = 24;        // of the prism that stands for a cylinder
constexpr double kSquare = 1e-9;  // [1] cosine of directions at right angles
constexpr double kSame = 1e-9;    // [m] of anchors that are one point, per metre
constexpr double kTurn = 2 * std::numbers::pi;

std::string number(double x) {
  std::string text = detail::text_of(x == 0 ? 0.0 : x);                                    // no −0
  if (std::abs(x) >= 1e15 && text.find_first_of(".e") == std::string::npos) text += ".0";  // no integer of TOML's
  return text;
}
template <class X> std::string list(const Eigen::MatrixBase<X>& x) {
  std::string all = "[";
  for (Eigen::Index i = 0; i < x.size(); ++i) all += (i > 0 ? ", " : "") + number(x(i));
  return all + "]";
}
std::string list(const std::vector<Vector3d>& points) {
  std::string all = "[";
  for (std::size_t i = 0; i < points.size(); ++i) all += (i > 0 ? ", " : "") + list(points[i]);
  return all + "]";
}
std::string quoted(const std::string& text) { return '"' + text + '"'; }
std::string pair_of(const std::string& a, const std::string& b) { return "[" + quoted(a) + ", " + quoted(b) + "]"; }

/// (w, x, y, z), w ≥ 0.
Eigen::Vector4d quaternion_of(const Matrix3d& R) {
  Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  if (q.w() < 0) q.coeffs() *= -1;
  return {q.w(), q.x(), q.y(), q.z()};
}

bool parallel_to(const Vector3d& u, const Vector3d& w) { return u.cross(w).norm() <= kSquare; }
bool square(const Vector3d& u, const Vector3d& w) { return std::abs(u.dot(w)) <= kSquare; }

/// Names of one kind: of letters, digits, _ and -, each once. An element that is read as `parts` ones is NAME_1, …
class Names {
 public:
  std::string take(std::string name, const std::string& otherwise, int parts = 0) {
    for (char& c : name)
      if (!(c >= 'A' && c <= 'Z') && !(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9') && c != '_' && c != '-')
        c = '_';
    if (name.empty()) name = otherwise;
    if (name == "ground") name += '_';
    std::string one = name;
    const auto all = [&] {
      std::vector<std::string> names{one};
      for (int i = 1; i <= parts; ++i) names.push_back(one + "_" + std::to_string(i));
      return names;
    };
    const auto taken = [&](const std::string& n) { return taken_.contains(n); };
    for (int k = 2; std::ranges::any_of(all(), taken); ++k) one = name + "_" + std::to_string(k);
    for (const std::string& n : all()) taken_.insert(n);
    return one;
  }

 private:
  std::set<std::string> taken_;
};

/// A body of the scene, or the ground: links that move as one.
struct Carrier {
  std::string name = "ground";
  int link = 0;               // whose frame it has
  int parent = -1, root = 0;  // carriers: the one that it is joined to; the last one before the ground
  Place world;                // of the frame, at the start
  ModelLink whole{.name = "", .at = {}, .joints = {}, .shapes = {}};  // mass and shapes of all its links, in its frame
  std::string parts;                                                  // names of the other links
};

/// Keys that name the free coordinate of a joint. Its value at the start differs by `offset` from the joint's own.
struct CoordinateKeys {
  std::string keys;
  bool angle = false;
  double offset = 0;
};

class SceneText {
 public:
  SceneText(Model& model, const ModelOptions& options) : model_(model), options_(options) {}

  std::string write() {
    set_starts();
    make_carriers();
    for (std::size_t c = 1; c < carriers_.size(); ++c) body(carriers_[c]);
    for (std::size_t c = 1; c < carriers_.size(); ++c) joints(carriers_[c]);
    for (const ModelTie& tie : model_.ties) add_tie(tie);
    shapes();
    std::string text = "# " + model_.format + " model " + quoted(in_one_line(model_.name)) + ", imported. SI units.\n";
    for (const std::string& note : model_.notes) text += "# " + in_one_line(note) + "\n";
    text += "dimension = 3\ngravity = " + list(model_.gravity) + "\nstep = " + number(model_.step) + "\n";
    return text + bodies_ + joints_ + contacts_ + collisions_ + frictions_ + springs_;
  }

 private:
  void note(const std::string& text) { model_.notes.push_back(text); }

  void set_starts() {
    std::string known;
    auto wanted = options_.at;
    for (ModelLink& link : model_.links)
      for (ModelJoint& j : link.joints) {
        if (!j.coordinate()) continue;
        known += (known.empty() ? "" : ", ") + j.name;
        if (const auto given = wanted.find(j.name); given != wanted.end()) {
          j.start = given->second;
          wanted.erase(given);
          continue;
        }
        const double before = j.start;
        if (j.lower) j.start = std::max(j.start, *j.lower);
        if (j.upper) j.start = std::min(j.start, *j.upper);
        if (j.start != before)
          note("joint " + j.name + " starts at its limit, " + number(j.start) + ": its zero is beyond it");
      }
    if (!wanted.empty())
      throw std::invalid_argument("option model.at." + shortened(wanted.begin()->first) +
                                  ": must be the name of a joint that turns or slides, one of " +
                                  (known.empty() ? "(the model has none)" : shortened(known, 400)));
  }

  static Place motion(const ModelJoint& j) {
    const double by = j.start - j.reference;
    if (by == 0 || !j.coordinate()) return {};
    if (j.kind == ModelJoint::Kind::slide) return {Matrix3d::Identity(), by * j.axis};
    const Matrix3d R = Eigen::AngleAxisd(by, j.axis).toRotationMatrix();
    return {R, j.anchor - R * j.anchor};
  }

  void make_carriers() {
    carrier_of_.resize(model_.links.size());
    in_carrier_.resize(model_.links.size());
    carriers_.emplace_back();
    std::vector<Place> world(model_.links.size());
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      const ModelLink& link = model_.links[i];
      Place at = link.at;
      for (const ModelJoint& j : link.joints) at = at * motion(j);
      const auto up = static_cast<std::size_t>(std::max(0, link.parent));
      world[i] = i == 0 ? Place{} : world[up] * at;
      const bool part = link.joints.empty() && (options_.fixed_joints == ModelOptions::FixedJoints::merge ||
                                                link.mass == 0 || (carrier_of_[up] == 0 && link.parent == 0));
      if (i == 0 || part) {
        if (i > 0) carrier_of_[i] = carrier_of_[up], in_carrier_[i] = in_carrier_[up] * link.at;
        if (i > 0) (carrier(i).parts += carrier(i).parts.empty() ? "" : ", ") += shortened(link.name);
      } else {
        carrier_of_[i] = static_cast<int>(carriers_.size());
        Carrier c;
        c.name = body_names_.take(link.name, "body" + std::to_string(carriers_.size()));
        c.link = static_cast<int>(i), c.parent = carrier_of_[up], c.world = world[i];
        c.root = c.parent == 0 ? carrier_of_[i] : carriers_[static_cast<std::size_t>(c.parent)].root;
        carriers_.push_back(c);
      }
      add_part(carrier(i).whole, link, in_carrier_[i]);
    }
    if (carriers_.size() == 1) {
      const ModelLink& last = model_.links.back();
      const std::string why =
          "nothing can move: must have a joint that moves, or a base that is free "
          "(--set model.base=free)";
      if (last.element == nullptr) throw std::invalid_argument(model_.file + ": " + why);
      refuse(*last.element, why);
    }
    for (const Carrier& c : carriers_) {
      if (c.link == 0) continue;
      const XmlElement& element = *model_.links[static_cast<std::size_t>(c.link)].element;
      if (!(c.whole.mass > 0)) refuse(element, "has no mass, but moves: must have a mass and an inertia");
      check_inertia(element, c.whole.inertia);
    }
  }

  Carrier& carrier(std::size_t link) { return carriers_[static_cast<std::size_t>(carrier_of_[link])]; }

  static void add_part(ModelLink& whole, const ModelLink& part, const Place& at) {
    add_mass(whole, part.mass, at * part.centre, at.R * part.inertia * at.R.transpose());
    for (ModelShape shape : part.shapes) {
      shape.at = at * shape.at;
      for (Vector3d& corner : shape.corners) corner = at * corner;
      whole.shapes.push_back(shape);
    }
  }

  /// A point of the carrier's frame, in the body's.
  static Vector3d from_centre(const Carrier& c, const Vector3d& p) { return c.link == 0 ? p : p - c.whole.centre; }

  void body(const Carrier& c) {
    const ModelLink& w = c.whole;
    const Matrix3d J = (w.inertia + w.inertia.transpose()) / 2;
    bodies_ += "\n[[body]]\nname = " + quoted(c.name) + "\n";
    const ModelLink& link = model_.links[static_cast<std::size_t>(c.link)];
    if (link.name != c.name) bodies_ += "# link " + in_one_line(shortened(link.name)) + "\n";
    if (!c.parts.empty()) bodies_ += "# with " + c.parts + "\n";
    bodies_ += "mass = " + number(w.mass) + "\n";
    Matrix3d across = J;
    across.diagonal().setZero();
    if (across.isZero(0))
      bodies_ += "inertia = " + list(J.diagonal()) + "\n";
    else
      bodies_ += "inertia = [" + list(J.row(0)) + ", " + list(J.row(1)) + ", " + list(J.row(2)) + "]\n";
    bodies_ += "position = " + list(Vector3d(c.world * w.centre)) + "\n";
    if (!c.world.R.isIdentity(0)) bodies_ += "orientation = " + list(quaternion_of(c.world.R)) + "\n";
  }

  /// Writes the joints between c and its parent, all in one of the scene's forms. One function: a case for each form.
  void joints(const Carrier& c) {
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
      joints_ += "\n[[joint]]\ntype = \"" + std::string(type) + "\"\nname = " + quoted(own) + "\n" + bodies;
      return "joint = " + quoted(own) + "\n";
    };
    const auto axes = [&](const Vector3d& axis) {
      return "axis = " + list(in_a(axis)) + "\naxis_b = " + list(axis) + "\n";
    };
    const auto start = [](const ModelJoint& j) { return j.start == 0 ? "" : "angle = " + number(j.start) + "\n"; };
    const auto angle_to = [&](const ModelJoint& j, const Vector3d& axis) {
      return CoordinateKeys{"of = \"angle\"\n" + bodies + axes(axis), true, j.start};
    };
    const auto one_anchor = [&] {
      return std::all_of(hinges.begin(), hinges.end(), [&](const ModelJoint* j) {
        return (j->anchor - hinges[0]->anchor).norm() <= kSame * std::max(1.0, j->anchor.norm());
      });
    };
    const auto euler = [&] {  // three hinges that reach every orientation
      return hinges.size() == 3 && square(hinges[0]->axis, hinges[1]->axis) &&
             square(hinges[1]->axis, hinges[2]->axis) && one_anchor();
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
        along(c, j, CoordinateKeys{keys, true, 0});
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
    } else if (others == 0 && slides.size() == 1 && hinges.size() == 1 &&
               parallel_to(slides[0]->axis, hinges[0]->axis)) {
      const ModelJoint &s = *slides[0], &h = *hinges[0];
      const double sense = s.axis.dot(h.axis) < 0 ? -1 : 1;
      const std::string keys = begin("cylindrical", h.name);
      joints_ += points(h.anchor, -s.reference * in_a(s.axis)) + axes(h.axis) + start(h);
      along(c, h, CoordinateKeys{keys + "of = \"angle\"\n", true, 0});
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

  static CoordinateKeys slide_keys(const std::string& bodies, const std::string& points, const Vector3d& axis) {
    return {"of = \"slide\"\n" + bodies + points + "axis = " + list(axis) + "\n", false, 0};
  }

  /// Limits, friction, damper and spring along a joint's coordinate; without one they are not taken.
  void along(const Carrier& c, const ModelJoint& j, const CoordinateKeys& of) {
    const auto named = [&](Names& names, const char* suffix) {
      return "name = " + quoted(names.take(j.name + suffix, c.name + suffix)) + "\n";
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
    if (of.angle && j.lower && j.upper && *j.upper - *j.lower >= kTurn) {
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

  void add_tie(const ModelTie& tie) {
    const auto i = static_cast<std::size_t>(tie.first), k = static_cast<std::size_t>(tie.second);
    const Carrier &a = carrier(i), &b = carrier(k);
    if (carrier_of_[i] == carrier_of_[k]) {
      note("not taken: " + tie.element->place() + ", within one body");
      return;
    }
    const std::string name = joint_names_.take(tie.name, "tie_" + a.name + "_" + b.name);
    joints_ += "\n[[joint]]\ntype = \"" + std::string(tie.whole ? "fixed" : "spherical") +
               "\"\nname = " + quoted(name) + "\nbodies = " + pair_of(a.name, b.name) + "\n";
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

  // Shapes.

  static std::vector<Vector3d> ring(const ModelShape& s, double z) {
    std::vector<Vector3d> points;
    for (int i = 0; i < kSides; ++i) {
      const double angle = kTurn * i / kSides;
      points.push_back(s.at * Vector3d(s.size.x() * std::cos(angle), s.size.x() * std::sin(angle), z));
    }
    return points;
  }
  /// What of the shape a collision knows: one point of a sphere, two of a capsule, corners. In the carrier's frame.
  static std::vector<Vector3d> corners_of(const ModelShape& s) {
    using Kind = ModelShape::Kind;
    switch (s.kind) {
      case Kind::sphere:
        return {s.at.p};
      case Kind::capsule:
        return {s.at * Vector3d(0, 0, -s.size.y() / 2), s.at * Vector3d(0, 0, s.size.y() / 2)};
      case Kind::cylinder: {
        std::vector<Vector3d> all = ring(s, -s.size.y() / 2);
        for (const Vector3d& p : ring(s, s.size.y() / 2)) all.push_back(p);
        return all;
      }
      case Kind::box: {
        std::vector<Vector3d> all = spatial::box_corners(s.size / 2);
        for (Vector3d& p : all) p = s.at * p;
        return all;
      }
      case Kind::ellipsoid: {
        std::vector<Vector3d> all;
        constexpr int kPoints = 60;
        for (int i = 0; i < kPoints; ++i) {  // on a spiral over the sphere
          const double z = 1 - (2.0 * i + 1) / kPoints, r = std::sqrt(1 - z * z),
                       angle = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
          all.push_back(s.at * s.size.cwiseProduct(Vector3d(r * std::cos(angle), r * std::sin(angle), z)));
        }
        return all;
      }
      default:
        return s.corners;
    }
  }
  static bool rounded(const ModelShape& s) {
    return s.kind == ModelShape::Kind::sphere || s.kind == ModelShape::Kind::capsule;
  }
  static bool meet(const ModelShape& x, const ModelShape& y) {
    return (x.type & y.affinity) != 0 || (y.type & x.affinity) != 0;
  }

  void shapes() {
    std::vector<std::pair<std::size_t, const ModelShape*>> all;  // by carrier
    std::vector<ModelShape> planes;
    int idle = 0;
    for (std::size_t c = 0; c < carriers_.size(); ++c)
      for (const ModelShape& s : carriers_[c].whole.shapes) {
        if (s.type == 0 && s.affinity == 0) {
          ++idle;
          continue;
        }
        if (s.kind == ModelShape::Kind::plane)
          planes.push_back(s);
        else
          all.emplace_back(c, &s);
      }
    if (all.size() > kMostShapes)
      throw std::invalid_argument(model_.file + ": has " + std::to_string(all.size()) +
                                  " shapes that meet others: must be at most " + std::to_string(kMostShapes));
    if (idle > 0) note("not taken: " + std::to_string(idle) + " shapes that touch nothing (drawing only)");
    if (options_.floor) {
      ModelShape floor;
      floor.kind = ModelShape::Kind::plane, floor.at.p = {0, 0, *options_.floor}, floor.mu = options_.mu;
      floor.type = floor.affinity = ~0U, floor.name = "floor";
      planes.push_back(floor);
    }
    for (const ModelShape& plane : planes)
      for (const auto& [c, s] : all)
        if (c > 0 && meet(plane, *s)) wall(carriers_[c], *s, plane);
    collision(all);
  }

  /// The shape against a half-space, exact for every kind.
  void wall(const Carrier& c, const ModelShape& s, const ModelShape& plane) {
    using Kind = ModelShape::Kind;
    const auto write = [&](const char* type, const std::string& keys, int parts = 0) {
      const std::string on = plane.name.empty() ? "plane" : plane.name;
      const std::string name = contact_names_.take((s.name.empty() ? c.name : s.name) + "_on_" + on, "plane", parts);
      contacts_ += "\n[[contact]]\ntype = \"" + std::string(type) + "\"\nname = " + quoted(name) +
                   "\nbody = " + quoted(c.name) + "\nwall = {point = " + list(plane.at.p) +
                   ", normal = " + list(Vector3d(plane.at.R.col(2))) + "}\n" + keys;
      const double mu = std::max(s.mu, plane.mu);
      if (mu > 0) contacts_ += "mu = " + number(mu) + "\n";
    };
    const auto centre = [&] { return "centre = " + list(from_centre(c, s.at.p)) + "\n"; };
    if (rounded(s)) {
      for (const Vector3d& p : corners_of(s))
        write("sphere-wall", "centre = " + list(from_centre(c, p)) + "\nradius = " + number(s.size.x()) + "\n");
    } else if (s.kind == Kind::cylinder) {
      write("cylinder-wall",
            centre() + "axis = " + list(Vector3d(s.at.R.col(2))) + "\nradius = " + number(s.size.x()) +
                "\nheight = " + number(s.size.y()) + "\n",
            6);
    } else if (s.kind == Kind::ellipsoid) {
      write("ellipsoid-wall",
            centre() + "semi_axes = " + list(s.size) + "\norientation = " + list(quaternion_of(s.at.R)) + "\n");
    } else {
      const auto corners = moved(c, corners_of(s));
      write("polytope-wall", "corners = " + list(corners) + "\n", static_cast<int>(corners.size()));
    }
  }

  static std::vector<Vector3d> moved(const Carrier& c, std::vector<Vector3d> points) {
    for (Vector3d& p : points) p = from_centre(c, p);
    return points;
  }

  /// Writes one collision of all shapes. Bodies that are joined, or overlap at the start within one tree, are apart.
  /// One function: the text of one element, key by key.
  void collision(const std::vector<std::pair<std::size_t, const ModelShape*>>& all) {
    using Pair = std::pair<int, int>;
    std::set<std::size_t> bodies;
    for (const auto& [c, s] : all) bodies.insert(c);
    if (bodies.size() < 2) return;
    std::string list_of;
    double least = all.front().second->mu, most = least;
    int prisms = 0, ellipsoids = 0;
    spatial::Collision set{.name = "shapes", .shapes = {}, .law = {}};
    std::vector<spatial::Pose> poses;
    for (const Carrier& c : carriers_)
      poses.push_back({c.world * (c.link == 0 ? Vector3d(0, 0, 0) : c.whole.centre), c.world.R, c.world.R});
    for (const auto& [c, s] : all) {
      const auto points = moved(carriers_[c], corners_of(*s));
      set.shapes.push_back(
          {.body = static_cast<BodyId>(c), .corners = points, .radius = rounded(*s) ? s->size.x() : 0});
      least = std::min(least, s->mu), most = std::max(most, s->mu);
      prisms += s->kind == ModelShape::Kind::cylinder, ellipsoids += s->kind == ModelShape::Kind::ellipsoid;
      list_of += "  {body = " + quoted(carriers_[c].name) + ", ";
      if (s->kind == ModelShape::Kind::sphere)
        list_of += "radius = " + number(s->size.x()) + ", centre = " + list(points[0]);
      else if (s->kind == ModelShape::Kind::capsule)
        list_of += "radius = " + number(s->size.x()) + ", ends = " + list(points);
      else if (s->kind == ModelShape::Kind::box && s->at.R.isIdentity(0))
        list_of += "size = " + list(s->size) + ", centre = " + list(from_centre(carriers_[c], s->at.p));
      else
        list_of += "corners = " + list(points);
      list_of += "},\n";
    }
    if (prisms > 0)
      note(std::to_string(prisms) + (prisms == 1 ? " cylinder meets" : " cylinders meet") +
           " other bodies as a prism of " + std::to_string(kSides) + " sides; half-spaces exactly");
    if (ellipsoids > 0)
      note(std::to_string(ellipsoids) + (ellipsoids == 1 ? " ellipsoid meets" : " ellipsoids meet") +
           " other bodies as a polytope of 60 corners; half-spaces exactly");
    if (least != most)
      note("friction differs between shapes, " + number(least) + " to " + number(most) +
           ": all contacts between bodies have the largest");
    try {
      spatial::set_hulls(set);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(model_.file + ": a mesh: its corners " + error.what());
    }

    std::set<Pair> apart, masked, overlapping;
    const auto in_order = [](int a, int b) { return Pair{std::min(a, b), std::max(a, b)}; };
    for (const auto& [i, k] : model_.apart)
      apart.insert(in_order(carrier_of_[static_cast<std::size_t>(i)], carrier_of_[static_cast<std::size_t>(k)]));
    for (std::size_t c = 1; c < carriers_.size(); ++c)
      if (carriers_[c].parent > 0 || !model_.base_meets_children)
        apart.insert(in_order(static_cast<int>(c), carriers_[c].parent));
    std::set<Pair> met;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t k = i + 1; k < all.size(); ++k) {
        const auto& [c, x] = all[i];
        const auto& [d, y] = all[k];
        if (c == d) continue;
        const Pair pair = in_order(static_cast<int>(c), static_cast<int>(d));
        (meet(*x, *y) ? met : masked).insert(pair);
        const bool tree = c == 0 || d == 0 ? !model_.base_meets_children : carriers_[c].root == carriers_[d].root;
        if (!tree || apart.contains(pair) || overlapping.contains(pair)) continue;
        if (overlap(set.shapes[i], poses[c], set.shapes[k], poses[d])) overlapping.insert(pair);
      }
    for (const Pair& pair : masked) {
      if (!met.contains(pair))
        apart.insert(pair);
      else if (!apart.contains(pair))
        note("not taken: masks between shapes of " + name_of(pair.first) + " and " + name_of(pair.second) +
             ": all of them meet");
    }
    if (!overlapping.empty()) {
      std::string names;
      for (const Pair& pair : overlapping)
        names += (names.empty() ? "" : ", ") + name_of(pair.first) + " and " + name_of(pair.second);
      note("overlap at the start, and do not meet: " + names);
      apart.insert(overlapping.begin(), overlapping.end());
    }
    collisions_ += "\n[[collision]]\nname = \"shapes\"\n";
    if (most > 0) collisions_ += "mu = " + number(most) + "\n";
    collisions_ += "shapes = [\n" + list_of + "]\n";
    std::string pairs;
    for (const Pair& pair : apart)
      if (bodies.contains(static_cast<std::size_t>(pair.first)) &&
          bodies.contains(static_cast<std::size_t>(pair.second)) && pair.first != pair.second)
        pairs += (pairs.empty() ? "" : ", ") + pair_of(name_of(pair.first), name_of(pair.second));
    if (!pairs.empty()) collisions_ += "apart = [" + pairs + "]\n";
  }

  const std::string& name_of(int carrier) const { return carriers_[static_cast<std::size_t>(carrier)].name; }

  static bool overlap(const spatial::Shape& x, const spatial::Pose& at_x, const spatial::Shape& y,
                      const spatial::Pose& at_y) {
    const auto ball = [](const spatial::Shape& s, const spatial::Pose& at) {
      const Vector3d middle = s.corners.front();
      double radius = 0;
      for (const Vector3d& p : s.corners) radius = std::max(radius, (p - middle).norm());
      return std::pair<Vector3d, double>{at.x + at.turn(middle), radius + s.radius};
    };
    const auto [p, r] = ball(x, at_x);
    const auto [q, t] = ball(y, at_y);
    if ((p - q).norm() > r + t) return false;
    const spatial::TouchPoints points = touch(at_x, x, at_y, y);
    for (int i = 0; i < points.count; ++i)
      if (points.points[static_cast<std::size_t>(i)].gap < -1e-9 * (r + t)) return true;
    return false;
  }

  Model& model_;
  const ModelOptions& options_;
  std::vector<Carrier> carriers_;  // the ground first
  std::vector<int> carrier_of_;    // of each link
  std::vector<Place> in_carrier_;  // likewise
  Names body_names_, joint_names_, contact_names_, friction_names_, spring_names_;
  std::string bodies_, joints_, contacts_, collisions_, frictions_, springs_;
};

}  // namespace

std::string scene_text(Model& model, const ModelOptions& options) { return SceneText(model, options).write(); }

}  // namespace orthant::models
