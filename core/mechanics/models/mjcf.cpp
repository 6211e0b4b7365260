#include <orthant/core/mechanics/models/hulls.h>
#include <orthant/core/mechanics/models/mjcf.h>
#include <orthant/core/mechanics/spatial/inertia.h>
#include <orthant/core/mechanics/spatial/rotation.h>
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/support/options.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace orthant::models {
namespace {

constexpr std::uintmax_t kLargestPart = 16 << 20;  // [bytes] of an included file
constexpr int kDeepest = 16;                       // files included in each other
constexpr std::size_t kMostElements = 200000;      // of all files together

struct Found {
  const XmlElement* element;
  const XmlAttribute* attribute;
  explicit operator bool() const { return attribute != nullptr; }
};

/// An element with the defaults of its class: the attribute that stands nearest counts.
class Styled {
 public:
  Styled(const XmlElement& element, std::vector<const XmlElement*> defaults)
      : element_(element), defaults_(std::move(defaults)) {}

  Found find(std::string_view name) const {
    Found found{&element_, element_.find(name)};
    for (const XmlElement* e : defaults_)
      if (const Attribute a = e->find(name); a != nullptr && !found) found = {e, a};
    return found;
  }
  double number(std::string_view name, double otherwise) const {
    const Found f = find(name);
    return f ? number_of(*f.element, *f.attribute) : otherwise;
  }
  double not_negative(std::string_view name, double otherwise) const {
    const Found f = find(name);
    const double x = f ? number_of(*f.element, *f.attribute) : otherwise;
    if (x < 0) refuse(*f.element, *f.attribute, ">= 0");
    return x;
  }
  Vector3d vector(std::string_view name, const Vector3d& otherwise) const {
    const Found f = find(name);
    return f ? vector_of(*f.element, *f.attribute) : otherwise;
  }
  const XmlElement& element() const { return element_; }

 private:
  const XmlElement& element_;
  std::vector<const XmlElement*> defaults_;  // the nearest first
};

class MjcfReader {
 public:
  MjcfReader(XmlElement& root, ModelFiles& files) : root_(root), files_(files), hulls_(files) {}

  Model read() {
    model_.format = "MJCF", model_.file = model_.name = root_.file, model_.step = 0.002;
    model_.base_meets_children = true;
    include_files(root_, 0);
    if (const Attribute name = root_.find("model")) model_.name = name->value;
    for (const XmlElement* e : root_.all("compiler")) compiler(*e);
    for (const XmlElement* e : root_.all("option")) option(*e);
    for (const XmlElement* e : root_.all("default")) defaults(*e, "");
    for (const XmlElement* e : root_.all("asset")) assets(*e);
    bool any = false;
    for (const XmlElement* e : root_.all("worldbody")) {
      any = true;
      model_.links[0].element = e;
      for (const bool bodies : {false, true}) parts(*e, 0, Place{}, "", bodies);
    }
    if (!any) refuse(root_, "missing element <worldbody>");
    if (total_mass_ > 0) scale_masses();
    for (const XmlElement* e : root_.all("contact")) excluded(*e);
    for (const XmlElement* e : root_.all("equality")) ties(*e);
    for (const char* group : {"actuator", "sensor", "tendon", "keyframe"})  // their parts are listed one by one
      static_cast<void>(root_.all(group));
    if (torsion_ > 0)
      model_.notes.push_back("not taken: torsional and rolling friction (condim 4 and 6) of " +
                             std::to_string(torsion_) + " geoms");
    for (const std::string& one : hulls_.notes()) model_.notes.push_back(one);
    for (const auto& [name, mesh] : meshes_)
      if (!mesh.note.empty()) model_.notes.push_back(mesh.note);
    return std::move(model_);
  }

 private:
  static std::size_t size_of_tree(const XmlElement& e) {
    std::size_t n = 1;
    for (const XmlElement& child : e.children) n += size_of_tree(child);
    return n;
  }

  /// Puts the elements of included files in the place of <include>.
  void include_files(XmlElement& e, int depth) {
    std::vector<XmlElement> all;
    for (XmlElement& child : e.children) {
      if (child.name != "include") {
        include_files(child, depth);
        all.push_back(std::move(child));
        continue;
      }
      const XmlAttribute& file = needed(child, "file");
      if (depth == kDeepest) refuse(child, file, "included at most " + std::to_string(kDeepest) + " files deep");
      const auto path = files_.find(child, file, file.value);
      XmlElement part = parse_xml(files_.read(child, file, path, kLargestPart), path.filename().string());
      elements_ += size_of_tree(part);
      if (elements_ > kMostElements)
        refuse(child,
               "the included files have more than " + std::to_string(kMostElements) + " elements: must have less");
      include_files(part, depth + 1);
      for (XmlElement& of : part.children) all.push_back(std::move(of));
    }
    e.children = std::move(all);
  }

  void compiler(const XmlElement& e) {
    constexpr std::array<std::string_view, 2> kAngles = {"degree", "radian"}, kCoordinates = {"local", "global"};
    constexpr std::array<std::string_view, 3> kFrom = {"false", "true", "auto"};
    if (const Attribute a = e.find("angle")) degree_ = choice_of(e, *a, kAngles) == 0 ? std::numbers::pi / 180 : 1;
    if (const Attribute a = e.find("coordinate"))
      if (choice_of(e, *a, kCoordinates) == 1) refuse(e, *a, "local: MuJoCo itself dropped the other one");
    if (const Attribute a = e.find("eulerseq")) {
      sequence_ = a->value;
      if (sequence_.size() != 3 || sequence_.find_first_not_of("xyzXYZ") != std::string::npos)
        refuse(e, *a, "three letters of x, y, z, X, Y, Z");
    }
    if (const Attribute a = e.find("inertiafromgeom")) from_geoms_ = static_cast<int>(choice_of(e, *a, kFrom));
    if (const Attribute a = e.find("inertiagrouprange")) {
      const auto range = numbers_of(e, *a, 2, 2);
      groups_ = {range[0], range[1]};
    }
    if (const Attribute a = e.find("autolimits")) auto_limits_ = truth_of(e, *a);
    if (const Attribute a = e.find("boundmass")) least_mass_ = number_of(e, *a);
    if (const Attribute a = e.find("boundinertia")) least_inertia_ = number_of(e, *a);
    if (const Attribute a = e.find("balanceinertia")) balance_ = truth_of(e, *a);
    if (const Attribute a = e.find("settotalmass")) total_mass_ = number_of(e, *a);
    if (const Attribute a = e.find("assetdir")) mesh_folder_ = a->value;
    if (const Attribute a = e.find("meshdir")) mesh_folder_ = a->value;
    if (const Attribute a = e.find("strippath")) strip_ = truth_of(e, *a);
  }

  void option(const XmlElement& e) {
    if (const Attribute a = e.find("gravity")) model_.gravity = vector_of(e, *a);
    if (const Attribute a = e.find("timestep")) {
      model_.step = number_of(e, *a);
      if (!(model_.step > 0)) refuse(e, *a, "> 0");
    }
    constexpr std::array<std::string_view, 2> kSwitch = {"disable", "enable"};
    for (const XmlElement* flag : e.all("flag")) {
      if (const Attribute a = flag->find("gravity"); a != nullptr && choice_of(*flag, *a, kSwitch) == 0)
        model_.gravity.setZero();
      if (const Attribute a = flag->find("contact"); a != nullptr && choice_of(*flag, *a, kSwitch) == 0)
        contacts_ = false;
    }
  }

  // Default classes.

  void defaults(const XmlElement& e, const std::string& above) {
    const Attribute name = e.find("class");
    if (name == nullptr && !above.empty()) refuse(e, "missing attribute class");
    const std::string own = name != nullptr && !above.empty() ? name->value : "main";
    if (above.empty() && name != nullptr) top_ = name->value;
    Class& c = classes_[own];
    if (!above.empty() && !c.elements.empty()) refuse(e, *name, "distinct, is taken");
    c.above = above, c.elements.push_back(&e);
    for (const XmlElement* inner : e.all("default")) defaults(*inner, own);
  }

  /// The defaults for this kind of element, of its class or else of `inherited`.
  Styled styled(const XmlElement& e, const std::string& inherited) const {
    std::string name = inherited.empty() ? "main" : inherited;
    if (const Attribute a = e.find("class")) name = known_class(e, *a);
    std::vector<const XmlElement*> all;
    for (std::size_t deep = 0; !name.empty() && deep <= classes_.size(); ++deep) {
      const auto found = classes_.find(name);
      if (found == classes_.end()) break;
      for (const XmlElement* c : found->second.elements)
        for (const XmlElement* of : c->all(e.name)) all.push_back(of);
      name = found->second.above;
    }
    return {e, all};
  }
  std::string known_class(const XmlElement& e, const XmlAttribute& a) const {
    if (a.value == top_ || a.value == "main") return "main";
    if (!classes_.contains(a.value)) refuse(e, a, "the class of a <default>");
    return a.value;
  }

  // Frames.

  Place frame(const Styled& e) const {
    Place place;
    place.p = e.vector("pos", Vector3d::Zero());
    int given = 0;
    const auto turn = [&](const char* name, auto&& read) {
      const Found f = e.find(name);
      if (!f) return;
      if (++given > 1) refuse(*f.element, *f.attribute, "the only orientation");
      place.R = read(*f.element, *f.attribute);
      for (double& x : place.R.reshaped())
        if (std::abs(x) < 1e-15) x = 0;
    };
    turn("quat", [](const XmlElement& of, const XmlAttribute& a) {
      const auto q = numbers_of(of, a, 4, 4);
      const Eigen::Vector4d x(q[0], q[1], q[2], q[3]);
      if (x.isZero(0)) refuse(of, a, "a quaternion w x y z, not zero");
      return quaternions::matrix_of(Eigen::Vector4d(x.stableNormalized()));
    });
    turn("axisangle", [&](const XmlElement& of, const XmlAttribute& a) {
      const auto x = numbers_of(of, a, 4, 4);
      const Vector3d axis(x[0], x[1], x[2]);
      if (axis.isZero(0)) refuse(of, a, "an axis, not zero, and an angle");
      return Matrix3d(Eigen::AngleAxisd(degree_ * x[3], axis.stableNormalized()).toRotationMatrix());
    });
    turn("euler", [&](const XmlElement& of, const XmlAttribute& a) {
      const Vector3d x = degree_ * vector_of(of, a);
      Matrix3d R = Matrix3d::Identity();
      for (int i = 0; i < 3; ++i) {
        const char letter = sequence_[static_cast<std::size_t>(i)];
        const bool fixed = letter >= 'X' && letter <= 'Z';  // about the axes of the outer frame
        const Matrix3d one = Eigen::AngleAxisd(x[i], Vector3d::Unit(letter - (fixed ? 'X' : 'x'))).toRotationMatrix();
        R = fixed ? Matrix3d(one * R) : Matrix3d(R * one);
      }
      return R;
    });
    turn("xyaxes", [](const XmlElement& of, const XmlAttribute& a) {
      const auto x = numbers_of(of, a, 6, 6);
      const Vector3d first(x[0], x[1], x[2]), second(x[3], x[4], x[5]);
      const Vector3d u = first.stableNormalized(), w = second - u.dot(second) * u;
      if (first.isZero(0) || !(w.norm() > 1e-12 * second.norm())) refuse(of, a, "two directions, not along each other");
      Matrix3d R;
      R << u, w.normalized(), u.cross(w.normalized());
      return R;
    });
    turn("zaxis", [](const XmlElement& of, const XmlAttribute& a) { return towards(direction_of(of, a)); });
    return place;
  }
  /// The shortest turn that takes z there.
  static Matrix3d towards(const Vector3d& z) {
    return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), z).toRotationMatrix();
  }

  // Assets.

  void assets(const XmlElement& e) {
    for (const XmlElement* m : e.all("mesh")) {
      const Styled mesh = styled(*m, "");
      const Found file = mesh.find("file"), points = mesh.find("vertex");
      std::string name;
      if (const Attribute a = m->find("name")) name = a->value;
      if (file && name.empty()) name = std::filesystem::path(file.attribute->value).stem().string();
      if (name.empty()) refuse(*m, "must have a name or a file");
      for (const char* no : {"refpos", "refquat"})
        if (const Found f = mesh.find(no))
          refuse(*f.element, *f.attribute, "left out: the points are taken as they are");
      const Vector3d scale = mesh.vector("scale", {1, 1, 1});
      if (scale.prod() == 0) refuse(*m, "scale: must be three factors, not zero");
      if (points) {
        const auto x = numbers_of(*points.element, *points.attribute, 12, kMostElements);
        if (x.size() % 3 != 0) refuse(*points.element, *points.attribute, "three numbers a point");
        Mesh of;
        for (std::size_t i = 0; i < x.size(); i += 3) of.points.emplace_back(x[i], x[i + 1], x[i + 2]);
        try {
          meshes_[name] = hull_of_mesh(std::move(of), scale, "mesh " + shortened(name));
        } catch (const std::invalid_argument& error) {
          refuse(*m, error.what());
        }
      } else if (file) {
        pending_.insert_or_assign(name, PendingMesh{file, scale});
      } else {
        refuse(*m, "missing attribute file or vertex");
      }
    }
  }
  /// Files are read only where a geom wants them.
  const MeshHull& mesh_named(const XmlElement& of, const XmlAttribute& a) {
    if (const auto made = meshes_.find(a.value); made != meshes_.end()) return made->second;
    const auto found = pending_.find(a.value);
    if (found == pending_.end()) refuse(of, a, "the name of a <mesh> of <asset>");
    const auto& [file, scale] = found->second;
    XmlAttribute where = *file.attribute;
    if (strip_) where.value = std::filesystem::path(where.value).filename().string();
    return hulls_.get(*file.element, where, scale, mesh_folder_);
  }

  // Bodies.

  void body(const XmlElement& e, int parent, const Place& at, const std::string& inherited) {
    const int number = static_cast<int>(model_.links.size());
    ModelLink link{.parent = parent, .at = at, .joints = {}, .shapes = {}, .element = &e};
    if (const Attribute a = e.find("name")) {
      link.name = a->value;
      if (!bodies_.emplace(a->value, number).second) refuse(e, *a, "distinct, is taken");
    }
    if (link.name.empty()) link.name = "body" + std::to_string(number);
    for (const XmlElement& child : e.children)
      if (child.name == "joint" || child.name == "freejoint") {
        child.read = true;
        link.joints.push_back(joint(styled(child, inherited), link.name, link.joints.size()));
        if (link.joints.back().kind == ModelJoint::Kind::free && parent > 0)
          refuse(child, "must be in a body of <worldbody> itself");
      }
    for (const ModelJoint& j : link.joints)
      if (j.kind == ModelJoint::Kind::free && link.joints.size() > 1)
        refuse(*j.element, "must be the only joint of its body");
    model_.links.push_back(std::move(link));
    const XmlElement* inertial = e.first("inertial");
    geoms_count_ = from_geoms_ == 1 || (from_geoms_ == 2 && inertial == nullptr);
    const bool by_geoms = geoms_count_;
    parts(e, number, Place{}, inherited, false);
    ModelLink& own = model_.links[static_cast<std::size_t>(number)];
    if (inertial != nullptr && !by_geoms) given_inertia(*inertial, own);
    bound(own);
    geoms_count_ = false;
    parts(e, number, Place{}, inherited, true);
  }

  /// The geoms of a link, or the bodies below it; those in frames, too.
  void parts(const XmlElement& e, int link, const Place& at, const std::string& inherited, bool bodies) {
    if (!bodies)
      for (const XmlElement* g : e.all("geom")) geom(styled(*g, inherited), link, at);
    for (const XmlElement& child : e.children) {
      const bool is_body = child.name == "body", is_frame = child.name == "frame";
      if (!is_frame && !(is_body && bodies)) continue;
      child.read = true;
      std::string inner = inherited;
      if (const Attribute a = child.find("childclass")) inner = known_class(child, *a);
      const Place place = at * frame(Styled(child, {}));
      if (is_frame)
        parts(child, link, place, inner, bodies);
      else
        body(child, link, place, inner);
    }
  }

  void given_inertia(const XmlElement& e, ModelLink& link) const {
    const Place at = frame(Styled(e, {}));
    const XmlAttribute& m = needed(e, "mass");
    const double mass = number_of(e, m);
    if (mass < 0) refuse(e, m, ">= 0");
    Matrix3d I = Matrix3d::Zero();
    const Attribute diagonal = e.find("diaginertia"), full = e.find("fullinertia");
    if ((diagonal != nullptr) == (full != nullptr)) refuse(e, "must have either diaginertia or fullinertia");
    if (diagonal != nullptr) I.diagonal() = vector_of(e, *diagonal);
    if (full != nullptr) {
      const auto x = numbers_of(e, *full, 6, 6);
      I << x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2];
    }
    if (mass > 0 && !balance_ && least_inertia_ == 0) check_inertia(e, I);
    add_mass(link, mass, at.p, at.R * I * at.R.transpose());
  }

  /// Lower bounds, and equal moments where they are not those of a body, as the compiler element wishes.
  void bound(ModelLink& link) const {
    if (least_mass_ > 0) link.mass = std::max(link.mass, least_mass_);
    if (!(link.mass > 0) || (!(least_inertia_ > 0) && !balance_)) return;
    const spatial::Principal own = spatial::principal(link.inertia);
    Vector3d J = own.moments.cwiseMax(least_inertia_);
    if (balance_ && 2 * J.maxCoeff() > J.sum()) J.setConstant(J.mean());
    const Matrix3d A = quaternions::matrix_of(own.axes);
    if (J != own.moments) link.inertia = A * J.asDiagonal() * A.transpose();
  }

  void scale_masses() {
    double sum = 0;
    for (const ModelLink& link : model_.links) sum += link.parent < 0 ? 0 : link.mass;
    if (!(sum > 0)) return;
    for (ModelLink& link : model_.links) link.mass *= total_mass_ / sum, link.inertia *= total_mass_ / sum;
  }

  ModelJoint joint(const Styled& e, const std::string& body, std::size_t count) {
    constexpr std::array<std::string_view, 4> kTypes = {"hinge", "slide", "ball", "free"};
    using Kind = ModelJoint::Kind;
    constexpr std::array<Kind, 4> kKinds = {Kind::hinge, Kind::slide, Kind::ball, Kind::free};
    ModelJoint j{.lower = {}, .upper = {}, .element = &e.element()};
    j.name = body + "_joint" + (count > 0 ? std::to_string(count + 1) : "");
    if (const Attribute a = e.element().find("name")) {
      j.name = a->value;
      if (!joint_names_.insert(j.name).second) refuse(e.element(), *a, "distinct, is taken");
    }
    if (e.element().name == "freejoint") j.kind = Kind::free;
    if (const Found f = e.element().name == "freejoint" ? Found{} : e.find("type"))
      j.kind = kKinds[choice_of(*f.element, *f.attribute, kTypes)];
    if (j.kind == Kind::free) return j;
    const double unit = j.kind == Kind::slide ? 1 : degree_;
    j.anchor = e.vector("pos", Vector3d::Zero());
    if (j.coordinate()) {
      if (const Found f = e.find("axis")) j.axis = direction_of(*f.element, *f.attribute);
      j.reference = j.start = unit * e.number("ref", 0);
      j.rest = unit * e.number("springref", 0);
    }
    j.damping = e.not_negative("damping", 0), j.friction = e.not_negative("frictionloss", 0);
    j.stiffness = e.not_negative("stiffness", 0);
    const Found range = e.find("range"), limited = e.find("limited");
    constexpr std::array<std::string_view, 3> kLimited = {"false", "true", "auto"};
    const std::size_t wish = limited ? choice_of(*limited.element, *limited.attribute, kLimited) : 2;
    if (wish == 1 && !range) refuse(e.element(), "limited = 'true': must have a range");
    if (wish == 2 && range && !auto_limits_) refuse(e.element(), "must say limited, for autolimits is false");
    if (wish == 0 || !range) return j;
    const auto bounds = numbers_of(*range.element, *range.attribute, 2, 2);
    if (!(bounds[0] < bounds[1])) refuse(*range.element, *range.attribute, "two numbers, the first one less");
    if (j.coordinate()) j.lower = unit * bounds[0];
    j.upper = unit * bounds[1];
    return j;
  }

  void geom(const Styled& e, int number, const Place& at) {
    constexpr std::array<std::string_view, 8> kTypes = {"plane",     "hfield",   "sphere", "capsule",
                                                        "ellipsoid", "cylinder", "box",    "mesh"};
    const Found type_found = e.find("type"), mesh = e.find("mesh");
    const std::string_view type =
        kTypes[type_found ? choice_of(*type_found.element, *type_found.attribute, kTypes) : 2];
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
      if (dimension == 0) s.mu = 0;
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

  /// Kind, place and size of a geom; volume and inertia about its own centre (of meshes in their frame).
  void sized(const Styled& e, std::string_view type, const Found& mesh, ModelShape& s, spatial::Polyhedron& solid) {
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

  // Elements outside the tree of bodies.

  int body_named(const XmlElement& e, const XmlAttribute& a) const {
    if (a.value == "world") return 0;
    const auto found = bodies_.find(a.value);
    if (found == bodies_.end()) refuse(e, a, "the name of a <body>");
    return found->second;
  }

  void excluded(const XmlElement& e) {
    for (const XmlElement* x : e.all("exclude"))
      model_.apart.emplace_back(body_named(*x, needed(*x, "body1")), body_named(*x, needed(*x, "body2")));
  }

  void ties(const XmlElement& e) {
    for (const XmlElement& x : e.children) {
      const Attribute first = x.find("body1");
      if ((x.name != "connect" && x.name != "weld") || first == nullptr) continue;
      const Attribute active = x.find("active");
      if (active != nullptr && !truth_of(x, *active)) continue;  // stays unread: it is listed
      x.read = true;
      ModelTie tie{.relative = {}, .element = &x};
      tie.whole = x.name == "weld", tie.first = body_named(x, *first);
      if (const Attribute a = x.find("name")) tie.name = a->value;
      if (const Attribute a = x.find("body2")) tie.second = body_named(x, *a);
      if (!tie.whole) tie.anchor = vector_of(x, needed(x, "anchor"));
      if (const Attribute a = tie.whole ? x.find("relpose") : nullptr) {
        const auto p = numbers_of(x, *a, 7, 7);
        const Eigen::Vector4d q(p[3], p[4], p[5], p[6]);
        if (!q.isZero(0))
          tie.relative = Place{quaternions::matrix_of(Eigen::Vector4d(q.stableNormalized())), {p[0], p[1], p[2]}};
      }
      model_.ties.push_back(tie);
    }
  }

  struct Class {
    std::string above;
    std::vector<const XmlElement*> elements;  // the first level may stand in several
  };
  struct PendingMesh {
    Found file;
    Vector3d scale;
  };

  XmlElement& root_;
  ModelFiles& files_;
  MeshHulls hulls_;
  Model model_;
  std::size_t elements_ = 0;  // of included files
  double degree_ = std::numbers::pi / 180, least_mass_ = 0, least_inertia_ = 0, total_mass_ = -1;
  std::string sequence_ = "xyz", top_ = "main", mesh_folder_;
  int from_geoms_ = 2;  // no, yes, where there is no inertial
  std::pair<double, double> groups_{0, 5};
  bool auto_limits_ = true, balance_ = false, strip_ = false, contacts_ = true;
  bool geoms_count_ = false;  // those that are being read make mass
  int torsion_ = 0;
  std::map<std::string, Class> classes_;
  std::map<std::string, MeshHull> meshes_;  // written in the file
  std::map<std::string, PendingMesh> pending_;
  std::map<std::string, int> bodies_;
  std::set<std::string> joint_names_;
};

}  // namespace

Model read_mjcf(XmlElement& root, ModelFiles& files) { return MjcfReader(root, files).read(); }

}  // namespace orthant::models
