// core/mechanics/scene/toml/spatial_reader.h — reader of spatial scenes: tables and keys of files with dimension = 3.
#pragma once

#include "fields.h"

#include <orthant/core/mechanics/models/hulls.h>
#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>

#include <map>

namespace orthant::scene_file {

class SpatialReader {
 public:
  SpatialReader(const toml::table& root, std::string file) : root_(root), file_(std::move(file)) {}

  spatial::Scene scene();

 private:
  template <class Read> void each(Fields& top, std::string_view kind, Read&& read);
  void body(Fields& f);
  void solid(Fields& f, const toml::table& table, spatial::Body& b);
  void pose_bodies();

  BodyId id(const Fields& f, std::string_view key, const toml::node& node) const;
  BodyId body_of(Fields& f) const;
  template <class T> void points_of(Fields& f, T& x) const;
  template <class T> void axes_of(Fields& f, T& x) const;
  template <class T> void angle_of(Fields& f, T& x) const;
  template <class T> void orientation_of(Fields& f, T& x) const;
  void joint(Fields& f);
  spatial::Coordinate coordinate(Fields& f) const;
  spatial::Coordinate free_at(Fields& f, const toml::node& joint) const;
  /// Of a joint with two coordinates the one of this kind.
  spatial::Coordinate free_of(const Fields& f, std::string_view key, const toml::node& joint,
                              std::string_view kind) const;
  /// Likewise, and whether it has two.
  std::pair<spatial::Coordinate, bool> coordinate_of(const Fields& f, std::string_view key, const toml::node& joint,
                                                     std::string_view kind) const;
  spatial::Gear gear_of(Fields& f, bool rack, const std::string& name) const;
  std::pair<spatial::Coordinate, spatial::Coordinate> turning(Fields& f, bool rack) const;

  void contact(Fields& f);
  template <class T> void wall(Fields& f, T& c) const;
  void pin_bush(Fields& f, const std::string& name);
  void block_channel(Fields& f, const std::string& name);
  void limit(Fields& f, const std::string& name);
  void backlash(Fields& f, const std::string& name);
  template <class T> void half_space(Fields& w, T& c) const;
  void rims(Fields& f, const std::string& type, const std::string& name);
  void shape(Fields& f, spatial::Collision& c);
  static bool names_mesh(Fields& f);
  const models::MeshHull& mesh(Fields& f);
  std::vector<Vector3d> mesh_corners(Fields& f);
  void height_field(Fields& f, spatial::Collision& c) const;
  void collision(Fields& f);
  void apart(Fields& f, spatial::Collision& c) const;
  template <class Read> void each_table(Fields& f, std::string_view key, Read&& read) const;
  void friction(Fields& f);
  void spring(Fields& f);
  void load(Fields& f);

  const toml::node& find(const SceneError& error) const;

  const toml::table& root_;
  std::string file_;
  spatial::Scene scene_;
  spatial::Kinematics initial_;
  std::string given_name_;  // of the element being read, or by its place
  /// Of each contact, which element of the file it comes from.
  std::vector<std::pair<std::string_view, std::size_t>> written_;
  std::map<std::string, models::MeshHull> meshes_;  // by file and scale
  std::vector<std::size_t> springs_;                // of each spring its table: drag has several
  std::map<std::string, BodyId, std::less<>> ids_;
};

}  // namespace orthant::scene_file
