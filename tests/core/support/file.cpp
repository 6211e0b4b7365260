// Files are read whole up to a limit: a byte more is refused in one line, whatever the file says of its size.
#include <orthant/core/support/file.h>

#include "tests/support/folder.h"

#include <doctest/doctest.h>

using namespace orthant;

namespace {

std::string why_unread(const std::string& file, std::uintmax_t most) {
  try {
    read_whole(file, most);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

bool tells(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

}  // namespace

TEST_CASE("a file is read byte for byte up to the limit, and a byte more is refused with size, limit and option") {
  const Folder folder;
  for (const std::size_t size : {0u, 1u, 65535u, 65536u, 65537u, 300000u}) {
    CAPTURE(size);
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * i >> 3);
    const std::string file = folder.write("bytes", bytes);
    CHECK(read_whole(file, size) == bytes);
    CHECK(read_whole(file) == bytes);
    if (size > 0)
      CHECK(why_unread(file, size - 1).starts_with(file + ": " + std::to_string(size) + " bytes: must be at most "));
  }
  const std::string file = folder.write("large", std::string(5000, 'x'));
  CHECK(why_unread(file, 4096) ==
        file + ": 5000 bytes: must be at most 4 KiB (more by --max-input, or set_largest_input())");
  CHECK(tells(why_unread(folder / "none", 9), "none: cannot read: no such file"));
  CHECK(tells(why_unread(folder / ".", 9), "cannot read: is a folder"));
  CHECK(tells(why_unread("/dev/zero", 9), "cannot read: is no regular file"));
  std::filesystem::create_symlink("round", folder / "round");
  CHECK(tells(why_unread(folder / "round", 9), "round: cannot read: Too many levels of symbolic links"));
}

TEST_CASE("a file that says it is empty is read to the limit and no further") {
  CHECK(read_whole("/proc/self/limits").starts_with("Limit"));
  CHECK(tells(why_unread("/proc/self/limits", 100), "more bytes than the 0 it says it has: must be at most 100 bytes"));
}

TEST_CASE("the limit that is set holds for every kind of file, until it is taken away") {
  CHECK(largest_input(7) == 7);
  set_largest_input(5);
  CHECK(largest_input(7) == 5);
  CHECK(largest_input(3) == 5);
  set_largest_input(0);
  CHECK(largest_input(7) == 7);
}
