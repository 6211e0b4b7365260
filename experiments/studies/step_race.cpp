// How much faster is a step than Siconos', and how much sooner is an error reached?
//
// The slider-crank with clearance, 0.2 s, by Orthant in all coordinates and by the rivals' drivers in the folder given
// (Siconos: minimal coordinates, written by hand for this mechanism). A step: both by turns at h = 1e-5, the least of
// the repeats, as long for the one as for the other. An error: the quickest run of each that ends that near to the
// exact θ₁, for μ = 0.01, e = 0.4. Processor time.
#include "experiments/studies/support/rivals.h"
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/reference_kernel.h"

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <array>
#include <iomanip>
#include <iostream>
#include <sstream>

using namespace orthant;

namespace {

constexpr double kDuration = 0.2;  // [s]

struct Timed {
  double theta1 = 0, seconds = kInf;
  std::string failed = {};  // why there is no answer, or none to rely on
};

Timed ours(const SliderCrankExact& exact, const std::string& spec, double step) {
  const System system(slider_crank({.mu = exact.mu, .e = exact.e}));
  const auto scheme = make_integrator(spec, system);
  const auto solver = make_solver("auto");
  const double begin = thread_time();
  const Run run = simulate(*scheme, *solver, {.step = step, .duration = kDuration, .every = 1 << 30});
  const double seconds = thread_time() - begin;
  if (run.status != Status::solved) return {.failed = "a problem was not solved: " + scheme->why()};
  return {run.final.q[2], seconds};
}

/// The mean of as many runs as fit into that time: a single one, a twentieth of a rival's, would be half over when the
/// processor has got used to it.
Timed ours_for(double seconds, const SliderCrankExact& exact, const std::string& spec, double step) {
  Timed mean{.seconds = 0};
  double spent = 0;
  int runs = 0;
  do {
    const Timed once = ours(exact, spec, step);
    if (!once.failed.empty()) return once;
    mean.theta1 = once.theta1, spent += once.seconds, ++runs;
  } while (spent < seconds);
  mean.seconds = spent / runs;
  return mean;
}

Timed theirs(const SliderCrankExact& exact, const Rival& rival, double step) {
  std::istringstream text;
  try {
    text.str(output_of({rival.program.string(), rival.method, detail::text_of(exact.mu), detail::text_of(exact.e),
                        detail::text_of(step)}));
  } catch (const std::exception& error) {
    return {.failed = error.what()};
  }
  Timed t;
  std::string line, last;
  while (std::getline(text, line)) last = line;  // some say more before
  if (!(std::istringstream(last) >> t.theta1 >> t.seconds) || !(t.seconds > 0)) return {.failed = "no answer: " + last};
  return t;
}

std::string cells(std::initializer_list<std::string> words) {
  std::string line = "|";
  for (const std::string& word : words) line += " " + word + " |";
  return line + "\n";
}
std::string rounded(double x) {
  std::ostringstream text;
  text << std::setprecision(3) << x;
  return text.str();
}

void steps(const std::vector<Rival>& others, double step, int repeats) {
  std::cout << cells({"mu", "e", "rival", "its step, µs", "Orthant's, µs", "times"}) << "|---|---|---|---|---|---|\n";
  const double each = 1e6 * step / kDuration;
  for (const SliderCrankExact& exact : slider_crank_exact()) {
    if (exact.e > 0.4) continue;
    for (const Rival& rival : others) {
      std::array<Timed, 2> best;  // theirs, ours
      for (int k = 0; k < repeats && best[0].failed.empty() && best[1].failed.empty(); ++k) {
        const Timed rivals = theirs(exact, rival, step);
        const double as_long = rivals.failed.empty() ? rivals.seconds : 0;
        const std::array<Timed, 2> once{rivals, ours_for(as_long, exact, "moreau-jean", step)};
        for (std::size_t i = 0; i < 2; ++i)
          if (!once[i].failed.empty() || once[i].seconds < best[i].seconds) best[i] = once[i];
      }
      const auto cell = [&](const Timed& t) { return t.failed.empty() ? rounded(t.seconds * each) : t.failed; };
      const bool both = best[0].failed.empty() && best[1].failed.empty();
      std::cout << cells({rounded(exact.mu), rounded(exact.e), rival.name, cell(best[0]), cell(best[1]),
                          both ? rounded(best[0].seconds / best[1].seconds) : "–"})
                << std::flush;
    }
  }
}

void errors(const std::vector<Rival>& others, double finest) {
  const SliderCrankExact exact = *slider_crank_exact(0.01, 0.4);
  struct Entry {
    std::string who, setting;
    double error = kInf, seconds = kInf;
  };
  std::vector<Entry> entries;
  const auto add = [&](const std::string& who, const std::string& setting, const Timed& t) {
    if (t.failed.empty())
      entries.push_back({who, setting, std::abs(t.theta1 - exact.theta1), t.seconds});
    else
      std::cerr << "step_race: " << who << ", " << setting << ": " << t.failed << '\n';
  };
  for (double step = 1e-5; step > 0.9 * finest; step /= 10)
    for (const Rival& rival : others) add(rival.name, rounded(step) + " s", theirs(exact, rival, step));
  for (double step = 1e-5; step > 0.9e-7; step /= 10)
    add("moreau-jean", rounded(step) + " s", ours(exact, "moreau-jean", step));
  for (const std::string scheme : {"adaptive", "event-driven"})
    for (int digits = 4; digits <= 13; ++digits) {
      const std::string number = "1e-" + std::to_string(digits);
      const std::string absolute = detail::text_of(std::max(1e-3 * std::stod(number), 1e-15));
      add(scheme, "rtol " + number, ours(exact, scheme + ":rtol=" + number + ",atol=" + absolute, kDuration));
    }
  std::cout << '\n' << cells({"error, rad", "who", "setting", "reached", "s"}) << "|---|---|---|---|---|\n";
  for (const double target : {1.4e-3, 1e-6, 1e-9})
    for (const Entry& entry : entries) {
      const bool first = std::ranges::none_of(entries, [&](const Entry& other) {
        return other.who == entry.who && other.error <= target && other.seconds < entry.seconds;
      });
      if (entry.error <= target && first)
        std::cout << cells({rounded(target), entry.who, entry.setting, rounded(entry.error), rounded(entry.seconds)});
    }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("A step of the slider-crank, and the time to an error, compared with Siconos");
  std::string folder = "build/peers/slider_crank", only = "siconos";
  double step = 1e-5, finest = 1e-6;
  int repeats = 5;
  app.add_option("--rivals", folder, "folder of rivals' drivers")->capture_default_str();
  app.add_option("--only", only, "those whose names begin so; their settings must be steps")->capture_default_str();
  app.add_option("--step", step, "[s]")->capture_default_str()->check(between(1e-7, 1e-3));
  app.add_option("--repeats", repeats, "of each, by turns; the fastest counts")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  app.add_option("--finest", finest, "step of theirs on the way to an error [s]; 1e-7: minutes")
      ->capture_default_str()
      ->check(between(1e-8, 1e-5));
  if (const auto end = parse(app, argc, argv)) return *end;
  for (const char* threads : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"})
    setenv(threads, "1", 1);  // for theirs, as for ours
  try {
    std::vector<Rival> others = rivals(folder);
    std::erase_if(others, [&](const Rival& r) { return !r.name.starts_with(only) || !r.absent.empty(); });
    if (others.empty())
      throw std::runtime_error("no rival '" + only + "' in " + folder + ": experiments/benchmarks/setup");
    steps(others, step, repeats);
    errors(others, finest);
  } catch (const std::exception& error) {
    std::cerr << "step_race: " << error.what() << '\n';
    return 1;
  }
}
