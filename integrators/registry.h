// integrators/registry.h — integrator registry: names in one table.
#pragma once

#include <orthant/integrators/integrator.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace orthant {

struct IntegratorEntry {
  std::string_view name, summary;
  std::unique_ptr<Integrator> (*make)(const System& system, std::string_view options);
  std::string (*options)();  // every option with its default and range, one line
};

std::span<const IntegratorEntry> integrators();

/// "moreau-jean:joints=position,theta=0.5". Unknown name or option: std::invalid_argument that lists the known ones.
std::unique_ptr<Integrator> make_integrator(std::string_view spec, const System& system);

}  // namespace orthant
