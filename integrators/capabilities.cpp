#include <orthant/core/support/options.h>
#include <orthant/integrators/capabilities.h>
#include <orthant/integrators/registry.h>

#include <stdexcept>
#include <string>

namespace orthant {
namespace {

[[noreturn]] void refuse(std::string_view integrator, const std::string& what, const std::string& rule,
                         bool Capabilities::*feature) {
  throw std::invalid_argument("integrator " + std::string(integrator) + ": " + what + " must be " + rule +
                              ", or the integrator one of " + integrators_that_take(feature));
}

template <class Scene> void check_impact_laws(const Scene& scene, std::string_view integrator) {
  const auto must_be = [&](const char* field, std::string_view value, const char* rule) {
    if (value != rule)
      refuse(integrator, std::string(field) + " = \"" + std::string(value) + "\":", '"' + std::string(rule) + '"',
             &Capabilities::impact_laws);
  };
  must_be("restitution", kRestitutionNames[static_cast<std::size_t>(scene.restitution)], "newton");
  must_be("impacts", kImpactsNames[static_cast<std::size_t>(scene.impacts)], "simultaneous");
}

template <class Scene> void check_tangential_restitution(const Scene& scene, std::string_view integrator) {
  const auto must_have_none = [&](const std::string& what, const ContactLaw& law) {
    if (law.e_t != 0)
      refuse(integrator, what + " has e_t = " + detail::text_of(law.e_t) + ":", "0",
             &Capabilities::tangential_restitution);
  };
  for (const auto& contact : scene.contacts)
    std::visit([&](const auto& c) { must_have_none("contact \"" + c.name + '"', c.law); }, contact);
  for (const auto& c : scene.collisions) must_have_none("collision \"" + c.name + '"', c.law);
}

template <class Scene> void check_loaded_friction(const Scene& scene, std::string_view integrator) {
  for (const auto& f : scene.frictions)
    if (f.loaded())
      refuse(integrator, "friction \"" + f.name + "\" depends on the joint's load: mu", "0",
             &Capabilities::loaded_friction);
}

template <class Scene> void check_turning_friction(const Scene& scene, std::string_view integrator) {
  const auto must_have_none = [&](const std::string& what, const ContactLaw& law) {
    for (const auto& [field, value] :
         {std::pair{"rolling", law.surface.rolling}, std::pair{"spinning", law.surface.spinning}})
      if (value != 0)
        refuse(integrator, what + " has " + field + " = " + detail::text_of(value) + ":", "0",
               &Capabilities::turning_friction);
  };
  for (const auto& contact : scene.contacts)
    std::visit([&](const auto& c) { must_have_none("contact \"" + c.name + '"', c.law); }, contact);
  for (const auto& c : scene.collisions) must_have_none("collision \"" + c.name + '"', c.law);
}

}  // namespace

std::string integrators_that_take(bool Capabilities::*feature) {
  std::string names;
  for (const IntegratorEntry& entry : integrators())
    if (entry.can.*feature) names += (names.empty() ? "" : ", ") + std::string(entry.name);
  return names;
}

template <class Space> void check(const SystemOf<Space>& system, std::string_view integrator, const Capabilities& can) {
  if (!can.impact_laws) check_impact_laws(system.scene(), integrator);
  if (!can.tangential_restitution) check_tangential_restitution(system.scene(), integrator);
  if (!can.loaded_friction) check_loaded_friction(system.scene(), integrator);
  if (!can.turning_friction) check_turning_friction(system.scene(), integrator);
}

template void check(const SystemOf<Planar>&, std::string_view, const Capabilities&);
template void check(const SystemOf<Spatial>&, std::string_view, const Capabilities&);

}  // namespace orthant
