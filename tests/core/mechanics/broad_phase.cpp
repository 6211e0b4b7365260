// Candidates of a collision: none that touches is missed, in the order of the pairs, linear in the shapes.
#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/pile.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include <algorithm>

using namespace orthant;

namespace {

std::vector<Pair> found(const std::vector<Pair>& pairs) {
  std::vector<Pair> all;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(all), [](const Pair& p) { return !p.none(); });
  return all;
}

/// Discs and polygons, off their bodies' centres, strewn over a square; some belong to the ground, one is large.
Scene strewn(int n, unsigned seed) {
  Random random(seed);
  const auto number = [&](double low, double high) { return random.uniform(low, high); };
  Scene s;
  Collision c{.name = "all", .shapes = {}, .law = {}, .neighbours = 60};
  const double side = std::sqrt(n);
  for (int i = 0; i < n; ++i) {
    BodyId body = s.body({.position = {number(0, side), number(0, side)}, .angle = number(-4, 4)});
    if (i % 7 == 0) body = kGround;
    const double size = i == n / 2 ? 2 * side : number(0.2, 0.6);  // of far more than 100 cells
    const Vector2d at{number(-0.3, 0.3), number(-0.3, 0.3)};
    if (i % 3 == 0)
      c.shapes.push_back({.body = body, .corners = {at, at + Vector2d(size, 0), at + Vector2d(0, size)}});
    else
      c.shapes.push_back({.body = body, .centre = at, .radius = size});
  }
  s.collision(c);
  return s;
}

}  // namespace

TEST_CASE("broad phase: no pair that the way lets touch is missed, and all stand in order") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const System system(strewn(60, seed)), all(with_pairs_listed(system.scene()));
    const State x = system.initial_state();
    Terms terms(system), listed(all);
    set_poses(system, 0, x.q, terms.at), set_poses(all, 0, x.q, listed.at);
    Eigen::VectorXd way(system.dof());
    for (Index i = 0; i < way.size(); ++i) way[i] = 0.05 * std::cos(static_cast<double>(i));
    BroadPhase broad(system);
    REQUIRE(broad.find(way, terms));
    const auto pairs = found(terms.pairs);
    CHECK(std::is_sorted(pairs.begin(), pairs.end()));
    CHECK(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end());
    evaluate_gaps(all, listed);
    Index i = 0, near = 0, missed = 0;
    each_pair(system.scene().collisions[0], [&](const Pair& pair) {
      const bool touches = listed.gap[i++] <= 0;
      const bool has = std::binary_search(pairs.begin(), pairs.end(), pair);
      near += touches, missed += touches && !has;
    });
    REQUIRE(i == all.contacts());
    CHECK(near > 20);
    CHECK(missed == 0);
    // Where the bodies are after any part of the way they touch candidates only.
    set_poses(all, 0, x.q + way, listed.at);
    evaluate_gaps(all, listed);
    i = 0;
    each_pair(system.scene().collisions[0], [&](const Pair& pair) {
      missed += listed.gap[i++] <= 0 && !std::binary_search(pairs.begin(), pairs.end(), pair);
    });
    CHECK(missed == 0);
    // The gaps of candidates are those of the listed contacts, to the bit.
    set_poses(all, 0, x.q, listed.at);
    evaluate_gaps(all, listed), evaluate_gaps(system, terms);
    Index k = 0, differ = 0;
    i = 0;
    each_pair(system.scene().collisions[0], [&](const Pair& pair) {
      if (k < static_cast<Index>(pairs.size()) && pairs[static_cast<std::size_t>(k)] == pair)
        differ += terms.gap[k++] != listed.gap[i];
      ++i;
    });
    CHECK(k == static_cast<Index>(pairs.size()));
    CHECK(differ == 0);
  }
}

TEST_CASE("broad phase: candidates of a pile grow with its discs, not with their pairs") {
  for (const int n : {100, 1000, 10000}) {
    const Pile p{.discs = n};
    const System system(pile(p));
    Terms terms(system);
    set_poses(system, 0, system.initial_state().q, terms.at);
    BroadPhase broad(system);
    REQUIRE(broad.find(Eigen::VectorXd::Constant(system.dof(), 0.1 * p.radius), terms));
    const double each = static_cast<double>(found(terms.pairs).size()) / n;
    CHECK(each > 0.5);
    CHECK(each < 3);
    CHECK(system.contacts() <= 9 * n);
  }
}

TEST_CASE("broad phase: a body far away and one that is nowhere cost nothing and lose nothing") {
  Scene s = pile({.discs = 100});
  const System near(s);
  s.bodies[7].position = {1e12, -1e150};
  const System far(s);
  const auto pairs_at = [](const System& system, const Eigen::VectorXd& q) {
    Terms terms(system);
    set_poses(system, 0, q, terms.at);
    BroadPhase broad(system);
    CHECK(broad.find(Eigen::VectorXd::Constant(system.dof(), 0.01), terms));
    auto pairs = found(terms.pairs);
    std::erase_if(pairs, [](const Pair& p) { return p.a == 7 || p.b == 7; });
    return pairs;
  };
  const auto expected = pairs_at(near, near.initial_state().q);
  CHECK(pairs_at(far, far.initial_state().q) == expected);
  Eigen::VectorXd q = near.initial_state().q;
  q[3 * 7] = std::nan("");
  CHECK(pairs_at(near, q) == expected);
}

TEST_CASE("broad phase: more pairs than there is room for are reported, not dropped") {
  Scene s = pile({.discs = 30});
  s.collisions[0].neighbours = 0.5;
  const System system(s);
  Terms terms(system);
  set_poses(system, 0, system.initial_state().q, terms.at);
  BroadPhase broad(system);
  CHECK(broad.find(Eigen::VectorXd::Zero(system.dof()), terms));
  CHECK_FALSE(broad.find(Eigen::VectorXd::Constant(system.dof(), 0.02), terms));
  CHECK(broad.why().find("collision \"discs\": more pairs are near each other than neighbours = 0.5 a shape") == 0);
}

TEST_CASE("collisions in TOML: walls are contacts, and pairs where no search is wanted") {
  const std::string text = R"(
[[body]]
name = "a"
mass = 1
inertia = 1
[[body]]
name = "b"
mass = 1
inertia = 1
position = [3, 0]
[[collision]]
name = "two"
shapes = [{body = "a", radius = 1}, {body = "b", corners = [[0, 0], [1, 0], [0, 1]]},
  {body = "ground", radius = 0.5, centre = [0, -9]}]
walls = [{normal = [0, 2], point = [0, -2]}]
mu = 0.25
)";
  const Scene grid = parse_scene(text),
              none = parse_scene(text, std::vector<std::string>{"collision.two.search=\"none\""});
  REQUIRE(grid.contacts.size() == 4);  // the disc and three corners; the ground's disc does not meet the ground's wall
  REQUIRE(grid.collisions.size() == 1);
  const auto* disc = std::get_if<DiscWall>(grid.contacts.data());
  REQUIRE(disc != nullptr);
  CHECK(disc->name == "two_wall_1");
  CHECK(disc->normal == Vector2d(0, 1));
  CHECK(disc->law.mu == 0.25);
  CHECK(none.collisions.empty());
  REQUIRE(none.contacts.size() == 7);
  CHECK(std::get<DiscPolygon>(none.contacts[4]).a == 0);
  CHECK(std::get<DiscDisc>(none.contacts[5]).b == kGround);
  CHECK(std::get<DiscPolygon>(none.contacts[6]).a == kGround);  // the disc comes first, whatever the order
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& words) {
    std::string bad = text;
    bad.replace(bad.find(from), from.size(), to);
    try {
      parse_scene(bad);
      FAIL("accepted");
    } catch (const std::invalid_argument& error) {
      CAPTURE(error.what());
      CHECK(std::string(error.what()).find(words) != std::string::npos);
    }
  };
  refused("radius = 1", "radius = -1", "collision \"two\": shapes[0].radius = -1: must be > 0");
  refused("body = \"a\", radius = 1", "body = \"a\"", "missing key \"shapes[0].radius\"");
  refused("body = \"b\"", "body = \"c\"", "shapes[1].body = ");
  refused("[0, 1]]", "[0, -1]]", "counter-clockwise");
  refused("normal = [0, 2], ", "", "missing key \"walls[0].normal\"");
  refused("mu = 0.25", "mu = -0.25", "mu = -0.25: must be >= 0");
  refused("mu = 0.25", "neighbours = 0", "neighbours = 0: must be > 0");
  refused("mu = 0.25", "search = \"sweep\"", "must be one of grid, none");
}
