// Slopes of all equations of a step in space: see spatial_step_linearization.h.
#include <orthant/integrators/derivatives/spatial_step_linearization.h>

#include <algorithm>
#include <cmath>

namespace orthant {

void SpatialStepLinearization::append_turn_slopes(std::vector<Slope>& to, Index of, Index by,
                                                  const Eigen::Matrix3d& block) const {
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j)
      if (block(i, j) != 0) to.push_back({of + i, by + j, block(i, j)});
}

// Poses at q_a, masses and gyroscopic impulses in r₁, velocities and poses at the end. Of a start (δq, δv).
void SpatialStepLinearization::linearize_frames() {
  const Index dof = system_.dof();
  const double h = step_.h, theta = options_.theta;
  to_middle_.clear(), end_by_start_.clear(), end_by_w_.clear();
  for (Index body = 0; body < system_.bodies(); ++body) {
    const Index first = Spatial::kVelocities * body, turn = first + 3;
    for (Index i = first; i < turn; ++i) {
      to_middle_.push_back({i, i, 1}), to_middle_.push_back({i, dof + i, theta * h});
      by_start_.push_back({i, dof + i, -system_.mass()[i]});
      end_by_start_.push_back({i, i, 1}), end_by_start_.push_back({i, dof + i, h * (1 - theta)});
      end_by_w_.push_back({i, i, h * theta}), end_by_w_.push_back({dof + i, i, 1});
    }
    const TurnSlope& t = turns_[at(body)];
    append_turn_slopes(to_middle_, turn, turn, t.middle_by_turn);
    append_turn_slopes(to_middle_, turn, dof + turn, t.middle_by_omega);
    Eigen::Matrix3d by_omega, by_w;
    const Vector3d moments = rotation<Spatial>(system_.mass(), body);
    t.of_impulse(moments, by_omega, by_w);
    append_turn_slopes(by_start_, turn, dof + turn, -by_omega - Eigen::Matrix3d(moments.asDiagonal()));
    append_turn_slopes(end_by_start_, dof + turn, dof + turn, t.omega_by_omega);
    append_turn_slopes(end_by_w_, dof + turn, turn, t.omega_by_w);
    append_turn_slopes(end_by_start_, turn, turn, t.end_by_turn);
    append_turn_slopes(end_by_start_, turn, dof + turn, t.end_by_omega + t.end_by_end * t.omega_by_omega);
    append_turn_slopes(end_by_w_, turn, turn, t.end_by_end * t.omega_by_w);
  }
}

void SpatialStepLinearization::add_row(const Row& row, const RowSlopeOf<Spatial>& slope, double force,
                                       const Eigen::VectorXd& u, double e, Index out) {
  for (const Slope& s : slope) {
    by_pose_.push_back({s.of, s.by, -force * s.value});
    by_pose_.push_back({out, s.by, u[s.of] * s.value});
  }
  const Index dof = system_.dof();
  if (e != 0) each_entry(row, [&](Index place, double j) { by_start_.push_back({out, dof + place, e * j}); });
}

bool SpatialStepLinearization::jumps(std::size_t k) const {
  return step_.places[k].tangent >= 0 && !system_.law(step_.contacts[k]).surface.orthotropic() &&
         tangents_jump(spatial::direction_of(surfaces_[k].rows[0]));
}

void SpatialStepLinearization::linearize_rows() {
  const Index dof = system_.dof(), joints = system_.joint_rows();
  const double a = options_.theta;
  const Eigen::VectorXd& v = step_.before.v;
  const auto& scene = system_.scene();
  std::vector<RowSlopeOf<Spatial>> slopes(at(joints));
  for (std::size_t j = 0; j < scene.joints.size(); ++j)
    slopes_of(scene.joints[j], terms_.at, slopes.data() + system_.first_row(j));
  x_ = v / a + change_;
  for (Index i = 0; i < joints; ++i) add_row(terms_.G[at(i)], slopes[at(i)], joint_[i], x_, 1 / a - 1, dof + i);
  SurfaceSlopes all;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (step_.places[k].normal < 0) continue;
    slopes_of(system_, step_.contacts[k], terms_.at, all);
    const auto turns = [](const Slope& s) { return s.of % Spatial::kVelocities < 3 && std::abs(s.value) > kTurn; };
    if (jumps(k) && std::ranges::any_of(all.rows[0], turns)) jumping_.push_back(step_.contacts[k]);
    each_row(k, [&](Index row, std::size_t i) {
      x_ = w_ + e_[row] * v;
      add_row(rows_[at(row)], all.rows[i], step_.z[row], x_, e_[row], dof + joints + row);
      for (const Slope& s : all.belt)
        if (s.of == static_cast<Index>(i)) by_pose_.push_back({dof + joints + row, s.by, -(1 + e_[row]) * s.value});
    });
  }
  for (Index i = step_.first_friction; i < step_.rows; ++i) {
    RowSlopeOf<Spatial>& slope = all.rows[0];
    slope_of(scene.frictions[at(i - step_.first_friction)].of, terms_.at, slope);
    add_row(rows_[at(i)], slope, step_.z[i], w_, 0, dof + joints + i);
  }
}

}  // namespace orthant
