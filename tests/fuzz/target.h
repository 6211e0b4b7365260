// tests/fuzz/target.h — fuzz target: a parser accepts the bytes, or refuses them in one line.
//
//   Each .cpp here defines one target. The test command replays seeds/NAME/* and mutations of them (replay.cpp); the
//   preset `fuzz` makes a libFuzzer program of each (libfuzzer.cpp): build/fuzz/tests/fuzz_NAME seeds/NAME.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace orthant::fuzz {

// Whether the bytes were accepted.
bool matrix_market(std::string_view bytes);
bool problem_json(std::string_view bytes);
bool scene(std::string_view bytes);
bool sweep(std::string_view bytes);
bool fclib(std::string_view bytes);
bool options(std::string_view bytes);
bool model(std::string_view bytes);
bool mesh(std::string_view bytes);
bool view(std::string_view bytes);

[[noreturn]] inline void broken(const char* rule, const std::string& found) {
  std::fprintf(stderr, "fuzz: %s: %s\n", rule, found.c_str());
  std::abort();
}

/// Whether `work` ended without an error. Errors are std::runtime_error or std::invalid_argument, in a line or so;
/// anything else ends the program.
inline bool parse(const std::function<void()>& work) {
  const auto look = [](const std::string& words) {
    if (words.empty() || words.size() > 2000) broken("an error of one to 2000 characters", words.substr(0, 3000));
  };
  try {
    work();
    return true;
  } catch (const std::invalid_argument& error) {
    look(error.what());
  } catch (const std::runtime_error& error) {
    look(error.what());
  } catch (const std::exception& error) {
    broken("no other exception", error.what());
  }
  return false;
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

/// The bytes as a file in the folder of temporary files. HDF5 resolves links, and a MemoryFile's leads nowhere; a run's
/// events are searched next to it.
class NamedFile {
 public:
  NamedFile(const char* name, std::string_view bytes)
      : path_(std::filesystem::temp_directory_path() / ("orthant_fuzz_" + std::to_string(getpid()) + "_" + name)) {
    std::ofstream out(path_, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) broken("a temporary file", path_.string());
  }
  ~NamedFile() {
    std::error_code error;
    std::filesystem::remove(path_, error);
  }
  NamedFile(const NamedFile&) = delete;
  NamedFile& operator=(const NamedFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace orthant::fuzz
