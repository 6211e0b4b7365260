// core/mechanics/scene/toml/reader.h — reader of planar scenes: the tables of a file to a scene, element by element:
// joints.cpp, relations.cpp, contacts.cpp, chains.cpp, collisions.cpp and loads.cpp read the kinds, reader.cpp the
// rest.
#pragma once

#include "fields.h"

#include <orthant/core/mechanics/planar/chain.h>
#include <orthant/core/mechanics/planar/relation.h>
#include <orthant/core/mechanics/scene/scene.h>

#include <functional>
#include <map>

namespace orthant::scene_file {

class Reader {
 public:
  Reader(const toml::table& root, std::string file) : root_(root), file_(std::move(file)) {}

  Scene scene();

  // Of scenes in space, too (spatial_reader.h).
  /// False: without an offset.
  static bool time_law(Fields& f, TimeLaw& law);
  static void set_factor(Fields& f, std::function<double(double)>& factor, std::vector<double>& breakpoints,
                         double& swing);

 private:
  enum class Search { grid, none };

  template <class Read> void each(Fields& top, std::string_view kind, Read&& read) {
    each_element(top, kind, file_, given_name_, [&](Fields& fields, std::size_t i) {
      read(fields);
      fields.done();
      if (kind == "contact") written_.resize(scene_.contacts.size(), i);
    });
  }
  void body(Fields& f);
  /// The initial poses: angles and lengths that the file leaves out are taken from them.
  void pose_bodies();
  double initial_angle(BodyId a, BodyId b) const { return initial_.at(a).theta - initial_.at(b).theta; }
  template <class T> double initial_length(const T& link) const {
    return (initial_.at(link.a).x + initial_.at(link.a).turn(link.point_a) - initial_.at(link.b).x -
            initial_.at(link.b).turn(link.point_b))
        .norm();
  }

  BodyId id(const Fields& f, std::string_view key, const toml::node& node) const;
  BodyId body_of(Fields& f) const;
  template <class T> void bodies_of(Fields& f, T& x) const {
    const toml::node* node = f.find("bodies", Form::bodies, true);
    if (node == nullptr) f.fail(f.table(), "missing key \"bodies\"");
    const toml::array* names = node->as_array();
    if (names == nullptr || names->size() != 2) f.refuse("bodies", *node, "two names [\"first\", \"second\"]");
    x.a = id(f, "bodies", *names->get(0)), x.b = id(f, "bodies", *names->get(1));
  }
  template <class T> void points_of(Fields& f, T& x) const {
    bodies_of(f, x), f.maybe("point_a", x.point_a), f.maybe("point_b", x.point_b);
  }

  void joint(Fields& f);
  /// Coordinate: the free one of a named joint, or the one written: two bodies and a measure between them.
  Coordinate coordinate(Fields& f) const;
  Coordinate free_at(const Fields& f, const toml::node& joint) const;

  // Linear relations between coordinates (planar/relation.h): relations.cpp.
  std::vector<CoordinateTerm> terms_of(Fields& f);
  void apart_at_start(const Fields& f, const std::vector<CoordinateTerm>& terms) const;
  void relation(Fields& f, const std::string& name);
  void gear(Fields& f, const std::string& name);
  void relation_limit(Fields& f, const std::string& name);
  void pulley(Fields& f, const std::string& name);

  void contact(Fields& f);
  static void law(Fields& f, ContactLaw& law);
  static void convex_corners(const Fields& f, std::string_view key, const Polygon& corners);
  void guide_of(Fields& f, const std::string& name);
  void limit(Fields& f, const std::string& name);
  template <class T> void wall(Fields& f, T& c) const {
    const toml::table* table = f.inner("wall");
    if (table == nullptr) f.fail(f.table(), "missing key \"wall\"");
    Fields w = f.fields("wall", *table);
    half_plane(w, c);
    w.done();
  }
  template <class T> void half_plane(Fields& w, T& c) const {
    if (const toml::node* node = w.find("body", Form::body)) c.b = id(w, "body", *node);
    w.maybe("point", c.wall_point);
    if (!w.direction("normal", c.normal, true)) w.miss("normal");
  }

  /// Points from a table: a line each, x and y; the path is relative to the scene's file.
  std::vector<Vector2d> table_of(const Fields& f, std::string_view key, const toml::node& node) const;
  GroundChain chain_of(Fields& f) const;
  [[noreturn]] static void fail_at_points(const Fields& f, const std::string& what);
  std::vector<Polygon> pieces_of(Fields& f) const;
  void chain_contact(Fields& f, const std::string& name);

  void collision(Fields& f);
  template <class Read> void each_table(Fields& f, std::string_view key, Read&& read) {
    const toml::node* list = f.find(key, Form::tables);
    if (list == nullptr) return;
    const toml::array* tables = list->as_array();
    if (tables == nullptr) f.refuse(key, *list, "a list of tables [{...}, ...]");
    for (std::size_t i = 0; i < tables->size(); ++i) {
      const toml::table* table = tables->get(i)->as_table();
      if (table == nullptr) f.refuse(key, *tables->get(i), "a table");
      Fields g = f.fields(std::string(key) + "[" + std::to_string(i) + "]", *table);
      read(g);
      g.done();
    }
  }
  /// Lists the contacts of collisions that no search finds: every shape against each wall, and the pairs to be listed.
  void list_pairs();

  void friction(Fields& f);
  void spring(Fields& f);
  void load(Fields& f);
  static std::pair<std::vector<double>, std::vector<double>> points_in_time(Fields& f);

  /// Node that an error of check() concerns: the key if it is written, else its element, else the file.
  const toml::node& find(const SceneError& error) const;

  const toml::table& root_;
  std::string file_;
  Scene scene_;
  Kinematics initial_;
  std::string given_name_;                      // of the element being read, or by its place: what overrides know it by
  std::vector<Search> searches_;                // of each collision
  std::vector<std::vector<CornerWall>> walls_;  // likewise: b, wall_point and normal are read
  std::vector<std::size_t> written_;            // of each contact, which element of the file it comes from
  std::map<std::string, BodyId, std::less<>> ids_;
};

}  // namespace orthant::scene_file
