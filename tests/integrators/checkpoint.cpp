// A run that goes on from a checkpoint takes the bits that the run takes that wrote it.
#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

struct Trace {
  std::string bits;
  int records = 0;
  Run run;
};

void put(Trace& trace, const void* data, std::size_t size) { trace.bits.append(static_cast<const char*>(data), size); }

template <class Space> Trace trace_of(const SystemOf<Space>& system, const std::string& integrator, const Clock& clock,
                                      const Restart& restart, const std::string& solver_name = "lemke") {
  const auto scheme = make_integrator(integrator, system);
  const auto solver = make_solver(solver_name);
  Trace trace;
  const auto record = [&](const RunSampleOf<Space>& m) {
    ++trace.records;
    put(trace, &m.state.t, sizeof m.state.t);
    for (const Eigen::VectorXd* x : {&m.state.q, &m.state.v, &m.gaps})
      put(trace, x->data(), static_cast<std::size_t>(x->size()) * sizeof(double));
    put(trace, m.impulses.data(), m.impulses.size() * sizeof(m.impulses[0]));
    put(trace, m.frictions.data(), m.frictions.size() * sizeof(double));
    for (const Event& event : m.events) put(trace, &event.t, sizeof event.t);
  };
  trace.run = simulate(*scheme, *solver, clock, record, restart);
  return trace;
}

/// Returns how many continuations were compared.
template <class Space> int continue_all(const std::string& name, const typename ElementsOf<Space>::Scene& scene,
                                        double longest_step, const std::string& solver) {
  int compared = 0;
  for (const auto& entry : integrators()) {
    if (!kPlanar<Space> && entry.make_spatial == nullptr) continue;
    const std::string integrator(entry.name);
    const SystemOf<Space> system(scene);
    const double step = std::min(system.scene().step, longest_step);
    const Clock clock{.step = step, .duration = 30 * step, .every = 3};
    INFO(name, " ", integrator);
    std::vector<std::string> kept;
    Restart restart{.every = 9, .save = [&](const std::string& bytes) { kept.push_back(bytes); }, .from = ""};
    Trace whole;
    try {
      whole = trace_of<Space>(system, integrator, clock, restart, solver);
    } catch (const std::invalid_argument&) {
      continue;  // this integrator does not take this scene
    }
    if (whole.run.status == Status::solved) CHECK(kept.size() == 3);
    const std::vector<std::string> first = kept;
    for (std::size_t k = 0; k < first.size(); k += 2) {
      INFO("checkpoint ", k);
      kept.clear();
      restart.from = first[k];
      const Trace rest = trace_of<Space>(system, integrator, clock, restart, solver);
      ++compared;
      REQUIRE(rest.bits.size() <= whole.bits.size());
      CHECK((whole.bits.substr(whole.bits.size() - rest.bits.size()) == rest.bits));
      CHECK(rest.records < whole.records);
      CHECK(rest.run.status == whole.run.status);
      CHECK((rest.run.final.q == whole.run.final.q && rest.run.final.v == whole.run.final.v));
      CHECK(rest.run.steps == whole.run.steps);
      CHECK(rest.run.events == whole.run.events);
      CHECK(rest.run.lcp_iterations == whole.run.lcp_iterations);
      CHECK(rest.run.max_penetration == whole.run.max_penetration);
      CHECK(rest.run.motion.work == whole.run.motion.work);
      CHECK(rest.run.motion.energy_defect == whole.run.motion.energy_defect);
      CHECK(kept.size() == first.size() - k - 1);
      restart.from.clear();
    }
  }
  return compared;
}

}  // namespace

TEST_CASE("every integrator goes on from every checkpoint of every scene bit for bit") {
  int compared = 0;
  for (const auto& scene : scenes())
    compared += continue_all<Planar>(std::string(scene.name), make_scene(scene.name), 2e-3, "lemke");
  MESSAGE(compared, " continuations");
  CHECK(compared > 100);
}

TEST_CASE("every integrator goes on from every checkpoint of every scene in space bit for bit") {
  int compared = 0;
  for (const auto& scene : spatial_scenes()) {
    if (scene.name == "kapla_tower" || scene.name == "card_house" || scene.name == "box_pyramid" ||
        scene.name == "spheres")
      continue;  // whose steps take longest
    compared += continue_all<Spatial>(std::string(scene.name), std::get<spatial::Scene>(make_any_scene(scene.name)),
                                      1e-3, "auto");
  }
  MESSAGE(compared, " continuations");
  CHECK(compared > 100);
}

TEST_CASE("sleeping bodies sleep on, loads of joints are known") {
  const System system(make_scene("bouncing_ball"));
  const Clock clock{.step = 1e-3, .duration = 3};
  std::string kept;
  Restart restart{.every = 2900, .save = [&](const std::string& bytes) { kept = bytes; }, .from = ""};
  const Trace whole = trace_of(system, "moreau-jean:sleep_after=0.05", clock, restart);
  REQUIRE(!kept.empty());
  restart.from = kept;
  const Trace rest = trace_of(system, "moreau-jean:sleep_after=0.05", clock, restart);
  CHECK((whole.bits.substr(whole.bits.size() - rest.bits.size()) == rest.bits));
}

TEST_CASE("a checkpoint that does not fit is refused in words") {
  const System ball(make_scene("bouncing_ball")), crank(make_scene("slider_crank"));
  std::string kept;
  const Clock clock{.step = 1e-3, .duration = 0.02};
  Restart restart{.every = 10, .save = [&](const std::string& bytes) { kept = bytes; }, .from = ""};
  trace_of(ball, "moreau-jean", clock, restart);
  const auto refused = [&](const System& system, const char* integrator, const Clock& c, const std::string& from) {
    Restart bad{.every = 0, .save = {}, .from = from};
    CHECK_THROWS_AS(trace_of(system, integrator, c, bad), std::invalid_argument);
  };
  refused(crank, "moreau-jean", clock, kept);
  refused(ball, "event-driven", clock, kept);
  refused(ball, "moreau-jean", {.step = 2e-3, .duration = 0.02}, kept);
  refused(ball, "moreau-jean", clock, kept.substr(0, kept.size() / 2));
  refused(ball, "moreau-jean", clock, kept + "x");
  refused(ball, "moreau-jean", clock, std::string(200, '\xff'));
}

TEST_CASE("a run ends at its time limit and at a raised flag, with what it has; every scheme looks") {
  for (const auto& entry : integrators()) {
    const System system(make_scene("slider_crank"));
    const auto scheme = make_integrator(entry.name, system);
    const auto solver = make_solver("lemke");
    INFO(std::string(entry.name));
    const Clock limited{.step = 1e-6, .duration = 100, .time_limit = 0.05};
    const Run late = simulate(*scheme, *solver, limited);
    CHECK(late.status == Status::time_limit);
    CHECK(late.final.t < 100);
    const std::atomic<bool> raised{true};
    const Run stopped = simulate(*scheme, *solver, {.step = 1e-3, .duration = 1, .cancel = &raised});
    CHECK(stopped.status == Status::cancelled);
    CHECK(stopped.steps == 0);
    const Run whole = simulate(*scheme, *solver, {.step = 1e-3, .duration = 2e-3});  // neither is left behind
    CHECK(whole.status == Status::solved);
  }
  for (const char* spec : {"adaptive", "event-driven"}) {  // one step of many inner ones
    const System system(make_scene("slider_crank"));
    const auto scheme = make_integrator(spec, system);
    const auto solver = make_solver("lemke");
    const Run late = simulate(*scheme, *solver, {.step = 1000, .duration = 1000, .time_limit = 0.05});
    CHECK(late.status == Status::time_limit);
    CHECK(late.seconds < 5);
  }
}
