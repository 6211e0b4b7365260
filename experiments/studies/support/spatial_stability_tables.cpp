#include "experiments/studies/support/spatial_stability_tables.h"

#include "experiments/studies/support/spatial_stability.h"
#include "experiments/support/progress.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace orthant {
namespace {

std::string two_digits(double x) {
  std::ostringstream text;
  text << std::setprecision(1) << std::scientific << x;
  return x == 0 ? "0" : text.str();
}

std::string unit_in_words(const std::string& unit) { return unit == "1" ? "relative" : unit; }

/// Of one integrator: errors at the first and the last value, the worst of the runs that ended as solved; time; the
/// values at which these warned, and at which others did not end so.
std::string line_of_integrator(const std::string& integrator, const SpatialStudy& study,
                               const std::vector<SpatialTrialResult>& results) {
  double error = 0, drift = 0, penetration = 0, seconds = 0;
  std::string failed, warned;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const SpatialTrialResult& r = results[k];
    if (r.end != "solved") {
      failed += (failed.empty() ? "" : ", ") + two_digits(study.values[k]) + ": " + r.end;
      continue;
    }
    if (r.warned) warned += (warned.empty() ? "" : ", ") + two_digits(study.values[k]);
    error = std::max(error, r.error), drift = std::max(drift, r.drift);
    penetration = std::max(penetration, r.penetration), seconds += r.seconds;
  }
  const auto at = [&](const SpatialTrialResult& r) { return r.end == "solved" ? two_digits(r.error) : "-"; };
  return "| `" + integrator + "` | " + at(results.front()) + " | " + at(results.back()) + " | " + two_digits(error) +
         " | " + two_digits(drift) + " | " + two_digits(penetration) + " | " + two_digits(seconds) + " | " +
         (warned.empty() ? "-" : warned) + " | " + (failed.empty() ? "-" : failed) + " |\n";
}

}  // namespace

std::string spatial_stability(const SpatialStabilityPlan& plan) {
  auto all = spatial_studies(plan.quick);
  std::erase_if(all, [&](const SpatialStudy& study) { return study.name.find(plan.only) == std::string::npos; });
  if (all.empty()) throw std::invalid_argument("--only '" + plan.only + "': no study's name has it");
  std::vector<std::string> names;
  for (const IntegratorEntry& entry : integrators())
    if (entry.make_spatial != nullptr) names.emplace_back(entry.name);
  std::filesystem::create_directories(plan.output);
  std::string csv = "study,value,integrator,end,warned,steps,error,residual,drift,penetration,seconds\n", tables;
  Progress progress("stability", static_cast<double>(all.size() * names.size()));
  for (const SpatialStudy& study : all) {
    tables += "\n**" + study.name + "**, " + two_digits(study.values.front()) + " to " +
              two_digits(study.values.back()) + "; error [" + unit_in_words(study.unit) +
              "]:\n\n| integrator | at the first | at the last | worst | drift [m] | penetration [m] | time [s] | "
              "warned | not solved |\n|---|---|---|---|---|---|---|---|---|\n";
    for (const std::string& integrator : names) {
      std::vector<SpatialTrialResult> results;
      for (const double value : study.values) {
        const SpatialTrialResult& r = results.emplace_back(run_trial(study.trial(value), integrator, plan.time_limit));
        csv += study.name + ',' + detail::text_of(value) + ',' + integrator + ',' + r.end + (r.warned ? ",yes" : ",no");
        for (const double x : {r.steps, r.error, r.residual, r.drift, r.penetration, r.seconds})
          csv += ',' + detail::text_of(x);
        csv += '\n';
      }
      tables += line_of_integrator(integrator, study, results);
      progress.add(1, false);
    }
    write_whole(plan.output / "stability.csv", csv);  // a long study may be stopped
    write_whole(plan.output / "stability.md", tables);
  }
  return tables;
}

}  // namespace orthant
