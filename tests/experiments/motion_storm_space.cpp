// Storm of motions in space: its measures see what is wrong, twins and files are the same motion, a share of it runs.
#include "experiments/studies/motion_storm/examine.h"
#include "experiments/studies/motion_storm/judge.h"
#include "experiments/studies/motion_storm/painleve.h"
#include "experiments/studies/motion_storm/scenes.h"
#include "experiments/studies/motion_storm/shared_load.h"
#include "experiments/studies/motion_storm/shrink.h"
#include "experiments/studies/motion_storm/spatial_twin.h"
#include "experiments/studies/motion_storm/tally.h"

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "tests/support/sanitized.h"

namespace orthant::motion_storm {
namespace {

spatial::Scene falling_ball(double e) {
  spatial::Scene s{.gravity = {0, 0, -10}};
  s.body({.mass = 2, .inertia = 0.008 * Eigen::Matrix3d::Identity(), .position = {0, 0, 0.3}});
  s.contact(spatial::SpherePlane{{}, 0, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, {0, 0, 1}, {.e = e}});
  s.duration = 0.4, s.step = 1e-3;
  return s;
}

struct BallRow {
  double t, x, z, vx, vz;
};
Trace rows_of_ball(std::initializer_list<BallRow> rows) {
  Trace t;
  for (const BallRow& r : rows) {
    State x;
    x.t = r.t, x.q.resize(7), x.q << r.x, 0, r.z, 1, 0, 0, 0, x.v.resize(6), x.v << r.vx, 0, r.vz, 0, 0, 0;
    t.rows.push_back(x), t.belt.push_back(0), t.pressed.push_back(0);
  }
  return t;
}

/// As far as its parts are rigid: coordinates changed at random.
State disturbed(const SystemOf<Spatial>& system, Random& random) {
  State x = system.initial_state();
  Eigen::VectorXd step(x.v.size());
  for (Eigen::Index i = 0; i < x.v.size(); ++i) step[i] = random.uniform(-0.2, 0.2), x.v[i] = random.uniform(-2, 2);
  move<Spatial>(x.q, step);
  return x;
}

}  // namespace

TEST_CASE("motion storm in space: penetration, energy, passages and bad numbers are seen in made-up rows") {
  const spatial::Scene s = falling_ball(1);
  const Allowance exact{0, 1e-7};
  CHECK(examine(s, rows_of_ball({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.1, 0, -2}}), exact).depth_share.value <= 1);
  const Figures deep = examine(s, rows_of_ball({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.09, 0, -2}}), exact);
  CHECK(std::abs(deep.depth.value - 0.01) < 1e-12);
  CHECK(deep.depth_share.value > 1);
  CHECK(examine(s, rows_of_ball({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.09, 0, -2}}), {1e-2, 0}).depth_share.value < 1);  // h v
  const Figures gain = examine(s, rows_of_ball({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.1, 0, -2.1}}), exact);
  CHECK(std::abs(gain.gain.value - 0.41) < 1e-12);
  CHECK_FALSE(examine(s, rows_of_ball({{0, 0, 0.3, 0, NAN}}), exact).finite);

  spatial::Scene peg;
  peg.body({.position = {-1, 0, 0}, .velocity = {1, 0, 0}});
  peg.contact(spatial::SphereSphere{{}, 0, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, 0.1, {}});
  const auto over = rows_of_ball({{0, -0.3, 0, 60, 0}, {0.01, 0.3, 0, 60, 0}});
  CHECK(examine(peg, over, {0.01, 0}).passed.value > 0.9);
  CHECK(examine(peg, rows_of_ball({{0, -0.3, 0.3, 60, 0}, {0.01, 0.3, 0.3, 60, 0}}), {0.01, 0}).passed.value == 0);

  spatial::Scene pushed = falling_ball(1);  // a moment has no potential: what it can add is bounded
  pushed.load({.body = 0, .moment = {0, 0, 5}});
  Trace spun = rows_of_ball({{0, 0, 0.3, 0, 0}, {0.1, 0, 0.3, 0, 0}});
  spun.rows[1].v[5] = 10;  // 0.4 J, and at most 5 J
  CHECK(examine(pushed, spun, exact).gain.value == 0);
  CHECK(examine(s, spun, exact).gain.value > 0.3);
}

TEST_CASE("motion storm in space: gaps, joints and energy are those of the library, by other code, at random states") {
  Random random(3);
  int compared = 0, overlapping = 0, pairs = 0, close = 0;
  for (std::uint64_t k = 0; k < 6 * kinds<Spatial>().size(); ++k) {
    const auto it = random_scene<Spatial>(2, k);
    const SystemOf<Spatial> system(it.scene);
    const SpatialMeasure measure(it.scene);
    const State x = disturbed(system, random);
    TermsOf<Spatial> terms(system);
    set_poses(system, 0, x.q, terms.at);
    evaluate_gaps(system, terms), evaluate_joint_residual(system, terms);
    INFO(it.kind, " ", k);
    double loads = 0;
    for (const spatial::Load& l : it.scene.loads)
      if (l.frame == spatial::Frame::world)
        loads += l.force.dot(terms.at.at(l.body).x + terms.at.at(l.body).turn(l.point));
    const double E = energy(system, x);
    CHECK(std::abs(measure.kinetic(x.v) + measure.potential(x.q) + loads - E) < 1e-9 * (1 + std::abs(E)));
    for (std::size_t j = 0; j < it.scene.joints.size(); ++j) {
      const auto phi = terms.phi.segment(system.first_row(j), row_count(it.scene.joints[j]));
      const double most = phi.lpNorm<Eigen::Infinity>();
      const double off = measure.residual(it.scene.joints[j], 0, x.q);  // lengths, or the largest entry
      CHECK(off >= most / 2 - 1e-12);
      CHECK(off <= 2 * phi.norm() + 1e-12);
    }
    for (std::size_t c = 0; c < it.scene.contacts.size(); ++c) {
      const auto* rim = std::get_if<spatial::RimPlane>(&it.scene.contacts[c]);
      if (rim != nullptr && rim->phase != 0) continue;  // here every one stands for the lowest point
      const double gap = measure.gap(it.scene.contacts[c], x.q);
      CHECK(std::abs(gap - terms.gap[static_cast<Index>(c)]) < 1e-9);
      ++compared, overlapping += gap < 0;
    }
    for (const spatial::Collision& c : system.scene().collisions)
      for (std::size_t i = 0; i < c.shapes.size(); ++i)
        for (std::size_t j = i + 1; j < c.shapes.size(); ++j) {
          const spatial::Shape &a = c.shapes[i], &b = c.shapes[j];
          State near = x;  // bodies that may touch
          for (int axis = 0; axis < 3; ++axis)
            near.q[7 * b.body + axis] = x.q[7 * a.body + axis] + random.uniform(-0.25, 0.25);
          set_poses(system, 0, near.q, terms.at);
          const auto points = touch(terms.at.at(a.body), a, terms.at.at(b.body), b);
          double least = kInf;
          for (int p = 0; p < points.count; ++p) least = std::min(least, points.at(p).gap);
          const double gap = measure.gap(a, b, near.q);
          if (gap > 0.2) continue;
          ++pairs, close += gap < 0;
          INFO("shapes ", i, " ", j);
          CHECK((gap < 0) == (least < 0));
          // Of polytopes apart the storm's gap is that between the widest pair of planes, the library's their distance.
          const bool apart = a.polytope() && b.polytope() && gap > 0;
          CHECK((apart || gap >= least - 1e-7));
          if (a.polytope() == b.polytope()) CHECK(gap <= least + 1e-7);
          double corners = kInf;
          for (const Vector3d& p : a.corners)
            for (const Vector3d& r : b.corners)
              corners = std::min(corners, (terms.at.at(a.body).x + terms.at.at(a.body).turn(p) - terms.at.at(b.body).x -
                                           terms.at.at(b.body).turn(r))
                                              .norm());
          if (apart) CHECK(least <= corners + 1e-9);
        }
  }
  MESSAGE(compared, " contacts, ", overlapping, " overlap; ", pairs, " pairs, ", close, " overlap");
  CHECK(compared > 500);
  CHECK(overlapping > 50);
  CHECK(pairs > 20);
}

TEST_CASE("motion storm in space: a twin is the same motion, in other words, and so is the scene's file") {
  const SpatialTwin twins[] = {{.name = "turned", .turn = {0.7, -0.4, 1.1}},
                               {.name = "moved", .d = {3, -2, 1}},
                               {.name = "units", .lambda = 4, .kappa = 0.125, .tau = 2},
                               {.name = "reordered", .reversed = true}};
  for (std::uint64_t k = 0; k < 4 * kinds<Spatial>().size(); ++k) {
    const auto it = random_scene<Spatial>(5, k);
    INFO(it.kind, " ", k);
    const SystemOf<Spatial> system(it.scene);
    TermsOf<Spatial> terms(system);
    const State x = system.initial_state();
    set_poses(system, 0, x.q, terms.at), evaluate_gaps(system, terms), evaluate_joint_residual(system, terms);
    CHECK((terms.phi.size() == 0 || terms.phi.lpNorm<Eigen::Infinity>() < 1e-12));
    const auto scene_read = std::get<spatial::Scene>(parse_any_scene(to_toml(it.scene, "a comment")));
    const SystemOf<Spatial> read(scene_read);
    TermsOf<Spatial> again(read);
    set_poses(read, 0, x.q, again.at), evaluate_gaps(read, again), evaluate_joint_residual(read, again);
    CHECK((read.initial_state().q - x.q).lpNorm<Eigen::Infinity>() < 1e-15);
    CHECK((read.initial_state().v - x.v).lpNorm<Eigen::Infinity>() < 1e-14 * (1 + x.v.lpNorm<Eigen::Infinity>()));
    CHECK((read.mass() - system.mass()).norm() < 1e-12 * system.mass().norm());
    CHECK(read.joint_rows() == system.joint_rows());
    const Index listed = system.listed();
    CHECK(read.contacts() == system.contacts());
    CHECK((again.gap - terms.gap).head(listed).cwiseAbs().sum() < 1e-12);
    for (const SpatialTwin& twin : twins) {
      INFO(std::string(twin.name));
      const SystemOf<Spatial> other(twin_of(it.scene, twin));
      const State y = other.initial_state();
      CHECK(between<Spatial>(back(twin, y.q), x.q).lpNorm<Eigen::Infinity>() < 1e-12);
      TermsOf<Spatial> same(other);
      set_poses(other, 0, y.q, same.at), evaluate_gaps(other, same), evaluate_joint_residual(other, same);
      if (same.phi.size() > 0) CHECK(same.phi.lpNorm<Eigen::Infinity>() < 1e-11);
      for (Index c = 0; c < listed; ++c) {
        const spatial::Contact& contact = it.scene.contacts[static_cast<std::size_t>(c)];
        const auto* limit = std::get_if<spatial::Limit>(&contact);
        const auto* teeth = std::get_if<spatial::Backlash>(&contact);
        const bool angle = (limit != nullptr && limit->of.angle()) || (teeth != nullptr && teeth->gear.second.angle());
        const double unit = angle ? 1 : twin.lambda;
        CHECK(std::abs(same.gap[twin.reversed ? listed - 1 - c : c] / unit - terms.gap[c]) < 1e-11);
      }
    }
  }
}

TEST_CASE("motion storm in space: Painleve's paradox is possible for a rod with much friction, in any direction") {
  const auto possible = [](double mu, double angle, double around) {
    const Vector3d axis(std::cos(angle) * std::cos(around), std::cos(angle) * std::sin(around), std::sin(angle));
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - 0.999 * axis * axis.transpose();
    spatial::Scene s{.gravity = {0, 0, -10}};
    s.body({.mass = 1, .inertia = across / 12, .position = -axis / 2});
    s.contact(spatial::SpherePlane{{}, 0, axis / 2, 0, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = mu}});
    return painleve_possible(s, SystemOf<Spatial>(s).initial_state(), 1e-9);
  };
  // 1 + 3 cos φ (cos φ − μ |sin φ|) < 0, for some φ from μ = 4/3 on.
  for (const double around : {0.0, 0.3, 2.0}) {
    CHECK(possible(1.5, -1.1, around));
    CHECK_FALSE(possible(1.3, -1.1, around));
    CHECK_FALSE(possible(1.5, -0.1, around));
  }
}

TEST_CASE("motion storm in space: friction of a spinning box on four corners is left open, of a sliding one not") {
  const auto open = [](double slide, double spin) {
    spatial::Scene s{.gravity = {0, 0, -10}};
    s.body({.mass = 2, .inertia = spatial::box({0.4, 0.2, 0.1}).inertia * 2, .position = {0, 0, 0.05}});
    s.contact_set(
        spatial::corners_plane({.name = "floor", .a = 0, .law = {.mu = 0.3}}, spatial::box_corners({0.2, 0.1, 0.05})));
    Trace t = rows_of_ball({{0, 0, 0.05, slide, 0}, {0.5, 0, 0.05, slide, 0}, {0.75, 0, 0.05, slide, 0}});
    for (State& x : t.rows) x.v[5] = spin;
    t.pressed = {0, 10, 5};
    return friction_left_open(s, t, 4);
  };
  CHECK(open(1, 0) == 0);
  CHECK(open(0, 0) == 0);
  CHECK(open(1, 3) > 0.01);
}

TEST_CASE("motion storm in space: an impact in the last step leaves friction open from its time on") {
  spatial::Scene s{.gravity = {0, 0, -10}};
  s.body({.mass = 2, .inertia = spatial::box({0.4, 0.2, 0.1}).inertia * 2, .position = {0, 0, 0.05}});
  s.contact_set(
      spatial::corners_plane({.name = "floor", .a = 0, .law = {.mu = 0.3}}, spatial::box_corners({0.2, 0.1, 0.05})));
  Trace t = rows_of_ball({{0, 0, 0.05, 1, 0}, {0.5, 0, 0.05, 1, 0}, {0.75, 0, 0.05, 1, 0}});
  for (State& x : t.rows) x.v[5] = 3;
  t.pressed = {0, 0, 5};
  CHECK(friction_left_open(s, t, 4) == 0);  // what acts at the end moves nothing
  const auto struck_at = [&](double when) {
    t.events = {{when, EventKind::impact, 0, 5, 1.5}};
    return friction_left_open(s, t, 4);
  };
  CHECK(struck_at(0.7) > 0.01);
  CHECK(struck_at(0.65) == doctest::Approx(2 * struck_at(0.7)).epsilon(1e-9));
}

TEST_CASE("motion storm in space: a moment spins a slender body as fast as it does, and no fault is found in that") {
  const auto scene = random_scene<Spatial>(5, 880).scene;  // 0.4 N m about an axis of 7e-8 kg m²
  for (const Verdict& v : judge(scene, {"adaptive"}, 880 / kinds<Spatial>().size(), {60, 30})) {
    INFO(v.integrator, ": ", v.why);
    CHECK(v.result != Result::energy);
  }
}

TEST_CASE("motion storm in space: a fault is shrunk to what it needs, sets of contacts as a whole") {
  const auto whole = random_scene<Spatial>(1, 20).scene;
  REQUIRE(whole.bodies.size() > 1);
  const auto least = shrink(whole, [](const spatial::Scene& s) { return !s.contacts.empty(); });
  check(least);
  CHECK(least.bodies.size() <= 2);
  CHECK(least.joints.empty());

  spatial::Scene can;
  can.body({.position = {0, 0, 1}});
  can.contact_set(spatial::standing_rim({.name = "rim", .centre = {0, 0, -0.1}, .law = {.mu = 0.3, .e = 0.5}}, 1));
  can.contact_set(spatial::standing_rim({.name = "rim", .centre = {0, 0, 0.1}, .law = {.mu = 0.3, .e = 0.5}}, 4));
  for (spatial::Contact& c : can.contacts) std::get<spatial::RimPlane>(c).a = 0;
  can.contact(spatial::SpherePlane{"ball", 0, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, {0, 0, 1}, {}});
  const auto rims = [](const spatial::Scene& s) {
    return std::ranges::count_if(s.contacts,
                                 [](const auto& c) { return std::get_if<spatial::RimPlane>(&c) != nullptr; });
  };
  const auto kept = shrink(can, [&](const spatial::Scene& s) {
    return rims(s) > 0 && std::get<spatial::RimPlane>(s.contacts.at(0)).law.mu > 0;
  });
  CHECK(rims(kept) == 6);
  CHECK(kept.contacts.size() == 6);
  CHECK(std::get<spatial::RimPlane>(kept.contacts[5]).law.e == 0);
  CHECK(std::get<spatial::Scene>(parse_any_scene(to_toml(kept, "kept"))).contacts.size() == 6);
}

TEST_CASE("motion storm in space: a plain motion is without fault by every integrator, a run that lies is found out") {
  for (const Verdict& v : judge(falling_ball(0.5), all_integrators<Spatial>(), 0, {1, 30})) {
    INFO(v.integrator, ": ", v.why);
    CHECK(v.result == Result::solved);
  }
  spatial::Scene wall = falling_ball(0);  // a drive through a wall: no run may end solved
  wall.joint(spatial::Drive{{}, spatial::Slide{kGround, 0, {0, 0, 0.3}, {0, 0, 0}, {0, 0, 1}}, {}});
  std::get<spatial::Drive>(wall.joints[0]).law.rate_of_change = -1;
  for (const Verdict& v : judge(wall, {"moreau-jean", "stewart-trinkle"}, 0, {1, 30}))
    CHECK(v.result == Result::stopped);
}

TEST_CASE("motion storm in space: a scene is the same each time, and all kinds come") {
  std::set<std::string> seen;
  for (std::uint64_t k = 0; k < 100; ++k) {
    const auto a = random_scene<Spatial>(3, k), b = random_scene<Spatial>(3, k);
    CHECK(to_toml(a.scene, "") == to_toml(b.scene, ""));
    CHECK(a.scene.bodies.size() <= 8);
    seen.insert(a.kind);
  }
  CHECK(seen.size() == kinds<Spatial>().size());
}

TEST_CASE("motion storm in space: a share of it, without a crash or numbers that are not finite") {
  const std::uint64_t scenes = kSanitized ? 3 : kinds<Spatial>().size();
  const Tally tally = storm<Spatial>(20, 0, scenes, all_integrators<Spatial>(), {0.5, 30});
  Tally::Counts sum{};
  for (const auto& [key, counts] : tally.rows)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += counts[i];
  for (const Fault& f : tally.faults) {
    const std::string words = f.kind + " " + std::to_string(f.k) + ", " + f.integrator + ": " + f.what + ": " + f.why;
    if (f.what == "crashed" || f.what == "nan")
      FAIL_CHECK(words);
    else
      MESSAGE(words);
  }
  CHECK(sum[static_cast<std::size_t>(Result::solved)] > 4 * scenes);
}

}  // namespace orthant::motion_storm
