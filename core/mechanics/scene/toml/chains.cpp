// Ground chains of a scene file.
#include "reader.h"

#include <orthant/core/mechanics/planar/chain.h>
#include <orthant/core/support/file.h>

#include <charconv>
#include <filesystem>

namespace orthant::scene_file {

namespace {

constexpr std::uintmax_t kLargestTable = 16 << 20;  // [bytes]
constexpr std::array<std::string_view, 2> kSideNames = {"left", "right"};

/// The numbers of a line, between commas, semicolons, spaces or tabs. False: something else stands there.
bool numbers_of(std::string_view line, std::vector<double>& numbers) {
  constexpr std::string_view kBetween = ",; \t\r";
  numbers.clear();
  for (std::size_t i = line.find_first_not_of(kBetween); i < line.size(); i = line.find_first_not_of(kBetween, i)) {
    const std::size_t end = std::min(line.find_first_of(kBetween, i), line.size());
    const char* first = line.data() + i + (line[i] == '+' ? 1 : 0);
    double value = 0;
    const auto [rest, error] = std::from_chars(first, line.data() + end, value);
    if (error != std::errc() || rest != line.data() + end || !std::isfinite(value)) return false;
    numbers.push_back(value), i = end;
  }
  return true;
}

}  // namespace

std::vector<Vector2d> Reader::table_of(const Fields& f, std::string_view key, const toml::node& node) const {
  const auto written = node.value_exact<std::string>();
  if (!written || written->empty()) f.refuse(key, node, "the name of a file in quotes");
  const std::filesystem::path path = std::filesystem::path(file_).parent_path() / *written;
  std::string text;
  try {
    text = read_whole(path, largest_input(kLargestTable));
  } catch (const std::runtime_error& error) {
    f.refuse(key, node, std::string("a file that can be read: ") + error.what());
  }
  std::vector<Vector2d> points;
  std::vector<double> numbers;
  long line = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view row = std::string_view(text).substr(begin, end - begin);
    begin = end + 1, ++line;
    if (row.find_first_not_of(" \t\r") == std::string_view::npos || row.front() == '#') continue;
    const bool good = numbers_of(row, numbers) && numbers.size() == 2;
    if (!good && points.empty() && line == 1) continue;  // the columns' names
    if (!good)
      f.fail(node,
             std::string(key) + ": " + path.string() + ":" + std::to_string(line) + ": must be two numbers, x and y");
    points.emplace_back(numbers[0], numbers[1]);
  }
  return points;
}

GroundChain Reader::chain_of(Fields& f) const {
  GroundChain chain;
  const bool written = f.maybe("points", chain.points);
  const toml::node* file = f.find("file", Form::word);
  if (written && file != nullptr) f.refuse("file", *file, "left out where \"points\" are given");
  if (!written && file == nullptr) f.fail(f.table(), "missing key \"points\" or \"file\"");
  if (file != nullptr) chain.points = table_of(f, "file", *file);
  f.maybe("closed", chain.closed), f.maybe("depth", chain.depth);
  if (!(chain.depth >= 0)) f.refuse("depth", *f.table().get("depth"), ">= 0");
  enum class Side { left, right } side = Side::left;
  f.choice("free", side, kSideNames);
  chain.free_left = side == Side::left;
  return chain;
}

void Reader::fail_at_points(const Fields& f, const std::string& what) {
  const toml::node* points = f.table().get("points");
  f.fail(points != nullptr ? *points : *f.table().get("file"), what);
}

std::vector<Polygon> Reader::pieces_of(Fields& f) const {
  const GroundChain chain = chain_of(f);
  try {
    return chain_pieces(chain);
  } catch (const std::invalid_argument& error) {
    fail_at_points(f, error.what());
  }
}

void Reader::chain_contact(Fields& f, const std::string& name) {
  PolygonPolygon pair{.name = name};
  DiscPolygon disc{.name = name};
  bodies_of(f, pair), law(f, pair.law);
  disc.a = pair.a, disc.b = pair.b, disc.law = pair.law;
  const bool polygon = f.maybe("corners", pair.corners_a);
  if (polygon) convex_corners(f, "corners", pair.corners_a);
  if (!polygon) f.maybe("centre", disc.centre), f.need("radius", disc.radius);
  const GroundChain chain = chain_of(f);
  try {
    polygon ? scene_.contact_set(chain_polygon(pair, chain)) : scene_.contact_set(chain_disc(disc, chain));
  } catch (const std::invalid_argument& error) {
    fail_at_points(f, error.what());
  }
}

}  // namespace orthant::scene_file
