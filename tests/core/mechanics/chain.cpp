// Chains and the exposures of polygons that lie flush: which faces and corners of a surface can be met.
#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/planar/chain.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include "tests/support/folder.h"

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

Polygon tile(double left, double right, double bottom, double top) {
  return {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
}

Exposed among(const std::vector<Polygon>& polygons, std::size_t which) {
  std::vector<Solid> solids;
  for (const Polygon& p : polygons) solids.push_back({&p});
  return exposure(solids, which);
}

std::string error_of(const std::string& text) {
  try {
    parse_scene(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

std::string on_chain(const std::string& keys) {
  return "[[body]]\nname = \"ball\"\nmass = 1\ninertia = 1\n[[contact]]\ntype = \"chain\"\n"
         "bodies = [\"ball\", \"ground\"]\nradius = 0.1\n" +
         keys;
}

}  // namespace

TEST_CASE("of flush tiles the end faces are covered, and the corners on the seam are no corners") {
  const std::vector<Polygon> tiles = {tile(-1, 0, -1, 0), tile(0, 2, -1, 0), tile(5, 6, -1, 0)};
  const Exposed left = among(tiles, 0);
  REQUIRE(left != nullptr);
  CHECK(left->face[0].free);
  CHECK_FALSE(left->face[1].free);  // towards the neighbour
  CHECK(left->face[2].free);
  CHECK(left->face[3].free);
  CHECK_FALSE(left->corner[1].convex);
  CHECK_FALSE(left->corner[2].convex);
  CHECK(left->points_to(3, Vector2d(-1, 1).normalized()));
  CHECK_FALSE(left->points_to(2, Vector2d(1, 1).normalized()));
  CHECK(left->admits(2, {0, 1}));  // as the end of the top face
  CHECK(among(tiles, 2) == nullptr);
}

TEST_CASE("a step is not a seam: the face that stands out of it collides") {
  const Exposed high = among({tile(-1, 0, -1, 0.2), tile(0, 2, -1, 0)}, 0);
  REQUIRE(high != nullptr);
  CHECK(high->face[1].free);
  CHECK(high->points_to(2, Vector2d(1, 1).normalized()));
  const Exposed low = among({tile(-1, 0, -1, 0.2), tile(0, 2, -1, 0)}, 1);
  REQUIRE(low != nullptr);
  CHECK_FALSE(low->face[3].free);
  CHECK_FALSE(low->corner[3].convex);  // concave
}

TEST_CASE("flush within 1e-6 of the shortest face, turned by any angle") {
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.1 * i;
    const auto turn = [&](Polygon p) {
      for (Vector2d& c : p)
        c = Vector2d(std::cos(angle) * c.x() - std::sin(angle) * c.y() + 30,
                     std::sin(angle) * c.x() + std::cos(angle) * c.y() - 7);
      return p;
    };
    for (const double off : {0.0, 1e-7, 1e-5}) {
      const Exposed e = among({turn(tile(-1, 0, -1, 0)), turn(tile(off, 2, -1 + off, off))}, 0);
      CAPTURE(angle);
      CAPTURE(off);
      if (off > 1e-6) {
        CHECK((e == nullptr || e->points_to(2, outward(turn(tile(-1, 0, -1, 0)), 1))));
      } else {
        REQUIRE(e != nullptr);
        CHECK_FALSE(e->face[1].free);
        CHECK_FALSE(e->corner[2].convex);
      }
    }
  }
}

TEST_CASE(
    "the joints of a chain: none where it is straight or concave, a corner between two segments where it is convex") {
  const std::vector<Polygon> pieces = chain_pieces({.points = {{0, 0}, {1, 0}, {2, 0}, {3, 1}, {4, 0}}});
  REQUIRE(pieces.size() == 3);
  for (const Polygon& p : pieces) CHECK(convex(p));
  const Exposed flat = among(pieces, 0), up = among(pieces, 1), down = among(pieces, 2);
  REQUIRE(flat != nullptr);
  REQUIRE(up != nullptr);
  REQUIRE(down != nullptr);
  const auto corner_at = [&](std::size_t piece, const Vector2d& at) {
    for (std::size_t i = 0; i < pieces[piece].size(); ++i)
      if (pieces[piece][i] == at) return i;
    FAIL("no such corner");
    return std::size_t{0};
  };
  // At the inner corner each goes on, straight, behind the other: points are from the free side's right to its left.
  const Vector2d &behind_up = pieces[0][0], &behind_flat = pieces[1][1];
  CHECK(behind_up.y() == 0);
  CHECK(behind_up.x() > 2);
  CHECK(behind_flat.x() < 2);
  CHECK(behind_flat.y() == doctest::Approx(behind_flat.x() - 2).epsilon(1e-14));
  CHECK_FALSE(flat->corner[0].convex);
  CHECK_FALSE(up->corner[1].convex);
  CHECK(flat->face[0].free);
  CHECK_FALSE(flat->face[3].free);  // its end
  CHECK_FALSE(up->face[1].free);
  for (const auto& [e, piece] : {std::pair{up, std::size_t{1}}, std::pair{down, std::size_t{2}}}) {
    const std::size_t top = corner_at(piece, {3, 1});
    CHECK(e->points_to(top, {0, 1}));
    CHECK(e->points_to(top, Vector2d(0.9, 1).normalized()));
    CHECK_FALSE(e->points_to(top, Vector2d(1.1, 1).normalized()));
    CHECK_FALSE(e->points_to(top, Vector2d(-1.1, 1).normalized()));
  }
}

TEST_CASE("of the pieces of any chain only segments can be met: every end is covered") {
  Random random(7);
  for (int round = 0; round < 2000; ++round) {
    std::vector<Vector2d> points{{0, 0}};
    const int count = 2 + static_cast<int>(6 * random.uniform());
    double angle = 0;
    for (int i = 0; i < count; ++i) {
      angle = std::clamp(angle + (random.uniform() - 0.5) * 3, -1.5, 1.5);
      const double length = std::pow(10, random.uniform() - 0.5);
      points.push_back(points.back() + length * Vector2d(std::cos(angle), std::sin(angle)));
    }
    const std::vector<Polygon> pieces = chain_pieces({.points = points});
    CAPTURE(round);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      CHECK(convex(pieces[k]));
      const Exposed e = among(pieces, k);
      if (e == nullptr) continue;
      // Walked from right to left: face 1 is the end on the left, face 3 that on the right.
      if (k > 0) CHECK_FALSE(e->face[1].free);
      if (k + 1 < pieces.size()) CHECK_FALSE(e->face[3].free);
    }
  }
}

TEST_CASE("the strip of a chain lies behind it, and never reaches through to a free side") {
  const std::vector<Vector2d> ridge = {{-2, 0}, {0, 0}, {0.1, 1}, {0.2, 0}, {2, 0}};
  for (const Polygon& p : chain_pieces({.points = ridge}))
    for (const Vector2d& c : p) {  // free: above the flat parts, outside of the ridge
      const bool below = c.y() <= 1e-12, inside = std::abs(c.x() - 0.1) <= 0.1 * (1 - c.y()) + 1e-12;
      CHECK((below || inside));
    }
  const std::vector<Vector2d> square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const auto outside = [](const Polygon& p) {
    for (const Vector2d& c : p)
      if (c.minCoeff() < -1e-12 || c.maxCoeff() > 1 + 1e-12) return true;
    return false;
  };
  for (const Polygon& p : chain_pieces({.points = square, .closed = true})) CHECK(outside(p));  // a room
  for (const Polygon& p : chain_pieces({.points = square, .closed = true, .free_left = false})) CHECK_FALSE(outside(p));
}

TEST_CASE("a chain in TOML: inline, from a table, and every mistake with its place") {
  const Folder folder;
  folder.write("profile.csv", "x,y\n# left to right\n0, 0\n1;0.5\n\n2\t0\n");
  const Scene scene = read_scene(folder.write("scene.toml", on_chain("name = \"hill\"\nfile = \"profile.csv\"")));
  const Scene same = parse_scene(on_chain("name = \"hill\"\npoints = [[0, 0], [1, 0.5], [2, 0]]"));
  REQUIRE(scene.contacts.size() == 2);
  REQUIRE(same.contacts.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& from_table = std::get<DiscPolygon>(scene.contacts[i]);
    CHECK(from_table.name == "hill_" + std::to_string(i + 1));
    CHECK(from_table.corners == std::get<DiscPolygon>(same.contacts[i]).corners);
  }
  const auto said = [&](const std::string& keys, const std::string& words) {
    const std::string error = error_of(on_chain(keys));
    INFO(error);
    CHECK(error.find(words) != std::string::npos);
  };
  said("", "missing key \"points\" or \"file\"");
  said("points = [[0, 0]]", "must be at least two");
  said("points = [[0, 0], [1, 0], [1, 0]]", "points[2]: must differ from the point before");
  said("points = [[0, 0], [1, 0], [0, 0.0001]]", "points[1]: the chain must not turn straight back");
  said("points = [[0, 0], [2, 0], [1, 1], [1, -1]]", "must not cross or touch itself");
  said("points = [[0, 0], [1, 0]]\nclosed = true", "must be at least three of a closed chain");
  said("points = [[0, 0], [1, 0]]\ndepth = -1", "depth = -1");
  said("points = [[0, 0], [1, 0]]\nfree = \"up\"", "must be one of left, right");
  said("points = [[0, 0], [1, 0]]\nfile = \"a.csv\"", "must be left out where \"points\" are given");
  said("file = \"no_such_file.csv\"", "must be a file that can be read");
  folder.write("bad.csv", "0 0\n1 one\n");
  std::string error;
  try {
    read_scene(folder.write("bad.toml", on_chain("file = \"bad.csv\"")));
  } catch (const std::invalid_argument& e) {
    error = e.what();
  }
  INFO(error);
  CHECK(error.find("bad.csv:2: must be two numbers") != std::string::npos);
}

}  // namespace orthant
