// Are the bits of a run the same on any number of threads, and those that were pinned?
//
// Every scene by every integrator with every solver, up to 10^4 steps: hashes of all states (support/fingerprint.h) in
// 1, 2 and 8 threads, against each other and, where the build is the same, against the table
// tests/data/determinism.csv. With --dimension 3: the scenes in space, and tests/data/determinism_space.csv.
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/fingerprint.h"
#include "experiments/support/progress.h"

#include <orthant/core/support/file.h>

#include <CLI/CLI.hpp>

#include <iostream>
#include <map>

using namespace orthant;

namespace {

int report(const std::vector<Fingerprint>& a, const std::vector<Fingerprint>& b, const std::string& of) {
  int wrong = 0;
  for (const Fingerprint& one : a)
    for (const Fingerprint& other : b)
      if (one.scene == other.scene && one.integrator == other.integrator && one.solver == other.solver &&
          differ(one, other))
        ++wrong, std::cout << of << " differs: " << one.row() << " and " << other.row() << '\n';
  std::cout << of << ": " << wrong << " differ" << std::endl;
  return wrong;
}

/// Those runs in the order of all, with the table's rows of the others.
std::vector<Fingerprint> with_others(const std::vector<Fingerprint>& runs, const std::vector<Fingerprint>& table,
                                     const std::vector<Fingerprint>& order) {
  const auto of = [](const Fingerprint& f) { return f.scene + ',' + f.integrator + ',' + f.solver; };
  std::map<std::string, const Fingerprint*> known;
  for (const auto* rows : {&table, &runs})
    for (const Fingerprint& f : *rows) known[of(f)] = &f;
  std::vector<Fingerprint> all;
  for (const Fingerprint& f : order)
    if (const auto found = known.find(of(f)); found != known.end()) all.push_back(*found->second);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  std::string pinned = "tests/data/determinism.csv";
  long steps = kMarks.back();
  double seconds = 10;
  bool pin = false;
  std::string only;
  int dimension = 2;
  CLI::App app("The bits of every scene, integrator and solver in 1, 2 and 8 threads");
  app.add_option("--table", pinned, "hashes to compare with, or to write")->capture_default_str();
  app.add_option("--dimension", dimension, "2: planar scenes, 3: scenes in space")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  app.add_option("--steps", steps, "of each run")->check(CLI::Range(1L, kMarks.back()))->capture_default_str();
  app.add_option("--time-limit", seconds, "of each run [s]; a late run has fewer hashes")
      ->check(between(1e-3, 1e6))
      ->capture_default_str();
  app.add_option("--only", only, "runs whose scene,integrator,solver holds this text");
  app.add_flag("--pin", pin, "write the table again, where the threads agree; with --only those rows, into the table");
  if (const auto end = parse(app, argc, argv)) return *end;
  if (dimension == 3 && app.count("--table") == 0) pinned = "tests/data/determinism_space.csv";
  try {
    const auto all = dimension == 3 ? all_spatial_fingerprints() : all_fingerprints();
    auto alone = all;
    std::erase_if(alone, [&](const Fingerprint& f) {
      return (f.scene + ',' + f.integrator + ',' + f.solver).find(only) == std::string::npos;
    });
    if (alone.empty()) throw std::invalid_argument("--only '" + only + "': no run's scene,integrator,solver holds it");
    std::string build;
    std::vector<Fingerprint> table;
    pin ? check_writable(pinned) : check_readable(pinned);
    if (!pin || !only.empty()) table = read_fingerprints(pinned, build);
    const auto untaken = alone;
    const auto all_in = [&](std::vector<Fingerprint>& runs, int threads) {
      Progress progress("threads " + std::to_string(threads), static_cast<double>(runs.size()));
      take(runs, steps, seconds, threads, [&] { progress.add(1, false); });
    };
    all_in(alone, 1);
    std::array<long, 4> reached{};
    for (const Fingerprint& f : alone)
      for (std::size_t k = 0; k < kMarks.size(); ++k) reached[k] += f.hash[k] != 0;
    std::cout << alone.size() << " runs;";
    for (std::size_t k = 0; k < kMarks.size(); ++k) std::cout << ' ' << reached[k] << " reached " << kMarks[k] << ';';
    std::cout << std::endl;
    if (alone.size() == 1) std::cout << alone[0].row() << std::endl;
    int wrong = 0;
    for (const int threads : {2, 8}) {
      auto together = untaken;
      all_in(together, threads);
      wrong += report(alone, together, std::to_string(threads) + " threads");
    }
    if (pin) {
      if (wrong == 0) write_whole(pinned, table_of(with_others(alone, table, all)));
    } else if (build == build_of_bits()) {
      wrong += report(table, alone, "the table");
    } else {
      std::cout << "the table is of another build: " << build << '\n';
    }
    return wrong > 0;
  } catch (const std::exception& error) {
    std::cerr << "determinism: " << error.what() << '\n';
    return 1;
  }
}
