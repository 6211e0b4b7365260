#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/boxes.h>

#include <cmath>
#include <numbers>

namespace orthant {
namespace {

/// A scene under gravity with a floor and one collision set of all bodies.
class OnFloor {
 public:
  explicit OnFloor(const ContactLaw& law) {
    scene_.gravity = {0, 0, -9.81};
    set_.name = "touch", set_.law = law;
  }
  BodyId box(const std::string& name, const Vector3d& size, const Vector3d& position,
             const Eigen::Vector4d& orientation = {1, 0, 0, 0}, double density = 700) {
    const spatial::Solid solid = spatial::box(size);
    return body(name, solid, density, position, orientation, spatial::box_corners(size / 2), 0);
  }
  BodyId capsule(const std::string& name, double radius, double length, const Vector3d& position,
                 const Eigen::Vector4d& orientation) {
    const Vector3d end(0, 0, length / 2);
    return body(name, spatial::capsule(radius, length), 1000, position, orientation, {-end, end}, radius);
  }
  spatial::Body& at(BodyId body) { return scene_.bodies[static_cast<std::size_t>(body)]; }
  spatial::Scene done(double duration, double step) {
    scene_.duration = duration, scene_.step = step;
    scene_.collision(set_);
    return std::move(scene_);
  }

 private:
  BodyId body(const std::string& name, const spatial::Solid& solid, double density, const Vector3d& position,
              const Eigen::Vector4d& orientation, std::vector<Vector3d> corners, double radius) {
    const BodyId id = scene_.body({.name = name,
                                   .mass = density * solid.volume,
                                   .inertia = density * solid.volume * solid.inertia,
                                   .position = position,
                                   .orientation = orientation});
    set_.shapes.push_back({id, std::move(corners), radius});
    for (const spatial::SpherePlane& corner :
         spatial::shape_plane({.name = name + "_floor", .a = id, .law = set_.law}, set_.shapes.back()))
      scene_.contact(corner);
    return id;
  }
  spatial::Scene scene_;
  spatial::Collision set_;
};

std::string numbered(const char* name, int i) { return name + std::to_string(i); }

}  // namespace

spatial::Scene dominoes(const Dominoes& p) {
  const Vector3d size(0.0075, 0.024, 0.048);
  OnFloor floor({.mu = p.mu});
  for (int i = 0; i < static_cast<int>(p.count); ++i)
    floor.box(numbered("domino", i + 1), size, {i * p.spacing, 0, size.z() / 2});
  // It turns about its lower edge in front.
  spatial::Body& first = floor.at(0);
  first.omega = {0, p.push / size.z(), 0};
  first.velocity = first.omega.cross(Vector3d(-size.x() / 2, 0, size.z() / 2));
  return floor.done(1, 1e-4);
}

spatial::Scene card_house(const CardHouse& p) {
  constexpr double kThick = 3e-4, kHigh = 0.089, kWide = 0.0635;
  const double lean = p.lean * std::numbers::pi / 180, s = std::sin(lean), c = std::cos(lean);
  const Vector3d card(kThick, kWide, kHigh);
  const double foot = kHigh * s + kThick * c;   // a leaning card's width on the floor
  const double level = kHigh * c + kThick * s;  // its height
  OnFloor floor({.mu = p.mu});
  const int levels = static_cast<int>(p.levels);
  double z = 0;
  int count = 0;
  for (int l = 0; l < levels; ++l, z += level + kThick) {
    const int tents = levels - l;
    for (int i = 0; i < tents; ++i) {
      const double middle = (2 * i - tents + 1) * foot;
      for (const double side : {-1.0, 1.0})
        floor.box(numbered("card", ++count), card, {middle + side * foot / 2, 0, z + level / 2},
                  quaternions::exponential(Vector3d(0, -side * lean, 0)).normalized());
    }
    for (int i = 0; i + 1 < tents; ++i)
      floor.box(numbered("card", ++count), {kHigh, kWide, kThick},
                {(2 * i - tents + 2) * foot, 0, z + level + kThick / 2});
  }
  return floor.done(0.5, 5e-4);
}

spatial::Scene kapla_tower(const KaplaTower& p) {
  constexpr double kLong = 0.117, kWide = 0.0234, kThick = 0.0078;
  OnFloor floor({.mu = p.mu});
  for (int layer = 0; layer < static_cast<int>(p.layers); ++layer)
    for (const int side : {-1, 1}) {
      const double off = side * (kLong - kWide) / 2, z = (layer + 0.5) * kThick;
      const bool along = layer % 2 == 0;
      floor.box(numbered("plank", 2 * layer + (side + 3) / 2),
                along ? Vector3d(kLong, kWide, kThick) : Vector3d(kWide, kLong, kThick),
                along ? Vector3d(0, off, z) : Vector3d(off, 0, z));
    }
  return floor.done(1, 2e-3);
}

spatial::Scene box_pyramid(const BoxPyramid& p) {
  const int base = static_cast<int>(p.base);
  OnFloor floor({.mu = p.mu});
  int count = 0;
  for (int layer = 0; layer < base; ++layer)
    for (int i = 0; i < base - layer; ++i)
      for (int j = 0; j < base - layer; ++j) {
        const double middle = 0.5 * (base - layer - 1);
        floor.box(numbered("box", ++count), Vector3d::Constant(p.size),
                  {1.1 * p.size * (i - middle), 1.1 * p.size * (j - middle), p.size * (layer + 0.5)});
      }
  return floor.done(1, 2e-3);
}

spatial::Scene capsules(const Capsules& p) {
  constexpr double kRadius = 0.03, kLength = 0.1;
  OnFloor floor({.mu = p.mu, .e = p.e});
  for (int i = 0; i < static_cast<int>(p.count); ++i) {
    // Golden angles: no two of them are parallel.
    const double angle = 2.399963229728653 * i, lean = std::numbers::pi / 2 * (0.5 + 0.5 * std::sin(1.7 * i));
    const Eigen::Vector4d turn = quaternions::exponential(Vector3d(0, 0, angle));
    floor.capsule(numbered("capsule", i + 1), kRadius, kLength,
                  {0.02 * std::cos(angle), 0.02 * std::sin(angle), kRadius + kLength / 2 + 0.01 + 0.17 * i},
                  quaternions::product(turn, quaternions::exponential(Vector3d(lean, 0, 0))).normalized());
  }
  return floor.done(2, 2e-3);
}

}  // namespace orthant
