// The answer of a sweep in two sentences: how its runs ended and how errors fall; what that means.
#include "analysis.h"

#include <orthant/core/support/options.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

std::string short_number(double x) {
  std::ostringstream out;
  out.precision(2);
  out << x;
  std::string text = out.str();
  if (const auto e = text.find("e-0"); e != std::string::npos) text.erase(e + 2, 1);
  return text;
}

constexpr std::size_t kMostListed = 3;  // settings in a sentence; of more it counts by value
constexpr std::size_t kManyValues = 5;  // of a parameter that is followed

/// How many runs did not end solved: by solver, or where there is one solver only by integrator.
std::string unsolved(const std::vector<ResultRow>& rows) {
  std::set<std::string> solvers;
  for (const ResultRow& row : rows) solvers.insert(row_text(row, "solver"));
  const char* by = solvers.size() > 1 ? "solver" : "integrator";
  std::map<std::string, int> counts;
  for (const ResultRow& row : rows)
    if (!row_solved(row)) ++counts[row_text(row, by)];
  std::string list;
  for (const auto& [name, count] : counts) list += (list.empty() ? " " : ", ") + name + " " + std::to_string(count);
  return list.empty() ? "" : std::string(" (not, by ") + by + ":" + list + ")";
}

/// Of the settings without order how many have each value of each parameter that has several.
std::string shares(const std::vector<std::pair<std::string, double>>& best,
                   const std::map<std::string, std::set<std::string>>& values) {
  std::string list;
  for (const auto& [name, all] : values) {
    if (all.size() < 2) continue;
    std::map<double, std::pair<int, int>> counts;  // without order, in all, by value
    for (const auto& [setting, order] : best) {
      const Json value = Json::parse(setting).value(name, Json());
      if (!value.is_number()) continue;
      auto& [without, some] = counts[value.get<double>()];
      without += order < kNoOrder, ++some;
    }
    std::string part;
    for (const auto& [value, count] : counts)
      if (count.first > 0)
        part += (part.empty() ? "" : ", ") + std::to_string(count.first) + " of the " + std::to_string(count.second) +
                " with " + name + " = " + short_number(value);
    if (!part.empty()) list += (list.empty() ? "" : "; ") + part;
  }
  return list;
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
  if (count > kMostListed) list = shares(best, values);
  return "by no method does the error fall as fast as h^" + short_number(kNoOrder) + " for " + std::to_string(count) +
         " of " + std::to_string(best.size()) + " settings" + (list.empty() ? "" : ": " + list);
}

/// What still converges where the measure does not.
std::string still_comparable(const std::vector<ResultRow>& rows, const Json& fits) {
  std::map<std::string, double> best;  // order of the measure, by parameters
  for (const Json& fit : fits) {
    double& order = best.try_emplace(fit.at("parameters").get<std::string>(), -kInf).first->second;
    order = std::max(order, fit.at("order").get<double>());
  }
  std::vector<std::pair<std::string, int>> falling;  // statistics, at how many settings
  std::set<std::string> lost;                        // settings that have statistics
  for (const Json& one : orders_of_statistics(rows)) {
    const auto setting = best.find(one.at("parameters").get<std::string>());
    if (setting == best.end() || setting->second >= kNoOrder) continue;
    lost.insert(setting->first);
    const auto statistic = one.at("statistic").get<std::string>();
    if (falling.empty() || falling.back().first != statistic) falling.emplace_back(statistic, 0);
    falling.back().second += one.at("order").get<double>() >= kNoOrder;
  }
  if (lost.empty()) return "";
  std::stable_sort(falling.begin(), falling.end(), [](auto& a, auto& b) { return a.second > b.second; });
  std::string list;
  for (const auto& [statistic, count] : falling)
    list += (list.empty() ? " " : ", ") + statistic + " at " + (count > 0 ? std::to_string(count) : "none");
  return "what still falls so by some method, of " + std::to_string(lost.size()) + " such settings looked at:" + list;
}

/// Which method keeps energy best and worst at its finest setting, where some method keeps it at all.
std::string energy_kept(const std::vector<ResultRow>& rows) {
  constexpr double kKept = 1e-6;  // of the energy
  struct Finest {
    double setting = kInf, drift = 0;
  };
  std::map<std::string, std::map<std::string, Finest>> finest;  // by scene and parameters, then integrator
  std::map<std::string, bool> kept;
  for (const ResultRow& row : rows) {
    if (!row_solved(row) || !row.contains("energy_drift") || row.at("energy_drift").is_null()) continue;
    const std::string scene = row_text(row, "parameters");
    const double drift = row_number(row, "energy_drift"),
                 setting = row.at("rtol").is_null() ? row_number(row, "step") : row_number(row, "rtol");
    kept[scene] = kept[scene] || drift <= kKept * std::abs(row_number(row, "energy_initial"));
    if (Finest& one = finest[scene][row_text(row, "integrator")]; setting < one.setting) one = {setting, drift};
  }
  std::map<std::string, double> worst;  // by integrator
  for (const auto& [scene, by] : finest)
    if (kept[scene])
      for (const auto& [integrator, one] : by) worst[integrator] = std::max(worst[integrator], one.drift);
  if (worst.size() < 2) return "";
  const auto by_drift = [](auto& a, auto& b) { return a.second < b.second; };
  const auto [least, most] = std::minmax_element(worst.begin(), worst.end(), by_drift);
  return "where energy is kept to a millionth by anybody, " + least->first + " strays from it by " +
         short_number(least->second) + " J at the most, " + most->first + " by up to " + short_number(most->second) +
         " J, each at its finest setting";
}

/// Where a parameter of many values changes the measure most, if by more than a quarter of all that it does.
std::string leap(const std::vector<ResultRow>& rows) {
  std::map<std::string, std::map<double, std::vector<double>>> measured;
  for (const ResultRow& row : rows) {
    if (!row_solved(row) || !row.contains("value") || row.at("value").is_null()) continue;
    const Json parameters = Json::parse(row_text(row, "parameters"));
    for (const auto& [name, value] : parameters.items())
      if (value.is_number()) measured[name][value.get<double>()].push_back(row_number(row, "value"));
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
    text += (text.empty() ? "" : "; ") + std::string("the greatest change: from ") + name + " = " +
            detail::text_of(medians[most].first) + " to " + detail::text_of(medians[most + 1].first) +
            " the median of " + row_text(rows.front(), "measure") + " at the end goes from " +
            short_number(medians[most].second) + " to " + short_number(medians[most + 1].second);
  }
  return text;
}

/// What errors of a thousandth, a millionth, a thousand-millionth cost by the cheapest method.
std::string costs_of(const Json& times) {
  std::string list;
  for (const std::size_t k : {std::size_t{1}, std::size_t{4}, std::size_t{7}}) {
    const Json* best = nullptr;
    for (const Json& entry : times)
      if (!entry["seconds"][k].is_null() && (best == nullptr || entry["seconds"][k] < (*best)["seconds"][k]))
        best = &entry;
    if (best != nullptr)
      list += (list.empty() ? " " : ", ") + short_number(error_targets()[k]) + " costs " +
              short_number(1e3 * (*best)["seconds"][k].get<double>()) + " ms (" +
              (*best)["integrator"].get<std::string>() + ")";
  }
  return list.empty() ? "" : "in the worst case an error of" + list;
}

std::string energy_lost(const std::vector<ResultRow>& rows) {
  double low = kInf, high = -kInf;
  for (const ResultRow& row : rows)
    if (row_solved(row)) {
      const double loss = row_number(row, "energy_initial") - row_number(row, "energy_final");
      low = std::min(low, loss), high = std::max(high, loss);
    }
  return low <= high ? "between " + short_number(low) + " and " + short_number(high) + " J of energy went" : "";
}

}  // namespace

std::string answer(const std::vector<ResultRow>& rows) {
  if (rows.empty()) return "Nothing has been run yet.";
  const auto failed = std::count_if(rows.begin(), rows.end(), [](const ResultRow& row) { return !row_solved(row); });
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
    text += "; with the step size h the error falls fastest by " + medians.back().second + ", as h^" +
            short_number(medians.back().first) + " (median over the cases)";
  if (medians.size() > 1)
    text += ", slowest by " + medians.front().second + ", as h^" + short_number(medians.front().first);
  std::string second;  // sentence
  const auto say = [&](const std::string& part) {
    if (!part.empty()) second += (second.empty() ? "" : "; ") + part;
  };
  say(costs_of(time_to_error(rows)));
  const bool timed = !second.empty();
  say(without_order(fits));
  say(still_comparable(rows, fits));
  const auto largest = [&](const char* column) {
    double most = -1;
    for (const ResultRow& row : rows)
      if (row_solved(row) && row.contains(column) && !row.at(column).is_null())
        most = std::max(most, row_number(row, column));
    return most;
  };
  if (const double momentum = largest("momentum_drift"); !timed && momentum >= 0) {  // something isolated: what is kept
    say(energy_kept(rows));
    say("momentum is kept to " + short_number(momentum) + " N s, spin to " + short_number(largest("spin_drift")) +
        " N m s, joints to " + short_number(largest("max_joint_residual")) + " m, in the worst run");
  } else if (second.empty()) {  // what was lost
    say(energy_lost(rows));
    if (medians.empty()) say(leap(rows));
  }
  if (!second.empty()) second[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(second[0])));
  return text + "." + (second.empty() ? "" : " " + second + ".");
}

}  // namespace orthant
