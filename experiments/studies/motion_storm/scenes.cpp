#include "experiments/studies/motion_storm/scenes.h"

#include "experiments/studies/motion_storm/maker.h"
#include "experiments/studies/motion_storm/spatial_maker.h"

#include <array>
#include <cmath>

namespace orthant::motion_storm {
namespace {

template <class Maker> struct Kind {
  std::string_view name;
  void (*make)(Maker&);
};
constexpr std::array kKinds{Kind<Maker>{"dropped", dropped},
                            Kind<Maker>{"stack", stack},
                            Kind<Maker>{"seams", seams},
                            Kind<Maker>{"side by side", side_by_side},
                            Kind<Maker>{"spinning", spinning},
                            Kind<Maker>{"wedge", wedge},
                            Kind<Maker>{"ladder of masses", ladder_of_masses},
                            Kind<Maker>{"billiards", billiards},
                            Kind<Maker>{"belt", belt},
                            Kind<Maker>{"shaken", shaken},
                            Kind<Maker>{"chain", linked_chain},
                            Kind<Maker>{"pin contact", pin_contact},
                            Kind<Maker>{"hinged plank", hinged_plank},
                            Kind<Maker>{"four-bar", four_bar},
                            Kind<Maker>{"slider-crank", slider},
                            Kind<Maker>{"redundant", redundant},
                            Kind<Maker>{"rail", rail},
                            Kind<Maker>{"ropes", ropes},
                            Kind<Maker>{"jammed", jammed},
                            Kind<Maker>{"rotor", rotor},
                            Kind<Maker>{"mixed", mixed}};
constexpr std::array kFurther{Kind<Maker>{"gears", gears}, Kind<Maker>{"terrain", terrain}};
using InSpace = Kind<SpatialMaker>;
constexpr std::array kSpatialKinds{
    InSpace{"dropped", dropped},     InSpace{"sliding", sliding},       InSpace{"spinning", spinning},
    InSpace{"spheres", spheres},     InSpace{"wedge", wedge},           InSpace{"billiards", billiards},
    InSpace{"moving surface", belt}, InSpace{"shaken", shaken},         InSpace{"searched pairs", searched},
    InSpace{"chain", chain},         InSpace{"one joint", one_joint},   InSpace{"loop", loop},
    InSpace{"slider-crank", slider}, InSpace{"clearances", clearances}, InSpace{"rail", rail},
    InSpace{"ropes", ropes},         InSpace{"jammed", jammed},         InSpace{"gears", gears},
    InSpace{"redundant", redundant}, InSpace{"tumbling", tumbling},     InSpace{"mixed", mixed}};

template <class Space> constexpr auto& all_kinds() {
  if constexpr (kPlanar<Space>)
    return kKinds;
  else
    return kSpatialKinds;
}
template <class Space> constexpr auto kNames = [] {
  std::array<std::string_view, all_kinds<Space>().size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = all_kinds<Space>()[i].name;
  return names;
}();

template <class Space> auto kind_of(std::uint64_t k) {
  const auto& kinds_ = all_kinds<Space>();
  if constexpr (kPlanar<Space>)
    if (of_further_kinds(k / kinds_.size())) return kFurther[k % kFurther.size()];
  return kinds_[k % kinds_.size()];
}

std::uint64_t scrambled(std::uint64_t x) {  // splitmix64: neighbouring numbers give unrelated scenes
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9, x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

double spin(double omega) { return std::abs(omega); }
double spin(const Vector3d& omega) { return omega.norm(); }

template <class Space>
double fastest(const SceneOf<Space>& scene) {  // [m/s] at the start, at half a metre from the centre
  double speed = 1;
  for (const auto& b : scene.bodies) speed = std::max(speed, b.velocity.norm() + 0.5 * spin(b.omega));
  return speed;
}

}  // namespace

template <class Space> std::span<const std::string_view> kinds() { return kNames<Space>; }
template std::span<const std::string_view> kinds<Planar>();
template std::span<const std::string_view> kinds<Spatial>();

template <class Space> RandomSceneOf<Space> random_scene(std::uint64_t seed, std::uint64_t k) {
  Random random(scrambled(seed) ^ scrambled(k + 0x1234567));
  const auto kind = kind_of<Space>(k);
  std::conditional_t<kPlanar<Space>, Maker, SpatialMaker> m(random);
  kind.make(m);
  // Steps in which the fastest point moves some 5 mm, at least 50 and at most 600 of them.
  m.scene.duration = m.log_uniform(kind.name == "spinning" ? 0.3 : 0.05, kind.name == "spinning" ? 1 : 0.6);
  m.scene.step = std::clamp(0.005 / fastest<Space>(m.scene), m.scene.duration / 600, m.scene.duration / 50);
  check(m.scene);
  return {std::string(kind.name), std::move(m.scene)};
}
template RandomSceneOf<Planar> random_scene<Planar>(std::uint64_t, std::uint64_t);
template RandomSceneOf<Spatial> random_scene<Spatial>(std::uint64_t, std::uint64_t);

}  // namespace orthant::motion_storm
