#include "toml/reader.h"
#include "toml/spatial_reader.h"

#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/shortened.h>

#include <cstdint>
#include <stdexcept>

namespace orthant {
namespace {

constexpr std::uintmax_t kLargestScene = 16 << 20;  // [bytes]

/// Whatever is wrong with a scene is an invalid argument.
template <class Work> auto as_invalid(Work&& work) {
  try {
    return work();
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace

std::string read_scene_text(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw std::invalid_argument(file.string() + ": must be a file that exists");
  return as_invalid([&] { return read_whole(file, largest_input(kLargestScene)); });
}

namespace {

/// read(root, file) of the text with the overrides in place.
template <class Read>
auto with_table(std::string_view text, std::span<const std::string> overrides, std::string_view name, Read&& read) {
  const std::string file(name);
  as_invalid([&] { check_size(file, text.size(), largest_input(kLargestScene)); });
  return in_a_line([&] {
    toml::table root = scene_file::parse(text, file);
    scene_file::apply_overrides(root, overrides);
    return read(root, file);
  });
}

}  // namespace

Scene parse_scene(std::string_view text, std::span<const std::string> overrides, std::string_view name) {
  if (is_model(text))
    throw std::invalid_argument(std::string(name) + ": is a model in space: must be a planar scene here");
  return with_table(text, overrides, name, [](const toml::table& root, const std::string& file) {
    return scene_file::Reader(root, file).scene();
  });
}

namespace {

/// The scene that the model becomes; `model.KEY=VALUE` among the overrides are options of the import.
AnyScene parse_model(std::string_view text, std::span<const std::string> overrides, std::string_view name) {
  constexpr std::string_view kOption = "model.";
  std::vector<std::string> options, others;
  for (const std::string& one : overrides)
    if (one.starts_with(kOption))
      options.push_back(one.substr(kOption.size()));
    else
      others.push_back(one);
  const std::string file(name);
  as_invalid([&] { check_size(file, text.size(), largest_input(kLargestScene)); });
  const ImportedModel model = import_model(text, file, options);
  AnyScene scene = parse_any_scene(model.toml, others, file + " (imported)");
  for (const std::string& note : model.notes) std::get<spatial::Scene>(scene).notes.push_back(file + ": " + note);
  return scene;
}

}  // namespace

AnyScene parse_any_scene(std::string_view text, std::span<const std::string> overrides, std::string_view name) {
  if (is_model(text)) return parse_model(text, overrides, name);
  return with_table(text, overrides, name, [](const toml::table& root, const std::string& file) -> AnyScene {
    const toml::node* dimension = root.get("dimension");
    if (dimension != nullptr && dimension->value<double>() == 3) return scene_file::SpatialReader(root, file).scene();
    return scene_file::Reader(root, file).scene();
  });
}

Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides) {
  return parse_scene(read_scene_text(file), overrides, file.string());
}

AnyScene read_any_scene(const std::filesystem::path& file, std::span<const std::string> overrides) {
  return parse_any_scene(read_scene_text(file), overrides, file.string());
}

}  // namespace orthant
