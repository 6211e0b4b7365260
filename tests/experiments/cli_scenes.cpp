// Commands about scenes: new, check, schema, and manual pages and completions made of the same options as the help.
#include "tests/support/cli.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <set>
#include <string>

namespace fs = std::filesystem;
using Tree = nlohmann::json;  // of JSON
using orthant::Cli, orthant::Reply, orthant::lines, orthant::slurp;

namespace {

constexpr const char* kParallelogram = ORTHANT_TEST_DATA "/parallelogram_redundant.toml";

/// Keys of one table of a scene against the schema: unknown ones, and needed ones that are missing.
void compare_keys(const Tree& table, const Tree& schema, std::vector<std::string>& wrong) {
  for (const auto& [key, value] : table.items())
    if (!schema.at("properties").contains(key)) wrong.push_back("unknown " + key);
  if (schema.contains("required"))
    for (const auto& key : schema.at("required"))
      if (!table.contains(key.get<std::string>())) wrong.push_back("missing " + key.get<std::string>());
}

const Tree& variant(const Tree& items, const std::string& type) {
  if (!items.contains("oneOf")) return items;
  for (const Tree& one : items.at("oneOf"))
    if (one.at("properties").at("type").at("const") == type) return one;
  throw std::runtime_error("no variant " + type);
}

}  // namespace

TEST_CASE("orthant new mechanism: a scene that runs, and never the end of a file") {
  const Cli folder;
  CHECK(folder.orthant("new mechanism --output mine.toml").out == "scene: mine.toml\n");
  const auto run = Tree::parse(folder.orthant("simulate mine.toml --integrator adaptive --json").out);
  CHECK(run.at("status") == "solved");
  CHECK(run.at("events").get<int>() > 3);  // it strikes its stop
  CHECK(folder.orthant("check mine.toml").exit_code == 0);
  const Reply again = folder.orthant("new mechanism --output mine.toml");
  CHECK(again.exit_code == 1);
  CHECK(again.err.find("mine.toml: exists already") != std::string::npos);
  CHECK(folder.orthant("new mechanism --output -").out == slurp(folder.path / "mine.toml"));
}

TEST_CASE("orthant check: mobility by Gruebler and by rank, redundant rows by name") {
  const Cli folder;
  const auto crank = Tree::parse(folder.orthant("check slider_crank --json").out);
  CHECK(crank.at("bodies") == 3);
  CHECK(crank.at("joint_rows") == 6);
  CHECK(crank.at("mobility_gruebler") == 3);
  CHECK(crank.at("mobility_rank") == 3);
  CHECK(crank.at("redundant_rows") == "");
  CHECK(crank.at("clearances").at("corner1").get<double>() == doctest::Approx(0.001).epsilon(1e-9));
  CHECK(crank.at("suggested_integrator") == "adaptive");

  const Reply parallel = folder.orthant(std::string("check ") + kParallelogram + " --json");
  const auto account = Tree::parse(parallel.out);
  CHECK(account.at("mobility_rank").get<int>() > account.at("mobility_gruebler").get<int>());
  CHECK(account.at("redundant_rows").get<std::string>().find("repeats") != std::string::npos);
  CHECK(folder.orthant(std::string("check ") + kParallelogram)
            .out.find("redundant rows: the joints' 9 rows have rank 8") != std::string::npos);

  // Against a cosine of ω the step is 0.02 / ω or less, and a round number.
  folder.write("driven.toml",
               "[[body]]\nname = \"a\"\nmass = 1\ninertia = 1\n[[joint]]\ntype = \"drive\"\nof = \"slide\"\nbodies = "
               "[\"ground\", \"a\"]\namplitude = 0.1\nomega = 50\n");
  const auto driven = Tree::parse(folder.orthant("check driven.toml --json").out);
  CHECK(driven.at("suggested_step").get<double>() == doctest::Approx(2e-4).epsilon(1e-9));  // 0.02 / 50 is 4e-4
  CHECK(driven.at("jam") == "");
}

TEST_CASE("orthant check in space: overconstrained linkages move, by rank, and their redundant rows are named") {
  const Cli folder;
  // Bennett's linkage: four hinges, rank 17 of 20. Bricard's: six, rank 29 of 30. Hunt (1978), ch. 11; IFToMM A04.
  const struct {
    const char* scene;
    int bodies, rows, gruebler;
  } known[] = {{"bennett", 3, 20, -2}, {"bricard", 5, 30, 0}, {"spatial_slider_crank", 3, 17, 1}, {"top", 1, 3, 3}};
  for (const auto& one : known) {
    CAPTURE(one.scene);
    const auto account = Tree::parse(folder.orthant(std::string("check ") + one.scene + " --json").out);
    CHECK(account.at("dimension") == 3);
    CHECK(account.at("bodies") == one.bodies);
    CHECK(account.at("joint_rows") == one.rows);
    CHECK(account.at("mobility_gruebler") == one.gruebler);
    CHECK(account.at("mobility_rank") == (one.gruebler < 1 ? 1 : one.gruebler));
    const auto redundant = account.at("redundant_rows").get<std::string>();
    CHECK(redundant.empty() == (one.gruebler >= 1));
    CHECK(redundant.find("singular") == std::string::npos);  // in every pose
    CHECK(account.at("suggested_integrator") == "generalized-alpha");
  }
  CHECK(folder.orthant("check bennett").out.find("rows z, tilt 1, tilt 2 of joint \"hinge4\" repeat what") !=
        std::string::npos);

  // A slider-crank built of spatial bodies has the clearances and the step of the planar one.
  const auto plane = Tree::parse(folder.orthant("check slider_crank --json").out);
  const auto space = Tree::parse(folder.orthant("check slider_crank_space --json").out);
  CHECK(space.at("mobility_rank") == 3);
  CHECK(space.at("clearances").size() == 4);
  for (const auto& [name, gap] : plane.at("clearances").items())
    CHECK(space.at("clearances").at(name).get<double>() == doctest::Approx(gap.get<double>()).epsilon(1e-9));
  CHECK(space.at("suggested_step") == plane.at("suggested_step"));
  CHECK(space.at("suggested_integrator") == "moreau-jean");
  CHECK(Tree::parse(folder.orthant("check euler_disc --json").out).at("suggested_integrator") == "stewart-trinkle");

  // Two hinges on one axis: the second repeats the first.
  folder.write("door.toml",
               "dimension = 3\n[[body]]\nname = \"door\"\nmass = 20\ninertia = 5\n[[joint]]\ntype = "
               "\"revolute\"\nname = \"upper\"\nbodies = [\"ground\", \"door\"]\npoint_a = [0, 0, 1]\npoint_b = [0, 0, "
               "1]\naxis = [0, 0, 1]\n[[joint]]\ntype = \"revolute\"\nname = \"lower\"\nbodies = [\"ground\", "
               "\"door\"]\naxis = [0, 0, 1]\n[[joint]]\nname = \"motor\"\ntype = \"drive\"\njoint = \"upper\"\nomega "
               "= 50\namplitude = 0.1\n");
  const Reply said = folder.orthant("check door.toml");
  CHECK(said.out.find("mobility: -5 by Grübler (6 bodies - joint rows), 0 by rank (6 independent rows)") !=
        std::string::npos);
  CHECK(said.out.find("rows x, y, z, tilt 1, tilt 2 of joint \"lower\" repeat what joint \"upper\" already says") !=
        std::string::npos);
  CHECK(said.out.find("drives: motor; no jam (looked at until t = 1 s)") != std::string::npos);
  CHECK(said.out.find("fixed steps of 0.0002 s") != std::string::npos);  // 0.02 / 50 is 4e-4
}

TEST_CASE("orthant check: drives that jam are told before a run") {
  const Cli folder;
  folder.write("jam.toml",
               "duration = 2\n[[body]]\nname = \"a\"\nmass = 1\ninertia = 1\nposition = [0, 0]\n[[joint]]\ntype = "
               "\"prismatic\"\nbodies = [\"ground\", \"a\"]\n[[joint]]\nname = \"motor\"\ntype = \"drive\"\nof = "
               "\"slide\"\nbodies = [\"ground\", \"a\"]\nrate = 1\n[[contact]]\nname = \"stop\"\ntype = "
               "\"corner-wall\"\nbody = \"a\"\nwall = {point = [1, 0], normal = [-1, 0]}\n");
  const Reply jam = folder.orthant("check jam.toml");
  CHECK(jam.exit_code == 3);
  CHECK(jam.out.find("jammed: drive \"motor\", contact \"stop\"") != std::string::npos);
  CHECK(folder.orthant("check jam.toml --set duration=0.5").exit_code == 0);

  // In space, in a plane that is turned.
  folder.write("jam3.toml",
               "dimension = 3\nduration = 2\n[[body]]\nname = \"a\"\nmass = 1\ninertia = 1\n[[joint]]\nname = "
               "\"rail\"\ntype = \"prismatic\"\nbodies = [\"ground\", \"a\"]\naxis = [1, 2, 2]\n[[joint]]\nname = "
               "\"motor\"\ntype = \"drive\"\njoint = \"rail\"\nrate = 3\n[[contact]]\nname = \"stop\"\ntype = "
               "\"corner-wall\"\nbody = \"a\"\nwall = {point = [1, 0, 0], normal = [-1, 0, 0]}\n");
  const Reply in_space = folder.orthant("check jam3.toml");
  CHECK(in_space.exit_code == 3);
  CHECK(in_space.out.find("jammed: drive \"motor\", contact \"stop\" leave no motion; since t = 1") !=
        std::string::npos);
  CHECK(folder.orthant("check jam3.toml --set duration=0.9").exit_code == 0);
}

TEST_CASE("orthant schema scene has every key that the documented scenes use, and needs none that they lack") {
  const Cli folder;
  const auto both = Tree::parse(folder.orthant("schema scene").out);
  CHECK(both.at("$schema") == "http://json-schema.org/draft-07/schema#");
  const auto dimension = [](const Tree& scene) { return scene.value("dimension", 2) == 3 ? "space" : "plane"; };
  folder.write("scenes.py", R"(
import glob, json, re, sys, tomllib
root = sys.argv[1]
texts = re.findall("```toml\\n(.*?)```", open(root + "/core/scenes/README.md").read(), re.S)
for files in ("/core/scenes/*.toml", "/tests/data/*.toml"):
    texts += [open(name).read() for name in glob.glob(root + files)]
print(json.dumps([tomllib.loads(text) for text in texts]))
)");
  const Reply scenes = folder.run("/usr/bin/python3 -s -E scenes.py '" ORTHANT_ROOT "'");
  std::vector<std::string> wrong;
  std::set<std::string> seen;
  std::set<std::string> keys_in_space;
  for (const Tree& scene : Tree::parse(scenes.out)) {
    const std::string kept = dimension(scene);
    const Tree& schema = both.at("definitions").at(kept);
    compare_keys(scene, schema, wrong);
    for (const auto& [kind, elements] : scene.items()) {
      if (!elements.is_array() || !elements[0].is_object()) continue;
      for (const Tree& element : elements) {
        const std::string type = element.value("type", "");
        seen.insert(kept + " " + kind + " " + type);
        if (kept == "space")
          for (const auto& [key, inner] : element.items()) keys_in_space.insert(kind + " " + type + " " + key);
        const Tree& table = variant(schema.at("properties").at(kind).at("items"), type);
        compare_keys(element, table, wrong);
        for (const auto& [key, inner] : element.items()) {
          if (inner.is_object()) compare_keys(inner, table.at("properties").at(key), wrong);
          if (inner.is_array() && !inner.empty() && inner[0].is_object())
            for (const Tree& one : inner) compare_keys(one, table.at("properties").at(key).at("items"), wrong);
        }
      }
    }
  }
  CHECK(wrong == std::vector<std::string>());
  CHECK(seen.size() > 20);
  // Every type of the schema is in a documented scene: it is not longer than the format.
  for (const std::string where : {"plane", "space"})
    for (const std::string kind : {"joint", "contact", "spring"})
      for (const Tree& one : both.at("definitions").at(where).at("properties").at(kind).at("items").at("oneOf"))
        if (const auto type = one.at("properties").at("type").at("const").get<std::string>();
            !seen.contains(where + " " + kind + " " + type))
          wrong.push_back(where + " " + kind + " " + type);
  // In space every key, too.
  for (const auto& [kind, list] : both.at("definitions").at("space").at("properties").items()) {
    if (!list.contains("items")) continue;
    const Tree& items = list.at("items");
    for (const Tree& one : items.value("oneOf", Tree::array({items}))) {
      if (!one.contains("properties")) continue;  // of numbers
      const Tree& type = one.at("properties").value("type", Tree::object());
      for (const auto& [key, form] : one.at("properties").items())
        if (const std::string name = kind + " " + type.value("const", "") + " " + key; !keys_in_space.contains(name))
          wrong.push_back(name);
    }
  }
  CHECK(wrong == std::vector<std::string>());
  const Tree& schema = both.at("definitions").at("plane");
  CHECK(both.at("definitions").at("space").at("required") == Tree({"dimension"}));
  const Tree& corner = variant(schema.at("properties").at("contact").at("items"), "corner-wall");
  CHECK(corner.at("required") == Tree({"type", "body"}));
  CHECK(corner.at("properties").at("wall").at("required") == Tree({"normal"}));
  CHECK(schema.at("properties").at("restitution").at("enum") == Tree({"newton", "poisson"}));
}

TEST_CASE("orthant schema simulate holds for what simulate prints") {
  const Cli folder;
  const auto schema = Tree::parse(folder.orthant("schema simulate").out);
  for (const char* run :
       {"simulate slider_crank --integrator adaptive --json", "simulate bouncing_ball --check --json"}) {
    const auto printed = Tree::parse(folder.orthant(run).out);
    std::vector<std::string> wrong;
    compare_keys(printed, schema, wrong);
    CHECK(wrong == std::vector<std::string>());
    for (const Tree& event : printed.at("event_table"))
      compare_keys(event, schema.at("properties").at("event_table").at("items"), wrong);
    CHECK(wrong == std::vector<std::string>());
    for (const auto& [key, value] : printed.items()) {
      CAPTURE(key);
      const Tree& type = schema.at("properties").at(key).at("type");
      CHECK((type == "number"    ? value.is_number()
             : type == "integer" ? value.is_number_integer()
             : type == "string"  ? value.is_string()
             : type == "array"   ? value.is_array()
                                 : value.is_object()));
    }
  }
}

TEST_CASE("manual pages and completions name every option of the help") {
  const Cli folder;
  const std::string fish = folder.orthant("completion fish").out;
  for (const std::string command :
       {"solve", "simulate", "gradient", "view", "check", "new", "schema", "sweep", "report", "man"}) {
    CAPTURE(command);
    const std::string help = folder.orthant(command + " --help").out, page = folder.orthant("man " + command).out;
    CHECK(page.starts_with(".TH ORTHANT\\-"));
    int options = 0;
    for (std::size_t at = help.find("\n  --"); at != std::string::npos; at = help.find("\n  --", at + 1)) {
      const std::string name = help.substr(at + 5, help.find_first_of(" ,\n", at + 5) - at - 5);
      CAPTURE(name);
      std::string escaped;
      for (const char c : name) escaped += c == '-' ? std::string("\\-") : std::string(1, c);
      CHECK(page.find("\\fB\\-\\-" + escaped) != std::string::npos);
      CHECK(fish.find("-n '__orthant_at " + command + "' -l " + name) != std::string::npos);
      ++options;
    }
    CHECK(options > 0);
  }
  CHECK(folder.orthant("man").out.find("\\fBorthant\\-simulate\\fR(1)") != std::string::npos);
  CHECK(folder.orthant("man nothing").exit_code == 1);
  CHECK(folder.orthant("completion zsh").out.starts_with("autoload -U +X bashcompinit"));
  if (folder.run("command -v man").exit_code == 0)
    CHECK(folder.run("'" ORTHANT_CLI "' man simulate > s.1 && man --warnings -l s.1 > /dev/null").err.empty());
}
