// experiments/support/fingerprint.h — fingerprint of a run: its bits as a few numbers, equal on any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace orthant {

inline constexpr std::array<long, 4> kMarks = {10, 100, 1000, 10000};  // steps

/// One scene by one integrator with one solver.
struct Fingerprint {
  std::string scene, integrator, solver;
  std::string end;                         // "solved", or how the run ended before its last mark
  std::array<std::uint64_t, 4> hash = {};  // of all bits of all states up to each mark; 0: not reached

  std::string row() const;
};

/// All planar scenes × integrators × solvers, nothing run yet. `ipopt` is left out: its linear solver keeps state of
/// the process.
std::vector<Fingerprint> all_fingerprints();
/// Likewise the scenes in space, with the solvers that take friction discs.
std::vector<Fingerprint> all_spatial_fingerprints();

/// Runs up to `steps` steps, or until `seconds` are over at the end of one: a late run has fewer marks. Islands are
/// shared by `threads`.
void take(Fingerprint& f, long steps, double seconds, int threads);
/// All of them, `threads` at a time. done() after each, in any thread.
void take(std::vector<Fingerprint>& all, long steps, double seconds, int threads,
          const std::function<void()>& done = {});

/// Whether a mark that both reached differs.
bool differ(const Fingerprint& a, const Fingerprint& b);

/// Build settings on which bits may depend besides the sources: compiler, flags, C library, processor.
std::string build_of_bits();

/// A table: the build in the first line, then a row each. `read` throws std::runtime_error.
std::string table_of(const std::vector<Fingerprint>& all);
std::vector<Fingerprint> read_fingerprints(const std::string& file, std::string& build);

}  // namespace orthant
