#include "experiments/support/chunks.h"

#include "experiments/runs/manifest.h"
#include "experiments/support/progress.h"

#include <orthant/core/support/file.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace orthant {
namespace {

/// A chunk's first case and count, so that a series may be made longer or shorter.
using Finished = std::map<std::pair<std::uint64_t, std::uint64_t>, std::string>;

Finished finished_chunks(const std::filesystem::path& file, const std::string& header) {
  Finished done;
  std::ifstream in(file);
  std::string line, kept;
  while (std::getline(in, line)) {
    if (in.eof()) break;  // no line end: not whole
    if (!line.starts_with(header + ' '))
      throw std::runtime_error(file.string() + ": was made with other choices or another build: take another --output");
    std::istringstream words(line.substr(header.size()));
    std::uint64_t first = 0, count = 0;
    words >> first >> count >> std::ws;
    std::getline(words, done[{first, count}]);
    kept += line + '\n';
  }
  in.close();
  if (std::filesystem::exists(file) && std::filesystem::file_size(file) != kept.size()) write_whole(file, kept);
  return done;
}

}  // namespace

std::string chunk_header(std::uint64_t seed, std::uint64_t size, std::span<const std::string> methods) {
  std::string header =
      std::to_string(seed) + '/' + std::to_string(size) + '/' + manifest()["revision"].get<std::string>();
  for (const std::string& method : methods) header += '/' + method;
  std::ranges::replace(header, ' ', '_');
  return header;
}

std::map<std::uint64_t, std::string> run_chunks(const Chunks& chunks, const ChunkWork& work, Isolated& processes) {
  const Finished before = finished_chunks(chunks.file, chunks.header);
  std::map<std::uint64_t, std::string> done;
  std::ofstream lines(chunks.file, std::ios::app | std::ios::binary);
  const auto count_of = [&](std::uint64_t first) { return std::min(chunks.size, chunks.cases - first); };
  const auto keep = [&](std::uint64_t first, const std::string& result) {
    lines << chunks.header << ' ' << first << ' ' << count_of(first) << ' ' << result << '\n' << std::flush;
    if (!lines) throw std::runtime_error("cannot write " + chunks.file.string() + ": the disk may be full");
    done[first] = result;
  };
  Progress progress(chunks.title, static_cast<double>(chunks.cases),
                    static_cast<long>((chunks.cases + chunks.size - 1) / chunks.size));
  std::vector<std::uint64_t> lost;
  for (std::uint64_t first = 0; first < chunks.cases; first += chunks.size) {
    const std::uint64_t count = count_of(first);
    const auto note = [&, first, count](bool back) {
      progress.add(static_cast<double>(count), !back || work.faulty(done[first]));
    };
    if (const auto known = before.find({first, count}); known != before.end()) {
      done[first] = known->second;
      note(true);
      continue;
    }
    processes.start([&work, first, count] { return work.work(first, count); }, work.limit(count),
                    [&, first, note](const Outcome& o) {
                      const bool back = o.kind == Outcome::finished;
                      if (back)
                        keep(first, o.text);
                      else
                        lost.push_back(first);
                      note(back);
                    });
  }
  processes.wait_for_all();
  for (const std::uint64_t first : lost) keep(first, work.again(first, count_of(first)));
  return done;
}

}  // namespace orthant
