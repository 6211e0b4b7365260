#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/motion_variation.h>
#include <orthant/integrators/simulate.h>

#include <cmath>
#include <stdexcept>

namespace orthant {

MotionTangent differentiate_motion(const System& system, const std::vector<RunParameter>& parameters,
                                   const EventDrivenOptions& options, Solver& solver, double duration, double every,
                                   const MotionRecorder& record, const std::atomic<bool>* cancel) {
  if (!(duration > 0) || !std::isfinite(duration)) throw std::invalid_argument("duration: must be > 0 and finite");
  if (!(every > 0)) throw std::invalid_argument("every: must be > 0");
  MotionTangent result;
  result.final = system.initial_state();
  State& x = result.final;
  MotionVariation variation(system, parameters, duration, options, result);
  variation.begin(x);
  close_joints(system, x);
  EventDriven integrator(system, options);
  if (record) record(x, result.q, result.v);
  for (long row = 1; x.t < duration; ++row) {
    const double end = std::min(static_cast<double>(row) * every, duration);
    while (x.t < end) {
      if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) {
        result.status = Status::cancelled;
        return result;
      }
      const StepReport report = integrator.stride(end - x.t, solver, x);
      if (report.status != Status::solved) {
        result.status = report.status, result.why = integrator.why();
        return result;
      }
      if (report.crossings > 0 && result.none.empty())
        result.none = "at t = " + detail::text_of(x.t) + " s a crowd of events is crossed";
      variation.pass(integrator.arc(), integrator.events());
      if (end - x.t <= 1e-15 * end) x.t = end;
    }
    if (record) record(x, result.q, result.v);
  }
  return result;
}

}  // namespace orthant
