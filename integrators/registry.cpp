#include <orthant/core/support/options.h>
#include <orthant/integrators/moreau_jean.h>
#include <orthant/integrators/registry.h>

namespace orthant {
namespace {

template <class Scheme> std::unique_ptr<Integrator> make(const System& system, std::string_view text) {
  typename Scheme::Options options;
  set_options(options, text);
  return std::make_unique<Scheme>(system, options);
}

template <class Scheme> std::string options_of() { return describe(typename Scheme::Options{}); }

constexpr IntegratorEntry kIntegrators[] = {
    {"moreau-jean", "theta stepping at velocity level; order 1 with impacts, 2 on smooth motion", &make<MoreauJean>,
     &options_of<MoreauJean>},
};

}  // namespace

std::span<const IntegratorEntry> integrators() { return kIntegrators; }

std::unique_ptr<Integrator> make_integrator(std::string_view spec, const System& system) {
  const auto [name, options] = Spec::parse(spec);
  std::string known;
  for (const IntegratorEntry& entry : kIntegrators) {
    if (entry.name == name) return entry.make(system, options);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("unknown integrator '" + std::string(name) + "': must be one of " + known);
}

}  // namespace orthant
