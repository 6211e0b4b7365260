// Writer of an imported model as a scene in space: bodies from links, joints from stacks of joints, contacts and
// collisions from shapes. Internal to the import.
#pragma once

#include <orthant/core/mechanics/models/model.h>
#include <orthant/core/mechanics/spatial/collision.h>

#include <set>

namespace orthant::models {

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

  std::string write();

 private:
  void note(const std::string& text) { model_.notes.push_back(text); }

  void set_starts();
  static Place motion(const ModelJoint& j);
  void make_carriers();

  Carrier& carrier(std::size_t link) { return carriers_[static_cast<std::size_t>(carrier_of_[link])]; }

  static void add_part(ModelLink& whole, const ModelLink& part, const Place& at);

  /// A point of the carrier's frame, in the body's.
  static Vector3d from_centre(const Carrier& c, const Vector3d& p) { return c.link == 0 ? p : p - c.whole.centre; }

  void body(const Carrier& c);

  /// Writes the joints between c and its parent, all in one of the scene's forms. One function: a case for each form.
  void joints(const Carrier& c);
  static CoordinateKeys slide_keys(const std::string& bodies, const std::string& points, const Vector3d& axis);

  /// Limits, friction, damper and spring along a joint's coordinate; without one they are not taken.
  void along(const Carrier& c, const ModelJoint& j, const CoordinateKeys& of);
  void add_tie(const ModelTie& tie);

  // Shapes.

  static std::vector<Vector3d> ring(const ModelShape& s, double z);
  /// What of the shape a collision knows: one point of a sphere, two of a capsule, corners. In the carrier's frame.
  static std::vector<Vector3d> corners_of(const ModelShape& s);
  static bool rounded(const ModelShape& s) {
    return s.kind == ModelShape::Kind::sphere || s.kind == ModelShape::Kind::capsule;
  }
  static bool meet(const ModelShape& x, const ModelShape& y);
  void shapes();

  /// The shape against a half-space, exact for every kind.
  void wall(const Carrier& c, const ModelShape& s, const ModelShape& plane);
  static std::vector<Vector3d> moved(const Carrier& c, std::vector<Vector3d> points);

  using Shapes = std::vector<std::pair<std::size_t, const ModelShape*>>;  // with the carrier of each
  using Pair = std::pair<int, int>;                                       // of carriers, the lesser one first
  /// Writes one collision of all shapes.
  void collision(const Shapes& all);
  /// Carriers that do not meet: joined ones, those masked, and those that overlap at the start within one tree.
  std::set<Pair> pairs_apart(const Shapes& all, const spatial::Collision& set, const std::vector<spatial::Pose>& poses);

  const std::string& name_of(int carrier) const { return carriers_[static_cast<std::size_t>(carrier)].name; }

  static bool overlap(const spatial::Shape& x, const spatial::Pose& at_x, const spatial::Shape& y,
                      const spatial::Pose& at_y);

  Model& model_;
  const ModelOptions& options_;
  std::vector<Carrier> carriers_;  // the ground first
  std::vector<int> carrier_of_;    // of each link
  std::vector<Place> in_carrier_;  // likewise
  Names body_names_, joint_names_, contact_names_, friction_names_, spring_names_;
  std::string bodies_, joints_, contacts_, collisions_, frictions_, springs_;
};

}  // namespace orthant::models
