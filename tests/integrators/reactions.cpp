// Reaction forces of joints against closed forms, in the plane and in space, by every kind of integrator.
#include "tests/support/runs.h"
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/integrators/reactions.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

using namespace orthant;

namespace {

/// Calls what(state, reactions) at every record of a run.
template <class Space, class What> Run with_reactions(const SystemOf<Space>& system, std::string_view integrator,
                                                      double h, double duration, const What& what) {
  const auto scheme = make_integrator(integrator, system);
  const auto solver = make_solver("auto");
  ReactionsOf<Space> reactions(system);
  return simulate(*scheme, *solver, {.step = h, .duration = duration},
                  [&](const RunSampleOf<Space>& moment) { what(moment, reactions.next(moment)); });
}

AnyScene reaction_scene(const std::string& text) { return parse_any_scene(text, {}, "scene.toml"); }

/// A rod of 2 kg and 1 m on a pin at the origin, its centre 0.5 m away, released at 60 degrees below the horizontal.
const std::string kPinnedRod =
    "gravity = [0, -9.81]\n[[body]]\nname = 'rod'\nmass = 2\ninertia = 0.2\nposition = [0.25, -0.4330127018922193]\n"
    "angle = -1.0471975511965976\n[[joint]]\nname = 'pin'\ntype = 'revolute'\nbodies = ['ground', 'rod']\n"
    "point_b = [-0.5, 0]\n";

}  // namespace

TEST_CASE("the pin of a swinging rod holds it with m (a - g): error of second order, no moment, friction or none") {
  for (const std::string friction : {"", "[[friction]]\njoint = 'pin'\nbound = 0.7\n"}) {
    CAPTURE(friction);
    const System system(std::get<Scene>(reaction_scene(kPinnedRod + friction)));
    for (const std::string_view integrator : {"moreau-jean", "rattle", "generalized-alpha", "event-driven"}) {
      if (!friction.empty() && integrator == "event-driven") continue;
      CAPTURE(integrator);
      double worst[2] = {};
      for (const int level : {0, 1}) {
        const double h = level == 0 ? 2e-3 : 1e-3;
        Eigen::VectorXd before;
        double t = 0;
        with_reactions(system, integrator, h, 0.3, [&](const RunSample& m, const auto& reactions) {
          if (before.size() > 0) {
            const double dt = m.state.t - t;
            const Vector2d mean = 2 * ((m.state.v - before).head<2>() / dt + Vector2d(0, 9.81));
            const Vector2d force(reactions[0].force[0], reactions[0].force[1]);
            worst[level] = std::max({worst[level], (force - mean).norm(), std::abs(reactions[0].moment[0])});
          }
          before = m.state.v, t = m.state.t;
        });
        CHECK(worst[level] < 30 * h * h);
      }
      CHECK(std::abs(std::log2(worst[0] / worst[1]) - 2) < 0.05);
    }
  }
}

TEST_CASE("a door at rest hangs on its hinge in space: its weight, and the moment that keeps it from tipping") {
  const SpatialSystem system(std::get<spatial::Scene>(reaction_scene(
      "dimension = 3\ngravity = [0, 0, -10]\n[[body]]\nname = 'door'\nmass = 20\ninertia = [6.7, 8.3, 1.7]\n"
      "position = [0.5, 0, 1]\n[[joint]]\ntype = 'revolute'\nname = 'hinge'\nbodies = ['ground', 'door']\n"
      "point_b = [-0.5, 0, -1]\naxis = [0, 0, 1]\n[[joint]]\ntype = 'drive'\nname = 'hand'\njoint = 'hinge'\n")));
  for (const std::string_view integrator : {"moreau-jean", "stewart-trinkle", "rattle", "adaptive", "event-driven"}) {
    CAPTURE(integrator);
    std::vector<ReactionOf<Spatial>> last;
    with_reactions(system, integrator, 1e-2, 0.1, [&](const SpatialSample&, const auto& all) { last = all; });
    REQUIRE(last.size() == 2);
    const Vector3d force(last[0].force[0], last[0].force[1], last[0].force[2]);
    const Vector3d moment(last[0].moment[0], last[0].moment[1], last[0].moment[2]);
    CHECK((force - Vector3d(0, 0, 200)).norm() < 1e-9);
    CHECK((moment - Vector3d(0, -100, 0)).norm() < 1e-9);  // r × m g = (0.5, 0, 1) × (0, 0, −200) has +100 about y
  }
}

TEST_CASE("reactions in an impact with friction balance the momentum of a body on a ball joint") {
  const SpatialSystem system(std::get<spatial::Scene>(reaction_scene(
      "dimension = 3\ngravity = [0, 0, -9.81]\n[[body]]\nname = 'club'\nmass = 3\ninertia = [0.1, 0.2, 0.25]\n"
      "position = [0.6, 0, 0]\nomega = [2, 0.5, 1]\n[[joint]]\ntype = 'spherical'\nname = 'ball'\n"
      "bodies = ['ground', 'club']\npoint_b = [-0.6, 0, 0]\n[[contact]]\ntype = 'sphere-wall'\nbody = 'club'\n"
      "centre = [0.3, 0, 0]\nradius = 0.05\nmu = 0.4\ne_n = 0.5\nwall = {point = [0, 0, -0.4], normal = [0, 0, "
      "1]}\n")));
  for (const std::string_view integrator : {"moreau-jean", "adaptive"}) {
    CAPTURE(integrator);
    Vector3d sum(0, 0, 0), pushed(0, 0, 0), start(0, 0, 0), end(0, 0, 0);
    double t = 0;
    bool struck = false;
    with_reactions(system, integrator, 1e-4, 0.6, [&](const SpatialSample& m, const auto& all) {
      if (m.state.t == 0) start = m.state.v.head<3>();
      const auto& push = m.impulses[0];
      struck = struck || push.normal > 0;
      pushed += Vector3d(push.tangent.first, push.tangent.second, push.normal);  // of z: t1 = x, t2 = y
      for (int k = 0; k < 3; ++k) sum[k] += (m.state.t - t) * all[0].force[static_cast<std::size_t>(k)];
      t = m.state.t, end = m.state.v.head<3>();
    });
    CHECK(struck);
    CHECK((sum - (3 * (end - start) + 3 * 9.81 * t * Vector3d::UnitZ() - pushed)).norm() < 2e-3 * sum.norm());
  }
}

TEST_CASE("each kind of joint in space holds the same cantilever with the same force and moment, in either order") {
  for (const std::string type : {"fixed", "prismatic", "cylindrical", "screw", "revolute"})
    for (const bool other_way : {false, true}) {
      CAPTURE(type);
      CAPTURE(other_way);
      const std::string axis = type == "fixed" ? "" : "axis = [1, 0, 0]\n";
      const std::string ends = other_way ? "bodies = ['beam', 'ground']\npoint_a = [-0.5, 0, 0]\npoint_b = [1, 0, 0]\n"
                                         : "bodies = ['ground', 'beam']\npoint_a = [1, 0, 0]\npoint_b = [-0.5, 0, 0]\n";
      const SpatialSystem system(std::get<spatial::Scene>(
          reaction_scene("dimension = 3\ngravity = [0, 0, -10]\n[[body]]\nname = 'beam'\nmass = 2\n"
                         "inertia = [0.1, 0.2, 0.3]\nposition = [1.5, 0, 0]\n[[joint]]\ntype = '" +
                         type + "'\n" + ends + axis + (type == "screw" ? "pitch = 0.1\n" : ""))));
      std::vector<ReactionOf<Spatial>> last;
      with_reactions(system, "moreau-jean", 1e-2, 0.05, [&](const SpatialSample&, const auto& all) { last = all; });
      const double sign = other_way ? -1 : 1;  // of what the beam exerts on the ground
      CHECK(std::abs(last[0].force[2] - sign * 20) < 1e-9);
      CHECK(std::abs(last[0].moment[1] + sign * 10) < 1e-9);
      CHECK(std::abs(last[0].force[0]) + std::abs(last[0].moment[0]) + std::abs(last[0].moment[2]) < 1e-9);
    }
}

TEST_CASE("a drive's reaction is the moment that turns its body, in the plane and in space") {
  // J θ'' = M of the drive: θ = sin(2 t), J = 0.3: M(0.2) = −4 · 0.3 sin(0.4) about z.
  const std::string hinge = "[[joint]]\ntype = 'revolute'\nname = 'hinge'\nbodies = ['ground', 'arm']\n";
  const std::string drive = "[[joint]]\ntype = 'drive'\njoint = 'hinge'\namplitude = 1\nomega = 2\n";
  const std::string body = "[[body]]\nname = 'arm'\nmass = 1\ninertia = 0.3\n";
  const double mean = -4 * 0.3 * (std::cos(0.398) - std::cos(0.4)) / (2 * 1e-3);
  const System plane(std::get<Scene>(reaction_scene(body + "omega = 2\n" + hinge + drive)));
  double found = 0;
  with_reactions(plane, "moreau-jean", 1e-3, 0.2, [&](const RunSample&, const auto& all) { found = all[1].moment[0]; });
  CHECK(std::abs(found - mean) < 1e-3);
  const SpatialSystem space(std::get<spatial::Scene>(
      reaction_scene("dimension = 3\n" + body + "omega = [0, 0, 2]\n" + hinge + "axis = [0, 0, 1]\n" + drive)));
  with_reactions(space, "moreau-jean", 1e-3, 0.2,
                 [&](const SpatialSample&, const auto& all) { found = all[1].moment[2]; });
  CHECK(std::abs(found - mean) < 1e-3);
}
