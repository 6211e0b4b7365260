// core/support/file.h — file input and output: files are written whole or not at all, and read up to a limit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

/// How much one file may bring [bytes]: `usual`, which goes by the kind of file, or what was set for all kinds.
std::uintmax_t largest_input(std::uintmax_t usual);

/// From now on, in every thread; 0: the usual of each kind. `orthant --max-input`.
void set_largest_input(std::uintmax_t bytes);

/// Throws std::runtime_error when `bytes` are more than `most`, a largest_input(); `name` is what has them.
void check_size(const std::string& name, std::uintmax_t bytes, std::uintmax_t most);

/// A regular file's bytes. Never reads on beyond `most`, whatever size the file says it has: it may grow meanwhile.
/// Throws std::runtime_error naming the file and the reason.
std::string read_whole(const std::filesystem::path& path, std::uintmax_t most = UINTMAX_MAX);

/// Writes to a temporary file next to `path` and renames it: readers see the old or the new file, never half of it.
/// A link is followed; anything but a regular file (a device, say) is refused and left alone.
/// Throws std::runtime_error naming the file and the reason; nothing is left behind then.
void write_whole(const std::filesystem::path& path, std::string_view text);

/// Where this process writes what is to take the place of `path`: NAME.tmp and the process's number.
std::filesystem::path temporary_name(std::filesystem::path path);
/// Temporary files that killed processes left: their names hold the number of an ended process, or of this one.
std::vector<std::filesystem::path> leftovers_beside(const std::filesystem::path& path);

/// Whether `file` is in `folder` or below it; both canonical.
bool lies_in(const std::filesystem::path& file, const std::filesystem::path& folder);

/// Throws std::runtime_error when `path` is no regular file that can be read (a folder or a device, say).
void check_readable(const std::filesystem::path& path);

/// Throws std::runtime_error when `path` could not be written. Call it before a long run, not after it.
void check_writable(const std::filesystem::path& path);

/// Throws std::invalid_argument when both are one file: the output would take the place of the input, or
/// written.
/// `one` and `other` as the caller knows them, such as "--output".
void check_apart(std::string_view one, const std::filesystem::path& path, std::string_view other,
                 const std::filesystem::path& other_path);

}  // namespace orthant
