#include "experiments/runs/trajectory.h"

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/spatial/friction_impulse.h>
#include <orthant/core/support/options.h>

namespace orthant {

namespace {

double size_of_tangent(double impulse) { return std::abs(impulse); }
double size_of_tangent(const Tangents& impulse) { return size_of(impulse); }

/// Of each collision the least gap, the sums of impulses.
template <class Space>
void append_collisions(const SystemOf<Space>& system, const RunSampleOf<Space>& moment, std::vector<double>& table) {
  for (std::size_t c = 0; c + 1 < system.pairs().size(); ++c) {
    double gap = kInf, normal = 0, tangent = 0;
    for (int i = system.listed() + system.pairs()[c]; i < system.listed() + system.pairs()[c + 1]; ++i) {
      const auto& impulse = moment.impulses[static_cast<std::size_t>(i)];
      gap = std::min(gap, moment.gaps[i]);
      normal += impulse.normal, tangent += size_of_tangent(impulse.tangent);
    }
    table.insert(table.end(), {gap, normal, tangent});
  }
}

}  // namespace

std::vector<std::string> body_columns(const Scene& scene) {
  std::vector<std::string> columns;
  for (const Body& body : scene.bodies)
    for (const char* part : {".x", ".y", ".theta", ".vx", ".vy", ".omega"}) columns.push_back(body.name + part);
  return columns;
}

std::vector<std::string> body_columns(const spatial::Scene& scene) {
  std::vector<std::string> columns;
  for (const spatial::Body& body : scene.bodies)
    for (const char* part : {".x", ".y", ".z", ".qw", ".qx", ".qy", ".qz", ".vx", ".vy", ".vz", ".wx", ".wy", ".wz"})
      columns.push_back(body.name + part);
  return columns;
}

void append_bodies(const System& /*system*/, const State& x, std::vector<double>& row) {
  for (Index i = 0; i < x.q.size(); i += 3) {
    row.insert(row.end(), x.q.data() + i, x.q.data() + i + 3);
    row.insert(row.end(), x.v.data() + i, x.v.data() + i + 3);
  }
}

void append_bodies(const SystemOf<Spatial>& system, const State& x, std::vector<double>& row) {
  for (Index i = 0; i < system.bodies(); ++i) {
    const spatial::Body& body = system.scene().bodies[static_cast<std::size_t>(i)];
    const auto centre = place_of<Spatial>(x.q, i);
    const auto axes = quaternion(x.q, i);  // of the principal axes
    const Eigen::Vector4d q = quaternions::product(axes, quaternions::inverse(body.axes));
    const auto v = translation<Spatial>(x.v, i);
    const Vector3d omega = quaternions::matrix_of(axes) * rotation<Spatial>(x.v, i);
    for (const double c : centre) row.push_back(c);
    for (const double c : q) row.push_back(c);
    for (const double c : v) row.push_back(c);
    for (const double c : omega) row.push_back(c);
  }
}

std::vector<std::string> trajectory_columns(const Scene& scene) {
  std::vector<std::string> columns = {"t"};
  for (std::string& column : body_columns(scene)) columns.push_back(std::move(column));
  for (const Contact& contact : scene.contacts)
    for (const char* part : {".gap", ".impulse_n", ".impulse_t"})
      columns.push_back(std::visit([](const auto& c) { return c.name; }, contact) + part);
  for (const Collision& collision : scene.collisions)
    for (const char* part : {".gap", ".impulse_n", ".impulse_t"}) columns.push_back(collision.name + part);
  for (const JointFriction& friction : scene.frictions) columns.push_back(friction.name + ".impulse");
  columns.insert(columns.end(), {"energy", "joint_residual", "penetration", "lcp_residual", "lcp_iterations"});
  return columns;
}

void append_row(const System& system, const RunSample& moment, std::vector<double>& table) {
  const State& x = moment.state;
  table.push_back(x.t);
  append_bodies(system, x, table);
  for (int i = 0; i < system.listed(); ++i) {
    const Impulse& impulse = moment.impulses[static_cast<std::size_t>(i)];
    table.insert(table.end(), {moment.gaps[i], impulse.normal, impulse.tangent});
  }
  append_collisions(system, moment, table);
  table.insert(table.end(), moment.frictions.begin(), moment.frictions.end());
  const StepReport& r = moment.report;
  table.insert(table.end(), {energy(system, x), r.joint_residual, r.penetration, r.lcp_residual,
                             static_cast<double>(r.lcp_iterations)});
}

std::vector<std::string> trajectory_columns(const spatial::Scene& scene) {
  std::vector<std::string> columns = {"t"};
  for (std::string& column : body_columns(scene)) columns.push_back(std::move(column));
  for (const spatial::Contact& contact : scene.contacts)
    for (const char* part : {".gap", ".impulse_n", ".impulse_t1", ".impulse_t2"})
      columns.push_back(std::visit([](const auto& c) { return c.name; }, contact) + part);
  for (const spatial::Collision& collision : scene.collisions)
    for (const char* part : {".gap", ".impulse_n", ".impulse_t"}) columns.push_back(collision.name + part);
  for (const spatial::JointFriction& friction : scene.frictions) columns.push_back(friction.name + ".impulse");
  columns.insert(columns.end(), {"energy", "joint_residual", "penetration", "lcp_residual", "lcp_iterations"});
  return columns;
}

void append_row(const SystemOf<Spatial>& system, const RunSampleOf<Spatial>& moment, std::vector<double>& table) {
  const State& x = moment.state;
  table.push_back(x.t);
  append_bodies(system, x, table);
  for (int i = 0; i < system.listed(); ++i) {
    const auto& impulse = moment.impulses[static_cast<std::size_t>(i)];
    const Tangents tangent = along_unit_tangents(system.law(i), impulse.tangent);
    table.insert(table.end(), {moment.gaps[i], impulse.normal, tangent.first, tangent.second});
  }
  append_collisions(system, moment, table);
  table.insert(table.end(), moment.frictions.begin(), moment.frictions.end());
  const StepReport& r = moment.report;
  table.insert(table.end(), {energy(system, x), r.joint_residual, r.penetration, r.lcp_residual,
                             static_cast<double>(r.lcp_iterations)});
}

std::vector<std::string> reaction_columns(const Scene& scene) {
  std::vector<std::string> columns;
  for (const Joint& joint : scene.joints)
    for (const char* part : {".force_x", ".force_y", ".moment"})
      columns.push_back(std::visit([](const auto& j) { return j.name; }, joint) + part);
  return columns;
}
std::vector<std::string> reaction_columns(const spatial::Scene& scene) {
  std::vector<std::string> columns;
  for (const spatial::Joint& joint : scene.joints)
    for (const char* part : {".force_x", ".force_y", ".force_z", ".moment_x", ".moment_y", ".moment_z"})
      columns.push_back(std::visit([](const auto& j) { return j.name; }, joint) + part);
  return columns;
}

JointCoordinates::JointCoordinates(const SystemOf<Spatial>& system) : system_(system) {
  for (const spatial::Joint& joint : system.scene().joints)
    std::visit(
        [&](const auto& j) {
          if constexpr (requires { j.angle(); }) names_.push_back(j.name + ".angle"), coordinates_.push_back(j.angle());
          if constexpr (requires { j.displacement(); })
            names_.push_back(j.name + ".displacement"), coordinates_.push_back(j.displacement());
        },
        joint);
  poses_.pose.resize(static_cast<std::size_t>(system.bodies()) + 1);
  turns_.resize(names_.size()), values_.resize(names_.size());
}

const std::vector<double>& JointCoordinates::at(const State& x) {
  set_poses(system_, x.t, x.q, poses_);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    values_[i] = coordinates_[i].value(poses_);
    if (coordinates_[i].angle())
      values_[i] = turns_[i].add(x.t, values_[i], apply(coordinates_[i].row(poses_), x.v.data()));
  }
  return values_;
}

std::string to_csv(const std::vector<std::string>& columns, const std::vector<double>& table) {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) text += columns[i] + (i + 1 < columns.size() ? "," : "\n");
  for (std::size_t i = 0; i < table.size(); ++i)
    text += detail::text_of(table[i]) + ((i + 1) % columns.size() == 0 ? "\n" : ",");
  return text;
}

}  // namespace orthant
