// Sleep in space: islands at rest keep their contact forces, and wake on a contact, a load and a moving surface only.
#include "tests/support/spatial.h"

#include <doctest/doctest.h>

using namespace orthant;

namespace {

const Eigen::Quaterniond kAslant(Eigen::AngleAxisd(0.7, Vector3d(-1, 0.4, 2).normalized()));
constexpr double kHalf = 0.5;  // [m]

/// A cube of 1 kg on a rough floor, and one on top of it; all turned.
spatial::Scene cubes() {
  const Vector3d up = kAslant * Vector3d(0, 0, 1);
  spatial::Scene s;
  s.gravity = -9.81 * up;
  for (int i = 0; i < 2; ++i) {
    const auto cube = s.body({.name = "cube" + std::to_string(i),
                              .mass = 1,
                              .inertia = Vector3d::Constant(1.0 / 6).asDiagonal(),
                              .position = (kHalf + i) * up,
                              .orientation = {kAslant.w(), kAslant.x(), kAslant.y(), kAslant.z()}});
    spatial::SpherePlane under{"under" + std::to_string(i), cube, {}, 0, cube - 1, {}, {0, 0, 1}, {.mu = 0.5}};
    if (i == 0)
      under.normal = up;
    else
      under.plane_point = {0, 0, kHalf};
    for (const spatial::SpherePlane& corner : corners_plane(under, spatial::box_corners(Vector3d::Constant(kHalf))))
      if (corner.centre.z() < 0) s.contact(corner);
  }
  return s;
}

/// Impulse of the contacts first … first + 3 in a step, by the time.
double carried(const IntegratorOf<Spatial>& scheme, std::size_t first, double h) {
  double sum = 0;
  for (std::size_t c = first; c < first + 4; ++c) sum += scheme.impulses()[c].normal;
  return sum / h;
}

struct Rest {
  long solves = 0;
  State final;
};
Rest rest_of(const spatial::Scene& scene, const std::string& options) {
  const Run run = run_in_space(SpatialSystem(scene), "moreau-jean" + options, 1e-3, 1);
  return {run.lcp_solves, run.final};
}

/// The run that may sleep spares solves, ends where the other one does, and has moved.
void check_wakes(const spatial::Scene& scene) {
  const Rest awake = rest_of(scene, ""), asleep = rest_of(scene, ":sleep_after=0.1");
  const State start = SpatialSystem(scene).initial_state();
  CHECK(asleep.solves < awake.solves * 4 / 5);
  CHECK(between<Spatial>(awake.final.q, asleep.final.q).lpNorm<Eigen::Infinity>() < 1e-6);
  CHECK(between<Spatial>(start.q, asleep.final.q).lpNorm<Eigen::Infinity>() > 0.05);
}

}  // namespace

TEST_CASE("an island in space sleeps at rest and keeps its contact forces") {
  const SpatialSystem system(cubes());
  const auto scheme = make_integrator("moreau-jean:sleep_after=0.1", system);
  const auto solver = make_solver("auto");
  State x = system.initial_state();
  for (int k = 0; k < 200; ++k) {
    const StepReport report = scheme->step(1e-3, *solver, x);
    REQUIRE(report.status == Status::solved);
    CHECK((report.lcp_solves == 0) == (k >= 100));
    CHECK(carried(*scheme, 0, 1e-3) == doctest::Approx(2 * 9.81).epsilon(1e-8));
    CHECK(carried(*scheme, 4, 1e-3) == doctest::Approx(9.81).epsilon(1e-8));
  }
  x.v[0] = 0.5;  // another state than the one returned
  CHECK(scheme->step(1e-3, *solver, x).lcp_solves > 0);
  CHECK(rest_of(cubes(), "").solves == 1000);  // off by default
}

TEST_CASE("a sleeping island in space wakes on a strike and on a load, and never rests on a moving surface") {
  const Vector3d up = kAslant * Vector3d(0, 0, 1), along = kAslant * Vector3d(1, 0, 0);
  spatial::Scene struck = cubes();
  const auto ball = struck.body({.name = "ball",
                                 .mass = 3,
                                 .inertia = Vector3d::Constant(0.05).asDiagonal(),
                                 .position = -4.7 * along + 1.5 * up,
                                 .velocity = 8 * along + 9.81 / 4 * up});
  struck.contact(spatial::SpherePlane{"side", ball, {0, 0, 0}, 0.2, 1, {-kHalf, 0, 0}, {-1, 0, 0}, {.e = 0.5}});
  check_wakes(struck);

  spatial::Scene pushed = cubes();
  pushed.loads.push_back(
      {.name = "push", .body = 1, .force = 30 * along, .factor = [](double t) { return std::max(0.0, t - 0.5); }});
  check_wakes(pushed);

  spatial::Scene belt = cubes();  // under cubes that are held: not at rest
  for (spatial::Contact& c : belt.contacts) {
    auto& wall = std::get<spatial::SpherePlane>(c);
    wall.law.surface.velocity = 1e-3 * spatial::perpendicular(wall.normal);
  }
  for (const BodyId b : {0, 1})
    belt.joint(spatial::Prismatic{
        .name = "held" + std::to_string(b), .b = b, .axis = up, .orientation = belt.bodies[0].orientation});
  CHECK(rest_of(belt, ":sleep_after=0.1").solves == 1000);
}
