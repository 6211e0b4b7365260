// core/scenes/cross_slope.h — block sent across a slope: Coulomb's disc, and pyramids, which bend its path.
//
//   Disc, k = μ / tan α > 1: it stops after T = k v₀ / (g sin α (k² − 1)), v₀² / (4 g sin α (k² − 1)) further down and
//   2 k v₀² / (g sin α (4 k² − 1)) across. For the defaults T = .271831464492014951 s, .0679578661230037377 m down,
//   .217465171593611961 m across.
//   Pyramid of n sides with the corners d_j (solvers/cones/facets.h): the friction is −μ N d of the corner d that is
//   least along the slip, so that the path consists of parabolas. Where two corners are equal and either one drives the
//   slip to the other, the friction is between them and the path is straight. All pieces are in closed form.
// Source: Stewart & Trinkle, Int. J. Numer. Meth. Engng 39 (1996), on pyramids; the disc by φ̇ = −g sin α sin φ / v of
// the angle φ between slip and the line of descent.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

#include <optional>

namespace orthant {

struct CrossSlope {
  double slope = 0.52359877559829887, mu = 1.1547005383792515;  // [rad], μ: k = 2
  double speed = 2, g = 9.81;                                   // [m/s], [m/s²]
  double turn = 0;  // [rad] of gravity and of the start, against the contact's tangents
};

/// The slope is the plane z = 0; at turn = 0 the start is along x, the descent along −y.
spatial::Scene cross_slope(const CrossSlope& p = {});

struct SlopeStop {
  double time = 0;          // [s]
  Vector3d place{0, 0, 0};  // [m]
};
/// Empty: it does not stop.
std::optional<SlopeStop> stop_on_slope(const CrossSlope& p);
std::optional<SlopeStop> stop_on_slope(const CrossSlope& p, int sides);

}  // namespace orthant
