#include "experiments/runs/check.h"

#include "experiments/runs/trajectory.h"

#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive/adaptive.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {
namespace {

constexpr double kFloor = 3e-11, kRounded = 2e-16;  // of the largest number of a kind; likewise, a step
constexpr double kTighter = 100;
constexpr double kSlower = 20, kLeastLimit = 10;  // times the run's; [s]
constexpr std::string_view kJudge = "adaptive:rtol=1e-9", kPreciseJudge = "adaptive:rtol=1e-10,atol=1e-13";

struct Repetition {
  std::string integrator;
  double step = 0;
  double factor = 1;  // of the difference
};

/// name:options with other tolerances.
template <class Options> std::string with_tolerances(const Spec& spec, const Options& options) {
  std::string text(spec.name);
  text += ":rtol=" + detail::text_of(options.rtol) + ",atol=" + detail::text_of(options.atol);
  std::string_view rest = spec.options;
  while (!rest.empty()) {
    const auto comma = rest.find(',');
    const std::string_view item = rest.substr(0, comma);
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
    if (!item.starts_with("rtol=") && !item.starts_with("atol=")) text += "," + std::string(item);
  }
  return text;
}

/// tightest: the rtol that rounding leaves any sense to.
template <class Options> Repetition other_tolerance(const Spec& spec, double step, double tightest, double least_atol) {
  Options options;
  set_options(options, spec.options);
  const double factor = options.rtol >= kTighter * tightest ? 1 / kTighter : kTighter;
  options.rtol = std::min(factor * options.rtol, 1e-2);
  options.atol = std::clamp(factor * options.atol, least_atol, 1e-2);
  return {with_tolerances(spec, options), step, 2};
}

template <class Space> std::vector<Repetition> repetitions(std::string_view integrator, double step) {
  const Spec spec = Spec::parse(integrator);
  if (spec.name == "adaptive")
    return {other_tolerance<AdaptiveOptions>(spec, step, 1e-10, 1e-15), {"event-driven", step, 1}};
  if (spec.name == "event-driven")
    return {other_tolerance<EventDrivenOptions>(spec, step, 1e-13, 1e-16), {std::string(kPreciseJudge), step, 1}};
  std::vector<Repetition> all{{std::string(integrator), step / 2, 3}, {std::string(integrator), step * 2 / 3, 4}};
  if (!kPlanar<Space>) all.push_back({std::string(integrator), step / 4, 1.5});
  all.push_back({std::string(kJudge), step, 1});
  return all;
}

/// The end of a repetition; empty q: it failed, `why` has the words.
template <class Space> State repeat(const SystemOf<Space>& system, const Repetition& repetition,
                                    std::string_view solver, Clock clock, std::string& why) {
  try {
    const auto integrator = make_integrator(repetition.integrator, system);
    const auto lcp = make_solver(solver);
    clock.step = repetition.step;
    Run run = simulate(*integrator, *lcp, clock);
    if (run.status == Status::solved) return run.final;
    why = run.why.empty() ? std::string(name(run.status)) : run.why;
  } catch (const std::invalid_argument& refused) {
    why = refused.what();
  }
  return {};
}

std::string list_with(std::string list, const std::string& item) { return list.empty() ? item : list + "; " + item; }

/// What a column of a body is measured in, by its place among the columns of the body.
template <class Space> int unit_of(std::size_t column) {
  const std::size_t k = column % kBodyColumns<Space>;
  if constexpr (kPlanar<Space>)
    return static_cast<int>(k == 2) + 2 * static_cast<int>(k > 2) + static_cast<int>(k == 5);
  else
    return k < 3 ? 0 : k < 7 ? 1 : k < 10 ? 2 : 3;
}

}  // namespace

template <class Space> CheckedRun check_run(const SystemOf<Space>& system, std::string_view integrator,
                                            std::string_view solver, const Clock& clock, const Run& run) {
  CheckedRun checked;
  const double floor = std::max(kFloor, kRounded * static_cast<double>(run.accepted));
  const std::vector<std::string> names = body_columns(system.scene());
  std::vector<double> values, others;
  append_bodies(system, run.final, values);
  std::array<double, 4> size{};  // the largest |value| of each unit
  for (std::size_t i = 0; i < values.size(); ++i) {
    double& most = size[static_cast<std::size_t>(unit_of<Space>(i))];
    most = std::max(most, std::abs(values[i]));
    checked.columns.push_back({names[i], values[i], 0, 0});
  }
  for (const Repetition& repetition : repetitions<Space>(integrator, clock.step)) {
    Clock patient = clock;
    patient.every = 1000000000, patient.time_limit = std::max(kLeastLimit, kSlower * run.seconds);
    std::string why;
    const State end = repeat(system, repetition, solver, patient, why);
    std::string label = repetition.integrator;
    if (repetition.step != clock.step) label += ", step " + detail::text_of(repetition.step) + " s";
    if (end.q.size() == 0) {
      checked.left_out = list_with(checked.left_out, label + ": " + why);
      continue;
    }
    checked.against = list_with(checked.against, label);
    others.clear();
    append_bodies(system, end, others);
    for (std::size_t i = 0; i < values.size(); ++i) {
      double& error = checked.columns[i].error;
      error = std::max({error, repetition.factor * std::abs(values[i] - others[i]),
                        floor * size[static_cast<std::size_t>(unit_of<Space>(i))]});
    }
  }
  for (CheckedColumn& c : checked.columns) {
    if (checked.against.empty()) c.error = kInf;
    const double digits = c.value == 0 ? 0 : -std::log10(c.error / std::abs(c.value));
    c.digits = static_cast<int>(std::floor(std::clamp(digits, 0.0, 15.0)));
  }
  return checked;
}

template CheckedRun check_run(const SystemOf<Planar>&, std::string_view, std::string_view, const Clock&, const Run&);
template CheckedRun check_run(const SystemOf<Spatial>&, std::string_view, std::string_view, const Clock&, const Run&);

}  // namespace orthant
