#include "analysis.h"

#include "experiments/support/fit_order.h"

#include <orthant/core/support/options.h>

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

namespace {

constexpr double kNoOrder = 0.5;        // below it an error does not fall to speak of
constexpr std::size_t kMostListed = 9;  // settings in a sentence
constexpr std::size_t kManyValues = 5;  // of a parameter that is followed

/// How many runs did not end solved: by solver, or where there is one solver only by integrator.
std::string unsolved(const std::vector<ResultRow>& rows) {
  std::set<std::string> solvers;
  for (const ResultRow& row : rows) solvers.insert(text_of(row, "solver"));
  const char* by = solvers.size() > 1 ? "solver" : "integrator";
  std::map<std::string, int> counts;
  for (const ResultRow& row : rows)
    if (!solved(row)) ++counts[text_of(row, by)];
  std::string list;
  for (const auto& [name, count] : counts) list += (list.empty() ? " " : ", ") + name + " " + std::to_string(count);
  return list.empty() ? "" : std::string(" (not, by ") + by + ":" + list + ")";
}

/// For which parameters no method converges.
std::string without_order(const Json& fits) {
  std::vector<std::pair<std::string, double>> best;  // order by parameters, as they come
  for (const Json& fit : fits) {
    const auto name = fit.at("parameters").get<std::string>();
    const auto at = std::ranges::find(best, name, &std::pair<std::string, double>::first);
    if (at == best.end())
      best.emplace_back(name, fit.at("order").get<double>());
    else
      at->second = std::max(at->second, fit.at("order").get<double>());
  }
  std::map<std::string, std::set<std::string>> values, failing;  // of each parameter
  for (const auto& [name, order] : best) {
    const Json parameters = Json::parse(name);
    for (const auto& [key, value] : parameters.items()) {
      values[key].insert(value.dump());
      if (order < kNoOrder) failing[key].insert(value.dump());
    }
  }
  const auto words = [](const std::string& key, const Json& value) {
    return key + " = " + (value.is_number() ? short_number(value.get<double>()) : value.dump());
  };
  std::size_t count = 0;
  std::string shared, list;  // what all of them have, what each has
  for (const auto& [name, order] : best) {
    if (order >= kNoOrder || ++count > kMostListed) continue;
    const Json parameters = Json::parse(name);
    std::string setting;
    for (const auto& [key, value] : parameters.items()) {
      if (values[key].size() == 1) continue;
      if (failing[key].size() > 1)
        setting += (setting.empty() ? "" : ", ") + words(key, value);
      else if (count == 1)
        shared += (shared.empty() ? "" : ", ") + words(key, value);
    }
    if (!setting.empty()) list += (list.empty() ? "" : "; ") + setting;
  }
  if (!shared.empty()) list = shared + (list.empty() ? "" : " and " + list);
  if (count == 0) return "";
  return " By no method does it fall as fast as h^" + short_number(kNoOrder) + " for " + std::to_string(count) +
         " of " + std::to_string(best.size()) + " settings" + (list.empty() ? "" : ": " + list) +
         (count > kMostListed ? "; …" : "") + ".";
}

/// Where a parameter of many values changes the measure most, if by more than a quarter of all that it does.
std::string leap(const std::vector<ResultRow>& rows) {
  std::map<std::string, std::map<double, std::vector<double>>> measured;
  for (const ResultRow& row : rows) {
    if (!solved(row) || !row.contains("value") || row.at("value").is_null()) continue;
    const Json parameters = Json::parse(text_of(row, "parameters"));
    for (const auto& [name, value] : parameters.items())
      if (value.is_number()) measured[name][value.get<double>()].push_back(number(row, "value"));
  }
  std::string text;
  for (auto& [name, by_value] : measured) {
    if (by_value.size() < kManyValues) continue;
    std::vector<std::pair<double, double>> medians;
    for (auto& [value, list] : by_value) {
      std::nth_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2), list.end());
      medians.emplace_back(value, list[list.size() / 2]);
    }
    const auto change = [&](std::size_t i) { return std::abs(medians[i + 1].second - medians[i].second); };
    std::size_t most = 0;
    double low = kInf, high = -kInf;
    for (std::size_t i = 0; i < medians.size(); ++i) {
      low = std::min(low, medians[i].second), high = std::max(high, medians[i].second);
      if (i + 1 < medians.size() && change(i) > change(most)) most = i;
    }
    if (!(change(most) > 0.25 * (high - low))) continue;
    text += " The greatest change: from " + name + " = " + detail::text_of(medians[most].first) + " to " +
            detail::text_of(medians[most + 1].first) + " the median of " + text_of(rows.front(), "measure") +
            " at the end goes from " + short_number(medians[most].second) + " to " +
            short_number(medians[most + 1].second) + ".";
  }
  return text;
}

}  // namespace

std::string answer(const std::vector<ResultRow>& rows) {
  if (rows.empty()) return "Nothing has been run yet.";
  const auto failed = std::count_if(rows.begin(), rows.end(), [](const ResultRow& row) { return !solved(row); });
  std::string text = std::to_string(static_cast<long>(rows.size()) - failed) + " of " + std::to_string(rows.size()) +
                     " runs ended solved";
  std::map<std::string, std::vector<double>> orders;
  const Json fits = fitted_orders(rows);
  for (const Json& fit : fits) orders[fit.at("integrator").get<std::string>()].push_back(fit.at("order").get<double>());
  std::vector<std::pair<double, std::string>> medians;
  for (auto& [name, list] : orders) {
    std::nth_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2), list.end());
    medians.emplace_back(list[list.size() / 2], name);
  }
  std::sort(medians.begin(), medians.end());
  text += unsolved(rows);
  if (!medians.empty())
    text += "; the error falls with the step size h as h^" + short_number(medians.front().first) + " (" +
            medians.front().second + ", median over the cases) to h^" + short_number(medians.back().first) + " (" +
            medians.back().second + ")";
  text += "." + without_order(fits);
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
  return medians.empty() ? text + leap(rows) : text;
}

}  // namespace orthant
