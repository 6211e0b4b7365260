// Bodies that do not act on one another are solved apart: the same motion, no allocation. Those at rest may sleep.
#include "tests/support/allocations.h"
#include "tests/support/runs.h"

#include <orthant/integrators/step/islands.h>

#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <barrier>
#include <cmath>
#include <stdexcept>

using namespace orthant;

namespace {

struct End {
  Eigen::VectorXd q, v;
  long solves = 0, iterations = 0;
  bool operator==(const End& other) const {
    return q == other.q && v == other.v && solves == other.solves && iterations == other.iterations;
  }
};

/// n stacks of two discs each on a floor, thrown at each other's floor at different times, `apart` metres between them.
Scene stacks(int n, double mu, double apart = 3) {
  Scene s;
  s.gravity = {0, -9.81};
  s.duration = 1;
  for (int i = 0; i < n; ++i) {
    const double x = apart * i, y = 0.6 + 0.01 * (i % 7);
    const auto low = s.body({.inertia = 0.1, .position = {x, y}, .velocity = {0.3, 0}});
    const auto high = s.body({.inertia = 0.1, .position = {x + 0.01, y + 1}, .omega = 1});
    const ContactLaw law{.mu = mu, .e = 0.3};
    s.contact(DiscWall{"", low, {0, 0}, 0.5, kGround, {0, 0}, {0, 1}, law});
    s.contact(DiscDisc{"", high, {0, 0}, 0.5, low, {0, 0}, 0.5, law});
    s.contact(DiscWall{"", high, {0, 0}, 0.5, kGround, {0, 0}, {0, 1}, law});
  }
  return s;
}

/// The same mechanism as one island: springs of no stiffness join all bodies.
Scene joined(Scene s) {
  for (BodyId b = 1; b < static_cast<BodyId>(s.bodies.size()); ++b) s.spring(TorsionSpring{"", b - 1, b});
  return s;
}

}  // namespace

TEST_CASE("islands: components by joints, springs and contacts, rows in order") {
  Scene s;
  for (int i = 0; i < 6; ++i) s.body({.position = {i, 0}});
  s.joint(Revolute{"", 0, 2, {1, 0}, {-1, 0}});
  s.spring(PointSpring{"", 3, 4});
  s.spring(PointSpring{"", 3, kGround});
  Islands islands((System(s)));
  const auto row = [](BodyId a, BodyId b) { return Row{a, b, {}, {}}; };
  const std::vector<Row> rows = {row(1, kGround), row(kGround, 4), row(2, kGround),
                                 row(5, 1),       row(0, kGround), row(3, 4)};
  islands.sort(rows);
  REQUIRE(islands.count() == 3);
  const auto is = [&](int block, std::vector<int> expected) {
    const auto found = islands.rows(block);
    return std::vector<int>(found.begin(), found.end()) == expected;
  };
  CHECK(is(0, {0, 3}));
  CHECK(is(1, {1, 5}));
  CHECK(is(2, {2, 4}));
  islands.sort(std::vector<Row>{row(1, kGround), row(5, kGround), row(0, 1)});  // forgets the last contacts
  CHECK(islands.count() == 2);
}

TEST_CASE("solved apart is solved as a whole") {
  for (const char* integrator : {"moreau-jean", "moreau-jean:form=full", "stewart-trinkle", "anitescu-potra", "rattle"})
    for (const double mu : {0.0, 0.4})
      for (const int n : {3, 24}) {  // dense, and more rows than a dense matrix is formed for
        if (n > 3 && std::string_view(integrator) != "moreau-jean") continue;
        CAPTURE(integrator);
        CAPTURE(n);
        const Scene scene = stacks(n, mu);
        const Run apart = run(scene, integrator, 4e-3), whole = run(joined(scene), integrator, 4e-3);
        REQUIRE(apart.status == Status::solved);
        REQUIRE(whole.status == Status::solved);
        CHECK((apart.final.q - whole.final.q).lpNorm<Eigen::Infinity>() < 1e-9);
        CHECK(apart.lcp_solves > whole.lcp_solves);
      }
}

TEST_CASE("an island moves as it does alone, to the bit") {
  const Run one = run(stacks(1, 0.4), "moreau-jean", 2e-3), many = run(stacks(7, 0.4), "moreau-jean", 2e-3);
  REQUIRE(many.status == Status::solved);
  CHECK(many.final.q.head(6) == one.final.q);
}

TEST_CASE("parallel islands give the bits of sequential ones, with any number of threads") {
  const System system(stacks(60, 0.4));  // 240 rows, once all lie
  for (const char* integrator : {"moreau-jean", "rattle"})
    for (const char* solver : {"lemke", "auto", "psor"}) {
      CAPTURE(integrator);
      CAPTURE(solver);
      const auto end = [&](int helpers) {
        const auto scheme = make_integrator(integrator, system);
        std::vector<std::unique_ptr<Solver>> more;
        for (int i = 0; i < helpers; ++i) more.push_back(make_solver(solver));
        scheme->employ(std::move(more));
        const auto one = make_solver(solver);
        State x = system.initial_state();
        End result;
        for (int k = 0; k < 120; ++k) {
          const StepReport report = scheme->step(4e-3, *one, x);
          result.solves += report.lcp_solves, result.iterations += report.lcp_iterations;
          if (report.status != Status::solved) break;
        }
        result.q = x.q, result.v = x.v;
        return result;
      };
      const End alone = end(0);
      CHECK(alone.solves > 1000);
      CHECK(end(1) == alone);
      CHECK(end(7) == alone);
    }
}

TEST_CASE("a pool works at the same time, does each task once, and tells the first failure") {
  std::vector<std::unique_ptr<Solver>> helpers;
  for (int i = 0; i < 2; ++i) helpers.push_back(make_solver("pgs"));
  SolverPool pool(std::move(helpers));
  const auto own = make_solver("pgs");
  REQUIRE(pool.size() == 3);
  std::barrier together(3);  // one worker alone would wait here for ever
  pool.run(3, *own, [&](int, Solver&, int) { together.arrive_and_wait(); });
  std::array<std::atomic<int>, 100> done{};
  for (int round = 0; round < 50; ++round)
    pool.run(100, *own, [&](int task, Solver&, int worker) {
      if (worker >= 0 && worker < 3) ++done[static_cast<std::size_t>(task)];
    });
  for (const auto& times : done) CHECK(times == 50);
  auto fails = [](int task, Solver&, int) {
    if (task == 3 || task == 40) throw std::runtime_error(std::to_string(task));
  };
  CHECK_THROWS_WITH_AS(pool.run(60, *own, fails), "3", std::runtime_error);
}

TEST_CASE("solving apart and sleeping allocate nothing after the first steps") {
  for (const char* spec : {"moreau-jean", "moreau-jean:sleep_after=0.05"}) {
    const System system(stacks(24, 0.4));
    const auto scheme = make_integrator(spec, system);
    const auto solver = make_solver("lemke");
    State x = system.initial_state();
    for (int k = 0; k < 1000; ++k) scheme->step(2e-3, *solver, x);
    const auto before = AllocationCount::now();
    for (int k = 0; k < 200; ++k) scheme->step(2e-3, *solver, x);
    CHECK(AllocationCount::now() == before);
  }
}

namespace {

/// A block of two corners on a rough floor, and one on top of it.
Scene blocks() {
  Scene s;
  s.gravity = {0, -9.81};
  s.duration = 2;
  for (int i = 0; i < 2; ++i) {
    const auto block = s.body({.inertia = 0.2, .position = {0, 0.5 + i}});
    for (const double x : {-0.5, 0.5})
      s.contact(CornerWall{"", block, {x, -0.5}, block - 1, {0, i == 0 ? 0.0 : 0.5}, {0, 1}, {.mu = 0.5}});
  }
  return s;
}

struct Nap {
  long solves = 0;
  State final;
};

Nap nap(const Scene& scene, const std::string& options) {
  const Run r = run(scene, "moreau-jean" + options, 1e-3);
  REQUIRE(r.status == Status::solved);
  return {r.lcp_solves, r.final};
}

void check_wakes(const Scene& scene, double moves) {
  const Nap awake = nap(scene, ""), asleep = nap(scene, ":sleep_after=0.1");
  CHECK(asleep.solves < awake.solves * 3 / 4);
  CHECK((asleep.final.q - awake.final.q).lpNorm<Eigen::Infinity>() < 1e-5);
  CHECK((asleep.final.q - System(scene).initial_state().q).lpNorm<Eigen::Infinity>() > moves);
}

}  // namespace

TEST_CASE("an island at rest sleeps, its contact forces stay") {
  const Scene scene = blocks();
  const System system(scene);
  const auto scheme = make_integrator("moreau-jean:sleep_after=0.1", system);
  const auto solver = make_solver("lemke");
  State x = system.initial_state();
  for (int k = 0; k < 300; ++k) {
    const StepReport report = scheme->step(1e-3, *solver, x);
    REQUIRE(report.status == Status::solved);
    CHECK((report.lcp_solves == 0) == (k >= 100));
    const auto& p = scheme->impulses();
    CHECK(p[0].normal + p[1].normal == doctest::Approx(2 * 9.81e-3).epsilon(1e-9));
    CHECK(p[2].normal + p[3].normal == doctest::Approx(9.81e-3).epsilon(1e-9));
  }
  x.v[3] = 0.5;  // another state than the one returned
  CHECK(scheme->step(1e-3, *solver, x).lcp_solves > 0);
  CHECK(x.v[3] > 0.4);
  CHECK(nap(blocks(), "").solves == 2000);  // off by default
}

TEST_CASE("a sleeping island wakes on a contact, on a load, and not before") {
  Scene hit = blocks();
  hit.duration = 1.5;
  const auto ball = hit.body({.mass = 3, .inertia = 1, .position = {-8, 1.5}, .velocity = {8, 9.81 / 2}});
  hit.contact(DiscWall{"side", ball, {0, 0}, 0.2, 1, {-0.5, 0}, {-1, 0}, {.e = 0.5}});
  check_wakes(hit, 0.05);

  Scene pushed = blocks();
  pushed.load({.name = "push", .body = 1, .force = {8, 0}, .factor = [](double t) { return std::max(0.0, t - 1); }});
  check_wakes(pushed, 0.05);

  Scene belt = blocks();  // slides under a body that is held: not at rest
  for (Contact& c : belt.contacts) std::get<CornerWall>(c).law.belt = 0.1;
  belt.joint(Prismatic{"held", kGround, 0, {0, 0.5}, {0, 0}, {0, 1}});
  belt.joint(Prismatic{"too", kGround, 1, {0, 1.5}, {0, 0}, {0, 1}});
  CHECK(nap(belt, ":sleep_after=0.1").solves == 2000);
}
