#include <orthant/core/mechanics/models/mesh.h>
#include <orthant/core/support/shortened.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace orthant::models {
namespace {

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;  // [bytes]

[[noreturn]] void refuse_mesh(const std::string& file, const std::string& place, const std::string& sentence) {
  throw std::invalid_argument(file + ": " + place + ": " + sentence);
}

/// Words of a text, line by line.
class MeshText {
 public:
  explicit MeshText(std::string_view text) : rest_(text) {}
  bool next_line() {
    if (rest_.empty()) return false;
    const auto end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
    ++number_;
    return true;
  }
  std::string_view word() {
    const auto first = line_.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    line_.remove_prefix(first);
    const auto length = std::min(line_.find_first_of(" \t\r"), line_.size());
    const auto found = line_.substr(0, length);
    line_.remove_prefix(length);
    return found;
  }
  std::string place() const { return "line " + std::to_string(number_); }

 private:
  std::string_view rest_, line_;
  long number_ = 0;
};

Vector3d point_of(MeshText& text, const std::string& file) {
  Vector3d p;
  for (int i = 0; i < 3; ++i) {
    std::string_view word = text.word();
    const std::string_view given = word;
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    const auto read = std::from_chars(word.data(), word.data() + word.size(), p[i]);
    if (read.ec != std::errc{} || read.ptr != word.data() + word.size() || !std::isfinite(p[i]))
      refuse_mesh(file, text.place(), "'" + shortened(given) + "': must be three finite numbers");
  }
  return p;
}

Mesh read_stl_text(std::string_view text, const std::string& file) {
  Mesh mesh;
  MeshText lines(text);
  while (lines.next_line()) {
    if (lines.word() != "vertex") continue;
    mesh.points.push_back(point_of(lines, file));
    if (const std::size_t n = mesh.points.size(); n % 3 == 0)
      mesh.surface.push_back({mesh.points[n - 3], mesh.points[n - 2], mesh.points[n - 1]});
  }
  if (mesh.points.empty()) refuse_mesh(file, "STL", "has no vertices: must have triangles");
  if (mesh.points.size() % 3 != 0)
    refuse_mesh(file, lines.place(), std::to_string(mesh.points.size()) + " vertices: must be three a triangle");
  return mesh;
}

}  // namespace

Mesh read_stl(std::string_view bytes, const std::string& file) {
  std::uint32_t count = 0;
  if (bytes.size() >= kStlHead) std::memcpy(&count, bytes.data() + kStlHead - 4, 4);
  static_assert(std::endian::native == std::endian::little);
  if (bytes.size() < kStlHead || bytes.size() != kStlHead + kStlTriangle * std::size_t{count}) {
    const auto first = bytes.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos || !bytes.substr(first).starts_with("solid"))
      refuse_mesh(file, "STL",
                  std::to_string(bytes.size()) +
                      " bytes: must be text that begins with \"solid\", or 84 bytes and "
                      "50 for each of its " +
                      std::to_string(count) + " triangles");
    return read_stl_text(bytes, file);
  }
  if (count == 0) refuse_mesh(file, "STL", "has no triangles: must have some");
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<float, 9> x{};
    std::memcpy(x.data(), bytes.data() + kStlHead + kStlTriangle * std::size_t{i} + 12, sizeof x);  // behind the normal
    spatial::Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      t[k] = {x[3 * k], x[3 * k + 1], x[3 * k + 2]};
      if (!t[k].allFinite()) refuse_mesh(file, "triangle " + std::to_string(i + 1), "must have finite coordinates");
      mesh.points.push_back(t[k]);
    }
    mesh.surface.push_back(t);
  }
  return mesh;
}

Mesh read_obj(std::string_view text, const std::string& file) {
  Mesh mesh;
  MeshText lines(text);
  while (lines.next_line()) {
    const std::string_view kind = lines.word();
    if (kind == "v") mesh.points.push_back(point_of(lines, file));
    if (kind != "f") continue;
    std::vector<std::size_t> corners;
    for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
      long index = 0;
      const auto read = std::from_chars(word.data(), word.data() + word.size(), index);
      const auto known = static_cast<long>(mesh.points.size());
      if (read.ec != std::errc{} || (read.ptr != word.data() + word.size() && *read.ptr != '/') || index == 0 ||
          index > known || index < -known)
        refuse_mesh(file, lines.place(),
                    "'" + shortened(word) + "': must be the number of a vertex before it, of " + std::to_string(known));
      corners.push_back(static_cast<std::size_t>(index > 0 ? index - 1 : known + index));
    }
    if (corners.size() < 3) refuse_mesh(file, lines.place(), "a face: must have at least three corners");
    for (std::size_t i = 2; i < corners.size(); ++i)
      mesh.surface.push_back({mesh.points[corners[0]], mesh.points[corners[i - 1]], mesh.points[corners[i]]});
  }
  if (mesh.points.empty()) refuse_mesh(file, "OBJ", "has no vertices: must have some");
  return mesh;
}

Mesh read_mesh(std::string_view bytes, const std::string& file) {
  std::string ending = file.size() >= 4 ? file.substr(file.size() - 4) : "";
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (ending == ".stl") return read_stl(bytes, file);
  if (ending == ".obj") return read_obj(bytes, file);
  return {};
}

bool closed(const Mesh& mesh) {
  if (mesh.surface.empty()) return false;
  using Edge = std::array<double, 6>;
  std::vector<Edge> there, back;
  const auto edge = [](const Vector3d& p, const Vector3d& q) {
    return Edge{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0, q.x() + 0.0, q.y() + 0.0, q.z() + 0.0};  // −0 becomes 0
  };
  for (const spatial::Triangle& t : mesh.surface)
    for (std::size_t i = 0; i < 3; ++i) {
      there.push_back(edge(t[i], t[(i + 1) % 3]));
      back.push_back(edge(t[(i + 1) % 3], t[i]));
    }
  std::sort(there.begin(), there.end()), std::sort(back.begin(), back.end());
  return there == back;
}

}  // namespace orthant::models
