// Storm of motions: its measures see what is wrong, twins and files are the same motion, a share of it runs.
#include "experiments/studies/motion_storm/closed_rows.h"
#include "experiments/studies/motion_storm/examine.h"
#include "experiments/studies/motion_storm/judge.h"
#include "experiments/studies/motion_storm/scenes.h"
#include "experiments/studies/motion_storm/shared_load.h"
#include "experiments/studies/motion_storm/shrink.h"
#include "experiments/studies/motion_storm/tally.h"
#include "experiments/studies/motion_storm/twin.h"

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/planar/contact_sets.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/integrators/registry.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "tests/support/sanitized.h"

namespace orthant::motion_storm {
namespace {

Scene falling_disc(double e) {
  Scene s{.gravity = {0, -10}};
  s.body({.mass = 2, .inertia = 0.01, .position = {0, 0.3}});
  s.contact(DiscWall{{}, 0, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.e = e}});
  s.duration = 0.4, s.step = 1e-3;
  return s;
}

Trace made_up(std::initializer_list<std::array<double, 5>> rows) {  // t, x, y, vx, vy of one body
  Trace t;
  for (const auto& r : rows) {
    State x;
    x.t = r[0], x.q = Eigen::Vector3d(r[1], r[2], 0), x.v = Eigen::Vector3d(r[3], r[4], 0);
    t.rows.push_back(x), t.belt.push_back(0), t.pressed.push_back(0);
  }
  return t;
}

/// Numbers of scenes: so many rounds, and one of further kinds.
std::vector<std::uint64_t> some_of_each_kind(std::uint64_t rounds) {
  std::vector<std::uint64_t> all;
  for (std::uint64_t round = 0; round <= 6; ++round)
    for (std::uint64_t i = 0; i < kinds().size() && (round < rounds || of_further_kinds(round)); ++i)
      all.push_back(round * kinds().size() + i);
  return all;
}

}  // namespace

TEST_CASE("motion storm: penetration, energy, passages and numbers that are none are seen in made-up rows") {
  const Scene s = falling_disc(1);
  const Allowance exact{0, 1e-7};
  CHECK(examine(s, made_up({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.1, 0, -2}}), exact).depth_share.value <= 1);
  const Figures deep = examine(s, made_up({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.09, 0, -2}}), exact);
  CHECK(deep.depth.value == doctest::Approx(0.01));
  CHECK(deep.depth_share.value > 1);
  CHECK(examine(s, made_up({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.09, 0, -2}}), {1e-2, 0}).depth_share.value < 1);  // h v
  CHECK(examine(s, made_up({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.1, 0, -2}}), exact).gain.value == 0);
  CHECK(examine(s, made_up({{0, 0, 0.3, 0, 0}, {0.2, 0, 0.1, 0, -2.1}}), exact).gain.value == doctest::Approx(0.41));
  CHECK_FALSE(examine(s, made_up({{0, 0, 0.3, 0, NAN}}), exact).finite);

  Scene peg;
  peg.body({.mass = 1, .inertia = 0.01, .position = {-1, 0}, .velocity = {1, 0}});
  peg.contact(DiscDisc{{}, 0, {0, 0}, 0.1, kGround, {0, 0}, 0.1, {}});
  const auto over = made_up({{0, -0.3, 0, 60, 0}, {0.01, 0.3, 0, 60, 0}});
  CHECK(examine(peg, over, {0.01, 0}).passed.value > 0.9);
  CHECK(examine(peg, made_up({{0, -0.3, 0.3, 60, 0}, {0.01, 0.3, 0.3, 60, 0}}), {0.01, 0}).passed.value == 0);
}

TEST_CASE("motion storm: gaps, joints and energy are those of the library, by other code, at random states") {
  Random random(3);
  int compared = 0, overlapping = 0;
  for (const std::uint64_t k : some_of_each_kind(4)) {
    const RandomScene it = random_scene(2, k);
    const System system(it.scene);
    const Measure measure(it.scene);
    State x = system.initial_state();
    for (Eigen::Index i = 0; i < x.q.size(); ++i) x.q[i] += random.uniform(-0.2, 0.2), x.v[i] = random.uniform(-2, 2);
    Terms terms(system);
    set_poses(system, 0, x.q, terms.at);
    evaluate_gaps(system, terms), evaluate_joint_residual(system, terms);
    INFO(it.kind, " ", k);
    double loads = 0;
    for (const Load& l : it.scene.loads)
      loads +=
          l.force.dot(terms.at.at(l.body).x + terms.at.at(l.body).turn(l.point)) + l.torque * terms.at.at(l.body).theta;
    const double E = energy(system, x);
    CHECK(std::abs(measure.kinetic(x.v) + measure.potential(x.q) + loads - E) < 1e-9 * (1 + std::abs(E)));
    for (std::size_t j = 0; j < it.scene.joints.size(); ++j) {
      double most = 0;
      for (int r = 0; r < row_count(it.scene.joints[j]); ++r)
        most = std::max(most, std::abs(terms.phi[system.first_row(j) + r]));
      const double off = measure.residual(it.scene.joints[j], 0, x.q);  // length of a vector, or its largest entry
      CHECK(off >= most - 1e-12);
      CHECK(off <= std::numbers::sqrt2 * most + 1e-12);
    }
    for (std::size_t c = 0; c < it.scene.contacts.size(); ++c) {
      if (std::holds_alternative<PolygonPolygon>(it.scene.contacts[c])) continue;  // two points; here one gap
      if (std::holds_alternative<DiscPolygon>(it.scene.contacts[c]) && (it.kind == "seams" || it.kind == "terrain"))
        continue;  // faces are covered
      const double gap = measure.gap(it.scene.contacts[c], x.q);
      CHECK(gap == doctest::Approx(terms.gap[static_cast<Index>(c)]).epsilon(1e-9));
      ++compared, overlapping += gap < 0;
    }
  }
  CHECK(compared > 200);
  CHECK(overlapping > 20);
}

TEST_CASE("motion storm: rows of joints and contacts are those of the library, by other code") {
  Random random(4);
  int compared = 0, of_polygons = 0;
  for (const std::uint64_t k : some_of_each_kind(4)) {
    const RandomScene it = random_scene(3, k);
    const System system(it.scene);
    INFO(it.kind, " ", k);
    for (const bool moved : {false, true}) {
      State x = system.initial_state();
      for (Eigen::Index i = 0; i < x.q.size(); ++i)
        x.q[i] += moved ? random.uniform(-0.2, 0.2) : 0, x.v[i] = random.uniform(-2, 2);
      const double gap = moved ? 100 : 1e-7;  // [m]
      const ClosedRows own = closed_rows(it.scene, x, gap);
      Terms terms(system);
      set_poses(system, 0, x.q, terms.at);
      evaluate_joint_rows(system, terms), evaluate_gaps(system, terms), evaluate_closed(system, gap, terms);
      const auto rate = [&](const Row& row) { return apply(row, x.v.data()); };
      CHECK(own.inverse_mass == system.inverse_mass());
      REQUIRE(own.joints.size() == terms.G.size());
      for (std::size_t i = 0; i < terms.G.size(); ++i)
        CHECK(std::abs(std::abs(own.joints[i].dot(x.v)) - std::abs(rate(terms.G[i]))) < 1e-12 * (1 + x.v.norm()));
      std::size_t comparable = 0;
      const bool covers = it.kind == "seams" || it.kind == "terrain";
      for (const ClosedContact& c : terms.closed) {
        const bool polygons =
            std::holds_alternative<PolygonPolygon>(it.scene.contacts[static_cast<std::size_t>(c.contact)]);
        if (covers || (polygons && moved)) continue;  // covered faces; ends that are far
        ++comparable;
        const ContactLaw& law = system.law(c.contact);
        const bool found = std::ranges::any_of(own.contacts, [&](const ClosedContactRows& o) {
          const bool normal = std::abs(o.normal.dot(x.v) - rate(c.rows.normal)) < 1e-6;
          const bool slip = !law.frictional() || moved || std::abs(o.slip[0] + law.belt - rate(c.rows.tangent)) < 1e-6;
          return std::abs(o.gap - terms.gap[c.contact]) < 1e-9 && normal && slip;
        });
        CHECK_MESSAGE(found, "contact ", c.contact);
        ++compared, of_polygons += polygons;
      }
      if (!moved && !covers) CHECK(own.contacts.size() == comparable);
    }
  }
  CHECK(compared > 200);
  CHECK(of_polygons > 20);
}

TEST_CASE("motion storm: a twin is the same motion, in other words, and so is the scene's file") {
  const Twin twins[] = {{.name = "mirrored", .m = -1},
                        {.name = "turned", .phi = 0.7},
                        {.name = "moved", .d = {3, -2}},
                        {.name = "units", .lambda = 4, .kappa = 0.125, .tau = 2},
                        {.name = "reordered", .reversed = true}};
  for (const std::uint64_t k : some_of_each_kind(2)) {
    const RandomScene it = random_scene(5, k);
    INFO(it.kind, " ", k);
    const System system(it.scene);
    Terms terms(system);
    const State x = system.initial_state();
    set_poses(system, 0, x.q, terms.at), evaluate_gaps(system, terms);
    const System read(parse_scene(to_toml(it.scene, "a comment")));
    Terms again(read);
    set_poses(read, 0, x.q, again.at), evaluate_gaps(read, again);
    CHECK(read.initial_state().q == x.q);
    CHECK(read.mass() == system.mass());
    CHECK(read.joint_rows() == system.joint_rows());
    CHECK((again.gap - terms.gap).lpNorm<Eigen::Infinity>() < 1e-14);  // directions are made units once more
    for (const Twin& twin : twins) {
      INFO(std::string(twin.name));
      const System other(twin_of(it.scene, twin));
      const State y = other.initial_state();
      CHECK((back(twin, y.q) - x.q).lpNorm<Eigen::Infinity>() < 1e-12);
      Terms same(other);
      set_poses(other, 0, y.q, same.at), evaluate_gaps(other, same), evaluate_joint_residual(other, same);
      if (same.phi.size() > 0) CHECK(same.phi.lpNorm<Eigen::Infinity>() < 1e-11);
      const auto n = terms.gap.size();
      if (twin.m < 0) continue;  // corners in the opposite order: contacts of a pair change places
      for (Index c = 0; c < n; ++c) {
        const auto* limit = std::get_if<Limit>(&it.scene.contacts[static_cast<std::size_t>(c)]);
        const double unit = limit != nullptr && std::holds_alternative<Angle>(limit->of) ? 1 : twin.lambda;
        CHECK(std::abs(same.gap[twin.reversed ? n - 1 - c : c] / unit - terms.gap[c]) < 1e-11);
      }
    }
  }
}

TEST_CASE("motion storm: twins and output steps agree where rounding decided before") {
  const std::pair<std::uint64_t, const char*> seen[] = {
      {934, "event-driven"},     // impacts in turn, which a crossing cut off
      {1055, "event-driven"},    // impacts in turn of two contacts that touch to rounding
      {971, "event-driven"},     // an overlap at the start, closed by one Newton step
      {1674, "event-driven"},    // redundant joints of unlike masses
      {624, "moreau-jean"},      // velocities below the normal numbers
      {287, "anitescu-potra"}};  // a gap that is zero to rounding, closed on one side only
  for (const auto& [number, scheme] : seen)
    for (const Verdict& v : judge(random_scene(2, number).scene, {scheme}, number, {10, 30})) {
      INFO(number, " ", v.integrator, ": ", v.why);
      CHECK_FALSE(fault(v.result));
    }
}

TEST_CASE("motion storm: a fault is shrunk to what it needs") {
  const Scene whole = random_scene(1, 20 + 21).scene;
  REQUIRE(whole.bodies.size() > 1);
  const auto shows = [](const Scene& s) { return !s.contacts.empty(); };
  const Scene least = shrink(whole, shows);
  check(least);
  CHECK(least.bodies.size() == 1);
  CHECK(least.joints.empty());
  CHECK(least.contacts.size() == 1);
}

TEST_CASE("motion storm: the law of a pair of polygons is shrunk at both of its points, as its file has one") {
  Scene s;
  s.body({.mass = 1, .inertia = 0.1, .position = {0, 0.1}});
  const Polygon box = rectangle(0.4, 0.2), tile{{-1, -0.2}, {1, -0.2}, {1, 0}, {-1, 0}};
  s.contact_set(polygon_polygon({"tile", 0, box, kGround, tile, 0, {.mu = 0.3, .e = 0.5}}));
  const auto friction = [](const Scene& x, std::size_t k) { return std::get<PolygonPolygon>(x.contacts.at(k)).law.mu; };
  const Scene least =
      shrink(s, [&](const Scene& x) { return x.contacts.size() == 2 && (friction(x, 0) > 0 || friction(x, 1) > 0); });
  CHECK(friction(least, 0) == 0.3);
  CHECK(friction(least, 1) == 0.3);
  CHECK(std::get<PolygonPolygon>(least.contacts[1]).law.e == 0);
}

TEST_CASE("motion storm: friction of a box on a seam is left open where the tiles differ in it, and by how much") {
  const auto open = [](double left, double right, double belt, double x, double speed) {
    Scene s{.gravity = {0, -10}};
    s.body({.mass = 2, .inertia = 0.1, .position = {x, 0.1}, .velocity = {speed, 0}});
    const Polygon box = rectangle(0.4, 0.2);
    s.contact_set(polygon_polygon({"l", 0, box, kGround, {{-1, -0.2}, {0, -0.2}, {0, 0}, {-1, 0}}, 0, {.mu = left}}));
    s.contact_set(polygon_polygon(
        {"r", 0, box, kGround, {{0, -0.2}, {1, -0.2}, {1, 0}, {0, 0}}, 0, {.mu = right, .belt = belt}}));
    Trace t = made_up({{0, x, 0.1, speed, 0}, {0.5, x, 0.1, speed, 0}, {0.75, x, 0.1, speed, 0}});
    t.pressed = {0, 10, 5};  // [N s]
    return friction_left_open(s, t, 4);
  };
  CHECK(open(0.3, 0.1, 0, 0, 1) == doctest::Approx(0.2 * 10 / 2 * 0.25 / 4).epsilon(1e-12));
  CHECK(open(0.3, 0.3, 0, 0, 1) == 0);                                                        // one friction
  CHECK(open(0.3, 0.1, 0, 0.5, 1) == 0);                                                      // one tile
  CHECK(open(0.3, 0.1, 0, 0, 0) == 0);                                                        // at rest
  CHECK(open(0.3, 0.3, 2, 0, 1) == doctest::Approx(0.6 * 10 / 2 * 0.25 / 4).epsilon(1e-12));  // a belt that is faster
}

TEST_CASE("motion storm: a box that slides from a rough tile to a smooth one is judged by what friction leaves open") {
  const std::uint64_t k = 800;
  const Scene scene = random_scene(2, k).scene;
  for (const Verdict& v : judge(scene, {"rattle", "generalized-alpha"}, k / kinds().size(), {1, 30})) {
    INFO(v.integrator, ": ", v.why);
    CHECK(v.result == Result::solved);
  }
  // Onto one without friction: what friction is left depends on the share of the load.
  const Scene smooth = random_scene(3, 212).scene;
  CHECK(judge(smooth, {"paoli-schatzman"}, 212 / kinds().size(), {1, 30})[0].result == Result::solved);
  Scene same = scene;  // all tiles alike: the motion is determined, and no place changes it
  for (Contact& c : same.contacts) std::get<PolygonPolygon>(c).law.mu = 0.3;
  const Twin moved{.name = "moved", .d = {3.1, -1.7}};
  for (const std::string spec : {"rattle", "generalized-alpha"}) {
    INFO(spec);
    const Trace there = trace(twin_of(same, moved), spec, same.step, 1, 30);
    const Trace here = trace(same, spec, same.step, 1, 30);
    REQUIRE(here.rows.size() == there.rows.size());
    CHECK(friction_left_open(same, here, 1) == 0);
    for (std::size_t r = 0; r < here.rows.size(); ++r)
      CHECK((back(moved, there.rows[r].q) - here.rows[r].q).lpNorm<Eigen::Infinity>() < 1e-10);
  }
}

TEST_CASE(
    "motion storm: what a scheme of fixed step warns of its energy counts as reported, a precise one's does not") {
  const Scene s = falling_disc(1);
  Trace t = made_up({{0, 0, 0.3, 0, 0},  // + 1 J after three rows, which count together
                     {0.1, 0, 0.3, 0, 0},
                     {0.2, 0, 0.3, 0, 0},
                     {0.3, 0, 0.3, 0, -1},
                     {0.4, 0, 0.3, 0, -1},
                     {0.5, 0, 0.3, 0, -1}});
  const Allowance fixed{1e-2, 1e-7}, exact{0, 1e-7};
  CHECK(examine(s, t, fixed).gain.value == doctest::Approx(1));
  t.run.motion.energy_defect = 0.9, t.run.motion.energy_scale = 1;
  CHECK(examine(s, t, fixed).gain.value == doctest::Approx(0.1));
  CHECK(examine(s, t, exact).gain.value == doctest::Approx(1));
  t.run.motion.energy_scale = 100;  // then it does not warn
  CHECK(examine(s, t, fixed).gain.value == doctest::Approx(1));
}

TEST_CASE("motion storm: scenes in which a scheme of fixed step was at fault, or called so, are judged rightly") {
  struct Case {
    std::uint64_t seed, k;
    const char* scheme;
    Result result;
  };
  for (const Case& c : {Case{2, 321, "moreau-jean", Result::solved},
                        {2, 613, "moreau-jean", Result::solved},
                        {2, 2013, "moreau-jean", Result::solved},
                        {2, 2041, "stewart-trinkle", Result::solved},
                        {2, 2041, "paoli-schatzman", Result::solved},
                        {2, 1174, "moreau-jean", Result::stopped},
                        {2, 796, "rattle", Result::solved},
                        {1, 426, "paoli-schatzman", Result::solved},
                        {2, 949, "paoli-schatzman", Result::solved},
                        {2, 1289, "paoli-schatzman", Result::solved},
                        {2, 2167, "moreau-jean", Result::solved},
                        {3, 232, "rattle", Result::solved},            // energies of rounding, at rest
                        {3, 1121, "rattle", Result::solved},           // likewise
                        {3, 716, "event-driven", Result::solved},      // tiles of unlike friction under one box
                        {3, 6448, "moreau-jean", Result::solved},      // friction that can jam: several motions
                        {3, 4499, "adaptive", Result::solved},         // a contact within the tolerance joins an impact
                        {3, 412, "paoli-schatzman", Result::solved},   // an overlap that the run warns of
                        {3, 629, "stewart-trinkle", Result::solved},   // a taut rope, as another one strikes
                        {3, 1270, "paoli-schatzman", Result::solved},  // contacts that last, as another one strikes
                        {3, 1535, "adaptive", Result::solved},         // tiles of unlike friction, in an impact
                        {3, 1571, "stewart-trinkle", Result::solved},  // opens at the start as another one strikes
                        {3, 4889, "rattle", Result::solved},           // strikes a microsecond after another one
                        {3, 1811, "moreau-jean", Result::solved},      // few steps a bounce
                        {3, 2449, "event-driven", Result::stopped},    // where Painlevé's paradox begins
                        {2, 1530, "moreau-jean", Result::solved},      // pressed out of a wedge that a drive closes
                        {2, 869, "adaptive", Result::solved},          // a belt's friction within long inner steps
                        {11, 530, "rattle", Result::solved},           // a corner jams in a wedge
                        {11, 676, "rattle", Result::stopped}}) {       // a rough disc in a propeller's way
    const Verdict v =
        judge(random_scene(c.seed, c.k).scene, {c.scheme}, c.k / kinds().size(), {kSanitized ? 30.0 : 5.0, 30})[0];
    INFO(c.seed, " ", c.k, " ", c.scheme, ": ", v.why);
    CHECK(v.result == c.result);
  }
}

TEST_CASE("motion storm: a plain motion is found without fault by every integrator, and a run that lies is found out") {
  for (const Verdict& v : judge(falling_disc(0.5), all_integrators(), 0, {1, 30})) {
    INFO(v.integrator, ": ", v.why);
    CHECK(v.result == Result::solved);
  }
  // A drive through a wall would be a lie; no run may end solved.
  Scene wall = falling_disc(0);
  wall.joint(Drive{{}, Slide{kGround, 0, {0, 0.3}, {0, 0}, {0, 1}}, {.offset = 0, .rate_of_change = -1}});
  for (const Verdict& v : judge(wall, {"moreau-jean", "stewart-trinkle"}, 0, {1, 30}))
    CHECK(v.result == Result::stopped);
}

TEST_CASE("motion storm: a scene is the same each time, all kinds come, and a tally survives its text") {
  std::set<std::string> seen;
  for (std::uint64_t k = 0; k < 100; ++k) {
    const RandomScene a = random_scene(3, k), b = random_scene(3, k);
    CHECK(to_toml(a.scene, "") == to_toml(b.scene, ""));
    CHECK(a.scene.bodies.size() <= 8);
    seen.insert(a.kind);
  }
  CHECK(seen.size() == kinds().size());
  Tally tally;
  tally.count("stack", "rattle", Result::twin);
  tally.faults.push_back({7, "stack", "rattle", "twin", "why"});
  const Tally again = tally_from_text(to_text(tally));
  CHECK(again.rows == tally.rows);
  CHECK(again.faults.at(0).why == "why");
}

TEST_CASE("motion storm: a share of it, without a crash or numbers that are not finite") {
  const std::uint64_t scenes = kSanitized ? 5 : kinds().size();
  const Tally tally = storm(20, 0, scenes, all_integrators(), {1, 30});
  Tally::Counts sum{};
  for (const auto& [key, counts] : tally.rows)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += counts[i];
  for (const Fault& f : tally.faults) {
    const std::string words = f.kind + " " + std::to_string(f.k) + ", " + f.integrator + ": " + f.what + ": " + f.why;
    if (f.what == "crashed")
      FAIL_CHECK(words);
    else
      MESSAGE(words);
  }
  CHECK(sum[static_cast<std::size_t>(Result::solved)] > 4 * scenes);
}

}  // namespace orthant::motion_storm
