#include <orthant/core/support/file.h>

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
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

std::atomic<std::uintmax_t> set_limit{0};  // [bytes]; 0: none was set

/// 16 MiB, where a number is so round.
std::string in_units(std::uintmax_t bytes) {
  constexpr std::array kUnits = {" bytes", " KiB", " MiB", " GiB", " TiB"};
  std::size_t unit = 0;
  for (; bytes > 0 && bytes % 1024 == 0 && unit + 1 < kUnits.size(); ++unit) bytes /= 1024;
  return std::to_string(bytes) + kUnits[unit];
}

[[noreturn]] void refuse_size(const std::string& name, const std::string& size, std::uintmax_t most) {
  throw std::runtime_error(name + ": " + size + ": must be at most " + in_units(most) +
                           " (more by --max-input, or set_largest_input())");
}

}  // namespace

std::uintmax_t largest_input(std::uintmax_t usual) {
  const std::uintmax_t set = set_limit;
  return set > 0 ? set : usual;
}

void set_largest_input(std::uintmax_t bytes) { set_limit = bytes; }

void check_size(const std::string& name, std::uintmax_t bytes, std::uintmax_t most) {
  if (bytes > most) refuse_size(name, std::to_string(bytes) + " bytes", most);
}

std::string read_whole(const std::filesystem::path& path, std::uintmax_t most) {
  check_readable(path);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path.string() + ": cannot read: " + std::strerror(errno));
  std::error_code error;
  const std::uintmax_t said = std::filesystem::file_size(path, error);
  if (error) throw std::runtime_error(path.string() + ": cannot read: " + error.message());
  check_size(path.string(), said, most);
  std::string text;
  text.reserve(said);
  std::array<char, 1 << 16> chunk;
  while (in) {
    const std::uintmax_t left = most - text.size();  // one byte more is requested, and none after that
    in.read(chunk.data(), static_cast<std::streamsize>(left < chunk.size() ? left + 1 : chunk.size()));
    const auto count = static_cast<std::size_t>(in.gcount());
    if (count > left)
      refuse_size(path.string(), "more bytes than the " + std::to_string(said) + " it says it has", most);
    text.append(chunk.data(), count);
  }
  if (in.bad()) throw std::runtime_error(path.string() + ": cannot read: " + std::strerror(errno));
  return text;
}

void write_whole(const std::filesystem::path& file, std::string_view text) {
  check_writable(file);
  const std::filesystem::path path = target_of(file);
  const std::filesystem::path temporary = temporary_name(path);
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

std::filesystem::path temporary_name(std::filesystem::path path) { return path += ".tmp" + std::to_string(getpid()); }

std::vector<std::filesystem::path> leftovers_beside(const std::filesystem::path& path) {
  const std::string start = path.filename().string() + ".tmp";
  std::vector<std::filesystem::path> left;
  std::error_code error;
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const int process = name.starts_with(start) ? std::atoi(name.c_str() + start.size()) : 0;
    if (process == getpid() || (process > 0 && kill(process, 0) != 0 && errno == ESRCH)) left.push_back(entry.path());
  }
  return left;
}

void check_readable(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) throw std::runtime_error(path.string() + ": cannot read: is a folder");
  if (status.type() == std::filesystem::file_type::none)  // a loop of links, a folder without permission
    throw std::runtime_error(path.string() + ": cannot read: " + error.message());
  if (!std::filesystem::exists(status)) throw std::runtime_error(path.string() + ": cannot read: no such file");
  if (!std::filesystem::is_regular_file(status))
    throw std::runtime_error(path.string() + ": cannot read: is no regular file");
}

bool lies_in(const std::filesystem::path& file, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
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

void check_apart(std::string_view one, const std::filesystem::path& path, std::string_view other,
                 const std::filesystem::path& other_path) {
  std::error_code none;
  const auto place = [](const std::filesystem::path& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file));
  };
  if (!std::filesystem::equivalent(path, other_path, none) && place(path) != place(other_path)) return;
  throw std::invalid_argument(std::string(one) + " '" + path.string() + "' and " + std::string(other) + " '" +
                              other_path.string() + "': must be two files");
}

}  // namespace orthant
