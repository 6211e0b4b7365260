// experiments/benchmarks/lcp/driver.h — driver base of all LCP rivals: a problem from a file, a timed solve, an answer.
//
//   DRIVER                                     prints a line for each method: name, what it takes (pure, boxes,
//   friction)
//   DRIVER METHOD PROBLEM ANSWER TOLERANCE     solves
//
//   PROBLEM, binary, by experiments/studies/support/rivals.cpp: int64 n, entries, frictions; int64 start[n + 1];
//   int32 column[entries]; double value[entries], b[n], lo[n], hi[n]; int32 row[f], normal[f]; double mu[f];
//   int32 rows[f], 2 of a disc.
//   ANSWER, text: status, iterations, runs, seconds of a solve, a note to the end of the line; then z, a number a line.
//   Timed is the call of the solver alone, processor time, the median of up to 5 runs within 0.1 s; what takes
//   less than 20 µs, as often in a row as fills them, less what its preparation takes then. As Orthant's own.
//   No part of Orthant is included: the rivals' headers would meet ours.
#pragma once

#include "../../support/clock.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace rival {

/// lo ≤ z ≤ hi, w = A z + b, as in Orthant; friction rows: |z_row| ≤ μ z_normal.
struct Problem {
  std::int64_t n = 0;
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> column, friction_row, friction_normal, friction_rows;
  std::vector<double> value, b, lo, hi, mu;

  /// n × n, rows `stride` ≥ n numbers apart; the same by columns where `by_rows` is false.
  std::vector<double> dense(std::size_t stride, bool by_rows = true) const {
    const auto size = static_cast<std::size_t>(n);
    std::vector<double> A(size * stride);
    for (std::size_t i = 0; i < size; ++i)
      for (auto k = start[i]; k < start[i + 1]; ++k) {
        const auto j = static_cast<std::size_t>(column[static_cast<std::size_t>(k)]);
        A[by_rows ? i * stride + j : j * stride + i] = value[static_cast<std::size_t>(k)];
      }
    return A;
  }
  std::vector<double> dense() const { return dense(static_cast<std::size_t>(n)); }
  bool symmetric() const {
    const std::vector<double> A = dense();
    const auto size = static_cast<std::size_t>(n);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (std::abs(A[i * size + j] - A[j * size + i]) >
            1e-12 * (std::abs(A[i * size + j]) + std::abs(A[j * size + i])))
          return false;
    return true;
  }
};

struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Answer {
  bool solved = false;  // what the solver says; one that says nothing has said yes
  int iterations = 0;
  std::string note;
  std::vector<double> z;
};

/// Called for every timed run; `prepare` before it, untimed, for solvers that destroy what they are given.
struct Work {
  std::function<void()> prepare, solve;
  std::function<Answer()> answer;
};

struct Method {
  const char *name, *takes;
  std::function<Work(const Problem&, double tolerance)> start;  // throws Unsupported
};

inline Problem read(const char* path) {
  std::ifstream in(path, std::ios::binary);
  in.exceptions(std::ios::failbit | std::ios::badbit);
  const auto fill = [&in](auto& v, std::int64_t count) {
    v.resize(static_cast<std::size_t>(count));
    in.read(reinterpret_cast<char*>(v.data()), static_cast<std::streamsize>(v.size() * sizeof v[0]));
  };
  std::vector<std::int64_t> sizes;
  fill(sizes, 3);
  Problem p;
  p.n = sizes[0];
  fill(p.start, p.n + 1), fill(p.column, sizes[1]), fill(p.value, sizes[1]);
  fill(p.b, p.n), fill(p.lo, p.n), fill(p.hi, p.n);
  fill(p.friction_row, sizes[2]), fill(p.friction_normal, sizes[2]), fill(p.mu, sizes[2]),
      fill(p.friction_rows, sizes[2]);
  return p;
}

inline void write(const char* path, const char* status, const Answer& a, const Timing& timing) {
  std::FILE* out = std::fopen(path, "w");
  if (out == nullptr) throw std::runtime_error(std::string(path) + ": cannot be written");
  std::fprintf(out, "%s %d %d %.9g %s\n", status, a.iterations, timing.runs, timing.seconds,
               a.note.empty() ? "-" : a.note.c_str());
  for (const double z : a.z) std::fprintf(out, "%.17g\n", z);
  std::fclose(out);
}

inline void solve(const Method& method, char** argv) {
  const Problem problem = read(argv[2]);
  Work work;
  try {
    work = method.start(problem, std::atof(argv[4]));
  } catch (const Unsupported& why) {
    return write(argv[3], "unsupported", {false, 0, why.what(), {}}, {});
  }
  const auto prepare = [&work] {
    if (work.prepare) work.prepare();
  };
  const Timing timing = time_calls(prepare, work.solve);
  const Answer answer = work.answer();
  write(argv[3], answer.solved ? "solved" : "failed", answer, timing);
}

/// main(), in full.
inline int drive(int argc, char** argv, const std::vector<Method>& methods) {
  try {
    if (argc == 5)
      for (const Method& method : methods)
        if (std::strcmp(method.name, argv[1]) == 0) return solve(method, argv), 0;
    for (const Method& method : methods) std::cout << method.name << ' ' << method.takes << '\n';
    return argc == 1 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}

}  // namespace rival
