#include <orthant/core/support/file.h>

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

namespace orthant {

namespace {

/// Where a path leads: the end of its links, or itself when there is nothing yet.
std::filesystem::path target_of(const std::filesystem::path& path) {
  std::error_code error;
  const auto target = std::filesystem::weakly_canonical(path, error);
  return error ? path : target;
}

}  // namespace

void write_whole(const std::filesystem::path& file, std::string_view text) {
  check_writable(file);
  const std::filesystem::path path = target_of(file);
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

void check_readable(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) throw std::runtime_error(path.string() + ": cannot read: is a folder");
  if (!std::filesystem::exists(status)) throw std::runtime_error(path.string() + ": cannot read: no such file");
  if (!std::filesystem::is_regular_file(status))
    throw std::runtime_error(path.string() + ": cannot read: is no regular file");
}

void check_writable(const std::filesystem::path& file) {
  const std::filesystem::path path = target_of(file);
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (std::filesystem::is_directory(path)) throw std::runtime_error("cannot write " + path.string() + ": is a folder");
  if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path))
    throw std::runtime_error("cannot write " + path.string() + ": is no regular file");
  if (!std::filesystem::is_directory(folder))
    throw std::runtime_error("cannot write " + path.string() + ": there is no folder " + folder.string());
  if (access(folder.c_str(), W_OK) != 0)
    throw std::runtime_error("cannot write " + path.string() + ": no permission in " + folder.string());
}

}  // namespace orthant
