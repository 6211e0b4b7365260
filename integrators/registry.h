// integrators/registry.h — integrator registry: names in one table.
#pragma once

#include <orthant/core/support/option_list.h>
#include <orthant/integrators/integrator.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

struct IntegratorEntry {
  std::string_view name, summary;
  using Make = std::function<std::unique_ptr<Integrator>(const System& system, std::string_view options)>;
  Make make;
  using MakeSpatial = std::unique_ptr<IntegratorOf<Spatial>> (*)(const SystemOf<Spatial>& system,
                                                                 std::string_view options);
  MakeSpatial make_spatial;                           // null: takes planar scenes only
  std::function<std::vector<OptionEntry>()> options;  // with defaults and ranges
  Capabilities can;
};

std::span<const IntegratorEntry> integrators();

/// One more row, behind the others; as register_solver() (solvers/registry.h).
void register_integrator(IntegratorEntry entry);

/// "moreau-jean:joints=position,theta=0.5". Unknown name or option: std::invalid_argument that lists the known ones.
/// The system must outlive the integrator: a temporary one does not compile.
std::unique_ptr<Integrator> make_integrator(std::string_view spec, const System& system);
std::unique_ptr<Integrator> make_integrator(std::string_view spec, System&& system) = delete;
std::unique_ptr<IntegratorOf<Spatial>> make_integrator(std::string_view spec, const SystemOf<Spatial>& system);
std::unique_ptr<IntegratorOf<Spatial>> make_integrator(std::string_view spec, SystemOf<Spatial>&& system) = delete;

}  // namespace orthant
