#include <orthant/core/mechanics/models/hulls.h>
#include <orthant/core/mechanics/models/urdf.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace orthant::models {
namespace {

Matrix3d tidy(Matrix3d R) {  // rounding of sines of right angles
  for (double& x : R.reshaped())
    if (std::abs(x) < 1e-15) x = 0;
  return R;
}

/// Turns about the fixed axes x, y, z, in this order.
Matrix3d roll_pitch_yaw(const Vector3d& a) {
  const auto about = [](double angle, const Vector3d& u) { return Eigen::AngleAxisd(angle, u).toRotationMatrix(); };
  return tidy(about(a.z(), Vector3d::UnitZ()) * about(a.y(), Vector3d::UnitY()) * about(a.x(), Vector3d::UnitX()));
}

class UrdfReader {
 public:
  UrdfReader(const XmlElement& root, ModelFiles& files, const ModelOptions& options)
      : root_(root), options_(options), hulls_(files) {}

  Model read() {
    if (root_.name != "robot") refuse(root_, "must be <robot>");
    model_.format = "URDF", model_.file = root_.file, model_.name = root_.file;
    if (const Attribute name = root_.find("name")) model_.name = name->value;
    for (const XmlElement& child : root_.children)
      if (child.name.starts_with("xacro:"))
        refuse(child, "must be expanded before: xacro robot.urdf.xacro > robot.urdf");
    for (const XmlElement* e : root_.all("link")) link(*e);
    if (links_.empty()) refuse(root_, "must have a <link>");
    for (const XmlElement* e : root_.all("joint")) joint(*e);
    order();
    for (const std::string& one : hulls_.notes()) model_.notes.push_back(one);
    return std::move(model_);
  }

 private:
  struct UrdfJoint {
    std::string parent, child;
    Place at;
    std::optional<ModelJoint> moves;
    const XmlElement* element;
  };

  static Place origin_of(const XmlElement& element) {
    Place place;
    const XmlElement* origin = element.first("origin");
    if (origin == nullptr) return place;
    if (const Attribute xyz = origin->find("xyz")) place.p = vector_of(*origin, *xyz);
    if (const Attribute rpy = origin->find("rpy")) place.R = roll_pitch_yaw(vector_of(*origin, *rpy));
    return place;
  }

  static const XmlElement& child_of(const XmlElement& element, std::string_view name) {
    const XmlElement* child = element.first(name);
    if (child == nullptr) refuse(element, "missing element <" + std::string(name) + ">");
    return *child;
  }

  static double positive(const XmlElement& element, std::string_view attribute) {
    const XmlAttribute& a = needed(element, attribute);
    const double x = number_of(element, a);
    if (!(x > 0)) refuse(element, a, "> 0");
    return x;
  }

  void link(const XmlElement& e) {
    ModelLink link{.name = needed(e, "name").value, .at = {}, .joints = {}, .shapes = {}, .element = &e};
    if (link.name.empty()) refuse(e, "must have a name");
    if (!links_.emplace(link.name, found_.size()).second) refuse(e, needed(e, "name"), "distinct, is taken");
    if (const XmlElement* inertial = e.first("inertial")) inertia(*inertial, link);
    for (const XmlElement* collision : e.all("collision")) shape(*collision, link);
    found_.push_back(std::move(link));
  }

  static void inertia(const XmlElement& e, ModelLink& link) {
    const Place at = origin_of(e);
    const XmlElement& mass = child_of(e, "mass");
    const XmlAttribute& value = needed(mass, "value");
    const double m = number_of(mass, value);
    if (m < 0) refuse(mass, value, ">= 0");
    const XmlElement& tensor = child_of(e, "inertia");
    const auto entry = [&](const char* name) { return number_of(tensor, needed(tensor, name)); };
    const double xx = entry("ixx"), yy = entry("iyy"), zz = entry("izz"), xy = entry("ixy"), xz = entry("ixz"),
                 yz = entry("iyz");
    Matrix3d I;
    I << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    if (m == 0 && I.isZero(0)) return;
    if (m == 0) refuse(mass, value, "> 0, for the inertia is not zero");
    check_inertia(tensor, I);
    add_mass(link, m, at.p, at.R * I * at.R.transpose());
  }

  void shape(const XmlElement& e, ModelLink& link) {
    ModelShape s;
    s.at = origin_of(e), s.mu = options_.mu;
    if (const Attribute name = e.find("name")) s.name = name->value;
    const XmlElement& geometry = child_of(e, "geometry");
    if (geometry.children.size() != 1) refuse(geometry, "must have one shape");
    const XmlElement& g = geometry.children.front();
    g.read = true;
    using Kind = ModelShape::Kind;
    if (g.name == "box") {
      const XmlAttribute& size = needed(g, "size");
      s.kind = Kind::box, s.size = vector_of(g, size);
      if (!(s.size.minCoeff() > 0)) refuse(g, size, "three lengths > 0");
    } else if (g.name == "sphere") {
      s.kind = Kind::sphere, s.size.x() = positive(g, "radius");
    } else if (g.name == "cylinder" || g.name == "capsule") {
      s.kind = g.name == "cylinder" ? Kind::cylinder : Kind::capsule;
      s.size = {positive(g, "radius"), positive(g, "length"), 0};
    } else if (g.name == "mesh") {
      Vector3d scale(1, 1, 1);
      if (const Attribute a = g.find("scale")) {
        scale = vector_of(g, *a);
        if (scale.prod() == 0) refuse(g, *a, "three factors, not zero");
      }
      s.kind = Kind::polytope, s.corners = hulls_.get(g, needed(g, "filename"), scale).corners;
      for (Vector3d& p : s.corners) p = s.at * p;
      if (s.corners.empty()) return;
    } else {
      refuse(g, "must be <box>, <sphere>, <cylinder>, <capsule> or <mesh>");
    }
    link.shapes.push_back(std::move(s));
  }

  void joint(const XmlElement& e) {
    constexpr std::array<std::string_view, 6> kTypes = {"revolute", "continuous", "prismatic",
                                                        "fixed",    "planar",     "floating"};
    UrdfJoint j{.parent = {}, .child = {}, .at = origin_of(e), .moves = {}, .element = &e};
    const std::string name = needed(e, "name").value;
    if (name.empty()) refuse(e, "must have a name");
    if (!joint_names_.insert(name).second) refuse(e, needed(e, "name"), "distinct, is taken");
    const std::size_t type = choice_of(e, needed(e, "type"), kTypes);
    const auto end = [&](const char* which) {
      const XmlElement& child = child_of(e, which);
      const XmlAttribute& link = needed(child, "link");
      if (!links_.contains(link.value)) refuse(child, link, "the name of a <link>");
      return link.value;
    };
    j.parent = end("parent"), j.child = end("child");
    if (j.parent == j.child) refuse(e, "joins link " + shortened(j.child) + " to itself: must join two links");
    if (const auto [other, added] = above_.emplace(j.child, joints_.size()); !added)
      refuse(e, "link " + shortened(j.child) + " is the child of " + joints_[other->second].element->place() +
                    " already: must be a tree");
    if (kTypes[type] != "fixed") j.moves = motion(e, name, kTypes[type]);
    joints_.push_back(std::move(j));
  }

  ModelJoint motion(const XmlElement& e, const std::string& name, std::string_view type) {
    ModelJoint m{.name = name, .lower = {}, .upper = {}, .element = &e};
    using Kind = ModelJoint::Kind;
    m.kind = type == "prismatic"  ? Kind::slide
             : type == "planar"   ? Kind::planar
             : type == "floating" ? Kind::free
                                  : Kind::hinge;
    m.axis = {1, 0, 0};
    if (m.kind != Kind::free)
      if (const XmlElement* axis = e.first("axis")) m.axis = direction_of(*axis, needed(*axis, "xyz"));
    if (m.kind == Kind::free) return m;
    const XmlElement* limit = type == "continuous" ? nullptr : e.first("limit");
    if (type == "revolute" || type == "prismatic") {
      if (limit == nullptr)
        refuse(e, "missing element <limit>" + std::string(type == "revolute" ? ": or continuous" : ""));
      m.lower = m.upper = 0.0;
    }
    if (limit != nullptr) {
      if (const Attribute a = limit->find("lower")) m.lower = number_of(*limit, *a);
      if (const Attribute a = limit->find("upper")) m.upper = number_of(*limit, *a);
      if (m.lower && m.upper && *m.lower >= *m.upper)
        refuse(*limit, "lower = " + detail::text_of(*m.lower) + ": must be < upper = " + detail::text_of(*m.upper) +
                           ", or the joint of type fixed");
    }
    if (const XmlElement* dynamics = e.first("dynamics"))
      for (const auto& [key, field] : {std::pair{"damping", &m.damping}, std::pair{"friction", &m.friction}})
        if (const Attribute a = dynamics->find(key)) {
          *field = number_of(*dynamics, *a);
          if (*field < 0) refuse(*dynamics, *a, ">= 0");
        }
    for (const XmlElement& child : e.children)
      if (child.name == "mimic") {
        child.read = true;
        std::string of;
        for (const XmlAttribute& a : child.attributes)
          a.read = true, of += (of.empty() ? "" : " ") + a.name + "=" + a.value;
        model_.notes.push_back("not taken: mimic of joint " + name + " (" + shortened(of) + "): it moves on its own");
      }
    return m;
  }

  /// Links behind their parents, each with the joint above it.
  void order() {
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < found_.size(); ++i)
      if (!above_.contains(found_[i].name)) roots.push_back(i);
    if (roots.empty()) refuse(root_, "has no root: every link is the child of a joint, must be a tree");
    if (roots.size() > 1)
      refuse(*found_[roots[1]].element, "is a root as link " + shortened(found_[roots[0]].name) +
                                            " is: must be one tree, the others the children of joints");
    std::map<std::string, std::vector<std::size_t>> below;  // joints, by parent
    for (std::size_t j = 0; j < joints_.size(); ++j) below[joints_[j].parent].push_back(j);
    struct Next {
      std::size_t link;
      int parent;
      const UrdfJoint* joint;
    };
    std::vector<Next> queue{{roots[0], 0, nullptr}};
    for (std::size_t k = 0; k < queue.size(); ++k) {
      const Next next = queue[k];
      ModelLink link = found_[next.link];
      link.parent = next.parent;
      if (next.joint != nullptr) {
        link.at = next.joint->at;
        if (next.joint->moves) link.joints = {*next.joint->moves};
      } else if (options_.base == ModelOptions::Base::free) {
        link.joints = {ModelJoint{
            .kind = ModelJoint::Kind::free, .name = "base", .lower = {}, .upper = {}, .element = link.element}};
      }
      const int number = static_cast<int>(model_.links.size());
      for (const std::size_t j : below[link.name]) queue.push_back({links_.at(joints_[j].child), number, &joints_[j]});
      model_.links.push_back(std::move(link));
    }
    if (queue.size() < found_.size())
      for (const ModelLink& link : found_)
        if (std::none_of(model_.links.begin(), model_.links.end(), [&](const auto& l) { return l.name == link.name; }))
          refuse(*link.element, "is in a loop of joints: must be a tree");
  }

  const XmlElement& root_;
  const ModelOptions& options_;
  MeshHulls hulls_;
  Model model_;
  std::vector<ModelLink> found_;
  std::map<std::string, std::size_t> links_, above_;  // links in found_; the joint above a link
  std::set<std::string> joint_names_;
  std::vector<UrdfJoint> joints_;
};

}  // namespace

Model read_urdf(const XmlElement& root, ModelFiles& files, const ModelOptions& options) {
  return UrdfReader(root, files, options).read();
}

}  // namespace orthant::models
