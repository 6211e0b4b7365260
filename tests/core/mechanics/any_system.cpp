// Systems of scenes from files: examined by the reader, pairs that it lists included.
#include "tests/support/folder.h"

#include <orthant/core/scenes/registry.h>

#include <doctest/doctest.h>

#include <fstream>

using namespace orthant;

namespace {

constexpr const char* kTwoBalls = R"(
[[body]]
name = "one"
mass = 1
inertia = 0.1
position = [0, 1]
[[body]]
name = "two"
mass = 1
inertia = 0.1
position = [2, 1]
[[collision]]
name = "balls"
search = "none"
shapes = [{body = "one", radius = 0.1}, {body = "two", radius = 0.1}]
walls = [{normal = [0, 1]}]
)";

}  // namespace

TEST_CASE("contacts that a reader lists for a collision are examined by it, with the name of the file") {
  CHECK(parse_scene(kTwoBalls).contacts.size() == 3);
  const std::string taken = std::string(kTwoBalls) +
                            "[[contact]]\nname = 'balls_wall_2'\ntype = 'corner-wall'\nbody = 'one'\n"
                            "wall = {normal = [0, 1]}\n";
  CHECK_THROWS_WITH_AS(parse_scene(taken, {}, "balls.toml"), doctest::Contains("balls.toml: contact \"balls_wall_2\""),
                       std::invalid_argument);
}

TEST_CASE("the system of a scene by its name or file is that of the scene") {
  const Folder folder;
  const std::string file = (folder.path / "balls.toml").string();
  std::ofstream(file) << kTwoBalls;
  for (const std::string& name : {std::string("slider_crank"), file}) {
    CAPTURE(name);
    const AnySystem any = make_any_system(name);
    const System system(make_scene(name));
    const auto& same = std::get<System>(any);
    CHECK(same.contacts() == system.contacts());
    CHECK(same.mass() == system.mass());
    CHECK(same.initial_state().q == system.initial_state().q);
  }
  CHECK(std::holds_alternative<SystemOf<Spatial>>(make_any_system("top")));
  CHECK_THROWS_AS(make_any_system("no_such_scene"), std::invalid_argument);
}
