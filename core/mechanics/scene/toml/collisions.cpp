// Collision sets of a scene file.
#include "reader.h"

namespace orthant::scene_file {

namespace {

constexpr std::array<std::string_view, 2> kSearchNames = {"grid", "none"};

}  // namespace

void Reader::collision(Fields& f) {
  Collision c;
  f.maybe("name", c.name), f.maybe("neighbours", c.neighbours), law(f, c.law);
  Search search = Search::grid;
  f.choice("search", search, kSearchNames);
  searches_.push_back(search);
  each_table(f, "shapes", [&](Fields& g) {
    Shape s{.body = body_of(g)};
    const bool polygon = g.maybe("corners", s.corners);
    if (polygon) convex_corners(g, "corners", s.corners);
    if (!polygon) g.maybe("centre", s.centre), g.need("radius", s.radius);
    c.shapes.push_back(s);
  });
  each_table(f, "chains", [&](Fields& g) {
    Shape s;
    if (const toml::node* node = g.find("body", Form::body)) s.body = id(g, "body", *node);
    for (Polygon& piece : pieces_of(g)) s.corners = std::move(piece), c.shapes.push_back(s);
  });
  auto& walls = walls_.emplace_back();
  each_table(f, "walls", [&](Fields& g) { half_plane(g, walls.emplace_back()); });
  if (walls.empty() &&
      std::all_of(c.shapes.begin(), c.shapes.end(), [&](const Shape& s) { return s.body == c.shapes.front().body; }))
    f.fail(f.table(), "shapes: must be of two bodies at least, or there must be walls: nothing can meet");
  scene_.collision(c);
}

void Reader::list_pairs() {
  if (scene_.collisions.empty()) return;
  Scene all = scene_;
  all.collisions.clear();
  std::vector<Collision> searched;
  for (std::size_t i = 0; i < scene_.collisions.size(); ++i) {
    const Collision& c = scene_.collisions[i];
    int count = 0;
    const std::string wall_name = c.name + "_wall_";
    for (CornerWall wall : walls_[i])
      for (const Shape& s : c.shapes) {
        wall.name = wall_name + std::to_string(++count), wall.a = s.body, wall.law = c.law;
        if (s.body == wall.b) continue;
        if (s.corners.empty())
          all.contact(DiscWall{wall.name, s.body, s.centre, s.radius, wall.b, wall.wall_point, wall.normal, c.law});
        else
          all.contact_set(polygon_wall(wall, s.corners));
      }
    (searches_[i] == Search::none ? all.collisions : searched).push_back(c);
  }
  scene_ = with_pairs_listed(all);
  scene_.collisions = searched;
}

}  // namespace orthant::scene_file
