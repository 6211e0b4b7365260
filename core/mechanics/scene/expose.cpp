#include <orthant/core/mechanics/scene/expose.h>
#include <orthant/core/mechanics/scene/scene.h>

#include <map>

namespace orthant {
namespace {

/// What one body shows to another one: solids, and where their exposures go.
struct Facing {
  std::vector<Solid> solids;
  std::vector<std::vector<Exposed*>> wanted;  // of each polygon

  void add(const Polygon& p, Exposed& e) {
    for (std::size_t k = solids.size(); k-- > 0;)
      if (solids[k].polygon != nullptr && *solids[k].polygon == p) return wanted[k].push_back(&e);
    solids.push_back({&p}), wanted.push_back({&e});
  }
  void add(const Vector2d& point, const Vector2d& normal) {
    for (std::size_t k = solids.size(); k-- > 0;)
      if (solids[k].polygon == nullptr && solids[k].point == point && solids[k].normal == normal) return;
    solids.push_back({nullptr, point, normal}), wanted.emplace_back();
  }
  void set() {
    for (std::size_t k = 0; k < solids.size(); ++k) {
      if (wanted[k].empty()) continue;
      const Exposed e = exposure(solids, k);
      for (Exposed* one : wanted[k]) *one = e;
    }
  }
};

}  // namespace

void expose(Scene& scene) {
  std::map<std::pair<BodyId, BodyId>, Facing> facing;  // of (body, the one that it faces)
  for (Contact& contact : scene.contacts)
    if (auto* pair = std::get_if<PolygonPolygon>(&contact)) {
      facing[{pair->a, pair->b}].add(pair->corners_a, pair->exposed_a);
      facing[{pair->b, pair->a}].add(pair->corners_b, pair->exposed_b);
    } else if (auto* disc = std::get_if<DiscPolygon>(&contact)) {
      facing[{disc->b, disc->a}].add(disc->corners, disc->exposed);
    }
  if (!facing.empty())
    for (const Contact& contact : scene.contacts) {
      const auto wall = [&](const auto& c) {
        if (const auto found = facing.find({c.b, c.a}); found != facing.end())
          found->second.add(c.wall_point, c.normal);
      };
      if (const auto* corner = std::get_if<CornerWall>(&contact)) wall(*corner);
      if (const auto* disc = std::get_if<DiscWall>(&contact)) wall(*disc);
    }
  for (auto& [bodies, one] : facing) one.set();
  for (Collision& c : scene.collisions) {
    std::map<BodyId, Facing> own;
    for (Shape& s : c.shapes)
      if (!s.corners.empty()) own[s.body].add(s.corners, s.exposed);
    for (const Contact& contact : scene.contacts) {
      const auto wall = [&](const auto& w) {
        const auto found = own.find(w.b);
        if (found != own.end() && w.a != w.b) found->second.add(w.wall_point, w.normal);
      };
      if (const auto* corner = std::get_if<CornerWall>(&contact)) wall(*corner);
      if (const auto* disc = std::get_if<DiscWall>(&contact)) wall(*disc);
    }
    for (auto& [body, one] : own) one.set();
  }
}

}  // namespace orthant
