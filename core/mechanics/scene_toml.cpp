#include <orthant/core/mechanics/scene_toml.h>
#include <orthant/core/support/options.h>

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace orthant {
namespace {

constexpr std::uintmax_t kMaxFile = 16 << 20;  // [bytes]
constexpr int kMaxNesting = 16;                // brackets around a value, and dots in a key
constexpr std::string_view kOverride = "override ";
constexpr std::array<std::string_view, 7> kKinds = {"body",     "joint",  "contact", "collision",
                                                    "friction", "spring", "load"};
constexpr std::array<std::string_view, 2> kSearchNames = {"grid", "none"};

std::string in_quotes(std::string_view s) { return std::string("\"").append(s).append("\""); }

std::string join(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list.append(list.empty() ? "" : ", ").append(word);
  return list;
}

/// Where a node was written: "door.toml:12", or the override that brought it.
std::string place(const toml::node& node, const std::string& file) {
  const auto& source = node.source();
  if (!source.path) return file;
  if (source.path->starts_with(kOverride)) return *source.path;
  return *source.path + ":" + std::to_string(source.begin.line);
}

/// The node as one short line of TOML, numbers as short as they can be told.
std::string text(const toml::node& node) {
  std::string line;
  if (const auto* number = node.as_floating_point()) {
    line = detail::text_of(number->get());
  } else if (const auto* array = node.as_array()) {
    for (const toml::node& element : *array) line.append(line.empty() ? "[" : ", ").append(text(element));
    line.append(array->empty() ? "[]" : "]");
  } else {
    std::ostringstream out;
    node.visit([&](const auto& n) { out << n; });
    line = out.str();
    std::replace(line.begin(), line.end(), '\n', ' ');
  }
  constexpr std::size_t kLongest = 60;
  return line.size() <= kLongest ? line : line.substr(0, kLongest) + " ...";
}

/// The index of the last character of the string that opens at text[i].
std::size_t end_of_string(std::string_view text, std::size_t i) {
  const char quote = text[i];
  const std::string triple(3, quote);
  const bool long_form = text.substr(i, 3) == triple;
  for (i += long_form ? 3 : 1; i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (!long_form && (text[i] == quote || text[i] == '\n')) {
      return i;
    } else if (long_form && text.substr(i, 3) == triple) {
      i += 2;
      for (int extra = 0; extra < 2 && i + 1 < text.size() && text[i + 1] == quote; ++extra) ++i;  // """a"""""
      return i;
    }
  }
  return text.size();
}

/// toml++ walks nested tables by recursion, as deep as the text says; so depth is bounded before it sees the text.
void refuse_deep(std::string_view text, const std::string& name) {
  int brackets = 0, dots = 0, line = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const std::size_t end = end_of_string(text, i);
      line +=
          static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                                      text.begin() + static_cast<std::ptrdiff_t>(std::min(end, text.size())), '\n'));
      i = end;
      continue;
    }
    if (c == '#') i = std::min(text.find('\n', i), text.size() - 1);
    line += text[i] == '\n';
    brackets += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (c == '.')
      ++dots;
    else if (std::string_view(",=[]{}#\n").find(c) != std::string_view::npos)
      dots = 0;
    if (brackets > kMaxNesting || dots > kMaxNesting)
      throw std::invalid_argument(name + ":" + std::to_string(line) + ": nested deeper than " +
                                  std::to_string(kMaxNesting) + " levels: must be a scene, which needs 3");
  }
}

toml::table parse(std::string_view text, const std::string& name) {
  refuse_deep(text, name);
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const bool is_override = name.starts_with(kOverride);
    throw std::invalid_argument(name + (is_override ? "" : ":" + std::to_string(error.source().begin.line)) + ": " +
                                std::string(error.description()));
  }
}

/// Moves what `from` holds into `into`; tables written as key paths merge, everything else replaces.
void merge(toml::table&& from, toml::table& into) {
  for (auto&& [key, node] : from) {
    toml::table* inner = node.as_table();
    toml::table* outer = into[key.str()].as_table();
    if (inner != nullptr && outer != nullptr && !inner->is_inline())
      merge(std::move(*inner), *outer);
    else
      node.visit([&, &name = key](auto& n) { into.insert_or_assign(name.str(), std::move(n)); });
  }
}

/// An element's own name, or the one it gets from its place.
std::string name_of(const toml::node& element, std::string_view kind, std::size_t index) {
  const toml::table* table = element.as_table();
  const auto name = table == nullptr ? std::nullopt : (*table)["name"].value<std::string>();
  return name && !name->empty() ? *name : std::string(kind) + std::to_string(index + 1);
}

/// "contact.corner1.mu=0.1": what follows kind and name is TOML as it would stand in that element.
void apply_override(toml::table& root, std::string_view override_text) {
  const std::string name = std::string(kOverride) + std::string(override_text);
  const auto path = override_text.substr(0, override_text.find('='));
  if (path.size() == override_text.size()) throw std::invalid_argument(name + ": must have the form key=value");
  const auto dot = path.find('.');
  const auto kind = path.substr(0, dot);
  if (dot == std::string_view::npos) return merge(parse(override_text, name), root);
  if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end())
    throw std::invalid_argument(name + ": unknown kind " + in_quotes(kind) + ": must be one of " +
                                join({kKinds.begin(), kKinds.end()}));
  const auto second_dot = path.find('.', dot + 1);
  if (second_dot == std::string_view::npos)
    throw std::invalid_argument(name + ": must have the form " + std::string(kind) + ".NAME.KEY=VALUE");
  const auto wanted = path.substr(dot + 1, second_dot - dot - 1);
  std::vector<std::string> present;
  if (toml::array* elements = root[kind].as_array())
    for (std::size_t i = 0; i < elements->size(); ++i) {
      toml::node& element = *elements->get(i);
      present.push_back(name_of(element, kind, i));
      if (present.back() == wanted && element.is_table())
        return merge(parse(override_text.substr(second_dot + 1), name), *element.as_table());
    }
  throw std::invalid_argument(name + ": no " + std::string(kind) + " is named " + in_quotes(wanted) +
                              ": must be one of " + (present.empty() ? "(the scene has none)" : join(present)));
}

/// One table being read. Every key is asked for; done() refuses those that nobody asked for.
class Fields {
 public:
  Fields(const toml::table& table, std::string who, const std::string& file, std::string prefix = "")
      : table_(table), who_(std::move(who)), file_(file), prefix_(std::move(prefix)) {}

  template <class T> void need(std::string_view key, T& value) {
    if (!maybe(key, value)) miss(key);
  }
  [[noreturn]] void miss(std::string_view key) const {
    fail(table_, "missing key " + in_quotes(prefix_ + std::string(key)));
  }
  /// False, and `value` as it was, when the key is not there.
  template <class T> bool maybe(std::string_view key, T& value) {
    const toml::node* node = find(key);
    if (node != nullptr) convert(key, *node, value);
    return node != nullptr;
  }
  /// The table under `key`; null when it is not there.
  const toml::table* inner(std::string_view key) {
    const toml::node* node = find(key);
    if (node != nullptr && !node->is_table()) refuse(key, *node, "a table");
    return node == nullptr ? nullptr : node->as_table();
  }
  Fields fields(std::string_view key, const toml::table& table) const {
    return {table, who_, file_, prefix_ + std::string(key) + "."};
  }
  /// A direction of any length but zero, made a unit vector.
  bool direction(std::string_view key, Vector2d& unit) {
    const toml::node* node = find(key);
    if (node == nullptr) return false;
    convert(key, *node, unit);
    if (unit.isZero(0)) refuse(key, *node, "a direction, not zero");
    unit = unit.stableNormalized().eval();
    return true;
  }
  template <class Enum, std::size_t N>
  void choice(std::string_view key, Enum& value, const std::array<std::string_view, N>& names) {
    std::string word;
    if (!maybe(key, word)) return;
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) refuse(key, *table_.get(key), "one of " + join({names.begin(), names.end()}));
    value = static_cast<Enum>(found - names.begin());
  }
  void done() const {
    for (const auto& [key, node] : table_)
      if (std::find(known_.begin(), known_.end(), key.str()) == known_.end())
        fail(node, "unknown key " + in_quotes(prefix_ + std::string(key.str())) + ": must be one of " + join(known_));
  }

  const toml::node* find(std::string_view key) {
    known_.emplace_back(key);
    return table_.get(key);
  }
  [[noreturn]] void refuse(std::string_view key, const toml::node& node, const std::string& rule) const {
    fail(node, prefix_ + std::string(key) + " = " + text(node) + ": must be " + rule);
  }
  [[noreturn]] void fail(const toml::node& node, const std::string& sentence) const {
    // The table may be younger than the element: then the place of the table is the better guess.
    throw std::invalid_argument(place(node.source().path ? node : table_, file_) + ": " + who_ + sentence);
  }
  const toml::table& table() const { return table_; }

 private:
  void convert(std::string_view key, const toml::node& node, double& value) const {
    const auto number = node.is_number() ? node.value<double>() : std::nullopt;
    if (!number) refuse(key, node, "a number");
    if (!std::isfinite(*number)) refuse(key, node, "finite");
    value = *number;
  }
  void convert(std::string_view key, const toml::node& node, std::vector<double>& values) const {
    const toml::array* array = node.as_array();
    if (array == nullptr) refuse(key, node, "a list of numbers");
    values.resize(array->size());
    for (std::size_t i = 0; i < values.size(); ++i) convert(key, *array->get(i), values[i]);
  }
  void convert(std::string_view key, const toml::node& node, Vector2d& value) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 2) refuse(key, node, "two numbers [x, y]");
    convert(key, *array->get(0), value.x()), convert(key, *array->get(1), value.y());
  }
  void convert(std::string_view key, const toml::node& node, std::vector<Vector2d>& points) const {
    const toml::array* array = node.as_array();
    if (array == nullptr) refuse(key, node, "a list of points [[x, y], ...]");
    points.resize(array->size());
    for (std::size_t i = 0; i < points.size(); ++i) convert(key, *array->get(i), points[i]);
  }
  void convert(std::string_view key, const toml::node& node, std::string& value) const {
    const auto words = node.value_exact<std::string>();
    if (!words) refuse(key, node, "a string in quotes");
    value = *words;
  }

  const toml::table& table_;
  std::string who_;  // contact "corner1":
  const std::string& file_;
  std::string prefix_;  // of keys, inside an inner table
  std::vector<std::string> known_;
};

double cosine(double amplitude, double omega, double phase, double t) {
  return amplitude * std::cos(omega * t + phase);
}

/// Linear between the points, constant outside.
double interpolate(const std::vector<double>& times, const std::vector<double>& values, double t) {
  const auto next = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
  if (next == 0) return values.front();
  if (next == times.size()) return values.back();
  const double s = (t - times[next - 1]) / (times[next] - times[next - 1]);
  return (1 - s) * values[next - 1] + s * values[next];
}

class Reader {
 public:
  Reader(const toml::table& root, std::string file) : root_(root), file_(std::move(file)) {}

  Scene scene() {
    Fields top(root_, "", file_);
    top.maybe("gravity", scene_.gravity), top.maybe("duration", scene_.duration), top.maybe("step", scene_.step);
    top.choice("restitution", scene_.restitution, kRestitutionNames);
    top.choice("impacts", scene_.impacts, kImpactsNames);
    each(top, "body", [&](Fields& f) { body(f); });
    pose_bodies();
    each(top, "joint", [&](Fields& f) { joint(f); });
    each(top, "contact", [&](Fields& f) { contact(f); });
    each(top, "collision", [&](Fields& f) { collision(f); });
    each(top, "friction", [&](Fields& f) { friction(f); });
    each(top, "spring", [&](Fields& f) { spring(f); });
    each(top, "load", [&](Fields& f) { load(f); });
    top.done();
    try {
      check(scene_);
    } catch (const SceneError& error) {
      throw std::invalid_argument(place(find(error), file_) + ": " + error.what());
    }
    list_pairs();
    return std::move(scene_);
  }

 private:
  enum class Search { grid, none };
  template <class Read> void each(Fields& top, std::string_view kind, Read&& read) {
    const toml::node* list = top.find(kind);
    if (list == nullptr) return;
    if (!list->is_array()) top.refuse(kind, *list, "a list of tables [[" + std::string(kind) + "]]");
    const toml::array& elements = *list->as_array();
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const toml::table* table = elements.get(i)->as_table();
      if (table == nullptr) top.refuse(kind, *elements.get(i), "a table");
      given_name_ = name_of(*table, kind, i);
      Fields fields(*table, std::string(kind) + " " + in_quotes(given_name_) + ": ", file_);
      read(fields);
      fields.done();
      if (kind == "contact") written_.resize(scene_.contacts.size(), i);
    }
  }

  void body(Fields& f) {
    Body b;
    f.need("name", b.name), f.need("mass", b.mass), f.need("inertia", b.inertia);
    f.maybe("position", b.position), f.maybe("angle", b.angle);
    f.maybe("velocity", b.velocity), f.maybe("omega", b.omega);
    if (b.name.empty()) f.refuse("name", *f.table().get("name"), "of letters, digits, _ and -");
    ids_.emplace(b.name, scene_.body(b));
  }

  /// The initial poses: angles and lengths that the file leaves out are taken from them.
  void pose_bodies() {
    for (const Body& b : scene_.bodies)
      initial_.pose.push_back({b.position, b.angle, std::cos(b.angle), std::sin(b.angle)});
    initial_.pose.emplace_back();
  }
  double initial_angle(BodyId a, BodyId b) const { return initial_.at(a).theta - initial_.at(b).theta; }
  template <class T> double initial_length(const T& link) const {
    return (initial_.at(link.a).x + initial_.at(link.a).turn(link.point_a) - initial_.at(link.b).x -
            initial_.at(link.b).turn(link.point_b))
        .norm();
  }

  BodyId id(const Fields& f, std::string_view key, const toml::node& node) const {
    const auto name = node.value_exact<std::string>();
    if (name && *name == "ground") return kGround;
    const auto found = name ? ids_.find(*name) : ids_.end();
    if (found == ids_.end()) {
      std::vector<std::string> names{"ground"};
      for (const Body& b : scene_.bodies) names.push_back(b.name);
      f.refuse(key, node, "the name of a body: " + join(names));
    }
    return found->second;
  }
  BodyId body_of(Fields& f) const {
    std::string unused;
    f.need("body", unused);
    return id(f, "body", *f.table().get("body"));
  }
  template <class T> void bodies_of(Fields& f, T& x) const {
    const toml::node* node = f.find("bodies");
    if (node == nullptr) f.fail(f.table(), "missing key \"bodies\"");
    const toml::array* names = node->as_array();
    if (names == nullptr || names->size() != 2) f.refuse("bodies", *node, "two names [\"first\", \"second\"]");
    x.a = id(f, "bodies", *names->get(0)), x.b = id(f, "bodies", *names->get(1));
  }
  template <class T> void points_of(Fields& f, T& x) const {
    bodies_of(f, x), f.maybe("point_a", x.point_a), f.maybe("point_b", x.point_b);
  }

  void joint(Fields& f) {
    std::string type, name;
    f.need("type", type), f.maybe("name", name);
    if (type == "revolute") {
      Revolute j{.name = name};
      points_of(f, j);
      scene_.joint(j);
    } else if (type == "prismatic") {
      Prismatic j{.name = name};
      points_of(f, j), f.direction("axis", j.axis);
      if (!f.maybe("angle", j.angle)) j.angle = initial_angle(j.b, j.a);
      scene_.joint(j);
    } else if (type == "fixed") {
      Fixed j{.name = name};
      points_of(f, j);
      if (!f.maybe("angle", j.angle)) j.angle = initial_angle(j.a, j.b);
      scene_.joint(j);
    } else if (type == "distance") {
      Distance j{.name = name};
      points_of(f, j);
      if (!f.maybe("length", j.length)) j.length = initial_length(j);
      scene_.joint(j);
    } else if (type == "drive") {
      Drive j{name, coordinate(f), {}};
      const bool placed = time_law(f, j.law);
      if (!placed) j.law.offset = j.of.value(initial_) - j.law.value(0);
      scene_.joint(j);
    } else {
      f.refuse("type", *f.table().get("type"), "revolute, prismatic, fixed, distance or drive");
    }
  }

  /// False: without an offset.
  static bool time_law(Fields& f, TimeLaw& law) {
    const bool placed = f.maybe("offset", law.offset);
    f.maybe("rate", law.rate_of_change), f.maybe("amplitude", law.amplitude);
    f.maybe("omega", law.omega), f.maybe("phase", law.phase);
    if (const toml::table* table = f.inner("table")) {
      Fields g = f.fields("table", *table);
      const auto [times, values] = points_in_time(g);
      law.table = Spline(times, values);
      g.done();
    }
    return placed;
  }

  /// What is free at a joint that is named, or what is written: two bodies and what is measured between them.
  Coordinate coordinate(Fields& f) const {
    const toml::node* joint = f.find("joint");
    const toml::node* of = f.find("of");
    if (joint != nullptr) return free_at(f, *joint);
    if (of == nullptr) f.fail(f.table(), "missing key \"joint\" or \"of\"");
    const auto kind = of->value_exact<std::string>();
    if (kind == "angle") {
      Angle c;
      bodies_of(f, c);
      return c;
    }
    if (kind == "slide") {
      Slide c;
      points_of(f, c), f.direction("axis", c.axis);
      return c;
    }
    if (kind != "distance") f.refuse("of", *of, "angle, slide or distance");
    Span c;
    points_of(f, c);
    return c;
  }
  Coordinate free_at(const Fields& f, const toml::node& joint) const {
    const auto name = joint.value_exact<std::string>();
    for (const Joint& one : scene_.joints) {
      if (!name || std::visit([](const auto& j) { return j.name; }, one) != *name) continue;
      if (const auto* pin = std::get_if<Revolute>(&one)) return Angle{pin->a, pin->b};
      if (const auto* rail = std::get_if<Prismatic>(&one))
        return Slide{rail->a, rail->b, rail->point_a, rail->point_b, rail->axis};
      f.refuse("joint", joint, "a revolute or prismatic joint: others leave nothing free to name");
    }
    f.refuse("joint", joint, "the name of a joint written before");
  }

  static void law(Fields& f, ContactLaw& law) {
    f.maybe("mu", law.mu), f.maybe("e_n", law.e), f.maybe("e_t", law.e_t);
    f.maybe("mu_static", law.mu_static), f.maybe("belt", law.belt);
  }

  template <class T> void wall(Fields& f, T& c) const {
    const toml::table* table = f.inner("wall");
    if (table == nullptr) f.fail(f.table(), "missing key \"wall\"");
    Fields w = f.fields("wall", *table);
    half_plane(w, c);
    w.done();
  }
  template <class T> void half_plane(Fields& w, T& c) const {
    if (const toml::node* node = w.find("body")) c.b = id(w, "body", *node);
    w.maybe("point", c.wall_point);
    if (!w.direction("normal", c.normal)) w.miss("normal");
  }

  void contact(Fields& f) {
    std::string type, name;
    f.need("type", type), f.maybe("name", name);
    if (name.empty()) name = given_name_;
    if (type == "corner-wall") {
      CornerWall c{.name = name};
      c.a = body_of(f), f.maybe("point", c.point), wall(f, c), law(f, c.law);
      scene_.contact(c);
    } else if (type == "disc-wall") {
      DiscWall c{.name = name};
      c.a = body_of(f), f.maybe("centre", c.centre), f.need("radius", c.radius), wall(f, c), law(f, c.law);
      scene_.contact(c);
    } else if (type == "disc-disc") {
      DiscDisc c{.name = name};
      bodies_of(f, c), f.maybe("centre_a", c.centre_a), f.maybe("centre_b", c.centre_b);
      f.need("radius_a", c.radius_a), f.need("radius_b", c.radius_b), law(f, c.law);
      scene_.contact(c);
    } else if (type == "polygon-wall") {
      CornerWall c{.name = name};
      Polygon corners;
      c.a = body_of(f), f.need("corners", corners), wall(f, c), law(f, c.law);
      convex_corners(f, "corners", corners);
      scene_.contact_set(polygon_wall(c, corners));
    } else if (type == "disc-polygon") {
      DiscPolygon c{.name = name};
      bodies_of(f, c), f.maybe("centre", c.centre), f.need("radius", c.radius);
      f.need("corners", c.corners), law(f, c.law);
      scene_.contact(c);
    } else if (type == "polygon-polygon") {
      PolygonPolygon c{.name = name};
      bodies_of(f, c), f.need("corners_a", c.corners_a), f.need("corners_b", c.corners_b), law(f, c.law);
      convex_corners(f, "corners_a", c.corners_a), convex_corners(f, "corners_b", c.corners_b);
      scene_.contact_set(polygon_polygon(c));
    } else if (type == "journal") {
      Journal c{.name = name};
      bodies_of(f, c), f.maybe("centre_a", c.centre_a), f.maybe("centre_b", c.centre_b);
      f.need("radius_a", c.radius_a), f.need("radius_b", c.radius_b), law(f, c.law);
      scene_.contact(c);
    } else if (type == "guide") {
      guide_of(f, name);
    } else if (type == "limit") {
      limit(f, name);
    } else if (type == "rope") {
      Span span;
      Limit c{.name = name, .side = Limit::Side::upper};
      points_of(f, span), f.maybe("e_n", c.law.e), f.need("length", c.bound);
      if (!(c.bound > 0)) f.refuse("length", *f.table().get("length"), "> 0");
      c.of = span;
      scene_.contact(c);
    } else {
      f.refuse("type", *f.table().get("type"),
               "corner-wall, disc-wall, disc-disc, polygon-wall, disc-polygon, polygon-polygon, journal, guide, limit "
               "or rope");
    }
  }

  static void convex_corners(const Fields& f, std::string_view key, const Polygon& corners) {
    if (!convex(corners))
      f.refuse(key, *f.table().get(key), "the corners of a convex polygon, counter-clockwise, no three in a line");
  }

  void guide_of(Fields& f, const std::string& name) {
    Guide g{.name = name};
    g.a = body_of(f), f.maybe("centre", g.centre), f.need("width", g.width), f.need("height", g.height);
    f.need("clearance", g.clearance), law(f, g.law);
    const auto at_least = [&](std::string_view key, bool holds, const std::string& rule) {
      if (!holds) f.refuse(key, *f.table().get(key), rule);
    };
    at_least("width", g.width > 0, "> 0"), at_least("height", g.height > 0, "> 0");
    at_least("clearance", g.clearance >= 0, ">= 0");
    if (const toml::table* table = f.inner("walls")) {
      Fields w = f.fields("walls", *table);
      if (const toml::node* node = w.find("body")) g.b = id(w, "body", *node);
      w.maybe("point", g.point), w.direction("axis", g.axis);
      w.done();
    }
    for (const CornerWall& corner : guide(g)) {
      if (corner.gap(initial_) < -g.height / 2)
        f.fail(f.table(), "starts off its walls or crosswise: corner \"" + corner.name + "\" is " +
                              detail::text_of(-corner.gap(initial_)) +
                              " m inside its wall: must be at most height / 2");
      scene_.contact(corner);
    }
  }

  void limit(Fields& f, const std::string& name) {
    Limit c{.name = name, .of = coordinate(f)};
    f.maybe("e_n", c.law.e);
    double lower = 0, upper = 0;
    const bool below = f.maybe("lower", lower), above = f.maybe("upper", upper);
    if (!below && !above) f.fail(f.table(), "missing key \"lower\" or \"upper\"");
    if (below && above && lower > upper) f.refuse("lower", *f.table().get("lower"), "at most upper");
    const auto add = [&](Limit::Side side, double bound, const char* suffix) {
      Limit one = c;
      one.side = side, one.bound = bound;
      if (below && above) one.name += suffix;
      scene_.contact(one);
    };
    if (below) add(Limit::Side::lower, lower, "_lower");
    if (above) add(Limit::Side::upper, upper, "_upper");
  }

  void collision(Fields& f) {
    Collision c;
    f.maybe("name", c.name), f.maybe("neighbours", c.neighbours), law(f, c.law);
    Search search = Search::grid;
    f.choice("search", search, kSearchNames);
    searches_.push_back(search);
    each_table(f, "shapes", [&](Fields& g) {
      Shape s{.body = body_of(g)};
      const bool polygon = g.maybe("corners", s.corners);
      if (polygon) convex_corners(g, "corners", s.corners);
      if (!polygon) g.maybe("centre", s.centre), g.need("radius", s.radius);
      c.shapes.push_back(s);
    });
    auto& walls = walls_.emplace_back();
    each_table(f, "walls", [&](Fields& g) { half_plane(g, walls.emplace_back()); });
    scene_.collision(c);
  }
  template <class Read> void each_table(Fields& f, std::string_view key, Read&& read) {
    const toml::node* list = f.find(key);
    if (list == nullptr) return;
    const toml::array* tables = list->as_array();
    if (tables == nullptr) f.refuse(key, *list, "a list of tables [{...}, ...]");
    for (std::size_t i = 0; i < tables->size(); ++i) {
      const toml::table* table = tables->get(i)->as_table();
      if (table == nullptr) f.refuse(key, *tables->get(i), "a table");
      Fields g = f.fields(std::string(key) + "[" + std::to_string(i) + "]", *table);
      read(g);
      g.done();
    }
  }
  /// What collisions stand for and no search finds: every shape against each wall, and the pairs that are to be listed.
  void list_pairs() {
    Scene all = scene_;
    all.collisions.clear();
    std::vector<Collision> searched;
    for (std::size_t i = 0; i < scene_.collisions.size(); ++i) {
      const Collision& c = scene_.collisions[i];
      int count = 0;
      const std::string wall_name = c.name + "_wall_";
      for (CornerWall wall : walls_[i])
        for (const Shape& s : c.shapes) {
          wall.name = wall_name + std::to_string(++count), wall.a = s.body, wall.law = c.law;
          if (s.body == wall.b) continue;
          if (s.corners.empty())
            all.contact(DiscWall{wall.name, s.body, s.centre, s.radius, wall.b, wall.wall_point, wall.normal, c.law});
          else
            all.contact_set(polygon_wall(wall, s.corners));
        }
      (searches_[i] == Search::none ? all.collisions : searched).push_back(c);
    }
    scene_ = with_pairs_listed(all);
    scene_.collisions = searched;
  }

  void friction(Fields& f) {
    JointFriction friction;
    f.maybe("name", friction.name);
    friction.of = coordinate(f);
    f.maybe("mu", friction.mu), f.maybe("radius", friction.radius);
    if (!f.maybe("bound", friction.bound) && !friction.loaded()) f.miss("bound");
    if (friction.loaded())
      for (const Joint& one : scene_.joints)
        if (std::visit([](const auto& j) { return j.name; }, one) == f.table()["joint"].value_or(std::string()))
          friction.joint = static_cast<int>(&one - scene_.joints.data());
    scene_.friction(friction);
  }

  void spring(Fields& f) {
    std::string type, name;
    f.need("type", type), f.maybe("name", name);
    if (type == "point") {
      PointSpring s{.name = name};
      points_of(f, s), f.maybe("stiffness", s.stiffness), f.maybe("damping", s.damping);
      if (!f.maybe("rest", s.rest)) s.rest = initial_length(s);
      scene_.spring(s);
    } else if (type == "torsion") {
      TorsionSpring s{.name = name};
      bodies_of(f, s), f.maybe("stiffness", s.stiffness), f.maybe("damping", s.damping);
      if (!f.maybe("rest", s.rest)) s.rest = initial_angle(s.a, s.b);
      scene_.spring(s);
    } else if (type == "joint") {
      JointSpring s{.name = name, .of = coordinate(f)};
      f.maybe("stiffness", s.stiffness), f.maybe("damping", s.damping);
      if (!f.maybe("rest", s.rest)) s.rest = s.of.value(initial_);
      scene_.spring(s);
    } else {
      f.refuse("type", *f.table().get("type"), "point, torsion or joint");
    }
  }

  void load(Fields& f) {
    Load l;
    f.maybe("name", l.name);
    l.body = body_of(f), f.maybe("point", l.point), f.maybe("force", l.force), f.maybe("torque", l.torque);
    if (const toml::table* table = f.inner("factor")) {
      Fields g = f.fields("factor", *table);
      set_factor(g, l);
      g.done();
    }
    scene_.load(l);
  }

  static void set_factor(Fields& f, Load& l) {
    std::string type;
    f.need("type", type);
    if (type == "cosine") {
      double amplitude = 1, omega = 0, phase = 0;
      f.maybe("amplitude", amplitude), f.need("omega", omega), f.maybe("phase", phase);
      l.factor = [=](double t) { return cosine(amplitude, omega, phase, t); };
      l.omega = std::abs(omega);
      return;
    }
    if (type != "table") f.refuse("type", *f.table().get("type"), "cosine or table");
    const auto [times, values] = points_in_time(f);
    l.breakpoints = times;
    l.factor = [times = times, values = values](double t) { return interpolate(times, values, t); };
  }
  static std::pair<std::vector<double>, std::vector<double>> points_in_time(Fields& f) {
    std::vector<double> times, values;
    f.need("times", times), f.need("values", values);
    const toml::node& written = *f.table().get("times");
    if (times.empty()) f.refuse("times", written, "at least one time");
    if (times.size() != values.size()) f.refuse("times", written, "as many as values");
    if (std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) != times.end())
      f.refuse("times", written, "ascending");
    return {times, values};
  }

  /// What check() was unhappy with: the key if it is written, else its element, else the file.
  const toml::node& find(const SceneError& error) const {
    if (error.kind.empty()) {
      const toml::node* key = root_.get(error.field);
      return key != nullptr ? *key : root_;
    }
    const std::size_t index = error.kind == "contact" ? written_[error.index] : error.index;
    const toml::table& element = *root_.get(error.kind)->as_array()->get(index)->as_table();
    const toml::node* key = element.get(error.field);
    return key != nullptr ? *key : element;
  }

  const toml::table& root_;
  std::string file_;
  Scene scene_;
  Kinematics initial_;
  std::string given_name_;                      // of the element being read, or by its place: what overrides know it by
  std::vector<Search> searches_;                // of each collision
  std::vector<std::vector<CornerWall>> walls_;  // likewise: b, wall_point and normal are read
  std::vector<std::size_t> written_;            // of each contact, which element of the file it comes from
  std::map<std::string, BodyId, std::less<>> ids_;
};

}  // namespace

Scene parse_scene(std::string_view text, std::span<const std::string> overrides, std::string_view name) {
  const std::string file(name);
  if (text.size() > kMaxFile)
    throw std::invalid_argument(file + ": " + std::to_string(text.size()) + " bytes: must be at most 16 MiB");
  toml::table root = parse(text, file);
  for (const std::string& one : overrides) apply_override(root, one);
  return Reader(root, file).scene();
}

Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw std::invalid_argument(file.string() + ": must be a file that exists");
  const auto size = std::filesystem::file_size(file, error);
  if (size > kMaxFile)
    throw std::invalid_argument(file.string() + ": " + std::to_string(size) + " bytes: must be at most 16 MiB");
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::invalid_argument(file.string() + ": cannot be read");
  return parse_scene(text.str(), overrides, file.string());
}

}  // namespace orthant
