// Contacts of a planar scene file.
#include "reader.h"

#include <orthant/core/support/options.h>

namespace orthant::scene_file {

void Reader::contact(Fields& f) {
  std::string type, name;
  f.need("type", type), f.maybe("name", name);
  if (name.empty()) name = given_name_;
  if (type == "corner-wall") {
    CornerWall c{.name = name};
    c.a = body_of(f), f.maybe("point", c.point), wall(f, c), law(f, c.law);
    scene_.contact(c);
  } else if (type == "disc-wall") {
    DiscWall c{.name = name};
    c.a = body_of(f), f.maybe("centre", c.centre), f.need("radius", c.radius), wall(f, c), law(f, c.law);
    scene_.contact(c);
  } else if (type == "disc-disc") {
    DiscDisc c{.name = name};
    bodies_of(f, c), f.maybe("centre_a", c.centre_a), f.maybe("centre_b", c.centre_b);
    f.need("radius_a", c.radius_a), f.need("radius_b", c.radius_b), law(f, c.law);
    scene_.contact(c);
  } else if (type == "polygon-wall") {
    CornerWall c{.name = name};
    Polygon corners;
    c.a = body_of(f), f.need("corners", corners), wall(f, c), law(f, c.law);
    convex_corners(f, "corners", corners);
    scene_.contact_set(polygon_wall(c, corners));
  } else if (type == "disc-polygon") {
    DiscPolygon c{.name = name};
    bodies_of(f, c), f.maybe("centre", c.centre), f.need("radius", c.radius);
    f.need("corners", c.corners), law(f, c.law);
    scene_.contact(c);
  } else if (type == "polygon-polygon") {
    PolygonPolygon c{.name = name};
    bodies_of(f, c), f.need("corners_a", c.corners_a), f.need("corners_b", c.corners_b), law(f, c.law);
    convex_corners(f, "corners_a", c.corners_a), convex_corners(f, "corners_b", c.corners_b);
    scene_.contact_set(polygon_polygon(c));
  } else if (type == "chain") {
    chain_contact(f, name);
  } else if (type == "journal") {
    Journal c{.name = name};
    bodies_of(f, c), f.maybe("centre_a", c.centre_a), f.maybe("centre_b", c.centre_b);
    f.need("radius_a", c.radius_a), f.need("radius_b", c.radius_b), law(f, c.law);
    scene_.contact(c);
  } else if (type == "guide") {
    guide_of(f, name);
  } else if (type == "limit") {
    limit(f, name);
  } else if (type == "rope") {
    Span span;
    Limit c{.name = name, .side = Limit::Side::upper};
    points_of(f, span), f.maybe("e_n", c.law.e), f.need("length", c.bound);
    if (!(c.bound > 0)) f.refuse("length", *f.table().get("length"), "> 0");
    c.of = span;
    scene_.contact(c);
  } else if (type == "relation") {
    relation_limit(f, name);
  } else if (type == "pulley") {
    pulley(f, name);
  } else {
    f.refuse("type", *f.table().get("type"),
             "corner-wall, disc-wall, disc-disc, polygon-wall, disc-polygon, polygon-polygon, chain, journal, guide, "
             "limit, rope, relation or pulley");
  }
}

void Reader::law(Fields& f, ContactLaw& law) {
  f.maybe("mu", law.mu), f.maybe("e_n", law.e), f.maybe("e_t", law.e_t);
  f.maybe("mu_static", law.mu_static), f.maybe("belt", law.belt);
}

void Reader::convex_corners(const Fields& f, std::string_view key, const Polygon& corners) {
  if (!convex(corners))
    f.refuse(key, *f.table().get(key), "the corners of a convex polygon, counter-clockwise, no three in a line");
}

void Reader::guide_of(Fields& f, const std::string& name) {
  Guide g{.name = name};
  g.a = body_of(f), f.maybe("centre", g.centre), f.need("width", g.width), f.need("height", g.height);
  f.need("clearance", g.clearance), law(f, g.law);
  const auto at_least = [&](std::string_view key, bool holds, const std::string& rule) {
    if (!holds) f.refuse(key, *f.table().get(key), rule);
  };
  at_least("width", g.width > 0, "> 0"), at_least("height", g.height > 0, "> 0");
  at_least("clearance", g.clearance >= 0, ">= 0");
  if (const toml::table* table = f.inner("walls")) {
    Fields w = f.fields("walls", *table);
    if (const toml::node* node = w.find("body", Form::body)) g.b = id(w, "body", *node);
    w.maybe("point", g.point), w.direction("axis", g.axis);
    w.done();
  }
  for (const CornerWall& corner : guide(g)) {
    if (corner.gap(initial_) < -g.height / 2)
      f.fail(f.table(), "starts off its walls or crosswise: corner \"" + corner.name + "\" is " +
                            detail::text_of(-corner.gap(initial_)) + " m inside its wall: must be at most height / 2");
    scene_.contact(corner);
  }
}

void Reader::limit(Fields& f, const std::string& name) {
  Limit c{.name = name, .of = coordinate(f)};
  f.maybe("e_n", c.law.e);
  double lower = 0, upper = 0;
  const bool below = f.maybe("lower", lower), above = f.maybe("upper", upper);
  if (!below && !above) f.fail(f.table(), "missing key \"lower\" or \"upper\"");
  if (below && above && lower >= upper)
    f.refuse("lower", *f.table().get("lower"), "less than upper (a drive holds a coordinate in one place)");
  const auto add = [&](Limit::Side side, double bound, const char* suffix) {
    Limit one = c;
    one.side = side, one.bound = bound;
    if (below && above) one.name += suffix;
    scene_.contact(one);
  };
  if (below) add(Limit::Side::lower, lower, "_lower");
  if (above) add(Limit::Side::upper, upper, "_upper");
}

}  // namespace orthant::scene_file
