// Chunks: a series resumes from its file, a chunk that crashes is done again, a file of other choices is refused.
#include "experiments/support/chunks.h"

#include <orthant/core/support/file.h>

#include <doctest/doctest.h>

#include <cstdlib>

#include "tests/support/folder.h"

namespace orthant {
namespace {

/// The sum of the numbers of a chunk's cases, as text; `crash`: the chunk that begins there does not come back.
ChunkWork sums(std::uint64_t crash, int& again) {
  const auto sum = [](std::uint64_t first, std::uint64_t count) {
    std::uint64_t total = 0;
    for (std::uint64_t k = first; k < first + count; ++k) total += k;
    return std::to_string(total);
  };
  return {.work =
              [=](std::uint64_t first, std::uint64_t count) {
                if (first == crash) std::_Exit(1);
                return sum(first, count);
              },
          .limit = [](std::uint64_t) { return 60.0; },
          .again = [&again, sum](std::uint64_t first, std::uint64_t count) { return ++again, sum(first, count); },
          .faulty = [](const std::string&) { return false; }};
}

}  // namespace

TEST_CASE("chunks: a series resumes, repeats a chunk that crashed, drops a line cut off, refuses another header") {
  const Folder folder;
  const std::map<std::uint64_t, std::string> all{{0, "3"}, {3, "12"}, {6, "21"}, {9, "9"}};
  Chunks chunks{"sums", folder.path / "chunks.jsonl", "1/3/abc", 10, 3};
  Isolated processes(2, 0);
  int again = 0;
  CHECK(run_chunks(chunks, sums(3, again), processes) == all);
  CHECK(again == 1);
  const std::string whole = read_whole(chunks.file);
  CHECK(run_chunks(chunks, sums(0, again), processes) == all);  // 0 is there already: it cannot crash
  CHECK(again == 1);
  CHECK(read_whole(chunks.file) == whole);

  write_whole(chunks.file, whole.substr(0, whole.size() - 2));  // of the last line
  CHECK(run_chunks(chunks, sums(99, again), processes) == all);
  CHECK(read_whole(chunks.file).size() == whole.size());

  chunks.cases = 12;  // longer: the last chunk had one case
  CHECK(run_chunks(chunks, sums(0, again), processes).at(9) == "30");
  chunks.cases = 5;
  CHECK(run_chunks(chunks, sums(0, again), processes) == std::map<std::uint64_t, std::string>{{0, "3"}, {3, "7"}});
  chunks.header = "2/3/abc";
  CHECK_THROWS_WITH_AS(run_chunks(chunks, sums(99, again), processes), doctest::Contains("take another --output"),
                       std::runtime_error);
}

}  // namespace orthant
