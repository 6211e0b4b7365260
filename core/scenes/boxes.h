// core/scenes/boxes.h — boxes on a floor in space: dominoes, a house of cards, a tower of planks, a pyramid; capsules.
//
//   Every two of them may touch: one collision set, and the floor z = 0 under it.
//   kapla_tower: layers of two planks, crosswise; box_pyramid: square layers of n², (n − 1)², … cubes.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct Dominoes {
  double count = 12, spacing = 0.03, mu = 0.3, push = 1;  // [m, m/s of the first one's top]
  template <class V> void visit(V&& v) {
    v("count", count, 1.0, 1000.0), v("spacing", spacing, 8e-3, 1.0), v("mu", mu, 0.0, 1e6);
    v("push", push, -1e2, 1e2);
  }
};
spatial::Scene dominoes(const Dominoes& p = {});

struct CardHouse {
  double levels = 2, lean = 20, mu = 0.7;  // [degrees from the vertical]
  template <class V> void visit(V&& v) {
    v("levels", levels, 1.0, 20.0), v("lean", lean, 5.0, 40.0), v("mu", mu, 0.0, 1e6);
  }
};
spatial::Scene card_house(const CardHouse& p = {});

struct KaplaTower {
  double layers = 5, mu = 0.4;
  template <class V> void visit(V&& v) { v("layers", layers, 1.0, 1000.0), v("mu", mu, 0.0, 1e6); }
};
spatial::Scene kapla_tower(const KaplaTower& p = {});

struct BoxPyramid {
  double base = 3, size = 0.1, mu = 0.5;  // [cubes, m]
  template <class V> void visit(V&& v) {
    v("base", base, 1.0, 100.0), v("size", size, 1e-3, 1e3), v("mu", mu, 0.0, 1e6);
  }
};
spatial::Scene box_pyramid(const BoxPyramid& p = {});

struct Capsules {
  double count = 12, mu = 0.3, e = 0;
  template <class V> void visit(V&& v) { v("count", count, 1.0, 1e5), v("mu", mu, 0.0, 1e6), v("e", e, 0.0, 1.0); }
};
spatial::Scene capsules(const Capsules& p = {});

}  // namespace orthant
