#include "toml/reader.h"

#include <orthant/core/mechanics/scene_toml.h>
#include <orthant/core/support/shortened.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace orthant {
namespace {

constexpr std::uintmax_t kMaxFile = 16 << 20;  // [bytes]

}  // namespace

Scene parse_scene(std::string_view text, std::span<const std::string> overrides, std::string_view name) {
  const std::string file(name);
  if (text.size() > kMaxFile)
    throw std::invalid_argument(file + ": " + std::to_string(text.size()) + " bytes: must be at most 16 MiB");
  return in_a_line([&] {
    toml::table root = scene_file::parse(text, file);
    for (const std::string& one : overrides) scene_file::apply_override(root, one);
    return scene_file::Reader(root, file).scene();
  });
}

Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw std::invalid_argument(file.string() + ": must be a file that exists");
  const auto size = std::filesystem::file_size(file, error);
  if (size > kMaxFile)
    throw std::invalid_argument(file.string() + ": " + std::to_string(size) + " bytes: must be at most 16 MiB");
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::invalid_argument(file.string() + ": cannot be read");
  return parse_scene(text.str(), overrides, file.string());
}

}  // namespace orthant
