// integrators/event_driven/spatial_arc.h — smooth motion in space over one step, with contact impulses and work.
//
//   The method of chart_runge_kutta.h, with the motion of spatial_motion.h. The impulses of lasting contacts and the
//   work of drives and loads are integrals by the weights of the method.
#pragma once

#include <orthant/integrators/between_events/spatial_motion.h>
#include <orthant/integrators/event_driven/chart_runge_kutta.h>
#include <orthant/integrators/event_driven/stage_quadrature.h>

namespace orthant {

/// The smooth motion of an accepted step, before the event at its end.
struct SpatialArc {
  State start;
  Eigen::VectorXd a;      // at its start
  Eigen::VectorXd force;  // [N, W] likewise, see SpatialFlow
  std::vector<SpatialMode> modes;
  Eigen::VectorXd rest;  // [m] gaps at which contacts rest
  double length = 0;     // [s]; 0: there is none
  void remember(CheckpointData& memory) { memory(start, a, force, modes, rest, length); }
};

class SpatialFlow {
 public:
  /// measures: the work, too.
  SpatialFlow(const SystemOf<Spatial>& system, bool measures);

  /// Forces and power of the last accelerations: three numbers a contact of the scene [N], then the power [W].
  void forces(SpatialMotion& motion, double t, const Eigen::VectorXd& v, const Eigen::VectorXd& a,
              Eigen::VectorXd& to) const;

  /// A step of s in the modes of `motion`; loads and drives as they are until `stop`. a, force: at its start.
  bool step(SpatialMotion& motion, const State& from, const Eigen::VectorXd& a, const Eigen::VectorXd& force, double s,
            double stop, Eigen::VectorXd& q, Eigen::VectorXd& v);
  /// Of that step: each entry over its scale.
  double error(double s, const Eigen::VectorXd& path_scale, const Eigen::VectorXd& v_scale) {
    return rk_.error(s, path_scale, v_scale);
  }
  const Eigen::VectorXd& path() const { return rk_.path(); }  // φ at its end
  const Eigen::VectorXd& push() const { return push_; }       // [N s, J] in it

  /// What within() needs, of an arc in the modes of `motion`.
  bool extend(SpatialMotion& motion, const SpatialArc& arc);
  /// At x ∈ [0, 1] of the arc that was extended: the state, not projected, and the impulses and work until there.
  void within(const SpatialArc& arc, double x, Eigen::VectorXd& q, Eigen::VectorXd& v, Eigen::VectorXd& push);

 private:
  auto acceleration(SpatialMotion& motion, double stop);
  void note_stage(const SpatialMotion& motion, std::size_t stage);

  bool measures_;
  ChartRungeKutta rk_;
  StageQuadrature quadrature_;     // of forces and power
  Eigen::VectorXd push_;           // [N s, J]
  ContinuousExtension extension_;  // of the impulses and the work
  double stage_power_ = 0;         // [W]
  Eigen::VectorXd path_, end_q_, end_v_;
};

}  // namespace orthant
