#include <orthant/core/scenes/chain.h>

#include <cmath>

namespace orthant {
namespace {

constexpr ChainExact kExact[] = {
    {2, 5, {-0.6271867050666687, -1.3013155502094944, 0}, {-1.5507784694704703, -1.0759127348128774}},
    {3, 3, {0.494206978808615, 1.1327211804235282, 1.4028266150334647}, {2.3658297501816095, -1.4717232864086942}},
};

}  // namespace

std::span<const ChainExact> chain_exact() { return kExact; }

Scene chain(const Chain& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 5, s.step = 1e-3;
  const Vector2d link(std::sin(p.angle), -std::cos(p.angle));
  for (int i = 0; i < p.links; ++i) {
    const auto mass = s.body({.position = (i + 1) * link});
    s.joint(Distance{"", mass, i == 0 ? kGround : mass - 1, {0, 0}, {0, 0}, 1});
  }
  return s;
}

}  // namespace orthant
