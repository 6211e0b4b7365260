#include <orthant/integrators/event_driven/spatial_arc.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

/// Of the lasting contacts, three numbers a contact of the scene.
template <class Forces> void forces_to(const SpatialMotion& motion, Forces&& to) {
  for (std::size_t i = 0; i < motion.lasting().size(); ++i) {
    const Index first = 3 * motion.lasting()[i];
    const Tangents tangent = motion.tangent_force(i);
    to[first] = motion.normal_force(i), to[first + 1] = tangent.first, to[first + 2] = tangent.second;
  }
}

}  // namespace

SpatialFlow::SpatialFlow(const SystemOf<Spatial>& system, bool measures)
    : measures_(measures),
      rk_(system.dof()),
      quadrature_(3 * system.contacts() + 1, dormand_prince::kAllStages),
      push_(Eigen::VectorXd::Zero(3 * system.contacts() + 1)) {}

void SpatialFlow::forces(SpatialMotion& motion, double t, const Eigen::VectorXd& v, const Eigen::VectorXd& a,
                         Eigen::VectorXd& to) const {
  to.setZero(push_.size());
  if (measures_) to[to.size() - 1] = motion.power(t, v, a);
  forces_to(motion, to);
}

auto SpatialFlow::acceleration(SpatialMotion& motion, double stop) {
  return [this, &motion, stop](double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a) {
    t = std::min(t, stop);
    if (!motion.accelerations(t, q, v, a)) return false;
    if (measures_) stage_power_ = motion.power(t, v, a);
    return true;
  };
}

/// Forces and power of a stage that has just been evaluated.
void SpatialFlow::note_stage(const SpatialMotion& motion, std::size_t stage) {
  quadrature_.note(stage, [&](auto& column) {
    forces_to(motion, column);
    column[column.size() - 1] = stage_power_;
  });
}

bool SpatialFlow::step(SpatialMotion& motion, const State& from, const Eigen::VectorXd& a, const Eigen::VectorXd& force,
                       double s, double stop, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  stage_power_ = 0;
  quadrature_.begin(force);
  if (!rk_.step(acceleration(motion, stop), from.t, from.q, from.v, a, s, q, v,
                [&](std::size_t stage) { note_stage(motion, stage); }))
    return false;
  quadrature_.end();
  push_ = s * quadrature_.mean();
  return true;
}

bool SpatialFlow::extend(SpatialMotion& motion, const SpatialArc& arc) {
  const auto& [start, a, force, modes, rest, length] = arc;
  const double stop = std::nextafter(start.t + length, -kInf);
  if (!step(motion, start, a, force, length, stop, end_q_, end_v_) ||
      !rk_.extend(acceleration(motion, stop), start.t, start.q, start.v, a, length, end_v_,
                  [&](std::size_t stage) { note_stage(motion, stage); }))
    return false;
  extension_.fit(length, force, quadrature_.differences(), push_);
  return true;
}

void SpatialFlow::within(const SpatialArc& arc, double x, Eigen::VectorXd& q, Eigen::VectorXd& v,
                         Eigen::VectorXd& push) {
  rk_.at(x, path_, v);
  move<Spatial>(arc.start.q, path_, q);
  v += arc.start.v;
  extension_.at(x, push);
}

}  // namespace orthant
