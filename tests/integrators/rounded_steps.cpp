// Steps with a problem that is rounded only: taken and counted, or the end of the run.
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <atomic>

using namespace orthant;

TEST_CASE("rounded steps are taken and counted, or end the run before the first one") {
  const System system(slider_crank());
  const auto with = [&](const char* solver, Rounded rounded) {
    return simulate(*make_integrator("moreau-jean", system), *make_solver(solver),
                    {.step = 1e-4, .duration = 0.02, .rounded = rounded});
  };
  const Run exact = with("lemke", Rounded::stop);  // nothing to stop at
  CHECK(exact.status == Status::solved);
  CHECK(exact.rounded_steps == 0);
  CHECK(exact.first_rounded_time == kInf);

  const Run taken = with("lemke:tolerance=0", Rounded::take);  // passes for solved only where every w fits exactly
  CHECK(taken.status == Status::solved);
  CHECK(taken.final.q == exact.final.q);
  CHECK(taken.rounded_steps > 0);
  CHECK(taken.first_rounded_time <= 0.02);
  CHECK(taken.first_rounded.starts_with("row "));

  const Run stopped = with("lemke:tolerance=0", Rounded::stop);
  CHECK(stopped.status == Status::rounded);
  CHECK(stopped.why.find("rounded only: row ") != std::string::npos);
  CHECK(stopped.rounded_steps == 0);
  CHECK(stopped.final.t == doctest::Approx(taken.first_rounded_time - 1e-4));
}

TEST_CASE("a run gives the solver back the limits that its caller had set, and reports start as not_run") {
  CHECK(Run{}.status == Status::not_run);
  CHECK(StepReport{}.status == Status::not_run);
  CHECK(StepReport::solved().status == Status::solved);
  const System system(slider_crank());
  const auto scheme = make_integrator("moreau-jean", system);
  const auto solver = make_solver("lemke");
  const std::atomic<bool> callers = false, of_run = false;
  solver->set_time_limit(5), solver->set_cancel(&callers);
  const Run run = simulate(*scheme, *solver, {.step = 1e-4, .duration = 1e-3, .time_limit = 100, .cancel = &of_run});
  CHECK(run.status == Status::solved);
  CHECK(solver->time_limit() == 5);
  CHECK(solver->cancel() == &callers);
  CHECK(scheme->budget() == nullptr);
}
