#include <orthant/core/support/options.h>
#include <orthant/core/support/registered.h>
#include <orthant/integrators/adaptive/spatial_adaptive.h>
#include <orthant/integrators/between_events/listed_contacts.h>
#include <orthant/integrators/event_driven/event_driven.h>
#include <orthant/integrators/event_driven/spatial_event_driven.h>
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

template <class Scheme>
std::unique_ptr<IntegratorOf<Spatial>> make_in_space(const SystemOf<Spatial>& system, std::string_view text) {
  typename Scheme::Options options;
  set_options(options, text);
  return std::make_unique<Scheme>(system, options);
}

/// Of schemes that follow listed contacts only: through the equivalent scene of such (equivalent_scene.h), where it is
/// needed.
template <class Scheme> std::unique_ptr<Integrator> make_by_contacts(const System& system, std::string_view text) {
  if (!ListedContacts::needed(system.scene())) return make<Scheme>(system, text);
  return std::make_unique<ListedContactsIntegrator>(system, Scheme::kName, Scheme::kCan, &make<Scheme>, text);
}

template <class Scheme> IntegratorEntry entry(std::string_view summary,
                                              const IntegratorEntry::Make& make_it = &make<Scheme>,
                                              IntegratorEntry::MakeSpatial make_spatial = nullptr) {
  Capabilities can = Scheme::kCan;
  can.space = make_spatial != nullptr;
  return {Scheme::kName, summary, make_it, make_spatial, &list_options<typename Scheme::Options>, can};
}

std::vector<IntegratorEntry> built_in() {
  return {
      entry<MoreauJean>("theta stepping at velocity level; order 1 with impacts, 2 on smooth motion", &make<MoreauJean>,
                        &make_in_space<MoreauJeanOf<Spatial>>),
      entry<StewartTrinkle>("the linearized gap at the end of the step is unilateral; order 1", &make<StewartTrinkle>,
                            &make_in_space<StewartTrinkleOf<Spatial>>),
      entry<AnitescuPotra>("as stewart-trinkle, with convex relaxed friction; order 1", &make<AnitescuPotra>,
                           &make_in_space<AnitescuPotraOf<Spatial>>),
      entry<PaoliSchatzman>("three positions, restitution between the outer two; order 1", &make<PaoliSchatzman>,
                            &make_in_space<PaoliSchatzmanOf<Spatial>>),
      entry<GeneralizedAlpha>("joints and gaps at both levels, implicit; order 2 on smooth motion, damps stiff springs",
                              &make<GeneralizedAlpha>, &make_in_space<GeneralizedAlphaOf<Spatial>>),
      entry<Rattle>("joints and gaps at both levels, symplectic; order 2 on smooth motion", &make<Rattle>,
                    &make_in_space<RattleOf<Spatial>>),
      entry<Adaptive>("to a tolerance: located events, dense output; no answer depends on the output step",
                      &make_by_contacts<Adaptive>, &make_in_space<SpatialAdaptive>),
      entry<EventDriven>("Runge-Kutta of order 8 between located events; for references",
                         &make_by_contacts<EventDriven>, &make_in_space<SpatialEventDriven>),
  };
}

std::vector<IntegratorEntry>& integrator_rows() {
  static std::vector<IntegratorEntry> rows = built_in();
  return rows;
}

}  // namespace

std::span<const IntegratorEntry> integrators() { return integrator_rows(); }

void register_integrator(IntegratorEntry entry) {
  entry.name = registered_name("integrator", entry.name, integrators());
  entry.summary = kept_text(entry.summary);
  integrator_rows().push_back(entry);
}

std::unique_ptr<Integrator> make_integrator(std::string_view spec, const System& system) {
  const auto [name, options] = Spec::parse(spec);
  std::string known;
  for (const IntegratorEntry& entry : integrators()) {
    if (entry.name == name) return entry.make(system, options);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("unknown integrator '" + shortened(name) + "': must be one of " + known);
}

std::unique_ptr<IntegratorOf<Spatial>> make_integrator(std::string_view spec, const SystemOf<Spatial>& system) {
  const auto [name, options] = Spec::parse(spec);
  std::string known;
  bool planar = false;
  for (const IntegratorEntry& entry : integrators()) {
    planar = planar || entry.name == name;
    if (entry.make_spatial == nullptr) continue;
    if (entry.name == name) return entry.make_spatial(system, options);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  if (planar)
    throw std::invalid_argument("integrator " + std::string(name) + ": takes planar scenes only: must be one of " +
                                known + " for dimension = 3");
  throw std::invalid_argument("unknown integrator '" + shortened(name) + "': must be one of " + known);
}

}  // namespace orthant
