// experiments/support/chunks.h — long series of numbered cases, in chunks of one process each; a later run resumes.
//
//   The file has a line a finished chunk: header, number of the first case, count, result as text. A last line that a
//   kill cut off is dropped. A chunk whose process does not come back is done again by the caller, case by case.
#pragma once

#include "experiments/support/isolated.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>

namespace orthant {

struct Chunks {
  std::string title;  // of the progress line
  std::filesystem::path file;
  std::string header;  // of the choices and the build, without blanks
  std::uint64_t cases = 0, size = 1;
};

/// Header of a series: seed, chunk size, revision and the names of the methods.
std::string chunk_header(std::uint64_t seed, std::uint64_t size, std::span<const std::string> methods);

struct ChunkWork {
  using Cases = std::function<std::string(std::uint64_t first, std::uint64_t count)>;
  Cases work;                                        // in a process of its own
  std::function<double(std::uint64_t count)> limit;  // [s] after which that is killed
  Cases again;                                       // here, where it crashed or was killed
  std::function<bool(const std::string&)> faulty;    // of a result: the progress line counts it
};

/// Results of all chunks, by their first case. Throws std::runtime_error when the file is of another header or cannot
/// be written.
std::map<std::uint64_t, std::string> run_chunks(const Chunks& chunks, const ChunkWork& work, Isolated& processes);

}  // namespace orthant
