#include "trajectory.h"

#include <orthant/core/support/options.h>

namespace orthant {

std::vector<std::string> trajectory_columns(const Scene& scene) {
  std::vector<std::string> columns = {"t"};
  for (const Body& body : scene.bodies)
    for (const char* part : {".x", ".y", ".theta", ".vx", ".vy", ".omega"}) columns.push_back(body.name + part);
  for (const Contact& contact : scene.contacts)
    for (const char* part : {".gap", ".impulse_n", ".impulse_t"})
      columns.push_back(std::visit([](const auto& c) { return c.name; }, contact) + part);
  columns.insert(columns.end(), {"energy", "joint_residual", "penetration", "lcp_residual", "lcp_iterations"});
  return columns;
}

void append_row(const System& system, const Moment& moment, std::vector<double>& table) {
  const State& x = moment.state;
  table.push_back(x.t);
  for (Index i = 0; i < x.q.size(); i += 3) {
    table.insert(table.end(), x.q.data() + i, x.q.data() + i + 3);
    table.insert(table.end(), x.v.data() + i, x.v.data() + i + 3);
  }
  for (std::size_t i = 0; i < moment.impulses.size(); ++i) {
    const Impulse& impulse = moment.impulses[i];
    table.insert(table.end(), {moment.gaps[static_cast<Index>(i)], impulse.normal, impulse.tangent});
  }
  const StepReport& r = moment.report;
  table.insert(table.end(), {energy(system, x), r.joint_residual, r.penetration, r.lcp_residual,
                             static_cast<double>(r.lcp_iterations)});
}

std::string to_csv(const std::vector<std::string>& columns, const std::vector<double>& table) {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) text += columns[i] + (i + 1 < columns.size() ? "," : "\n");
  for (std::size_t i = 0; i < table.size(); ++i)
    text += detail::text_of(table[i]) + ((i + 1) % columns.size() == 0 ? "\n" : ",");
  return text;
}

}  // namespace orthant
