// The final state of every scene by every integrator: the same bits again, and in 2 and in 8 threads at once.
#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <atomic>
#include <thread>

using namespace orthant;

namespace {

struct Job {
  std::string scene, integrator, solver;
  std::string bits;
};

std::vector<Job> all_jobs() {
  std::vector<Job> jobs;
  for (const auto& scene : scenes())
    for (const auto& integrator : integrators())
      for (const char* solver : {"lemke", "auto", "pgs"})
        if (std::string_view(solver) == "lemke" || integrator.name == "moreau-jean")
          jobs.push_back({std::string(scene.name), std::string(integrator.name), solver, ""});
  return jobs;
}

/// Status, words and all bits of the last state after ten steps; or why not.
void run(Job& job) {
  try {
    const System system(make_scene(job.scene));
    const auto integrator = make_integrator(job.integrator, system);
    const auto solver = make_solver(job.solver);
    const double step = std::min(system.scene().step, 1e-3);
    const Run run = simulate(*integrator, *solver, {.step = step, .duration = 10 * step});
    job.bits = std::string(name(run.status)) + run.why + ' ';
    for (const auto* x : {&run.final.q, &run.final.v})
      job.bits.append(reinterpret_cast<const char*>(x->data()), static_cast<std::size_t>(x->size()) * sizeof(double));
  } catch (const std::invalid_argument& error) {  // this integrator does not take this scene
    job.bits = error.what();
  }
}

std::vector<Job> in_threads(int threads) {
  std::vector<Job> jobs = all_jobs();
  std::atomic<std::size_t> next{0};
  {
    std::vector<std::jthread> running;
    for (int i = 0; i < threads; ++i)
      running.emplace_back([&] {
        for (std::size_t k = next++; k < jobs.size(); k = next++) run(jobs[k]);
      });
  }
  return jobs;
}

}  // namespace

TEST_CASE("every scene by every integrator: the same bits in 1, 2 and 8 threads") {
  const auto alone = in_threads(1);
  int solved = 0;
  for (const Job& job : alone) solved += job.bits.starts_with(name(Status::solved));
  MESSAGE(alone.size(), " runs, ", solved, " solved");
  CHECK(solved > static_cast<int>(alone.size() / 2));
  for (const int threads : {2, 8}) {
    const auto together = in_threads(threads);
    for (std::size_t k = 0; k < alone.size(); ++k) {
      INFO(alone[k].scene, " ", alone[k].integrator, " ", alone[k].solver, " in ", threads, " threads");
      CHECK((together[k].bits == alone[k].bits));
    }
  }
}
