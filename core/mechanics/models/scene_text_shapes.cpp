// Contacts of a model's scene: shapes against half-spaces, and one collision of all shapes.
#include <orthant/core/mechanics/models/attributes.h>
#include <orthant/core/mechanics/models/scene_text.h>
#include <orthant/core/mechanics/models/toml_values.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace orthant::models {
namespace {

constexpr std::size_t kMostShapes = 2000;
constexpr int kSides = 24;  // of the prism that stands for a cylinder

/// As MuJoCo takes it: condim and friction are each the larger of the two; a condim of 1 has no friction.
double friction_of(const ModelShape& x, const ModelShape& y) {
  return x.slippery && y.slippery ? 0 : std::max(x.mu, y.mu);
}

/// The corner that lies farthest along d, in the world.
Vector3d farthest_corner(const spatial::Shape& s, const spatial::Pose& at, const Vector3d& d) {
  const Vector3d way = at.turn_back(d);
  const auto nearer = [&](const Vector3d& p, const Vector3d& q) { return way.dot(p) < way.dot(q); };
  return at.x + at.turn(*std::max_element(s.corners.begin(), s.corners.end(), nearer));
}

Vector3d middle_of_corners(const spatial::Shape& s, const spatial::Pose& at) {
  Vector3d sum(0, 0, 0);
  for (const Vector3d& p : s.corners) sum += p;
  return at.x + at.turn(sum / static_cast<double>(s.corners.size()));
}

/// Whether two polytopes overlap by more than `least` [m], where that is seen fast: no, where a plane parts them; yes,
/// where the middle of one lies in the other. Touching points of all pairs of edges cost a millisecond.
/// Source: Chung & Wang, Quick collision detection of polytopes in virtual environments (1996).
std::optional<bool> quick_overlap(const spatial::Shape& x, const spatial::Pose& at_x, const spatial::Shape& y,
                                  const spatial::Pose& at_y, double least) {
  const Vector3d p = middle_of_corners(x, at_x), q = middle_of_corners(y, at_y);
  if (x.hull->depth_of(at_x.turn_back(q - at_x.x)) < -least || y.hull->depth_of(at_y.turn_back(p - at_y.x)) < -least)
    return true;
  constexpr int kDirections = 20;
  if (p == q) return std::nullopt;
  Vector3d d = (q - p).normalized();
  for (int i = 0; i < kDirections; ++i) {
    const Vector3d way = farthest_corner(y, at_y, -d) - farthest_corner(x, at_x, d);
    if (d.dot(way) >= 0) return false;
    const Vector3d r = way.normalized();
    d = (d - 2 * r.dot(d) * r).normalized();
  }
  return std::nullopt;
}

}  // namespace

std::vector<Vector3d> SceneText::ring(const ModelShape& s, double z) {
  std::vector<Vector3d> points;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    points.push_back(s.at * Vector3d(s.size.x() * std::cos(angle), s.size.x() * std::sin(angle), z));
  }
  return points;
}

std::vector<Vector3d> SceneText::corners_of(const ModelShape& s) {
  using Kind = ModelShape::Kind;
  switch (s.kind) {
    case Kind::sphere:
      return {s.at.p};
    case Kind::capsule:
      return {s.at * Vector3d(0, 0, -s.size.y() / 2), s.at * Vector3d(0, 0, s.size.y() / 2)};
    case Kind::cylinder: {
      std::vector<Vector3d> all = ring(s, -s.size.y() / 2);
      for (const Vector3d& p : ring(s, s.size.y() / 2)) all.push_back(p);
      return all;
    }
    case Kind::box: {
      std::vector<Vector3d> all = spatial::box_corners(s.size / 2);
      for (Vector3d& p : all) p = s.at * p;
      return all;
    }
    case Kind::ellipsoid: {
      std::vector<Vector3d> all;
      constexpr int kPoints = 60;
      for (int i = 0; i < kPoints; ++i) {  // on a spiral over the sphere
        const double z = 1 - (2.0 * i + 1) / kPoints, r = std::sqrt(1 - z * z),
                     angle = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
        all.push_back(s.at * s.size.cwiseProduct(Vector3d(r * std::cos(angle), r * std::sin(angle), z)));
      }
      return all;
    }
    default:
      return s.corners;
  }
}

bool SceneText::meet(const ModelShape& x, const ModelShape& y) {
  return (x.type & y.affinity) != 0 || (y.type & x.affinity) != 0;
}

void SceneText::shapes() {
  std::vector<std::pair<std::size_t, const ModelShape*>> all;  // by carrier
  std::vector<ModelShape> planes;
  int idle = 0;
  for (std::size_t c = 0; c < carriers_.size(); ++c)
    for (const ModelShape& s : carriers_[c].whole.shapes) {
      if (s.type == 0 && s.affinity == 0) {
        ++idle;
        continue;
      }
      if (s.kind == ModelShape::Kind::plane)
        planes.push_back(s);
      else
        all.emplace_back(c, &s);
    }
  if (all.size() > kMostShapes)
    throw std::invalid_argument(model_.file + ": has " + std::to_string(all.size()) +
                                " shapes that meet others: must be at most " + std::to_string(kMostShapes));
  if (idle > 0) note("not taken: " + std::to_string(idle) + " shapes that touch nothing (drawing only)");
  if (options_.floor) {
    ModelShape floor;
    floor.kind = ModelShape::Kind::plane, floor.at.p = {0, 0, *options_.floor}, floor.mu = options_.mu;
    floor.type = floor.affinity = ~0U, floor.name = "floor";
    planes.push_back(floor);
  }
  for (const ModelShape& plane : planes)
    for (const auto& [c, s] : all)
      if (c > 0 && meet(plane, *s)) wall(carriers_[c], *s, plane);
  collision(all);
}

void SceneText::wall(const Carrier& c, const ModelShape& s, const ModelShape& plane) {
  using Kind = ModelShape::Kind;
  const auto write = [&](const char* type, const std::string& keys, int parts = 0) {
    const std::string on = plane.name.empty() ? "plane" : plane.name;
    const std::string name = contact_names_.take((s.name.empty() ? c.name : s.name) + "_on_" + on, "plane", parts);
    contacts_ += "\n[[contact]]\ntype = \"" + std::string(type) + "\"\nname = " + in_quotes(name) +
                 "\nbody = " + in_quotes(c.name) + "\nwall = {point = " + list(plane.at.p) +
                 ", normal = " + list(Vector3d(plane.at.R.col(2))) + "}\n" + keys;
    const double mu = friction_of(s, plane);
    if (mu > 0) contacts_ += "mu = " + number(mu) + "\n";
  };
  const auto centre = [&] { return "centre = " + list(from_centre(c, s.at.p)) + "\n"; };
  if (rounded(s)) {
    for (const Vector3d& p : corners_of(s))
      write("sphere-wall", "centre = " + list(from_centre(c, p)) + "\nradius = " + number(s.size.x()) + "\n");
  } else if (s.kind == Kind::cylinder) {
    write("cylinder-wall",
          centre() + "axis = " + list(Vector3d(s.at.R.col(2))) + "\nradius = " + number(s.size.x()) +
              "\nheight = " + number(s.size.y()) + "\n",
          6);
  } else if (s.kind == Kind::ellipsoid) {
    write("ellipsoid-wall",
          centre() + "semi_axes = " + list(s.size) + "\norientation = " + list(quaternion_of(s.at.R)) + "\n");
  } else {
    const auto corners = moved(c, corners_of(s));
    write("polytope-wall", "corners = " + list(corners) + "\n", static_cast<int>(corners.size()));
  }
}

std::vector<Vector3d> SceneText::moved(const Carrier& c, std::vector<Vector3d> points) {
  for (Vector3d& p : points) p = from_centre(c, p);
  return points;
}

void SceneText::collision(const Shapes& all) {
  std::set<std::size_t> bodies;
  for (const auto& [c, s] : all) bodies.insert(c);
  if (bodies.size() < 2) return;
  std::string list_of;
  double least = std::numeric_limits<double>::infinity(), most = 0;
  const auto smooth = std::ranges::count_if(all, [](const auto& one) { return one.second->slippery; });
  int prisms = 0, ellipsoids = 0;
  spatial::Collision set{.name = "shapes", .shapes = {}, .law = {}};
  std::vector<spatial::Pose> poses;
  for (const Carrier& c : carriers_)
    poses.push_back({c.world * (c.link == 0 ? Vector3d(0, 0, 0) : c.whole.centre), c.world.R, c.world.R});
  for (const auto& [c, s] : all) {
    const auto points = moved(carriers_[c], corners_of(*s));
    set.shapes.push_back({.body = static_cast<BodyId>(c), .corners = points, .radius = rounded(*s) ? s->size.x() : 0});
    const bool none = smooth == static_cast<std::ptrdiff_t>(all.size());  // with any other
    least = std::min(least, none || (s->slippery && smooth > 1) ? 0 : s->mu), most = std::max(most, none ? 0 : s->mu);
    prisms += s->kind == ModelShape::Kind::cylinder, ellipsoids += s->kind == ModelShape::Kind::ellipsoid;
    list_of += "  {body = " + in_quotes(carriers_[c].name) + ", ";
    if (s->kind == ModelShape::Kind::sphere)
      list_of += "radius = " + number(s->size.x()) + ", centre = " + list(points[0]);
    else if (s->kind == ModelShape::Kind::capsule)
      list_of += "radius = " + number(s->size.x()) + ", ends = " + list(points);
    else if (s->kind == ModelShape::Kind::box && s->at.R.isIdentity(0))
      list_of += "size = " + list(s->size) + ", centre = " + list(from_centre(carriers_[c], s->at.p));
    else
      list_of += "corners = " + list(points);
    list_of += "},\n";
  }
  if (prisms > 0)
    note(std::to_string(prisms) + (prisms == 1 ? " cylinder meets" : " cylinders meet") +
         " other bodies as a prism of " + std::to_string(kSides) + " sides; half-spaces exactly");
  if (ellipsoids > 0)
    note(std::to_string(ellipsoids) + (ellipsoids == 1 ? " ellipsoid meets" : " ellipsoids meet") +
         " other bodies as a polytope of 60 corners; half-spaces exactly");
  if (least != most)
    note("friction differs between shapes, " + number(least) + " to " + number(most) +
         ": all contacts between bodies have the largest");
  try {
    spatial::set_hulls(set);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(model_.file + ": a mesh: its corners " + error.what());
  }

  const std::set<Pair> apart = pairs_apart(all, set, poses);
  collisions_ += "\n[[collision]]\nname = \"shapes\"\n";
  if (most > 0) collisions_ += "mu = " + number(most) + "\n";
  collisions_ += "shapes = [\n" + list_of + "]\n";
  std::string pairs;
  for (const Pair& pair : apart)
    if (bodies.contains(static_cast<std::size_t>(pair.first)) &&
        bodies.contains(static_cast<std::size_t>(pair.second)) && pair.first != pair.second)
      pairs += (pairs.empty() ? "" : ", ") + pair_of(name_of(pair.first), name_of(pair.second));
  if (!pairs.empty()) collisions_ += "apart = [" + pairs + "]\n";
}

std::set<SceneText::Pair> SceneText::pairs_apart(const Shapes& all, const spatial::Collision& set,
                                                 const std::vector<spatial::Pose>& poses) {
  std::set<Pair> apart, masked, overlapping;
  const auto in_order = [](int a, int b) { return Pair{std::min(a, b), std::max(a, b)}; };
  for (const auto& [i, k] : model_.apart)
    apart.insert(in_order(carrier_of_[static_cast<std::size_t>(i)], carrier_of_[static_cast<std::size_t>(k)]));
  for (std::size_t c = 1; c < carriers_.size(); ++c)
    if (carriers_[c].parent > 0 || !model_.base_meets_children)
      apart.insert(in_order(static_cast<int>(c), carriers_[c].parent));
  std::set<Pair> met;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = i + 1; k < all.size(); ++k) {
      const auto& [c, x] = all[i];
      const auto& [d, y] = all[k];
      if (c == d) continue;
      const Pair pair = in_order(static_cast<int>(c), static_cast<int>(d));
      (meet(*x, *y) ? met : masked).insert(pair);
      const bool tree = c == 0 || d == 0 ? !model_.base_meets_children : carriers_[c].root == carriers_[d].root;
      if (!tree || apart.contains(pair) || overlapping.contains(pair)) continue;
      if (overlap(set.shapes[i], poses[c], set.shapes[k], poses[d])) overlapping.insert(pair);
    }
  for (const Pair& pair : masked) {
    if (!met.contains(pair))
      apart.insert(pair);
    else if (!apart.contains(pair))
      note("not taken: masks between shapes of " + name_of(pair.first) + " and " + name_of(pair.second) +
           ": all of them meet");
  }
  if (!overlapping.empty()) {
    std::string names;
    for (const Pair& pair : overlapping)
      names += (names.empty() ? "" : ", ") + name_of(pair.first) + " and " + name_of(pair.second);
    note("overlap at the start, and do not meet: " + names);
    apart.insert(overlapping.begin(), overlapping.end());
  }
  return apart;
}

bool SceneText::overlap(const spatial::Shape& x, const spatial::Pose& at_x, const spatial::Shape& y,
                        const spatial::Pose& at_y) {
  const auto ball = [](const spatial::Shape& s, const spatial::Pose& at) {
    const Vector3d middle = s.corners.front();
    double radius = 0;
    for (const Vector3d& p : s.corners) radius = std::max(radius, (p - middle).norm());
    return std::pair<Vector3d, double>{at.x + at.turn(middle), radius + s.radius};
  };
  const auto [p, r] = ball(x, at_x);
  const auto [q, t] = ball(y, at_y);
  if ((p - q).norm() > r + t) return false;
  if (x.polytope() && y.polytope())
    if (const auto known = quick_overlap(x, at_x, y, at_y, 1e-9 * (r + t))) return *known;
  const spatial::TouchPoints points = touch(at_x, x, at_y, y);
  for (int i = 0; i < points.count; ++i)
    if (points.points[static_cast<std::size_t>(i)].gap < -1e-9 * (r + t)) return true;
  return false;
}

}  // namespace orthant::models
