// Stress test of the integrators: random mechanisms of every kind by each of them, each motion checked by other code.
//
//   build/release/experiments/motion_storm                          10⁴ scenes; about an hour of a core (--jobs)
//   build/release/experiments/motion_storm --scenes 500 --seed 7    a share, of another seed
//   build/release/experiments/motion_storm --only 123 --toml        one scene, by its number, as a file
//   build/release/experiments/motion_storm --dimension 3            in space; into results/motion_storm_space
//
// Writes into the output folder: chunks.jsonl (one line a finished chunk; a run that was stopped does only what is
// missing), motion_storm.csv, .json and .md (kind of failure × integrator, × kind of scene), FAILURE_INTEGRATOR_*.toml
// (the scenes of faults, shrunk, for orthant simulate; the first comment says what is wrong). Every run has a process
// of its own, so that crashes and endless loops are results. Exit code 3 when there is a fault; motion_storm/judge.h
// says what counts as one.
#include "experiments/studies/motion_storm/scenes.h"
#include "experiments/studies/motion_storm/shrink.h"
#include "experiments/studies/motion_storm/tally.h"
#include "experiments/support/between.h"
#include "experiments/support/chunks.h"
#include "experiments/support/command_line.h"

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/support/file.h>
#include <orthant/integrators/registry.h>

#include <CLI/CLI.hpp>

#include <fstream>
#include <iostream>
#include <sstream>

using namespace orthant;
using namespace orthant::motion_storm;

namespace {

struct Arguments {
  std::filesystem::path output = "results/motion_storm";
  std::uint64_t scenes = 10000, seed = 1, chunk = 21;
  int dimension = 2;
  std::vector<std::string> integrators;  // none: all
  Limits limits;
  std::optional<std::uint64_t> only;
  bool toml = false, keep = false;
  unsigned jobs = 1;
  std::size_t memory = 4096;  // [MiB]
  long shrunk = 40;
};

template <class Space> struct MotionStorm {
  const Arguments& a;
  Isolated processes;

  double most_seconds(std::uint64_t count, std::size_t integrators) const {  // of wall time: others may be at work
    return 60 + 10 * (a.limits.time + a.limits.grace) * static_cast<double>(count * integrators);
  }

  /// A chunk that did not come back is done again scene by scene, a scene integrator by integrator.
  Tally corner(std::uint64_t first, std::uint64_t count, const std::vector<std::string>& integrators) {
    Tally tally;
    std::optional<Outcome> outcome;
    processes.start([&, this] { return to_text(storm<Space>(a.seed, first, count, integrators, a.limits)); },
                    most_seconds(count, integrators.size()), [&](const Outcome& o) { outcome = o; });
    processes.wait_for_all();
    if (outcome->kind == Outcome::finished) return tally_from_text(outcome->text);
    if (count > 1) {
      for (std::uint64_t k = first; k < first + count; ++k) tally.add(corner(k, 1, integrators));
    } else if (integrators.size() > 1) {
      for (const std::string& one : integrators) tally.add(corner(first, 1, {one}));
    } else {
      const std::string kind = random_scene<Space>(a.seed, first).kind;
      const Result what = outcome->kind == Outcome::killed ? Result::late : Result::crashed;
      tally.count(kind, integrators[0], what);
      tally.faults.push_back(
          {first, kind, integrators[0], std::string(kResults[static_cast<std::size_t>(what)]), outcome->text});
    }
    return tally;
  }

  Tally run() {
    const ChunkWork work{
        .work = [this](auto first,
                       auto count) { return to_text(storm<Space>(a.seed, first, count, a.integrators, a.limits)); },
        .limit = [this](auto count) { return most_seconds(count, a.integrators.size()); },
        .again = [this](auto first, auto count) { return to_text(corner(first, count, a.integrators)); },
        .faulty = [](const std::string& text) { return !tally_from_text(text).faults.empty(); }};
    const Chunks chunks{kPlanar<Space> ? "motion storm" : "motion storm in space", a.output / "chunks.jsonl",
                        chunk_header(a.seed, a.chunk, a.integrators), a.scenes, a.chunk};
    Tally all;
    for (const auto& [first, text] : run_chunks(chunks, work, processes)) all.add(tally_from_text(text));
    return all;
  }

  /// The fault's scene, as small as it gets, each try in a process of its own.
  void shrink_fault(const Fault& fault) {
    const std::uint64_t turn = fault.k / kinds<Space>().size();
    std::string why;
    const auto shows = [&](const SceneOf<Space>& scene) {
      bool same = false;
      processes.start(
          [&] {
            const Verdict v = judge(scene, {fault.integrator}, turn, a.limits)[0];
            return std::string(kResults[static_cast<std::size_t>(v.result)]) + '\n' + v.why;
          },
          most_seconds(1, 1),
          [&](const Outcome& o) {
            const std::string what = o.kind == Outcome::finished ? o.text.substr(0, o.text.find('\n'))
                                     : o.kind == Outcome::killed ? "late"
                                                                 : "crashed";
            same = what == fault.what;
            if (same && o.kind == Outcome::finished) why = o.text.substr(o.text.find('\n') + 1);
          });
      processes.wait_for_all();
      return same;
    };
    const SceneOf<Space> whole = random_scene<Space>(a.seed, fault.k).scene;
    why = fault.why;
    const SceneOf<Space> least = shows(whole) ? shrink(whole, shows) : whole;
    shows(least);
    const std::string seed = std::to_string(a.seed), number = std::to_string(fault.k);
    std::string name = fault.what + '_' + fault.integrator + '_' + seed + '_' + number;
    std::ranges::replace(name, ' ', '-');
    const auto file = a.output / (name + ".toml");
    write_whole(file, to_toml(least, fault.integrator + ": " + fault.what + ": " + why + "\n(" + fault.kind +
                                         ", seed " + seed + ", scene " + number + ")"));
    std::cerr << "  " << file.string() << ", " << least.bodies.size() << " bodies\n";
  }
};

/// At most `most` faults, those that are rare first: one of each kind, integrator and kind of scene, then more.
std::vector<Fault> chosen(const std::vector<Fault>& faults, long most) {
  std::map<std::string, long> times;
  std::vector<std::pair<long, const Fault*>> order;
  for (const Fault& f : faults) order.emplace_back(times[f.what + f.integrator + f.kind]++, &f);
  std::stable_sort(order.begin(), order.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  std::vector<Fault> first;
  for (const auto& [time, f] : order)
    if (static_cast<long>(first.size()) < most) first.push_back(*f);
  return first;
}

template <class Space> int run(Arguments a) {
  if (a.integrators.empty()) a.integrators = all_integrators<Space>();
  const SystemOf<Space> any(random_scene<Space>(a.seed, 0).scene);
  for (const std::string& spec : a.integrators) make_integrator(spec, any);  // known ones only
  if (!a.only || a.keep) std::filesystem::create_directories(a.output);
  MotionStorm<Space> it{a, Isolated(a.jobs, a.memory << 20)};
  Tally all;
  if (a.only) {
    if (a.toml) std::cout << to_toml(random_scene<Space>(a.seed, *a.only).scene, "scene " + std::to_string(*a.only));
    all = it.corner(*a.only, 1, a.integrators);
    for (const Fault& f : all.faults) std::cerr << f.integrator << ": " << f.what << ": " << f.why << '\n';
  } else {
    all = it.run();
    write_whole(a.output / "motion_storm.csv", csv(all));
    write_whole(a.output / "motion_storm.json", json(all, a.scenes, a.seed));
    write_whole(a.output / "motion_storm.md", tables(all, a.scenes));
  }
  if (!a.toml) std::cout << tables(all, a.only ? 1 : a.scenes);
  if (!a.only || a.keep)
    for (const Fault& f : chosen(all.faults, a.shrunk)) {
      std::cerr << "scene " << f.k << " (" << f.kind << "), " << f.integrator << ": " << f.what << ": " << f.why
                << '\n';
      it.shrink_fault(f);
    }
  return all.faults.empty() ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Random mechanisms of every kind by every integrator, each motion checked by independent code");
  Arguments a;
  const auto kCount = CLI::Range(0L, 1'000'000'000'000L);
  app.add_option("--dimension", a.dimension, "2: planar mechanisms, 3: mechanisms in space")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  app.add_option("--output", a.output, "folder")->capture_default_str();
  app.add_option("--scenes", a.scenes, "how many")->check(kCount)->capture_default_str();
  app.add_option("--seed", a.seed, "")->capture_default_str();
  app.add_option("--integrators", a.integrators, "as in orthant list, with options; default: all");
  app.add_option("--only", a.only, "one scene, by its number")->check(kCount);
  app.add_flag("--toml", a.toml, "with --only: print the scene's file instead of the table");
  app.add_flag("--keep", a.keep, "with --only: shrink the scene for each of its faults and write the files");
  app.add_option("--time-limit", a.limits.time, "of a run [s]")->check(between(1e-3, 1e6))->capture_default_str();
  app.add_option("--jobs", a.jobs, "processes at a time")->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_option("--chunk", a.chunk, "scenes a process")->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--memory", a.memory, "of a process [MiB]; 0: no limit")->capture_default_str();
  app.add_option("--shrink", a.shrunk, "at most so many faults")->check(CLI::Range(0, 1000000))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  if (a.dimension == 3 && app.count("--output") == 0) a.output = "results/motion_storm_space";
  try {
    return a.dimension == 3 ? run<Spatial>(a) : run<Planar>(a);
  } catch (const std::exception& error) {
    std::cerr << "motion_storm: " << error.what() << '\n';
    return 1;
  }
}
