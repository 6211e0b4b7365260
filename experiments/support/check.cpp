#include "experiments/support/check.h"

#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive/adaptive.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kFloor = 3e-11, kRounded = 2e-16;  // of the largest number of a kind; likewise, a step
constexpr double kTighter = 100;
constexpr double kSlower = 20, kLeastLimit = 10;  // times the run's; [s]
constexpr std::string_view kJudge = "adaptive:rtol=1e-9";

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

std::vector<Repetition> repetitions(std::string_view integrator, double step) {
  const Spec spec = Spec::parse(integrator);
  if (spec.name == "adaptive") return {other_tolerance<AdaptiveOptions>(spec, step, 1e-10, 1e-15)};
  if (spec.name == "event-driven") return {other_tolerance<EventDrivenOptions>(spec, step, 1e-13, 1e-16)};
  return {{std::string(integrator), step / 2, 3},
          {std::string(integrator), step * 2 / 3, 4},
          {std::string(kJudge), step, 1}};
}

/// The end of a repetition; empty q: it failed, `why` has the words.
State repeat(const System& system, const Repetition& repetition, std::string_view solver, Clock clock,
             std::string& why) {
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

/// Largest |entry| of the unit of entry i of q or v: translations, or angles.
double size_of(const Eigen::VectorXd& x, Index i) {
  double size = 0;
  for (Index k = 0; k < x.size(); ++k)
    if ((k % 3 == 2) == (i % 3 == 2)) size = std::max(size, std::abs(x[k]));
  return size;
}

}  // namespace

CheckedRun check_run(const System& system, std::string_view integrator, std::string_view solver, const Clock& clock,
                     const Run& run) {
  CheckedRun checked;
  const double floor = std::max(kFloor, kRounded * static_cast<double>(run.accepted));
  const auto visit = [&](const auto& take) {  // column, its value, and those of the same kind
    std::size_t column = 0;
    for (std::size_t body = 0; body < system.scene().bodies.size(); ++body)
      for (const auto& [vector, names] : {std::pair{&State::q, std::array{".x", ".y", ".theta"}},
                                          std::pair{&State::v, std::array{".vx", ".vy", ".omega"}}})
        for (std::size_t k = 0; k < 3; ++k)
          take(column++, system.scene().bodies[body].name + names[k], vector, static_cast<Index>(3 * body + k));
  };
  visit([&](std::size_t, std::string name, Eigen::VectorXd State::*x, Index i) {
    checked.columns.push_back({std::move(name), (run.final.*x)[i], 0, 0});
  });
  for (const Repetition& repetition : repetitions(integrator, clock.step)) {
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
    visit([&](std::size_t column, const std::string&, Eigen::VectorXd State::*x, Index i) {
      double& error = checked.columns[column].error;
      error = std::max(
          {error, repetition.factor * std::abs((run.final.*x)[i] - (end.*x)[i]), floor * size_of(run.final.*x, i)});
    });
  }
  for (CheckedColumn& c : checked.columns) {
    if (checked.against.empty()) c.error = kInf;
    const double digits = c.value == 0 ? 0 : -std::log10(c.error / std::abs(c.value));
    c.digits = static_cast<int>(std::floor(std::clamp(digits, 0.0, 15.0)));
  }
  return checked;
}

}  // namespace orthant
