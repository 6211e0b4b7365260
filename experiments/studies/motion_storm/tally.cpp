#include "experiments/studies/motion_storm/tally.h"

#include "experiments/studies/motion_storm/scenes.h"

#include <nlohmann/json.hpp>

#include <sstream>

namespace orthant::motion_storm {
namespace {

using Counts = Tally::Counts;
using Table = std::map<std::string, Counts>;

void markdown(std::ostringstream& out, const std::string& corner, const Table& table, bool faults_only) {
  const std::size_t from = faults_only ? static_cast<std::size_t>(Result::stopped) + 1 : 0;
  out << "| " << corner << " |";
  for (std::size_t i = from; i < kResults.size(); ++i) out << ' ' << kResults[i] << " |";
  out << "\n|---|";
  for (std::size_t i = from; i < kResults.size(); ++i) out << "--:|";
  out << '\n';
  for (const auto& [name, counts] : table) {
    out << "| " << name << " |";
    for (std::size_t i = from; i < kResults.size(); ++i) out << ' ' << counts[i] << " |";
    out << '\n';
  }
}

}  // namespace

void Tally::count(const std::string& kind, const std::string& integrator, Result result) {
  ++rows[{kind, integrator}][static_cast<std::size_t>(result)];
}

void Tally::add(const Tally& other) {
  for (const auto& [key, more] : other.rows)
    for (std::size_t i = 0; i < more.size(); ++i) rows[key][i] += more[i];
  faults.insert(faults.end(), other.faults.begin(), other.faults.end());
}

template <class Space> Tally storm(std::uint64_t seed, std::uint64_t first, std::uint64_t count,
                                   const std::vector<std::string>& integrators, const Limits& limits) {
  Tally tally;
  for (std::uint64_t k = first; k < first + count; ++k) {
    const RandomSceneOf<Space> random = random_scene<Space>(seed, k);
    for (const Verdict& v : judge(random.scene, integrators, k / kinds<Space>().size(), limits)) {
      tally.count(random.kind, v.integrator, v.result);
      if (fault(v.result))
        tally.faults.push_back(
            {k, random.kind, v.integrator, std::string(kResults[static_cast<std::size_t>(v.result)]), v.why});
    }
  }
  return tally;
}
template Tally storm<Planar>(std::uint64_t, std::uint64_t, std::uint64_t, const std::vector<std::string>&,
                             const Limits&);
template Tally storm<Spatial>(std::uint64_t, std::uint64_t, std::uint64_t, const std::vector<std::string>&,
                              const Limits&);

std::string to_text(const Tally& tally) {
  nlohmann::json json = {{"rows", nlohmann::json::array()}, {"faults", nlohmann::json::array()}};
  for (const auto& [key, counts] : tally.rows) json["rows"].push_back({key.first, key.second, counts});
  for (const Fault& f : tally.faults) json["faults"].push_back({f.k, f.kind, f.integrator, f.what, f.why});
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Tally tally_from_text(const std::string& text) {
  const auto json = nlohmann::json::parse(text);
  Tally tally;
  for (const auto& row : json.at("rows")) tally.rows[{row.at(0), row.at(1)}] = row.at(2);
  for (const auto& f : json.at("faults")) tally.faults.push_back({f.at(0), f.at(1), f.at(2), f.at(3), f.at(4)});
  return tally;
}

std::string csv(const Tally& tally) {
  std::ostringstream out;
  out << "kind,integrator";
  for (const auto& what : kResults) out << ',' << what;
  out << '\n';
  for (const auto& [key, counts] : tally.rows) {
    out << key.first << ',' << key.second;
    for (const long n : counts) out << ',' << n;
    out << '\n';
  }
  return out.str();
}

std::string tables(const Tally& tally, std::uint64_t scenes) {
  Table by_integrator, by_kind;
  for (const auto& [key, counts] : tally.rows)
    for (std::size_t i = 0; i < counts.size(); ++i)
      for (Counts* each : {&by_integrator[key.second], &by_integrator["~ all"], &by_kind[key.first]})
        (*each)[i] += counts[i];
  std::ostringstream out;
  out << scenes << " scenes\n\n";
  markdown(out, "integrator", by_integrator, false);
  out << "\nFaults by kind of scene, of all integrators\n\n";
  markdown(out, "kind", by_kind, true);
  return out.str();
}

std::string json(const Tally& tally, std::uint64_t scenes, std::uint64_t seed) {
  nlohmann::ordered_json out = {{"scenes", scenes}, {"seed", seed}, {"results", kResults}};
  out["counts"] = nlohmann::ordered_json::array();
  for (const auto& [key, counts] : tally.rows)
    out["counts"].push_back({{"kind", key.first}, {"integrator", key.second}, {"counts", counts}});
  out["faults"] = nlohmann::ordered_json::array();
  for (const Fault& f : tally.faults)
    out["faults"].push_back(
        {{"scene", f.k}, {"kind", f.kind}, {"integrator", f.integrator}, {"what", f.what}, {"why", f.why}});
  return out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

}  // namespace orthant::motion_storm
