// TOML document: parsing, keys that nobody reads, errors with their lines.
#include "document.h"

#include <orthant/core/support/options.h>
#include <orthant/core/support/toml_nesting.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace orthant::scene_file {
namespace {

constexpr std::string_view kOverride = "override ";
constexpr std::array<std::string_view, 7> kKinds = {"body",     "joint",  "contact", "collision",
                                                    "friction", "spring", "load"};

/// Moves what `from` holds into `into`; tables written as key paths merge, everything else replaces.
void merge(toml::table&& from, toml::table& into) {
  for (auto&& [key, node] : from) {
    toml::table* inner = node.as_table();
    toml::table* outer = into[key.str()].as_table();
    if (inner != nullptr && outer != nullptr && !inner->is_inline())
      merge(std::move(*inner), *outer);
    else
      node.visit([&, &name = key](auto& n) { into.insert_or_assign(name.str(), std::move(n)); });
  }
}

using Path = std::vector<std::string>;  // of keys, from the root

/// Where each value of `from` goes, as merge() takes them.
void list_paths(const toml::table& from, const Path& above, std::vector<Path>& all) {
  for (const auto& [key, node] : from) {
    Path path = above;
    path.emplace_back(key.str());
    const toml::table* inner = node.as_table();
    if (inner != nullptr && !inner->is_inline())
      list_paths(*inner, path, all);
    else
      all.push_back(std::move(path));
  }
}

/// One is the other, or above it.
bool meet(const Path& a, const Path& b) {
  return std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(std::min(a.size(), b.size())), b.begin());
}

/// `paths`: where what has been put in is; this one's are added.
void apply_override(toml::table& root, std::string_view override_text, std::vector<Path>& paths) {
  const std::string name = std::string(kOverride) + std::string(override_text);
  if (const auto end = override_text.find('\n'); end != std::string_view::npos)
    throw std::invalid_argument(std::string(kOverride) + std::string(override_text.substr(0, end)) +
                                " ...: must be one line");
  const auto put = [&](std::string_view text, const Path& above, toml::table& into) {
    const auto key = text.substr(0, text.find('='));
    if (const auto open = key.find('[');
        open != std::string_view::npos && key.find_first_of("\"'") == std::string_view::npos)
      throw std::invalid_argument(name + ": a key has no places: must give the whole array, " +
                                  std::string(key.substr(0, open)) + "=[...]");
    toml::table values = parse(text, name);
    std::vector<Path> added;
    list_paths(values, above, added);
    for (const Path& path : added)
      if (std::any_of(paths.begin(), paths.end(), [&](const Path& other) { return meet(path, other); }))
        throw std::invalid_argument(name + ": is given twice");
    std::move(added.begin(), added.end(), std::back_inserter(paths));
    merge(std::move(values), into);
  };
  const auto path = override_text.substr(0, override_text.find('='));
  if (path.size() == override_text.size()) throw std::invalid_argument(name + ": must have the form key=value");
  const auto dot = path.find('.');
  const auto kind = path.substr(0, dot);
  if (dot == std::string_view::npos) return put(override_text, {}, root);
  if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end())
    throw std::invalid_argument(name + ": unknown kind " + in_quotes(kind) + ": must be one of " +
                                join({kKinds.begin(), kKinds.end()}));
  const auto second_dot = path.find('.', dot + 1);
  if (second_dot == std::string_view::npos)
    throw std::invalid_argument(name + ": must have the form " + std::string(kind) + ".NAME.KEY=VALUE");
  const auto wanted = path.substr(dot + 1, second_dot - dot - 1);
  std::vector<std::string> present;
  if (toml::array* elements = root[kind].as_array())
    for (std::size_t i = 0; i < elements->size(); ++i) {
      toml::node& element = *elements->get(i);
      present.push_back(name_of(element, kind, i));
      if (present.back() == wanted && element.is_table())
        return put(override_text.substr(second_dot + 1), {std::string(kind), present.back()}, *element.as_table());
    }
  throw std::invalid_argument(name + ": no " + std::string(kind) + " is named " + in_quotes(wanted) +
                              ": must be one of " + (present.empty() ? "(the scene has none)" : join(present)));
}

}  // namespace

std::string join(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list.append(list.empty() ? "" : ", ").append(word);
  return list;
}

std::string place(const toml::node& node, const std::string& file) {
  const auto& source = node.source();
  if (!source.path) return file;
  if (source.path->starts_with(kOverride)) return *source.path;
  return *source.path + ":" + std::to_string(source.begin.line);
}

std::string text(const toml::node& node) {
  std::string line;
  if (const auto* number = node.as_floating_point()) {
    line = detail::text_of(number->get());
  } else if (const auto* array = node.as_array()) {
    for (const toml::node& element : *array) line.append(line.empty() ? "[" : ", ").append(text(element));
    line.append(array->empty() ? "[]" : "]");
  } else {
    std::ostringstream out;
    node.visit([&](const auto& n) { out << n; });
    line = out.str();
    std::replace(line.begin(), line.end(), '\n', ' ');
  }
  constexpr std::size_t kLongest = 60;
  return line.size() <= kLongest ? line : line.substr(0, kLongest) + " ...";
}

toml::table parse(std::string_view text, const std::string& name) {
  refuse_deep(text, name);
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const bool is_override = name.starts_with(kOverride);
    throw std::invalid_argument(name + (is_override ? "" : ":" + std::to_string(error.source().begin.line)) + ": " +
                                std::string(error.description()));
  }
}

std::string name_of(const toml::node& element, std::string_view kind, std::size_t index) {
  const toml::table* table = element.as_table();
  const auto name = table == nullptr ? std::nullopt : (*table)["name"].value<std::string>();
  return name && !name->empty() ? *name : std::string(kind) + std::to_string(index + 1);
}

void apply_overrides(toml::table& root, std::span<const std::string> overrides) {
  std::vector<Path> paths;
  for (const std::string& one : overrides) apply_override(root, one, paths);
}

}  // namespace orthant::scene_file
