// Bodies of MJCF: the tree, given inertias, joints, pairs that do not meet, ties.
#include <orthant/core/mechanics/models/mjcf_reader.h>
#include <orthant/core/mechanics/spatial/inertia.h>
#include <orthant/core/mechanics/spatial/rotation.h>
#include <orthant/core/support/options.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace orthant::models {

void MjcfReader::body(const XmlElement& e, int parent, const Place& at, const std::string& inherited) {
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

void MjcfReader::parts(const XmlElement& e, int link, const Place& at, const std::string& inherited, bool bodies) {
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

void MjcfReader::given_inertia(const XmlElement& e, ModelLink& link) const {
  const Place at = frame(Styled(e, {}));
  const XmlAttribute& m = needed(e, "mass");
  const double mass = number_of(e, m);
  if (mass < 0) refuse(e, m, ">= 0");
  Matrix3d I = Matrix3d::Zero();
  const Attribute diagonal = e.find("diaginertia"), full = e.find("fullinertia");
  if ((diagonal != nullptr) == (full != nullptr)) refuse(e, "must have either diaginertia or fullinertia");
  for (const char* turn : {"quat", "axisangle", "xyaxes", "zaxis", "euler"})
    if (const Attribute given = e.find(turn); full != nullptr && given != nullptr)
      refuse(e, *given, "left out next to fullinertia, which has its own axes");
  if (diagonal != nullptr) I.diagonal() = vector_of(e, *diagonal);
  if (full != nullptr) {
    const auto x = numbers_of(e, *full, 6, 6);
    I << x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2];
  }
  if (mass > 0 && !balance_ && least_inertia_ == 0) check_inertia(e, I);
  add_mass(link, mass, at.p, at.R * I * at.R.transpose());
}

void MjcfReader::bound(ModelLink& link) const {
  if (least_mass_ > 0) link.mass = std::max(link.mass, least_mass_);
  if (!(link.mass > 0) || (!(least_inertia_ > 0) && !balance_)) return;
  const spatial::Principal own = spatial::principal(link.inertia);
  Vector3d J = own.moments.cwiseMax(least_inertia_);
  if (balance_ && 2 * J.maxCoeff() > J.sum()) J.setConstant(J.mean());
  const Matrix3d A = quaternions::matrix_of(own.axes);
  if (J != own.moments) link.inertia = A * J.asDiagonal() * A.transpose();
}

void MjcfReader::scale_masses() {
  double sum = 0;
  for (const ModelLink& link : model_.links) sum += link.parent < 0 ? 0 : link.mass;
  if (!(sum > 0)) return;
  for (ModelLink& link : model_.links) link.mass *= total_mass_ / sum, link.inertia *= total_mass_ / sum;
}

ModelJoint MjcfReader::joint(const Styled& e, const std::string& body, std::size_t count) {
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

int MjcfReader::body_named(const XmlElement& e, const XmlAttribute& a) const {
  if (a.value == "world") return 0;
  const auto found = bodies_.find(a.value);
  if (found == bodies_.end()) refuse(e, a, "the name of a <body>");
  return found->second;
}

void MjcfReader::excluded(const XmlElement& e) {
  for (const XmlElement* x : e.all("exclude"))
    model_.apart.emplace_back(body_named(*x, needed(*x, "body1")), body_named(*x, needed(*x, "body2")));
}

void MjcfReader::ties(const XmlElement& e) {
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

}  // namespace orthant::models
