// Reader of MJCF: elements with the defaults of their class, and the model they make. Internal to the import.
#pragma once

#include <orthant/core/mechanics/models/hulls.h>
#include <orthant/core/mechanics/models/mjcf.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <map>
#include <numbers>
#include <set>

namespace orthant::models {

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

  Model read();

 private:
  static std::size_t size_of_tree(const XmlElement& e);

  /// Puts the elements of included files in the place of <include>.
  void include_files(XmlElement& e, int depth);
  void compiler(const XmlElement& e);
  void option(const XmlElement& e);

  // Default classes.

  void defaults(const XmlElement& e, const std::string& above);

  /// The defaults for this kind of element, of its class or else of `inherited`.
  Styled styled(const XmlElement& e, const std::string& inherited) const;
  std::string known_class(const XmlElement& e, const XmlAttribute& a) const;

  // Frames.

  Place frame(const Styled& e) const;
  /// The shortest turn that takes z there.
  static Matrix3d towards(const Vector3d& z);

  // Assets.

  void assets(const XmlElement& e);
  /// Files are read only where a geom wants them.
  const MeshHull& mesh_named(const XmlElement& of, const XmlAttribute& a);

  // Bodies.

  void body(const XmlElement& e, int parent, const Place& at, const std::string& inherited);

  /// The geoms of a link, or the bodies below it; those in frames, too.
  void parts(const XmlElement& e, int link, const Place& at, const std::string& inherited, bool bodies);
  void given_inertia(const XmlElement& e, ModelLink& link) const;

  /// Lower bounds, and equal moments where they are not those of a body, as the compiler element wishes.
  void bound(ModelLink& link) const;
  void scale_masses();
  ModelJoint joint(const Styled& e, const std::string& body, std::size_t count);
  void geom(const Styled& e, int number, const Place& at);

  /// Kind, place and size of a geom; volume and inertia about its own centre (of meshes in their frame).
  void sized(const Styled& e, std::string_view type, const Found& mesh, ModelShape& s, spatial::Polyhedron& solid);

  // Elements outside the tree of bodies.

  int body_named(const XmlElement& e, const XmlAttribute& a) const;
  void excluded(const XmlElement& e);
  void ties(const XmlElement& e);

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

}  // namespace orthant::models
