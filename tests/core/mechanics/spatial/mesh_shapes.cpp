// Meshes in scenes in space: shapes, corners and solids from STL and OBJ files of the scene's folder.
#include "tests/support/folder.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <vector>

using namespace orthant;

namespace {

/// A box of 2 × 4 × 6 with one corner at the origin.
constexpr const char* kObjBox =
    "v 0 0 0\nv 2 0 0\nv 2 4 0\nv 0 4 0\nv 0 0 6\nv 2 0 6\nv 2 4 6\nv 0 4 6\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

std::string mesh_body_with(const std::string& shape, const std::string& mass = "mass = 1\ninertia = 1\n") {
  return "dimension = 3\n[[body]]\nname = 'part'\n" + mass +
         "[[collision]]\nwalls = [{normal = [0, 0, 1]}]\nshapes = [{body = 'part', " + shape + "}]\n";
}
spatial::Scene read_mesh_scene(const Folder& folder, const std::string& text) {
  return std::get<spatial::Scene>(read_any_scene(folder.write("scene.toml", text)));
}
std::string refused_mesh(const Folder& folder, const std::string& text) {
  try {
    read_mesh_scene(folder, text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a mesh in a scene's folder is a shape, moved and scaled, a solid, and corners against a wall") {
  const Folder folder;
  folder.write("box.obj", kObjBox);
  const auto solid = "density = 3\nsolid = {file = 'box.obj', scale = 0.1}\n";
  const spatial::Scene s =
      read_mesh_scene(folder, mesh_body_with("file = 'box.obj', scale = 0.1, centre = [0, 0, 1]", solid) +
                                  "[[contact]]\ntype = 'polytope-wall'\nname = 'feet'\nbody = 'part'\n"
                                  "file = 'box.obj'\nwall = {normal = [0, 0, 1]}\n");
  const spatial::Body& b = s.bodies[0];
  CHECK(std::abs(b.mass - 3 * 0.048) < 1e-15);
  CHECK((b.inertia - b.mass / 12 * Vector3d(0.52, 0.40, 0.20).asDiagonal().toDenseMatrix()).norm() < 1e-15);
  const auto& corners = s.collisions[0].shapes[0].corners;
  REQUIRE(corners.size() == 8);
  Vector3d low = corners[0], high = corners[0];
  for (const Vector3d& c : corners) low = low.cwiseMin(c), high = high.cwiseMax(c);
  CHECK((low - Vector3d(-0.1, -0.2, 0.7)).norm() < 1e-15);
  CHECK((high - Vector3d(0.1, 0.2, 1.3)).norm() < 1e-15);
  int feet = 0;  // in the file's own coordinates
  double lowest = 1, highest = 0;
  for (const auto& contact : s.contacts) {
    const auto& c = std::get<spatial::SpherePlane>(contact);
    if (!c.name.starts_with("feet")) continue;  // of the collision's wall
    lowest = std::min(lowest, c.centre.z()), highest = std::max(highest, c.centre.z()), ++feet;
  }
  CHECK(feet == 8);
  CHECK(lowest == 0);
  CHECK(highest == 6);
}

TEST_CASE("mistakes in meshes of scenes are named by field, value and rule; nothing outside the folder is read") {
  const Folder folder;
  folder.write("box.obj", kObjBox), folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n");
  folder.write("note.txt", "v 0 0 0\n"), folder.write("bad.stl", "solid\nvertex 1 nan 2\n");
  const auto has = [&](const std::string& shape, const std::string& words) {
    const std::string why = refused_mesh(folder, mesh_body_with(shape));
    INFO(why);
    CHECK(why.find(words) != std::string::npos);
    CHECK(why.find("scene.toml:") != std::string::npos);
  };
  has("file = 'none.obj'", "file = 'none.obj': must be a file that can be read");
  has("file = '../box.obj'", "must be in the folder of the scene");
  has("file = '/etc/passwd'", "must be in the folder of the scene");
  has("file = 'note.txt'", "must be a mesh in STL or OBJ");
  has("file = 'flat.obj'", "file: flat.obj");
  has("file = 'bad.stl'", "bad.stl");
  has("file = 'box.obj', scale = 0", "scale = 0: must be not 0");
  has("file = 'box.obj', size = [1, 1, 1]", "size, ends, corners, file: must be one of them");
  has("semi_axes = [1, 2, 3]", "missing key \"radius\", \"size\", \"ends\", \"corners\", \"file\" or \"heights\"");
  has("radius = 1, scale = 2", "scale");
  CHECK_THROWS_WITH_AS(parse_any_scene(mesh_body_with("file = 'box.obj'"), {}, "text"),
                       doctest::Contains("a scene without a file names no others"), std::invalid_argument);
}
