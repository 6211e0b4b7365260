// The answer of a sweep in two sentences: how its runs ended, how errors fall, and the meaning of both.
#include "experiments/sweep/analysis.h"

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

constexpr std::size_t kMostNamed = 3;   // settings in a sentence; of more it counts by value
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
    if (order >= kNoOrder || ++count > kMostNamed) continue;
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
  if (count > kMostNamed) list = shares(best, values);
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

/// Of each parameter that is followed the rows by its value.
std::map<std::string, std::map<double, std::vector<const ResultRow*>>> followed(const std::vector<ResultRow>& rows) {
  std::map<std::string, std::map<double, std::vector<const ResultRow*>>> all;
  for (const ResultRow& row : rows) {
    const Json parameters = Json::parse(row_text(row, "parameters"));
    for (const auto& [name, value] : parameters.items())
      if (value.is_number()) all[name][value.get<double>()].push_back(&row);
  }
  std::erase_if(all, [](const auto& one) { return one.second.size() < kManyValues; });
  return all;
}

/// The medians of a quantity of solved rows, by the parameter's value; NaN of a row: there is none.
template <class Quantity>
std::vector<std::pair<double, double>> medians_of(const std::map<double, std::vector<const ResultRow*>>& by_value,
                                                  const Quantity& quantity) {
  std::vector<std::pair<double, double>> medians;
  for (const auto& [value, list] : by_value) {
    std::vector<double> numbers;
    for (const ResultRow* row : list)
      if (const double x = row_solved(*row) ? quantity(*row) : std::nan(""); std::isfinite(x)) numbers.push_back(x);
    if (numbers.empty()) continue;
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    medians.emplace_back(value, *middle);
  }
  return medians;
}

double measured(const ResultRow& row) {
  return row.contains("value") && !row.at("value").is_null() ? row_number(row, "value") : std::nan("");
}
double lost(const ResultRow& row) { return row_number(row, "energy_initial") - row_number(row, "energy_final"); }

/// "the median of crank.theta at the end from 17.4 to 2.1 (least, 1.9, at mu = 5)".
std::string change_of(const std::string& what, const std::string& parameter,
                      const std::vector<std::pair<double, double>>& medians) {
  if (medians.size() < 2) return "";
  constexpr double kBeyond = 0.1;  // of the change: an extreme between the ends that is worth a word
  const double first = medians.front().second, last = medians.back().second;
  const auto by_median = [](auto& a, auto& b) { return a.second < b.second; };
  const auto [least, most] = std::minmax_element(medians.begin(), medians.end(), by_median);
  if (least->second == most->second) return "";
  std::string text = what + " from " + short_number(first) + " to " + short_number(last);
  const double span = most->second - least->second;
  if (std::min(first, last) - least->second > kBeyond * span)
    text += " (least, " + short_number(least->second) + ", at " + parameter + " = " + short_number(least->first) + ")";
  if (most->second - std::max(first, last) > kBeyond * span)
    text += " (greatest, " + short_number(most->second) + ", at " + parameter + " = " + short_number(most->first) + ")";
  return text;
}

/// What changes with each parameter of many values: the measure, the energy lost, and from where on runs fail.
std::string effects(const std::vector<ResultRow>& rows) {
  std::string text;
  for (const auto& [name, by_value] : followed(rows)) {
    const double low = by_value.begin()->first, high = by_value.rbegin()->first;
    std::string part;
    const auto add = [&](const std::string& words) { part += (part.empty() || words.empty() ? "" : ", ") + words; };
    const std::string measure = rows.front().contains("measure") ? row_text(rows.front(), "measure") : "the measure";
    add(change_of("the median of " + measure + " at the end goes", name, medians_of(by_value, measured)));
    add(change_of("the energy lost [J]", name, medians_of(by_value, lost)));
    double failing = kInf;
    for (const auto& [value, list] : by_value)
      if (std::ranges::any_of(list, [](const ResultRow* row) { return !row_solved(*row); }))
        failing = std::min(failing, value);
    if (failing > low && failing < kInf)
      add("runs that are not solved begin at " + name + " = " + short_number(failing));
    if (part.empty()) continue;
    text += (text.empty() ? "" : "; ") + std::string("as ") + name + " goes from " + short_number(low) + " to " +
            short_number(high) + ", " + part;
  }
  return text;
}

/// Where a parameter of many values changes the measure most, if by more than a quarter of all that it does.
std::string leap(const std::vector<ResultRow>& rows) {
  std::string text;
  for (const auto& [name, by_value] : followed(rows)) {
    const auto medians = medians_of(by_value, measured);
    if (medians.size() < kManyValues) continue;
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

/// How errors fall with h, by the medians of the orders. The integrator whose error is the least is named as the most
/// accurate: with a tolerance of its own its error does not fall with h, and it is not the slowest to converge.
std::string orders_in_words(const Json& fits) {
  struct Method {
    std::vector<double> orders;
    double finest = 0;  // the worst error at the finest octave of any setting
  };
  std::map<std::string, Method> methods;
  for (const Json& fit : fits) {
    Method& method = methods[fit.at("integrator").get<std::string>()];
    method.orders.push_back(fit.at("order").get<double>());
    const Json& worst = fit.at("worst");
    const Json* finest = &worst.front();
    for (const Json& point : worst)
      if (point[0].get<double>() < (*finest)[0].get<double>()) finest = &point;
    method.finest = std::max(method.finest, (*finest)[1].get<double>());
  }
  if (methods.empty()) return "";
  std::vector<std::pair<double, std::string>> medians;
  for (auto& [name, method] : methods) {
    auto& list = method.orders;
    std::nth_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2), list.end());
    medians.emplace_back(list[list.size() / 2], name);
  }
  std::sort(medians.begin(), medians.end());
  const auto best = std::min_element(methods.begin(), methods.end(),
                                     [](auto& a, auto& b) { return a.second.finest < b.second.finest; });
  std::string text = "; with the step size h the error falls fastest by " + medians.back().second + ", as h^" +
                     short_number(medians.back().first) + " (median over the cases)";
  const auto slowest = std::ranges::find_if(medians, [&](const auto& one) { return one.second != best->first; });
  if (slowest != medians.end() && slowest->second != medians.back().second)
    text += ", slowest by " + slowest->second + ", as h^" + short_number(slowest->first);
  if (methods.size() > 1)
    text += "; the most accurate is " + best->first + ", at the finest steps off by " +
            short_number(best->second.finest) + " at the most";
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
  const Json fits = fitted_orders(rows);
  text += unsolved(rows) + orders_in_words(fits);
  std::string second;  // sentence
  const auto say = [&](const std::string& part) {
    if (!part.empty()) second += (second.empty() ? "" : "; ") + part;
  };
  say(effects(rows)), say(leap(rows));  // of a parameter that is followed
  const std::string costs = costs_of(time_to_error(rows));
  say(costs);
  const bool timed = !costs.empty();
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
  }
  if (!second.empty()) second[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(second[0])));
  return text + "." + (second.empty() ? "" : " " + second + ".");
}

}  // namespace orthant
