// orthant sweep — many runs from one file, into one SQLite file; orthant results — the content of that file.
#include "experiments/cli/commands.h"

#include "experiments/sweep/analysis.h"
#include "experiments/sweep/run.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <iostream>
#include <map>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

struct SweepArguments {
  std::string file, results;
  std::vector<std::string> keys;
  unsigned jobs = 0;
  bool quick = false, list = false, json = false, retry = false;
};

int run_sweep(SweepArguments a) {
  const Sweep sweep = read_sweep(a.file, a.quick);
  if (!a.keys.empty()) {  // somebody else keeps the rows
    for (const std::string& key : a.keys) {
      const auto c =
          std::find_if(sweep.cases.begin(), sweep.cases.end(), [&](const Case& x) { return x.key() == key; });
      if (c == sweep.cases.end())
        throw std::invalid_argument("--case " + key + ": must be a case of " + a.file + " as this build (" +
                                    revision() + ") sees it");
      for (const ResultRow& row : run_apart(*c)) std::cout << row.dump() << std::endl;
    }
    return 0;
  }
  if (a.results.empty()) a.results = "results/" + sweep.name + ".sqlite";
  if (const auto folder = std::filesystem::path(a.results).parent_path(); !folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw std::runtime_error("cannot write " + a.results + ": " + error.message());
  }
  Results results(a.results);
  if (a.list) {
    results.declare(sweep, a.retry);
    Json missing = Json::array();
    for (const Case& c : sweep.cases)
      if (!results.has(c.key())) missing.push_back(c.key());
    if (a.json) {
      std::cout << missing.dump() << '\n';
    } else {
      for (const Json& key : missing) std::cout << key.get<std::string>() << '\n';
    }
    return 0;
  }
  const Tally tally = run_sweep(sweep, results, a.results, a.jobs, a.retry);
  const auto rows = results.rows(sweep.name);
  const auto failed =
      std::count_if(rows.begin(), rows.end(), [](const ResultRow& r) { return r.at("status") != "solved"; });
  if (a.json) {
    const Json json = {{"sweep", sweep.name},
                       {"results", a.results},
                       {"cases", rows.size()},
                       {"new", tally.run},
                       {"not_solved", failed}};
    std::cout << json.dump() << '\n';
    return 0;
  }
  std::cout << sweep.name << ": " << rows.size() << " cases in " << a.results << ", " << tally.run << " of them new, "
            << failed << " not solved" << (failed > 0 ? " (orthant results " + a.results + " --failures)" : "") << '\n';
  return 0;
}

struct ResultsArguments {
  std::string file, sweep, dumps;
  bool csv = false, json = false, failures = false, orders = false, times = false, about = false, add = false;
};

/// The parameters as columns of their own; without the dumped problem, which is long.
Json flat(const std::string& sweep, const ResultRow& row) {
  Json line = {{"sweep", sweep}};
  for (const auto& [name, value] : row.items())
    if (name == "parameters")
      line.update(Json::parse(value.get<std::string>()));
    else if (name != "problem")
      line[name] = value;
  return line;
}

std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_number_float()) return detail::text_of(value.get<double>());
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  for (std::size_t i = 0; (i = text.find('"', i)) != std::string::npos; i += 2) text.insert(i, "\"");
  return '"' + text + '"';
}

/// Lines that may have different keys: the columns are all of them.
void print_csv(const std::vector<Json>& lines) {
  std::vector<std::string> columns;
  for (const Json& line : lines)
    for (const auto& [name, value] : line.items())
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  for (std::size_t i = 0; i < columns.size(); ++i) std::cout << (i ? "," : "") << columns[i];
  std::cout << '\n';
  for (const Json& line : lines) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      std::cout << (i ? "," : "") << cell(line.contains(columns[i]) ? line.at(columns[i]) : Json());
    std::cout << '\n';
  }
}

/// The problem of a failure into a file that `orthant solve` replays; empty: it kept none.
std::string dump_problem(const ResultRow& row, const std::filesystem::path& dumps) {
  if (!row.at("problem").is_string()) return {};
  std::filesystem::create_directories(dumps);
  const auto file = dumps / (row.at("key").get<std::string>() + ".json");
  write_whole(file, row.at("problem").get<std::string>());
  return file.string();
}

/// Each failure in words.
void print_failure(const ResultRow& row, const std::string& dump) {
  std::cout << row.at("key").get<std::string>() << ": " << row.at("status").get<std::string>();
  if (row.at("why").is_string() && row.at("why") != "") std::cout << " (" << row.at("why").get<std::string>() << ")";
  std::cout << ": " << row.at("integrator").get<std::string>() << ", " << row.at("solver").get<std::string>()
            << ", step " << detail::text_of(row.at("step").get<double>()) << ", "
            << row.at("parameters").get<std::string>();
  std::cout << (dump.empty() ? "" : "; replay: orthant solve " + dump) << '\n';
}

int add_rows(const std::string& file) {
  Results results(file);
  for (std::string line; std::getline(std::cin, line);) {
    ResultRow row = ResultRow::parse(line, nullptr, false);
    if (!row.is_object() || !row.contains("key")) throw std::invalid_argument("--add: a line that is no row: " + line);
    results.add(row);
  }
  return 0;
}

int run_results(ResultsArguments a) {
  if (a.add) return add_rows(a.file);
  const Results results(a.file, Results::read_only);
  if (a.dumps.empty()) a.dumps = std::filesystem::path(a.file).replace_extension().string() + ".failures";
  std::vector<Json> lines;
  bool found = a.sweep.empty();
  const auto sweeps = results.sweeps();
  if (sweeps.empty())  // its first writer got no further
    throw std::invalid_argument(a.file + ": holds no sweep yet: orthant sweep FILE --results " + a.file + " begins it");
  for (const auto& [name, about] : sweeps) {
    if (!a.sweep.empty() && name != a.sweep) continue;
    found = true;
    const auto rows = results.rows(name);
    if (a.about) {
      std::cout << about.dump(2) << '\n';
    } else if (a.failures) {
      for (const ResultRow& row : rows) {
        if (row.at("status") == "solved") continue;
        const std::string dump = dump_problem(row, a.dumps);
        if (!a.json) {
          print_failure(row, dump);
          continue;
        }
        lines.push_back(flat(name, row));
        lines.back()["dump"] = dump.empty() ? Json() : Json(dump);
      }
    } else if (a.orders) {
      for (Json& fit : fitted_orders(rows)) {
        fit["worst_error_finest_octave"] = fit.at("worst").back()[1],
        fit["h_finest_octave"] = fit.at("worst").back()[0];
        if (!a.json) fit.erase("worst");
        lines.push_back(flat(name, fit));
      }
    } else if (a.times) {
      for (const Json& entry : time_to_error(rows)) {
        Json line = {{"sweep", name}, {"integrator", entry["integrator"]}, {"solver", entry["solver"]}};
        for (std::size_t k = 0; k < error_targets().size(); ++k)
          line["to_" + detail::text_of(error_targets()[k])] = entry["seconds"][k];
        lines.push_back(line);
      }
    } else if (a.csv || a.json) {
      for (const ResultRow& row : rows) lines.push_back(flat(name, row));
    } else {
      std::map<std::string, int> statuses;
      for (const ResultRow& row : rows) ++statuses[row.at("status").get<std::string>()];
      std::cout << name << ": " << rows.size() << " of " << results.members(name) << " cases done";
      for (const auto& [status, count] : statuses) std::cout << ", " << count << ' ' << status;
      std::cout << "\n  " << about.at("question").get<std::string>() << "\n  " << answer(rows) << '\n';
    }
  }
  if (!found) throw std::invalid_argument("--sweep " + a.sweep + ": " + a.file + " has no such sweep");
  if (a.json)
    std::cout << Json(lines).dump(1) << '\n';
  else if (a.csv || a.orders || a.times)
    print_csv(lines);
  return 0;
}

}  // namespace

void add_sweep(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<SweepArguments>();
  CLI::App* command = app.add_subcommand("sweep", "Run a sweep: many runs of one scene, described by one file");
  command->add_option("file", arguments->file, "TOML file, see experiments/studies/*.sweep.toml")->required();
  command->add_option("--results", arguments->results, "SQLite file; default: results/NAME.sqlite");
  command->add_option("--jobs", arguments->jobs, "cases at a time; 0: one a core")
      ->capture_default_str()
      ->check(CLI::Range(0, 10000));
  command->add_flag("--quick", arguments->quick, "the reduced grid");
  command->add_flag("--list", arguments->list, "print the keys of the cases that are missing, and run none");
  command->add_flag("--json", arguments->json, "how it ended, or the list, as JSON");
  command->add_flag("--retry", arguments->retry,
                    "repeat cases that a time limit or a crash ended; a longer limit alone does so, too");
  command->add_option("--case", arguments->keys,
                      "KEY ...: run these and their references; print the rows as JSON, store nothing");
  command->footer(
      "Exit codes: 0 done, whatever the cases' statuses, 1 bad input.\n"
      "Examples:\n"
      "  orthant sweep experiments/studies/slider_crank.sweep.toml --quick\n"
      "  orthant sweep mine.sweep.toml --results mine.sqlite --jobs 4 --json");
  command->callback([arguments, &exit_code] { exit_code = run_sweep(*arguments); });
}

void add_results(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ResultsArguments>();
  CLI::App* command = app.add_subcommand("results", "What a results file holds: a summary, tables, failures");
  command->add_option("file", arguments->file, "SQLite file of orthant sweep")->required();
  command->add_option("--sweep", arguments->sweep, "this sweep only");
  CLI::Option* csv = command->add_flag("--csv", arguments->csv, "every case as CSV");
  CLI::Option* json = command->add_flag("--json", arguments->json, "every case, or the selected table, as JSON");
  CLI::Option* orders =
      command->add_flag("--orders", arguments->orders, "fitted orders of convergence as CSV, or with --json");
  CLI::Option* times =
      command->add_flag("--times", arguments->times, "processor time to an error [s] as CSV, or with --json");
  CLI::Option* failures = command->add_flag("--failures", arguments->failures,
                                            "failed cases, with their problems for replay; or with --json");
  CLI::Option* about =
      command->add_flag("--about", arguments->about, "definition of the sweep, build and machine, as JSON");
  command->add_option("--dumps", arguments->dumps, "folder for those problems; default: next to the file, .failures");
  command->add_flag("--add", arguments->add, "put the rows on standard input in (of orthant sweep --case)");
  csv->excludes(json)->excludes(orders)->excludes(times)->excludes(failures)->excludes(about);
  json->excludes(about);
  orders->excludes(times)->excludes(failures)->excludes(about);
  times->excludes(failures)->excludes(about);
  failures->excludes(about);
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Examples:\n"
      "  orthant results mine.sqlite\n"
      "  orthant results mine.sqlite --csv > mine.csv\n"
      "  orthant results mine.sqlite --orders --json\n"
      "  orthant results mine.sqlite --failures");
  command->callback([arguments, &exit_code] { exit_code = run_results(*arguments); });
}

}  // namespace orthant
