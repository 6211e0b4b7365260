// core/mechanics/models/model.h — a model of URDF or MJCF as plain data: a tree of links with joints and shapes.
//
//   Link i stands in its parent's frame at  T_i = at_i M_1 M_2 …,  M_k the motion of its joint k from its reference:
//   a turn by value − reference about the axis through the anchor, or a slide along the axis.
// Link 0 is the world. Places, axes, anchors, shapes, centres of mass are in the link's own frame; a link's inertia is
// about its centre of mass, along its frame. Without joints a link is a part of its parent.
#pragma once

#include <orthant/core/mechanics/models/xml.h>
#include <orthant/core/mechanics/spatial/geometry.h>

#include <map>
#include <optional>
#include <utility>

namespace orthant::models {

using spatial::Matrix3d;

struct Place {
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();
  Vector3d operator*(const Vector3d& x) const { return R * x + p; }
  Place operator*(const Place& x) const { return {R * x.R, R * x.p + p}; }
  Place inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};

struct ModelShape {
  enum class Kind { sphere, capsule, cylinder, box, ellipsoid, polytope, plane };
  Kind kind = Kind::sphere;
  Place at;                       // axis of capsules and cylinders, normal of planes: z
  Vector3d size{0, 0, 0};         // [m] radius; radius, length between the ends; radius, height; edges; semi-axes
  std::vector<Vector3d> corners;  // of a polytope
  double mu = 0;
  bool slippery = false;            // has no friction with another such shape, whatever their mu
  unsigned type = 1, affinity = 1;  // meets shapes with type & affinity of the other, or the other way round
  std::string name;
};

struct ModelJoint {
  enum class Kind { hinge, slide, ball, planar, free };
  Kind kind = Kind::hinge;
  std::string name;
  Vector3d axis{0, 0, 1}, anchor{0, 0, 0};
  double reference = 0, start = 0;     // [rad or m]
  std::optional<double> lower, upper;  // likewise
  double damping = 0, friction = 0, stiffness = 0, rest = 0;
  const XmlElement* element = nullptr;
  bool coordinate() const { return kind == Kind::hinge || kind == Kind::slide; }
};

struct ModelLink {
  std::string name;
  int parent = -1;
  Place at;
  double mass = 0;  // [kg] 0: a frame only
  Vector3d centre{0, 0, 0};
  Matrix3d inertia = Matrix3d::Zero();
  std::vector<ModelJoint> joints;
  std::vector<ModelShape> shapes;
  const XmlElement* element = nullptr;
};

/// Loop closure: a point of a link, or the whole link, is held to another link.
struct ModelTie {
  std::string name;
  bool whole = false;
  int first = 0, second = 0;
  Vector3d anchor{0, 0, 0};       // of a point, in the first link
  std::optional<Place> relative;  // second in first; none: as at the start
  const XmlElement* element = nullptr;
};

struct Model {
  std::string format, name, file;
  Vector3d gravity{0, 0, -9.81};
  double step = 1e-3;
  std::vector<ModelLink> links{ModelLink{.name = "world", .at = {}, .joints = {}, .shapes = {}}};
  std::vector<ModelTie> ties;
  std::vector<std::pair<int, int>> apart;  // links that do not meet
  bool base_meets_children = false;        // shapes of the world meet links that are joined to it
  std::vector<std::string> notes;          // how it was taken, and what was not
};

/// Settings of `model.KEY=VALUE`.
struct ModelOptions {
  enum class Base { fixed, free };
  enum class FixedJoints { merge, keep };
  Base base = Base::fixed;                        // of URDF: the root link
  FixedJoints fixed_joints = FixedJoints::merge;  // links without a joint: parts of their parents, or bodies
  std::string folder;                             // from which files may be read; empty: the model's
  std::optional<double> floor;                    // [m] height of a half-space below
  double mu = 0.5;                                // of URDF
  std::map<std::string, double> at;               // joint: value at the start [rad, m]

  /// "base=free". Throws std::invalid_argument naming key, value and rule.
  void set(std::string_view text);
};

/// Throws std::invalid_argument where a body could not have this inertia.
void check_inertia(const XmlElement& element, const Matrix3d& inertia);
/// Adds a part to mass, centre and inertia of the link, all in its frame; inertia about the part's centre.
void add_mass(ModelLink& link, double mass, const Vector3d& centre, const Matrix3d& inertia);

/// The model as a scene in space, commented TOML. Adds notes.
std::string scene_text(Model& model, const ModelOptions& options);

}  // namespace orthant::models
