// The format's description: every example runs, every key is named.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>

#include <cctype>
#include <cmath>
#include <set>

#include "tests/core/mechanics/scene_examples.h"
#include "tests/support/runs.h"
#include "tests/support/scene_texts.h"

namespace orthant {

using namespace scene_texts;
namespace {

/// From "## `[[kind]]`" to the next such headline.
std::string section(const std::string& description, const std::string& kind) {
  const auto begin = description.find("## `[[" + kind + "]]`");
  REQUIRE(begin != std::string::npos);
  return description.substr(begin, description.find("\n## ", begin) - begin);
}

Strings words(std::string list) {
  Strings found;
  std::replace_if(
      list.begin(), list.end(),
      [](char c) { return c != '_' && c != '-' && !std::isalnum(static_cast<unsigned char>(c)); }, ' ');
  std::istringstream in(list);
  for (std::string word; in >> word;) found.push_back(word);
  return found;
}

}  // namespace

TEST_CASE("every example of the format's description is a scene that runs") {
  const auto all = examples(contents(kCore / "scenes" / "README.md"));
  CHECK(all.size() >= 14);
  for (const Example& example : all) {
    CAPTURE(example.text);
    Scene scene;
    REQUIRE_NOTHROW(scene = parse_scene(example.text));
    const System system(scene);
    const State x = system.initial_state();
    Terms start(system);
    set_poses(system, x.t, x.q, start.at);
    evaluate_joint_residual(system, start), evaluate_joint_rows(system, start);
    for (Index i = 0; i < start.phi.size(); ++i) {
      CHECK(std::abs(start.phi[i]) < 1e-12);
      CHECK(std::abs(start.missing_rate(i, x.v)) < 1e-12);
    }
    scene.duration = 5 * scene.step;
    CHECK(run(scene, "moreau-jean", scene.step, {}, "auto").status == Status::solved);
  }
}

TEST_CASE("the complete scenes of the folder run") {
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(kCore / "scenes")) {
    if (file.path().extension() != ".toml") continue;
    CAPTURE(file.path().filename().string());
    Scene scene = read_scene(file);
    scene.duration = std::min(scene.duration, 500 * scene.step);
    CHECK(run(scene, "moreau-jean", scene.step, {}, "auto").status == Status::solved);
    ++files;
    CHECK(contains(contents(kCore / "scenes" / "README.md"), file.path().filename().string()));
  }
  CHECK(files >= 5);
}

TEST_CASE("the description shows every type and names every key that the reader knows") {
  const std::string description = contents(kCore / "scenes" / "README.md");
  const auto all = examples(description);
  const auto known = [](const std::string& error) { return words(error.substr(error.rfind("must be ") + 8)); };
  for (const std::string kind : {"joint", "contact", "spring"})
    for (const std::string& type : known(error_of(kBodies + "[[" + kind + "]]\ntype = \"?\""))) {
      if (type == "or") continue;
      CAPTURE(type);
      const bool shown = std::any_of(all.begin(), all.end(), [&](const Example& example) {
        return contains(example.text, "type = \"" + type + "\"");
      });
      CHECK(shown);
    }
  std::set<std::string> seen;
  for (const Example& example : all)
    for (const std::string& element : example.elements) {
      const std::string error = error_of(example.text, {element + ".no_such_key=1"});
      INFO("said: " << error);
      REQUIRE(contains(error, "no_such_key\": must be one of "));
      const std::string kind = element.substr(0, element.find('.'));
      const bool inner = std::count(element.begin(), element.end(), '.') == 2;
      const std::string prefix = inner ? element.substr(element.rfind('.') + 1) + "." : "";
      Strings keys = known(error);
      for (const std::string& key : Strings(keys.begin() + 2, keys.end())) {  // after "one of"
        CAPTURE(element);
        CAPTURE(key);
        seen.insert(kind);
        const auto named = [&](const std::string& text) {
          return contains(text, "`" + prefix + key + "`") || (inner && contains(text, "`" + key + "`")) ||
                 contains(text, key + " = ");
        };
        // The coordinates' keys are described with the joints.
        CHECK((named(section(description, kind)) || named(section(description, "joint"))));
      }
    }
  CHECK(seen.size() == 7);
  const std::string top = error_of("no_such_key = 1\n" + kBodies);
  for (const std::string& key : known(top)) {
    CAPTURE(key);
    if (key != "one" && key != "of")
      CHECK((contains(description, "`" + key + "`") || contains(description, "`[[" + key + "]]`")));
  }
}

}  // namespace orthant
