// MJCF as a whole: included files, compiler settings, default classes, frames, meshes.
#include <orthant/core/mechanics/models/mjcf_reader.h>
#include <orthant/core/mechanics/spatial/rotation.h>
#include <orthant/core/support/options.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace orthant::models {
namespace {

constexpr std::uintmax_t kLargestPart = 16 << 20;  // [bytes] of an included file
constexpr int kDeepest = 16;                       // files included in each other
constexpr std::size_t kMostElements = 200000;      // of all files together

}  // namespace

Model MjcfReader::read() {
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
    model_.notes.push_back("not taken: torsional and rolling friction (condim 4 and 6) of " + std::to_string(torsion_) +
                           " geoms");
  for (const std::string& one : hulls_.notes()) model_.notes.push_back(one);
  for (const auto& [name, mesh] : meshes_)
    if (!mesh.note.empty()) model_.notes.push_back(mesh.note);
  return std::move(model_);
}

std::size_t MjcfReader::size_of_tree(const XmlElement& e) {
  std::size_t n = 1;
  for (const XmlElement& child : e.children) n += size_of_tree(child);
  return n;
}

void MjcfReader::include_files(XmlElement& e, int depth) {
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
      refuse(child, "the included files have more than " + std::to_string(kMostElements) + " elements: must have less");
    include_files(part, depth + 1);
    for (XmlElement& of : part.children) all.push_back(std::move(of));
  }
  e.children = std::move(all);
}

void MjcfReader::compiler(const XmlElement& e) {
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

void MjcfReader::option(const XmlElement& e) {
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

void MjcfReader::defaults(const XmlElement& e, const std::string& above) {
  const Attribute name = e.find("class");
  if (name == nullptr && !above.empty()) refuse(e, "missing attribute class");
  const std::string own = name != nullptr && !above.empty() ? name->value : "main";
  if (above.empty() && name != nullptr) top_ = name->value;
  Class& c = classes_[own];
  if (!above.empty() && !c.elements.empty()) refuse(e, *name, "distinct, is taken");
  c.above = above, c.elements.push_back(&e);
  for (const XmlElement* inner : e.all("default")) defaults(*inner, own);
}

Styled MjcfReader::styled(const XmlElement& e, const std::string& inherited) const {
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

std::string MjcfReader::known_class(const XmlElement& e, const XmlAttribute& a) const {
  if (a.value == top_ || a.value == "main") return "main";
  if (!classes_.contains(a.value)) refuse(e, a, "the class of a <default>");
  return a.value;
}

Place MjcfReader::frame(const Styled& e) const {
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

Matrix3d MjcfReader::towards(const Vector3d& z) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), z).toRotationMatrix();
}

void MjcfReader::assets(const XmlElement& e) {
  for (const XmlElement* m : e.all("mesh")) {
    const Styled mesh = styled(*m, "");
    const Found file = mesh.find("file"), points = mesh.find("vertex");
    std::string name;
    if (const Attribute a = m->find("name")) name = a->value;
    if (file && name.empty()) name = std::filesystem::path(file.attribute->value).stem().string();
    if (name.empty()) refuse(*m, "must have a name or a file");
    for (const char* no : {"refpos", "refquat"})
      if (const Found f = mesh.find(no)) refuse(*f.element, *f.attribute, "left out: the points are taken as they are");
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

const MeshHull& MjcfReader::mesh_named(const XmlElement& of, const XmlAttribute& a) {
  if (const auto made = meshes_.find(a.value); made != meshes_.end()) return made->second;
  const auto found = pending_.find(a.value);
  if (found == pending_.end()) refuse(of, a, "the name of a <mesh> of <asset>");
  const auto& [file, scale] = found->second;
  XmlAttribute where = *file.attribute;
  if (strip_) where.value = std::filesystem::path(where.value).filename().string();
  return hulls_.get(*file.element, where, scale, mesh_folder_);
}

Model read_mjcf(XmlElement& root, ModelFiles& files) { return MjcfReader(root, files).read(); }

}  // namespace orthant::models
