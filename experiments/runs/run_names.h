// experiments/runs/run_names.h — columns and parameters of a run by their names: "crank.theta", "mu", "body.rod.mass".
//
// A parameter is a key of --set with a number for a value: of a built-in scene one of its options, of a file a key path
// ("contact.corner1.mu"), an entry of an array by its place ("body.rod.position[0]"; of an inertia tensor with its
// mirror image). An element without a name has that of its kind and number. A value that the file leaves out counts as
// given where its default is 0 or 1, or an array of such numbers. `start.BODY.COLUMN`, COLUMN of x, y, theta, vx, vy,
// omega, is the body's initial coordinate or velocity; in space x, y, z, rx, ry, rz (a turn about the world's axes),
// vx, vy, vz, wx, wy, wz.
#pragma once

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/integrators/derivatives/parameter_change.h>
#include <orthant/integrators/derivatives/run_columns.h>

#include <optional>
#include <string>
#include <vector>

namespace orthant {

struct SceneSource {
  std::optional<std::string> text;  // TOML; none: `name` is a built-in scene or a file
  std::string name;
  std::vector<std::string> sets;

  AnyScene make() const { return make_with(sets); }
  AnyScene make_with(const std::vector<std::string>& other_sets) const;
};
/// A scene's time step and duration, where they are not given; the name of a contact.
double step_of(const AnyScene& scene);
double duration_of(const AnyScene& scene);
std::string name_of_contact(const AnyScene& scene, int contact);

/// Throws std::invalid_argument for a key that is no number of the scene, and names the rule.
RunParameter parameter_of(const SceneSource& source, const Scene& scene, const std::string& key);
RunParameterOf<Spatial> parameter_of(const SceneSource& source, const spatial::Scene& scene, const std::string& key);

/// "crank.theta": x, y, theta, vx, vy, omega of a body; "corner1.gap", impulse_n, impulse_t of a contact;
/// "bearing.impulse" of a friction in a joint; "energy". In space the columns of a trajectory (trajectory.h). Throws
/// std::invalid_argument for what is none of these.
RunColumn column_of(const Scene& scene, const std::string& name);
RunColumn column_of(const spatial::Scene& scene, const std::string& name);

}  // namespace orthant
