#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive/adaptive.h>
#include <orthant/integrators/between_events/substitute.h>
#include <orthant/integrators/event_driven/event_driven.h>
#include <orthant/integrators/fixed_step/anitescu_potra.h>
#include <orthant/integrators/fixed_step/generalized_alpha.h>
#include <orthant/integrators/fixed_step/moreau_jean.h>
#include <orthant/integrators/fixed_step/paoli_schatzman.h>
#include <orthant/integrators/fixed_step/rattle.h>
#include <orthant/integrators/fixed_step/stewart_trinkle.h>
#include <orthant/integrators/registry.h>

namespace orthant {
namespace {

template <class Scheme> std::unique_ptr<Integrator> make(const System& system, std::string_view text) {
  typename Scheme::Options options;
  set_options(options, text);
  return std::make_unique<Scheme>(system, options);
}

/// Of schemes that follow listed contacts only: through the equivalent scene of such (substitute.h), where it is
/// needed.
template <class Scheme, const std::string_view& kName>
std::unique_ptr<Integrator> make_by_contacts(const System& system, std::string_view text) {
  if (!Substitute::needed(system.scene())) return make<Scheme>(system, text);
  return std::make_unique<SubstituteIntegrator>(system, kName, &make<Scheme>, text);
}
constexpr std::string_view kAdaptive = "adaptive", kEventDriven = "event-driven";

template <class Scheme> std::string options_of() { return describe(typename Scheme::Options{}); }

constexpr IntegratorEntry kIntegrators[] = {
    {"moreau-jean", "theta stepping at velocity level; order 1 with impacts, 2 on smooth motion", &make<MoreauJean>,
     &options_of<MoreauJean>},
    {"stewart-trinkle", "the linearized gap at the end of the step is unilateral; order 1", &make<StewartTrinkle>,
     &options_of<StewartTrinkle>},
    {"anitescu-potra", "as stewart-trinkle, with convex relaxed friction; order 1", &make<AnitescuPotra>,
     &options_of<AnitescuPotra>},
    {"paoli-schatzman", "three positions, restitution between the outer two; order 1", &make<PaoliSchatzman>,
     &options_of<PaoliSchatzman>},
    {"generalized-alpha", "joints and gaps at both levels, implicit; order 2 on smooth motion, damps stiff springs",
     &make<GeneralizedAlpha>, &options_of<GeneralizedAlpha>},
    {"rattle", "joints and gaps at both levels, symplectic; order 2 on smooth motion", &make<Rattle>,
     &options_of<Rattle>},
    {"adaptive", "to a tolerance: located events, dense output; no answer depends on the output step",
     &make_by_contacts<Adaptive, kAdaptive>, &options_of<Adaptive>},
    {"event-driven", "Runge-Kutta of order 8 between located events; for references",
     &make_by_contacts<EventDriven, kEventDriven>, &options_of<EventDriven>},
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
  throw std::invalid_argument("unknown integrator '" + shortened(name) + "': must be one of " + known);
}

}  // namespace orthant
