#include "analysis.h"

#include "experiments/support/fit_order.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kTargets[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};

std::string text_of(const ResultRow& row, const char* column) { return row.at(column).get<std::string>(); }
double number(const ResultRow& row, const char* column) {
  return row.at(column).is_null() ? kInf : row.at(column).get<double>();
}
bool solved(const ResultRow& row) { return row.at("status") == "solved"; }

std::string short_number(double x) {
  std::ostringstream out;
  out.precision(2);
  out << x;
  std::string text = out.str();
  if (const auto e = text.find("e-0"); e != std::string::npos) text.erase(e + 2, 1);
  return text;
}

}  // namespace

std::span<const double> error_targets() { return kTargets; }

Json fitted_orders(const std::vector<ResultRow>& rows) {
  struct Group {
    std::vector<Sample> samples;
    int failed = 0;
  };
  std::vector<std::array<std::string, 3>> names;  // in the order of the rows
  std::map<std::array<std::string, 3>, Group> groups;
  for (const ResultRow& row : rows) {
    if (!row.at("rtol").is_null() || row.at("repeats") != 0) continue;
    const std::array name = {text_of(row, "integrator"), text_of(row, "solver"), text_of(row, "parameters")};
    if (!groups.contains(name)) names.push_back(name);
    Group& group = groups[name];
    group.failed += !solved(row);
    if (const double error = number(row, "error"); error > 0 && error < kInf)
      group.samples.push_back({number(row, "step"), error});
  }
  Json all = Json::array();
  for (const auto& name : names) {
    const auto& [samples, failed] = groups[name];
    const auto [finest, coarsest] =
        std::minmax_element(samples.begin(), samples.end(), [](auto& a, auto& b) { return a.h < b.h; });
    if (samples.empty() || !(coarsest->h > 2.1 * finest->h)) continue;
    const Fit fit = fit_order(samples);
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

Json time_to_error(const std::vector<ResultRow>& rows) {
  struct Setting {
    double fineness, error, seconds;
  };
  std::vector<std::pair<std::string, std::string>> names;
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::vector<Setting>>> all;  // by parameters
  for (const ResultRow& row : rows) {
    if (row.at("repeats") == 0) continue;
    const auto name = std::pair(text_of(row, "integrator"), text_of(row, "solver"));
    if (!all.contains(name)) names.push_back(name);
    const double fineness = row.at("rtol").is_null() ? number(row, "step") : number(row, "rtol");
    all[name][text_of(row, "parameters")].push_back(
        {fineness, solved(row) ? number(row, "error") : kInf, number(row, "seconds")});
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

std::string answer(const std::vector<ResultRow>& rows) {
  if (rows.empty()) return "Nothing has been run yet.";
  const auto failed = std::count_if(rows.begin(), rows.end(), [](const ResultRow& row) { return !solved(row); });
  std::string text = std::to_string(static_cast<long>(rows.size()) - failed) + " of " + std::to_string(rows.size()) +
                     " runs ended solved";
  std::map<std::string, std::vector<double>> orders;
  for (const Json& fit : fitted_orders(rows))
    orders[fit.at("integrator").get<std::string>()].push_back(fit.at("order").get<double>());
  std::vector<std::pair<double, std::string>> medians;
  for (auto& [name, list] : orders) {
    std::nth_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2), list.end());
    medians.emplace_back(list[list.size() / 2], name);
  }
  std::sort(medians.begin(), medians.end());
  std::map<std::string, int> unsolved;
  for (const ResultRow& row : rows)
    if (!solved(row)) ++unsolved[text_of(row, "solver")];
  std::string list;
  for (const auto& [solver, count] : unsolved)
    list += (list.empty() ? " " : ", ") + solver + " " + std::to_string(count);
  if (!list.empty()) text += " (not, by solver:" + list + ")";
  if (!medians.empty())
    text += "; the error falls with the step size h as h^" + short_number(medians.front().first) + " (" +
            medians.front().second + ", median over the cases) to h^" + short_number(medians.back().first) + " (" +
            medians.back().second + ")";
  text += ".";
  std::string costs;
  const Json times = time_to_error(rows);
  for (const std::size_t k : {std::size_t{1}, std::size_t{4}, std::size_t{7}}) {
    const Json* best = nullptr;
    for (const Json& entry : times)
      if (!entry["seconds"][k].is_null() && (best == nullptr || entry["seconds"][k] < (*best)["seconds"][k]))
        best = &entry;
    if (best != nullptr)
      costs += (costs.empty() ? "" : ", ") + short_number(kTargets[k]) + " costs " +
               short_number(1e3 * (*best)["seconds"][k].get<double>()) + " ms (" +
               (*best)["integrator"].get<std::string>() + ")";
  }
  if (!costs.empty()) return text + " In the worst case an error of " + costs + ".";
  const auto largest = [&](const char* column) {
    double most = -1;
    for (const ResultRow& row : rows)
      if (solved(row) && row.contains(column) && !row.at(column).is_null()) most = std::max(most, number(row, column));
    return most;
  };
  if (const double momentum = largest("momentum_drift"); momentum >= 0)  // something isolated: what is kept
    return text + " Momentum is kept to " + short_number(momentum) + " N s, spin to " +
           short_number(largest("spin_drift")) + " N m s, joints to " + short_number(largest("max_joint_residual")) +
           " m, in the worst run.";
  double low = kInf, high = -kInf;  // no times: what was lost
  for (const ResultRow& row : rows)
    if (solved(row)) {
      const double loss = number(row, "energy_initial") - number(row, "energy_final");
      low = std::min(low, loss), high = std::max(high, loss);
    }
  if (low <= high) text += " Between " + short_number(low) + " and " + short_number(high) + " J of energy went.";
  return text;
}

}  // namespace orthant
