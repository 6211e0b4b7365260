// experiments/runs/trajectory.h — a run as a table: one column list for CSV files, summaries and plots.
#pragma once

#include <orthant/integrators/reactions.h>

#include <string>
#include <vector>

namespace orthant {

/// t, then x, y, theta, vx, vy, omega of each body, then gap, impulse_n, impulse_t of each contact (impulses summed
/// since the row before), then energy, joint_residual, penetration, lcp_residual, lcp_iterations of the step. SI units.
std::vector<std::string> trajectory_columns(const Scene& scene);

/// Appends one row in that order.
void append_row(const System& system, const RunSample& moment, std::vector<double>& table);

/// In space: t, then x, y, z [m] of the centre of mass, qw, qx, qy, qz (unit quaternion, body → world), vx, vy, vz
/// [m/s], wx, wy, wz [rad/s] in the world, of each body, then gap, impulse_n, impulse_t1, impulse_t2 of each contact
/// (t1 and t2 of spatial/contact_rows.h), then as in the plane.
std::vector<std::string> trajectory_columns(const spatial::Scene& scene);
void append_row(const SystemOf<Spatial>& system, const RunSampleOf<Spatial>& moment, std::vector<double>& table);

/// The part of the columns and of a row that belongs to the bodies.
template <class Space> inline constexpr std::size_t kBodyColumns = kPlanar<Space> ? 6 : 13;
std::vector<std::string> body_columns(const Scene& scene);
std::vector<std::string> body_columns(const spatial::Scene& scene);
void append_bodies(const System& system, const State& x, std::vector<double>& row);
void append_bodies(const SystemOf<Spatial>& system, const State& x, std::vector<double>& row);

/// NAME.force_x, force_y [N] and NAME.moment [N m] of each joint; in space force_z, too, and moment_x, moment_y,
/// moment_z (integrators/reactions.h).
std::vector<std::string> reaction_columns(const Scene& scene);
std::vector<std::string> reaction_columns(const spatial::Scene& scene);
/// Whether these are the columns of a run of the scene, with reactions or without.
template <class Scene> bool columns_of_run(const Scene& scene, const std::vector<std::string>& columns) {
  auto known = trajectory_columns(scene);
  if (columns == known) return true;
  for (std::string& column : reaction_columns(scene)) known.push_back(std::move(column));
  return columns == known;
}
/// Appends their row: means since the moment before.
template <class Space>
void append_reactions(ReactionsOf<Space>& reactions, const RunSampleOf<Space>& moment, std::vector<double>& table) {
  for (const ReactionOf<Space>& one : reactions.next(moment)) {
    table.insert(table.end(), one.force.begin(), one.force.end());
    table.insert(table.end(), one.moment.begin(), one.moment.end());
  }
}

/// The free coordinates of joints in space: NAME.angle [rad], followed through full turns from record to record, and
/// NAME.displacement [m].
class JointCoordinates {
 public:
  explicit JointCoordinates(const SystemOf<Spatial>& system);
  const std::vector<std::string>& names() const { return names_; }
  /// The values at the state, which comes after the one before.
  const std::vector<double>& at(const State& x);

 private:
  const SystemOf<Spatial>& system_;
  KinematicsOf<Spatial> poses_;
  std::vector<std::string> names_;
  std::vector<spatial::Coordinate> coordinates_;
  std::vector<spatial::Unwrapped> turns_;
  std::vector<double> values_;
};

/// The table as CSV text, numbers in their shortest exact form.
std::string to_csv(const std::vector<std::string>& columns, const std::vector<double>& table);

}  // namespace orthant
