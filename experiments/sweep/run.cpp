#include "experiments/sweep/run.h"

#include "experiments/support/isolated.h"
#include "experiments/support/progress.h"

#include <set>
#include <thread>

namespace orthant {
namespace {

constexpr std::chrono::milliseconds kLookAgain{50};

/// Something like the seconds that a case takes, for the progress bar.
double work(const Case& c) { return std::max(1, c.repeats) * (1e-3 + 3e-6 * c.duration / c.step); }

ResultRow row_of(const Case& c, const Outcome& outcome) {
  if (outcome.kind == Outcome::finished) return ResultRow::parse(outcome.text);
  return unfinished_row(c, outcome.kind == Outcome::killed ? "time_limit" : "crashed", outcome.text);
}

class Runner {
 public:
  Runner(Results& results, const std::filesystem::path& file, unsigned jobs)
      : results_(results), claims_(file), jobs_(jobs > 0 ? jobs : std::max(1U, std::thread::hardware_concurrency())) {}

  Tally run(const Sweep& sweep) {
    for (const Case& c : sweep.cases) own_.insert(c.key());
    std::set<std::string> references;  // keys
    std::vector<Case> parts[2];        // on all cores, alone
    for (const Case& c : sweep.cases) {
      if (results_.has(c.key())) continue;
      parts[c.repeats > 0].push_back(c);
      if (const auto other = c.reference_case()) references.insert(other->key());
    }
    std::vector<Case> first;
    for (const Case& c : sweep.reference_cases())
      if (references.contains(c.key())) first.push_back(c);
    do_all(sweep.name + ", references", first, jobs_);
    do_all(sweep.name, parts[0], jobs_);
    do_all(sweep.name + ", timed", parts[1], 1);
    return tally_;
  }

 private:
  void do_all(const std::string& title, std::vector<Case> cases, unsigned jobs) {
    if (cases.empty()) return;
    double total = 0;
    for (const Case& c : cases) total += work(c);
    Progress progress(title, total, static_cast<long>(cases.size()));
    while (true) {
      std::vector<Case> left;  // others work at them: if they die, the next round does it
      Isolated processes(jobs, 0);
      for (const Case& c : cases) {
        processes.wait_for_room();
        if (results_.has(c.key()))
          progress.add(work(c), false);
        else if (!claims_.take(c.key()))
          left.push_back(c);
        else if (results_.has(c.key()))  // done between the two looks
          claims_.release(c.key()), progress.add(work(c), false);
        else
          start(c, processes, progress);
      }
      processes.wait_for_all();
      if (left.empty()) return;
      cases = std::move(left);
      std::this_thread::sleep_for(kLookAgain);
    }
  }

  void start(const Case& c, Isolated& processes, Progress& progress) {
    std::optional<double> reference;
    if (const auto other = c.reference_case())
      if (const auto row = results_.find(other->key()); row) reference = answer_of(*row);
    processes.start([c, reference] { return run_case(c, reference).dump(); }, c.time_limit,
                    [&, c](const Outcome& outcome) {
                      const ResultRow row = row_of(c, outcome);
                      results_.add(row);
                      claims_.release(c.key());
                      const bool failed = row.at("status") != "solved";
                      if (own_.contains(row.at("key").get<std::string>())) ++tally_.run, tally_.failed += failed;
                      progress.add(work(c), failed);
                    });
  }

  Results& results_;
  Claims claims_;
  unsigned jobs_;
  std::set<std::string> own_;  // keys; references are run besides
  Tally tally_;
};

}  // namespace

std::vector<ResultRow> run_apart(const Case& c) {
  std::vector<ResultRow> rows;
  std::optional<double> reference;
  if (const auto other = c.reference_case()) rows = run_apart(*other), reference = answer_of(rows.back());
  Isolated one(1, 0);
  one.start([&] { return run_case(c, reference).dump(); }, c.time_limit,
            [&](const Outcome& outcome) { rows.push_back(row_of(c, outcome)); });
  one.wait_for_all();
  return rows;
}

Tally run_sweep(const Sweep& sweep, Results& results, const std::filesystem::path& file, unsigned jobs, bool retry) {
  results.declare(sweep, retry);
  return Runner(results, file, jobs).run(sweep);
}

}  // namespace orthant
