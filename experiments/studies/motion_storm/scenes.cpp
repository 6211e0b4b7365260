#include "experiments/studies/motion_storm/scenes.h"

#include "experiments/studies/motion_storm/maker.h"

#include <array>
#include <cmath>

namespace orthant::motion_storm {
namespace {

using Make = void (*)(Maker&);
struct Kind {
  std::string_view name;
  Make make;
};
constexpr std::array kKinds{Kind{"dropped", dropped},
                            Kind{"stack", stack},
                            Kind{"seams", seams},
                            Kind{"side by side", side_by_side},
                            Kind{"spinning", spinning},
                            Kind{"wedge", wedge},
                            Kind{"ladder of masses", ladder_of_masses},
                            Kind{"billiards", billiards},
                            Kind{"belt", belt},
                            Kind{"shaken", shaken},
                            Kind{"chain", linked_chain},
                            Kind{"pin contact", pin_contact},
                            Kind{"hinged plank", hinged_plank},
                            Kind{"four-bar", four_bar},
                            Kind{"slider-crank", slider},
                            Kind{"redundant", redundant},
                            Kind{"rail", rail},
                            Kind{"ropes", ropes},
                            Kind{"jammed", jammed},
                            Kind{"rotor", rotor},
                            Kind{"mixed", mixed}};
constexpr auto kNames = [] {
  std::array<std::string_view, kKinds.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kKinds[i].name;
  return names;
}();

std::uint64_t scrambled(std::uint64_t x) {  // splitmix64: neighbouring numbers give unrelated scenes
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9, x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

double fastest(const Scene& scene) {  // [m/s] at the start, at half a metre from the centre
  double speed = 1;
  for (const Body& b : scene.bodies) speed = std::max(speed, b.velocity.norm() + 0.5 * std::abs(b.omega));
  return speed;
}

}  // namespace

std::span<const std::string_view> kinds() { return kNames; }

RandomScene random_scene(std::uint64_t seed, std::uint64_t k) {
  Random random(scrambled(seed) ^ scrambled(k + 0x1234567));
  const Kind& kind = kKinds[k % kKinds.size()];
  Maker m(random);
  kind.make(m);
  // Steps in which the fastest point moves some 5 mm, at least 50 and at most 600 of them.
  m.scene.duration = m.log_uniform(kind.name == "spinning" ? 0.3 : 0.05, kind.name == "spinning" ? 1 : 0.6);
  m.scene.step = std::clamp(0.005 / fastest(m.scene), m.scene.duration / 600, m.scene.duration / 50);
  check(m.scene);
  return {std::string(kind.name), std::move(m.scene)};
}

}  // namespace orthant::motion_storm
