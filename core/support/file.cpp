#include <orthant/core/support/file.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

namespace orthant {

void write_whole(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::path temporary = path;
  temporary += ".tmp" + std::to_string(getpid());
  errno = 0;
  std::ofstream out(temporary, std::ios::binary);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  std::error_code error;
  if (out) {
    std::filesystem::rename(temporary, path, error);
    if (!error) return;
  }
  const std::string reason = error ? error.message() : std::strerror(errno);
  std::filesystem::remove(temporary, error);
  throw std::runtime_error("cannot write " + path.string() + ": " + reason);
}

void check_writable(const std::filesystem::path& path) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (std::filesystem::is_directory(path)) throw std::runtime_error("cannot write " + path.string() + ": is a folder");
  if (!std::filesystem::is_directory(folder))
    throw std::runtime_error("cannot write " + path.string() + ": there is no folder " + folder.string());
  if (access(folder.c_str(), W_OK) != 0)
    throw std::runtime_error("cannot write " + path.string() + ": no permission in " + folder.string());
}

}  // namespace orthant
