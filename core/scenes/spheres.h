// core/scenes/spheres.h — piles in space: N spheres dropped into a square well, bodies poured into a box; for growth.
//
//   The pile in space: radii within a tenth of each other, and places shifted by up to a tenth of a radius (a fixed
//   pattern, no random numbers), so that no sphere balances on another. About ∛N spheres stand along each wall.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/core/scenes/motion.h>

#include <array>
#include <string_view>

namespace orthant {

struct Spheres {
  int count = 64;
  double radius = 0.05;  // of the largest [m]
  double mu = 0.3;
  double e = 0;
  double g = kGravity;  // [m/s²]

  template <class V> void visit(V&& v) {
    v("count", count, 1, 1000000), v("radius", radius, 1e-3, 1e3), v("mu", mu, 0.0, 1e6), v("e", e, 0.0, 1.0),
        v("g", g, 0.0, 1e3);
  }
};

/// Spheres of 1000 kg/m³. Contacts 5i … 5i + 4 are sphere i with the floor and the four walls; one collision set.
spatial::Scene spheres(const Spheres& p = {});

// Pour: spheres, boxes or capsules poured into a box, to measure growth with their number up to a million.
//
//   Bodies start in square layers, each shifted by half a place against the one below, so that a body comes to rest on
//   four others. Sizes and orientations follow a fixed pattern, no random numbers. About ∛N bodies stand along each
//   wall. Floor and walls are shapes of the ground in the one collision set: no listed contacts, 0.6 kB a body in the
//   scene, where a well of listed planes takes 3 kB (spheres.h).
//   apart = 1.1, spread = 0.1: a pour that settles in some tenths of a second; 1.01 and 0.01: a packing that settles
//   within some steps.
struct Pour {
  enum class Bodies { spheres, boxes, capsules, mixed };  // mixed: by turns
  static constexpr std::array<std::string_view, 4> kBodiesNames = {"spheres", "boxes", "capsules", "mixed"};

  int count = 64;
  Bodies bodies = Bodies::spheres;
  double radius = 0.05;  // of the largest sphere [m]; boxes and capsules fit into it
  double apart = 1.1;    // places, in units of its diameter; ≥ 1
  double spread = 0.1;   // of the sizes, in [0, 0.5]
  double mu = 0.3;
  double g = kGravity;  // [m/s²]
};

/// Bodies of 1000 kg/m³. Shapes 0 … 4 of the collision set are floor and walls.
spatial::Scene pour(const Pour& p = {});

}  // namespace orthant
