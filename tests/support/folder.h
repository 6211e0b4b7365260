// tests/support/folder.h — programs run as their users run them, in a folder of their own.
#pragma once

#include <stdlib.h>  // mkdtemp

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace orthant {

struct Reply {
  int exit_code = -1;
  std::string out, err;
};

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

struct Folder {  // a place of its own for each test, gone afterwards
  std::filesystem::path path = fresh();
  Folder() = default;
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }
  std::string operator/(const char* file) const { return (path / file).string(); }
  std::string write(const char* file, const std::string& text) const {
    std::ofstream(path / file) << text;
    return *this / file;
  }
  Reply run(const std::string& command) const {
    const std::string all = "cd '" + path.string() + "' && " + command + " >out.txt 2>err.txt";
    const int status = std::system(all.c_str());
    return {WEXITSTATUS(status), slurp(path / "out.txt"), slurp(path / "err.txt")};
  }

 private:
  /// A name that no other process has, however many tests run at once.
  static std::filesystem::path fresh() {
    std::string name = (std::filesystem::temp_directory_path() / "orthant_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no folder for the test: " + name);
    return name;
  }
};

}  // namespace orthant
