// core/support/file.h — files are written whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

namespace orthant {

/// Writes to a temporary file beside `path` and renames it: readers see the old file or the new one, never half.
/// A link is followed; what is no regular file (a device, say) is refused and left alone.
/// Throws std::runtime_error naming the file and the reason; nothing is left behind then.
void write_whole(const std::filesystem::path& path, std::string_view text);

/// Throws std::runtime_error when `path` is no regular file that can be read (a folder or a device, say).
void check_readable(const std::filesystem::path& path);

/// Throws std::runtime_error when `path` could not be written: asked before a long run, not after it.
void check_writable(const std::filesystem::path& path);

}  // namespace orthant
