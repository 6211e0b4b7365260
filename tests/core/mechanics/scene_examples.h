// tests/core/mechanics/scene_examples.h — examples in the description of a format.
#pragma once

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>

#include <cctype>
#include <map>

#include "tests/support/runs.h"
#include "tests/support/scene_texts.h"

namespace orthant {

struct Example {
  std::string text;
  scene_texts::Strings elements;  // "contact.foot", "contact.foot.wall"
};

/// The ```toml blocks of the description.
inline std::vector<Example> examples(const std::string& description) {
  std::vector<Example> found;
  std::istringstream in(description);
  std::string line;
  bool inside = false;
  std::map<std::string, int> count;
  std::string kind;
  std::size_t element = 0;
  while (std::getline(in, line)) {
    if (line == "```toml") {
      inside = true, count.clear(), kind.clear();
      found.emplace_back();
    } else if (line == "```") {
      inside = false;
    } else if (inside) {
      Example& example = found.back();
      example.text += line + "\n";
      if (line.starts_with("[[")) {
        kind = line.substr(2, line.find(']') - 2);
        element = example.elements.size();
        example.elements.push_back(kind + "." + kind + std::to_string(++count[kind]));
      } else if (line.starts_with("name = ")) {
        example.elements[element] = kind + "." + line.substr(8, line.size() - 9);
      } else if (const auto brace = line.find(" = {"); brace != std::string::npos) {
        example.elements.push_back(example.elements[element] + "." + line.substr(0, brace));
      }
    }
  }
  return found;
}

}  // namespace orthant
