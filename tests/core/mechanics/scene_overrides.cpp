// Overrides and options of scenes, and files with damage.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>

#include <cctype>
#include <random>

#include "tests/core/mechanics/scene_dump.h"
#include "tests/core/mechanics/scene_examples.h"
#include "tests/support/runs.h"
#include "tests/support/scene_texts.h"

namespace orthant {

using namespace scene_texts;

TEST_CASE("overrides change the named values and nothing else") {
  const auto foot = [](const Strings& sets) { return std::get<CornerWall>(parse_scene(kCorner, sets).contacts[0]); };
  CHECK(foot({"contact.foot.mu=0.1"}).law.mu == 0.1);
  CHECK(foot({"contact.foot.wall.normal=[1, 0]"}).normal == Vector2d(1, 0));
  CHECK(foot({"contact.foot.wall.point=[1, 0]"}).normal == Vector2d(0, 1));         // a key path adds
  CHECK(foot({"contact.foot.wall={normal = [-3, 0]}"}).normal == Vector2d(-1, 0));  // an inline table replaces
  CHECK(foot({"contact.foot.wall.body=\"ball\""}).b == 2);
  CHECK(parse_scene(kCorner, Strings{"gravity=[0, 0]", "step = 0.5", "contact = []"}).contacts.empty());
  CHECK(parse_scene(kCorner, Strings{"body.cart.omega=-0.01"}).bodies[1].omega == -0.01);
  CHECK(parse_scene(kCorner + "[[load]]\nbody = \"rod\"", Strings{"load.load1.torque=3"}).loads[0].torque == 3);

  const Strings sets{"contact.corner3.mu=0.5", "body.slider.omega=-0.01"};
  Scene expected = slider_crank({.omega3 = -0.01});
  std::get<CornerWall>(expected.contacts[2]).law.mu = 0.5;
  CHECK(dump(read_scene(kCore / "scenes" / "slider_crank.toml", sets)) == dump(expected));
}

TEST_CASE("a factor can be given and replaced by overrides") {
  const std::string text = kBodies + "[[load]]\nbody = \"rod\"\nfactor = {type = \"table\", times = [0], values = [3]}";
  CHECK(parse_scene(text).loads[0].factor(5) == 3);
  const Strings replaced{"load.load1.factor={type = \"cosine\", omega = 0}"};
  CHECK(parse_scene(text, replaced).loads[0].factor(5) == 1);
  const Strings built{"load.load1.factor.type=\"cosine\"", "load.load1.factor.omega=0",
                      "load.load1.factor.amplitude=2"};
  CHECK(parse_scene(kBodies + "[[load]]\nbody = \"rod\"", built).loads[0].factor(5) == 2);
}

TEST_CASE("built-in scenes take options, files take overrides, anything else lists what there is") {
  CHECK(dump(make_scene("slider_crank")) == dump(slider_crank()));
  CHECK(dump(make_scene("slider_crank_ideal")) == dump(slider_crank_ideal()));
  const Strings options{"mu=0.1", "e=0.9,e_t=0.2", "clearance=0.002", "theta3=0.001", "omega3=-0.01"};
  CHECK(dump(make_scene("slider_crank", options)) ==
        dump(slider_crank({.mu = 0.1, .e = 0.9, .e_t = 0.2, .clearance = 0.002, .theta3 = 0.001, .omega3 = -0.01})));
  CHECK(dump(make_scene((kCore / "scenes" / "slider_crank.toml").string(), Strings{"contact.corner1.mu=0.5"})) !=
        dump(slider_crank()));
  for (const SceneEntry& entry : scenes()) CHECK_NOTHROW(check(entry.make({})));

  const auto error = [](const std::string& name, const Strings& sets) -> std::string {
    try {
      make_scene(name, sets);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return {};
  };
  const std::string unknown = error("slidercrank", {});
  CHECK(contains(unknown, "unknown scene 'slidercrank': must be a TOML file that exists or one of bouncing_ball, "));
  for (const SceneEntry& entry : scenes()) CHECK(contains(unknown, std::string(entry.name)));
  CHECK(contains(error("slider_crank", {"muu=1"}), "unknown option 'muu': must be one of mu, e, e_t, clearance"));
  CHECK(contains(error("slider_crank", {"mu=0.1", "mu=0.2"}), "option 'mu=0.2': is given twice"));
  CHECK(contains(error("slider_crank", {"e=2"}), "option e = 2: must be in [0, 1]"));
  CHECK(contains(error("slider_crank", {"mu=nan"}), "option mu = nan: must be in"));
  CHECK(contains(error("slider_crank_ideal", {"mu=1"}), "unknown option 'mu'"));
  CHECK(contains(error(kCore.string(), {}), "must be a file that exists"));  // a folder
  CHECK(contains(error("", {}), "unknown scene ''"));
}

TEST_CASE("files with random damage are scenes or errors, never anything else") {
  const auto all = examples(contents(kCore / "scenes" / "README.md"));
  std::mt19937 random(1);
  const std::string alphabet = "[]{}=.,\"'#\n\\ -e0\xc3\x01";
  for (std::size_t i = 0; i < 200 * all.size(); ++i) {
    std::string text = all[i % all.size()].text;
    for (unsigned k = 0; k <= random() % 3; ++k) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.erase(at, random() % 20);
          break;
        default:
          text.insert(at, 1, alphabet[random() % alphabet.size()]);
      }
    }
    try {
      check(parse_scene(text));
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace orthant
