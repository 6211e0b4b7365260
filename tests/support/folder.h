// tests/support/folder.h — programs run as their users run them, in a folder of their own.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
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
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("orthant_cli_" + std::to_string(std::rand()));
  Folder() { std::filesystem::create_directories(path); }
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
};

}  // namespace orthant
