// orthant new — a scene file to begin with, commented.
#include "experiments/cli/commands.h"

#include <orthant/core/support/file.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>

namespace orthant {
namespace {

constexpr const char* kMechanism =
    R"(# A mechanism: a rod on a pin falls onto a stop. Units are SI: m, kg, s, N, rad; angles are counter-clockwise.
#   orthant check FILE                  explains it
#   orthant simulate FILE               runs it
#   orthant view FILE                   shows it
# Every key: core/scenes/README.md, or `orthant schema scene` for an editor.
gravity = [0, -9.81]  # [m/s²]
duration = 2          # [s]
step = 1e-3           # [s] of fixed-step integrators; `adaptive` chooses its own between two records

# A body: its position is that of its centre of mass. Points of joints and contacts are given in the body's own frame,
# which begins there and turns with the body.
[[body]]
name = "rod"
mass = 1            # [kg]
inertia = 0.0833    # [kg m²] about the centre of mass: of a rod m l² / 12
position = [0.5, 0]
# angle = 0         # [rad]
# velocity = [0, 0] # [m/s]
# omega = 0         # [rad/s]

# Joints take motions away. Here: the rod's left end stays at the origin of the ground.
# Others: prismatic, fixed, distance, drive (a motion given in time), relation, gear.
[[joint]]
type = "revolute"
name = "pin"
bodies = ["ground", "rod"]
point_a = [0, 0]
point_b = [-0.5, 0]

# Contacts push only. Here: the rod's right end strikes the ground half a metre below the pin.
# Others: disc-wall, disc-disc, polygon-wall, polygon-polygon, chain, journal (pin with clearance), guide, limit, rope.
[[contact]]
type = "corner-wall"
name = "stop"
body = "rod"
point = [0.5, 0]
wall = {point = [0, -0.5], normal = [0, 1]}  # the free side is where the normal points
mu = 0.3    # Coulomb friction
e_n = 0.5   # restitution: speed after an impact over speed before

# Friction in the pin, springs and loads, where needed:
# [[friction]]
# joint = "pin"
# bound = 0.05          # [N m]
# [[spring]]
# type = "joint"
# joint = "pin"
# stiffness = 1         # [N m/rad]
# [[load]]
# body = "rod"
# force = [0, 1]        # [N] at `point`, in the world's directions
)";

}  // namespace

void add_new(CLI::App& app, int& exit_code) {
  struct Arguments {
    std::string what, output = "mechanism.toml";
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("new", "A commented scene file to begin with");
  command->add_option("what", arguments->what, "mechanism")->required()->check(CLI::IsMember({"mechanism"}));
  command->add_option("--output", arguments->output, "the file, or - for standard output")->capture_default_str();
  command->add_flag("--json", arguments->json, "where it is, as one JSON object");
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Example:\n"
      "  orthant new mechanism --output mine.toml");
  command->callback([arguments, &exit_code] {
    exit_code = 0;
    if (arguments->output == "-") {
      std::cout << kMechanism;
      return;
    }
    if (std::filesystem::exists(arguments->output))
      throw std::invalid_argument(arguments->output + ": exists already: choose another name by --output");
    write_whole(arguments->output, kMechanism);
    if (arguments->json)
      std::cout << nlohmann::json{{"scene", arguments->output}}.dump() << '\n';
    else
      std::cout << "scene: " << arguments->output << '\n';
  });
}

}  // namespace orthant
