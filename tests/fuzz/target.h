// tests/fuzz/target.h — fuzz target: a parser accepts the bytes, or refuses them in one line.
//
//   Each .cpp here defines one target. The test command replays seeds/NAME/* and mutations of them (replay.cpp); the
//   preset `fuzz` makes a libFuzzer program of each (libfuzzer.cpp): build/fuzz/tests/fuzz_NAME seeds/NAME.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace orthant::fuzz {

void matrix_market(std::string_view bytes);
void problem_json(std::string_view bytes);
void scene(std::string_view bytes);
void sweep(std::string_view bytes);
void fclib(std::string_view bytes);
void options(std::string_view bytes);
void model(std::string_view bytes);
void mesh(std::string_view bytes);
void view(std::string_view bytes);

[[noreturn]] inline void broken(const char* rule, const std::string& found) {
  std::fprintf(stderr, "fuzz: %s: %s\n", rule, found.c_str());
  std::abort();
}

/// Errors are std::runtime_error or std::invalid_argument, in a line or so; anything else ends the program.
inline void parse(const std::function<void()>& work) {
  const auto look = [](const std::string& words) {
    if (words.empty() || words.size() > 2000) broken("an error of one to 2000 characters", words.substr(0, 3000));
  };
  try {
    work();
  } catch (const std::invalid_argument& error) {
    look(error.what());
  } catch (const std::runtime_error& error) {
    look(error.what());
  } catch (const std::exception& error) {
    broken("no other exception", error.what());
  }
}

/// The bytes as a file in memory, for readers that take a path.
class MemoryFile {
 public:
  MemoryFile(const char* name, std::string_view bytes) : descriptor_(memfd_create(name, 0)) {
    if (descriptor_ < 0 || write(descriptor_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      broken("a file in memory", name);
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace orthant::fuzz
