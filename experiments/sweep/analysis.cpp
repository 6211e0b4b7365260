#include "experiments/sweep/analysis.h"

#include "experiments/support/fit_order.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kTargets[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};

}  // namespace

std::span<const double> error_targets() { return kTargets; }

namespace {

constexpr double kFinest = 8.01;     // times the finest step: where a statistic has to fall
constexpr double kRounding = 1e-13;  // relative; errors below it say nothing of a method
constexpr std::size_t kFewest = 3;   // octaves: a line goes through any two

/// The error of a run, by its row; infinite where there is none.
using ErrorOf = std::function<double(const ResultRow&)>;

Json fits_of(const std::vector<ResultRow>& rows, const ErrorOf& error_of) {
  struct Group {
    std::vector<Sample> samples;
    int failed = 0;
  };
  std::vector<std::array<std::string, 3>> names;  // in the order of the rows
  std::map<std::array<std::string, 3>, Group> groups;
  for (const ResultRow& row : rows) {
    if (!row.at("rtol").is_null() || row.at("repeats") != 0) continue;
    const std::array name = {row_text(row, "integrator"), row_text(row, "solver"), row_text(row, "parameters")};
    if (!groups.contains(name)) names.push_back(name);
    Group& group = groups[name];
    group.failed += !row_solved(row);
    if (const double error = error_of(row); error > 0 && error < kInf)
      group.samples.push_back({row_number(row, "step"), error});
  }
  Json all = Json::array();
  for (const auto& name : names) {
    const auto& [samples, failed] = groups[name];
    const auto [finest, coarsest] =
        std::minmax_element(samples.begin(), samples.end(), [](auto& a, auto& b) { return a.h < b.h; });
    if (samples.empty() || !(coarsest->h > 2.1 * finest->h)) continue;
    const Fit fit = fit_order(samples);
    if (fit.worst.size() < kFewest) continue;
    Json worst = Json::array();
    for (const Sample& s : fit.worst) worst.push_back({s.h, s.error});
    all.push_back({{"integrator", name[0]},
                   {"solver", name[1]},
                   {"parameters", name[2]},
                   {"order", fit.order},
                   {"scatter", fit.scatter},
                   {"failed", failed},
                   {"worst", worst}});
  }
  return all;
}

/// What a run says besides its measure.
struct Statistic {
  const char* name;
  double (*of)(const ResultRow&);
};
double at(const ResultRow& row, const char* column) { return row.contains(column) ? row_number(row, column) : kInf; }
constexpr Statistic kStatistics[] = {
    {"first touch", [](const ResultRow& row) { return at(row, "first_touch"); }},
    {"first release", [](const ResultRow& row) { return at(row, "first_release"); }},
    {"last release", [](const ResultRow& row) { return at(row, "last_release"); }},
    {"energy lost", [](const ResultRow& row) { return at(row, "energy_initial") - at(row, "energy_final"); }},
    {"whole impulse", [](const ResultRow& row) { return at(row, "impulse"); }},
};

}  // namespace

Json fitted_orders(const std::vector<ResultRow>& rows) {
  return fits_of(rows, [](const ResultRow& row) {
    const double error = row_number(row, "error"), size = row.contains("reference") ? row_number(row, "reference") : 0;
    return error > kRounding * (size < kInf ? std::abs(size) : 0) ? error : kInf;
  });
}

Json orders_of_statistics(const std::vector<ResultRow>& rows) {
  std::map<std::string, const ResultRow*> exact;  // by parameters
  std::map<std::string, double> finest;           // step of the others
  for (const ResultRow& row : rows)
    if (row.contains("compared_with") && row_solved(row) && row.at("repeats") == 0 &&
        row_text(row, "compared_with").starts_with(row_text(row, "integrator")))
      exact[row_text(row, "parameters")] = &row;
  for (const ResultRow& row : rows) {
    const auto other = exact.find(row_text(row, "parameters"));
    if (other == exact.end() || other->second == &row || row.at("repeats") != 0) continue;
    double& step = finest.try_emplace(other->first, kInf).first->second;
    step = std::min(step, row_number(row, "step"));
  }
  Json all = Json::array();
  for (const Statistic& statistic : kStatistics) {
    const Json fits = fits_of(rows, [&](const ResultRow& row) {
      const auto other = exact.find(row_text(row, "parameters"));
      if (other != exact.end() && row_number(row, "step") > kFinest * finest[other->first]) return kInf;
      if (other == exact.end() || other->second == &row || !row_solved(row)) return kInf;
      const double error = std::abs(statistic.of(row) - statistic.of(*other->second));
      return std::isfinite(error) ? error : kInf;
    });
    std::map<std::string, const Json*> best;
    for (const Json& fit : fits) {
      const Json*& kept = best[fit.at("parameters").get<std::string>()];
      if (kept == nullptr || fit.at("order") > kept->at("order")) kept = &fit;
    }
    for (const auto& [parameters, fit] : best)
      all.push_back({{"parameters", parameters},
                     {"statistic", statistic.name},
                     {"order", fit->at("order")},
                     {"integrator", fit->at("integrator")}});
  }
  return all;
}

Json time_to_error(const std::vector<ResultRow>& rows) {
  struct Setting {
    double fineness, error, seconds;
  };
  std::vector<std::pair<std::string, std::string>> names;
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::vector<Setting>>> all;  // by parameters
  for (const ResultRow& row : rows) {
    if (row.at("repeats") == 0) continue;
    const auto name = std::pair(row_text(row, "integrator"), row_text(row, "solver"));
    if (!all.contains(name)) names.push_back(name);
    const double fineness = row.at("rtol").is_null() ? row_number(row, "step") : row_number(row, "rtol");
    all[name][row_text(row, "parameters")].push_back(
        {fineness, row_solved(row) ? row_number(row, "error") : kInf, row_number(row, "seconds")});
  }
  for (auto& [name, by_parameters] : all)
    std::erase_if(by_parameters, [](const auto& x) { return x.second.size() < 3; });
  std::erase_if(names, [&](const auto& name) { return all[name].empty(); });
  const auto time_to = [](double target, std::vector<Setting>& settings) {
    std::sort(settings.begin(), settings.end(),
              [](const Setting& a, const Setting& b) { return a.fineness < b.fineness; });
    double best = kInf;
    for (const Setting& s : settings) {
      if (!(s.error <= target)) break;
      best = std::min(best, s.seconds);
    }
    return best;
  };
  std::map<std::string, std::array<bool, std::size(kTargets)>> reachable;  // by anybody
  for (auto& [name, by_parameters] : all)
    for (auto& [parameters, settings] : by_parameters)
      for (std::size_t k = 0; k < std::size(kTargets); ++k)
        if (time_to(kTargets[k], settings) < kInf) reachable[parameters][k] = true;
  Json table = Json::array();
  for (const auto& name : names) {
    Json seconds = Json::array();
    for (std::size_t k = 0; k < std::size(kTargets); ++k) {
      double worst = 0;
      for (auto& [parameters, settings] : all[name])
        if (reachable[parameters][k]) worst = std::max(worst, time_to(kTargets[k], settings));
      seconds.push_back(worst > 0 && worst < kInf ? Json(worst) : Json());
    }
    table.push_back({{"integrator", name.first}, {"solver", name.second}, {"seconds", seconds}});
  }
  return table;
}

}  // namespace orthant
