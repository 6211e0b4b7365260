// integrators/capabilities.h — capabilities: the features of a scene that an integrator takes, checked when it is made.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <string>
#include <string_view>

namespace orthant {

struct Capabilities {
  bool impact_laws = true;             // restitution = "poisson", impacts = "sequential"
  bool tangential_restitution = true;  // e_t ≠ 0
  bool loaded_friction = true;         // dry friction in a joint by its load, mu ≠ 0
  bool turning_friction = false;       // rolling and spinning friction of contacts, in space
  bool error_control = false;          // divides the step that it is given, to a tolerance
  bool threads = true;                 // solves islands of bodies at the same time
  bool pyramids = true;                // pyramids in place of friction discs, the solvers' option facets
  bool space = false;                  // dimension = 3; set by the registry

  /// v(name, field, words) over all of them.
  template <class V> void visit(V&& v) const {
    v("impact_laws", impact_laws, "Poisson's law, sequential impacts");
    v("tangential_restitution", tangential_restitution, "`e_t`");
    v("loaded_friction", loaded_friction, "joint friction by load");
    v("turning_friction", turning_friction, "rolling, spinning friction");
    v("error_control", error_control, "controls its step");
    v("threads", threads, "threads");
    v("pyramids", pyramids, "solver option `facets`");
    v("space", space, "`dimension = 3`");
  }
};

/// "moreau-jean, adaptive": those with the feature.
std::string integrators_that_take(bool Capabilities::*feature);

/// Throws std::invalid_argument with field, value, rule and the integrators that do, where the scene has a feature that
/// `integrator` does not take.
template <class Space> void check(const SystemOf<Space>& system, std::string_view integrator, const Capabilities& can);

}  // namespace orthant
