// Every parser on its seeds and on thousands of fixed mutations of them; the long run: preset fuzz.
#include <orthant/core/lcp/problems/collection.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <vector>

#include "target.h"
#include "tests/support/folder.h"
#include "tests/support/sanitized.h"

using namespace orthant;

namespace {

struct Target {
  const char* name;
  bool (*run)(std::string_view);
  std::vector<const char*> folders;  // of further seeds, from the root
  const char* ending = "";           // of those
};
const Target kTargets[] = {{"matrix_market", fuzz::matrix_market},
                           {"problem_json", fuzz::problem_json},
                           {"scene", fuzz::scene, {"core/scenes", "tests/data"}, ".toml"},
                           {"sweep", fuzz::sweep, {"experiments/studies"}, ".toml"},
                           {"fclib", fuzz::fclib},
                           {"options", fuzz::options},
                           {"model", fuzz::model},
                           {"mesh", fuzz::mesh},
                           {"view", fuzz::view}};

std::vector<std::string> seeds_of(const Target& target) {
  const std::filesystem::path root = ORTHANT_ROOT;
  std::vector<std::filesystem::path> files;
  const auto collect = [&](const std::filesystem::path& folder, std::string_view ending) {
    if (!std::filesystem::exists(folder)) return;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.is_regular_file() && entry.path().string().ends_with(ending)) files.push_back(entry.path());
  };
  collect(root / "tests/fuzz/seeds" / target.name, "");
  for (const char* folder : target.folders) collect(root / folder, target.ending);
  std::sort(files.begin(), files.end());
  std::vector<std::string> seeds;
  for (const auto& file : files) seeds.push_back(slurp(file));
  return seeds;
}

std::string mutated(std::string text, const std::vector<std::string>& seeds, Random& random) {
  constexpr std::string_view kTokens[] = {
      "",           "0",          "-1",     "1e999", "nan", "-inf", "99999999999999999999",
      "2147483647", "1e-320",     "\n",     "[[[[",  "]",   "{",    "\"",
      "=",          ",",          "a.b.c",  "\xff",  "#",   "%",    "true",
      " ",          "4294967296", "\\u0000"};
  for (int k = random.integer(1, 4); k > 0; --k) {
    const auto size = static_cast<int>(text.size());
    const auto place = static_cast<std::size_t>(random.integer(0, size));
    const auto length = static_cast<std::size_t>(random.integer(0, random.integer(0, 1) == 0 ? 4 : 64));
    switch (random.integer(0, 6)) {
      case 0:
        text.resize(place);
        break;
      case 1:
        text.erase(place, length);
        break;
      case 2:
        text.insert(place, text.substr(static_cast<std::size_t>(random.integer(0, size)), length));
        break;
      case 3:
        text.insert(place, kTokens[random.integer(0, std::size(kTokens) - 1)]);
        break;
      case 4:
        text.replace(place, length, kTokens[random.integer(0, std::size(kTokens) - 1)]);
        break;
      case 5:
        if (size > 0) text[place % text.size()] = static_cast<char>(random.integer(0, 255));
        break;
      default: {
        const std::string& other =
            seeds[static_cast<std::size_t>(random.integer(0, static_cast<int>(seeds.size()) - 1))];
        text = text.substr(0, place) + other.substr(std::min(other.size(), place));
      }
    }
  }
  return text;
}

}  // namespace

TEST_CASE("every parser takes its seeds and mutations of them, or says in a line why not") {
  const char* wanted = std::getenv("ORTHANT_MUTATIONS");  // more of them, by hand
  const int mutations = wanted != nullptr ? std::atoi(wanted) : kSanitized ? 300 : 1500;
  for (const Target& target : kTargets) {
    const std::vector<std::string> seeds = seeds_of(target);
    REQUIRE(seeds.size() >= 2);
    Random random(7);
    double longest = 0;
    std::size_t accepted = 0;  // of the seeds
    for (int k = -static_cast<int>(seeds.size()); k < mutations; ++k) {
      const std::size_t seed = static_cast<std::size_t>(k + static_cast<int>(seeds.size())) % seeds.size();
      const std::string text = k < 0 ? seeds[seed] : mutated(seeds[seed], seeds, random);
      const auto begin = std::chrono::steady_clock::now();
      const bool taken = target.run(text);
      accepted += k < 0 && taken ? 1 : 0;
      longest = std::max(longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    MESSAGE(std::string(target.name), ": ", seeds.size(), " seeds, ", accepted, " accepted, longest ", longest, " s");
    CHECK(longest < 5);
    CHECK(2 * accepted > seeds.size());  // a parser that no seed gets through is not tested
  }
}

TEST_CASE("oversized and deeply nested input ends at once") {
  const auto times = [](const std::string& text, int n) {
    std::string all;
    for (int i = 0; i < n; ++i) all += text;
    return all;
  };
  const auto begin = std::chrono::steady_clock::now();
  fuzz::problem_json(times("[", 1000000));
  fuzz::problem_json(times("{\"A\":", 1000000));
  fuzz::scene("a = " + times("[", 1000000));
  fuzz::scene(times("a.", 1000000) + "b = 1");
  fuzz::scene("[" + times("a.", 1000000) + "b]");
  fuzz::sweep("a = " + times("[", 1000000));
  fuzz::sweep("a = " + times("{b = ", 100000));
  fuzz::sweep(times("a.", 1000000) + "b = 1");
  fuzz::sweep("[" + times("a.", 1000000) + "b]");
  fuzz::sweep("scene = 'bouncing_ball'\n[[grid]]\nstep = {from = 1e-9, to = 1, count = 1000000000}\n");
  fuzz::matrix_market("%%MatrixMarket matrix coordinate real general\n100000000 100000000 0\n");
  fuzz::matrix_market("%%MatrixMarket matrix array real general\n100000000 100000000\n1\n");
  fuzz::matrix_market(times("%%MatrixMarket ", 1000000));
  fuzz::options("pgs:" + times("omega=1,", 100000));
  std::string needles = "<mujoco><worldbody><body><freejoint/><geom size='1'/>";  // side by side, each in all balls
  for (int i = 1; i <= 200; ++i)
    needles += "<body pos='" + std::to_string(i) + " 0 0'><joint/><geom type='ellipsoid' size='0.1 0.1 1000'/></body>";
  fuzz::model(needles + "</body></worldbody></mujoco>");
  const std::string lists = R"(, "outlines": [], "pins": [], "contacts": [], "event_contacts": []})";
  fuzz::view("t,x\n0,0\n%%\n\n%%\n{\"bodies\": " + times("[", 1000000) + times("]", 1000000) + lists);
  fuzz::view(times("t,", 1000000) + "\n" + times("0,", 1000000));
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(20));
}
