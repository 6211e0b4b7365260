// Bodies that are placed on their contacts: which parameters open or close them, by both modes.
#include "tests/integrators/derivatives/spatial_trials.h"

namespace orthant {

namespace {

const char* const kDisc = R"(
gravity = [0, -9.81]
[[body]]
name = "ball"
mass = 1
inertia = 1
position = [0, 0.3]
[[contact]]
name = "floor"
type = "disc-wall"
body = "ball"
radius = 0.3
mu = 0.2
wall = {point = [0, 0], normal = [0, 1]}
)";
const char* const kSphere = R"(
gravity = [0, 0, -9.81]
dimension = 3
[[body]]
name = "ball"
mass = 1
inertia = 1
position = [0, 0, 0.3]
[[contact]]
type = "sphere-wall"
name = "floor"
body = "ball"
radius = 0.3
mu = 0.2
wall = {point = [0, 0, 0], normal = [0, 0, 1]}
)";
const Clock kClock{.step = 0.01, .duration = 0.05};

/// The steps that both modes name, of one parameter.
template <class Space> std::vector<DegenerateStep> steps_by_both(const typename ElementsOf<Space>::Scene& scene,
                                                                 const RunParameterOf<Space>& parameter) {
  const SystemOf<Space> system(scene);
  const auto solver = make_solver("auto");
  const RunColumn column;
  const RunTangent t = differentiate_run(system, {parameter}, MoreauJeanOptions(), *solver, kClock, {column});
  const RunAdjoint a =
      differentiate_run_reverse(system, {parameter}, MoreauJeanOptions(), *solver, kClock, {column}, 1, weigh_last());
  REQUIRE(t.run.status == Status::solved);
  REQUIRE(t.degenerate.size() == a.degenerate.size());
  for (std::size_t i = 0; i < t.degenerate.size(); ++i) {
    CHECK(t.degenerate[i].t == a.degenerate[i].t);
    CHECK(t.degenerate[i].contacts == a.degenerate[i].contacts);
  }
  return t.degenerate;
}

void check_named(const std::vector<DegenerateStep>& steps) {
  REQUIRE(steps.size() == 1);
  CHECK(steps.front().t == 0);
  CHECK(steps.front().contacts == std::vector<int>{0});
}

}  // namespace

TEST_CASE("derivatives of a run: a gap of 0 that the place, the radius or the wall opens is named, by both modes") {
  const Scene scene = from_text(kDisc)({});
  const auto by = [](const std::string& key, double value) {
    return RunParameter{key, value, [key](double x) { return from_text(kDisc)({override_text(key, x)}); }, -1};
  };
  check_named(steps_by_both<Planar>(scene, by("contact.floor.radius", 0.3)));
  check_named(steps_by_both<Planar>(scene, {"start", 0, {}, 1}));  // y
  check_named(steps_by_both<Planar>(scene, {"start", 0, {}, 4}));  // v_y: half a step ahead
  const auto changed = [](const std::string& name, double value, auto&& change) {
    return RunParameter{name, value,
                        [=](double x) {
                          Scene other = from_text(kDisc)({});
                          change(other, std::get<DiscWall>(other.contacts[0]), x);
                          return other;
                        },
                        -1};
  };
  check_named(
      steps_by_both<Planar>(scene, changed("height", 0, [](Scene&, DiscWall& c, double x) { c.wall_point.y() = x; })));
  CHECK(steps_by_both<Planar>(scene, by("contact.floor.mu", 0.2)).empty());
  CHECK(steps_by_both<Planar>(scene, {"start", 0, {}, 3}).empty());  // v_x
  CHECK(steps_by_both<Planar>(
            scene, changed("both", 0.3,
                           [](Scene& other, DiscWall& c, double x) { c.radius = x, other.bodies[0].position.y() = x; }))
            .empty());
}

TEST_CASE("derivatives of a run in space: a gap of 0 that the place or the radius opens is named, by both modes") {
  const spatial::Scene scene = spatial_from_text(kSphere);
  check_named(steps_by_both<Spatial>(scene, by_key(kSphere, "contact.floor.radius", 0.3)));
  check_named(steps_by_both<Spatial>(scene, by_start(scene, 2)));  // z
  check_named(steps_by_both<Spatial>(scene, by_start(scene, 8)));  // v_z
  CHECK(steps_by_both<Spatial>(scene, by_key(kSphere, "contact.floor.mu", 0.2)).empty());
  CHECK(steps_by_both<Spatial>(scene, by_start(scene, 6)).empty());  // v_x
  CHECK(steps_by_both<Spatial>(scene, by_change(kSphere, "both", 0.3,
                                                [](spatial::Scene& other, double x) {
                                                  std::get<spatial::SpherePlane>(other.contacts[0]).radius = x;
                                                  other.bodies[0].position.z() = x;
                                                }))
            .empty());
}

}  // namespace orthant
