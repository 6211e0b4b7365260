// experiments/studies/motion_storm/closed_rows.h — constraint Jacobians of joints and closed contacts at a state, as
// dense vectors; in the plane without the library's rows.
//
//   Planar rows are rates of points: body b's point that is at P moves with v_b + ω_b × (P − x_b). A row along u at P
//   is u · (rate of a's point − rate of b's point). Contacts have n from b to a and t = (n_y, −n_x).
//   Two polygons touch along the face with the largest separation. Its points are the other polygon's corners over this
//   face, and the ends of the face over the other's opposite face. Points with a gap above `gap` are left out.
#pragma once

#include "experiments/studies/motion_storm/space.h"

#include <orthant/core/mechanics/dynamics/state.h>

#include <vector>

namespace orthant::motion_storm {

struct ClosedContactRows {
  int contact = 0;
  ContactLaw law;
  double gap = 0;                          // [m, rad]
  Eigen::VectorXd normal;                  // row of the gap's rate
  std::vector<Eigen::VectorXd> tangents;   // rows of slip [m/s], one per tangential direction; zero where there is none
  std::vector<Eigen::VectorXd> direction;  // of each tangent: in the world; in the plane 1, along the tangent
  Eigen::VectorXd slip;                    // [m/s] against b's surface, which may move
};

struct ClosedRows {
  Eigen::VectorXd inverse_mass;         // diagonal
  std::vector<Eigen::VectorXd> joints;  // one a row
  std::vector<ClosedContactRows> contacts;

  Eigen::Index dof() const { return inverse_mass.size(); }
};

/// Contacts count as closed up to `gap` [m]. Listed ones only.
ClosedRows closed_rows(const Scene& scene, const State& x, double gap);
ClosedRows closed_rows(const spatial::Scene& scene, const State& x, double gap);

}  // namespace orthant::motion_storm
