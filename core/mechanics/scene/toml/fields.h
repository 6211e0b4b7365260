// core/mechanics/scene/toml/fields.h — fields of a TOML table: reads keys by name, reports mistakes with their place.
#pragma once

#include "document.h"
#include "field_record.h"

#include <orthant/core/mechanics/planar/geometry.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant::scene_file {

/// One table being read. done() refuses the keys that no call has read.
class Fields {
 public:
  Fields(const toml::table& table, std::string who, const std::string& file, std::string prefix = "")
      : table_(table), who_(std::move(who)), file_(file), prefix_(std::move(prefix)) {
    if (prefix_.empty()) begin_record(table["type"].value_or(std::string()));
  }

  template <class T> void need(std::string_view key, T& value) {
    if (find(key, form_of<T>(), true) == nullptr) miss(key);
    convert(key, *table_.get(key), value);
  }
  [[noreturn]] void miss(std::string_view key) const {
    fail(table_, "missing key " + in_quotes(prefix_ + std::string(key)));
  }
  /// False, and `value` as it was, when the key is not there.
  template <class T> bool maybe(std::string_view key, T& value) {
    const toml::node* node = find(key, form_of<T>());
    if (node != nullptr) convert(key, *node, value);
    return node != nullptr;
  }
  /// Reports a key to the schema that only files with others have; here it stays unknown.
  void report(std::string_view key, Form form) const { record(key, form, false); }
  /// The table under `key`; null when it is not there.
  const toml::table* inner(std::string_view key) {
    const toml::node* node = find(key, Form::table);
    if (node != nullptr && !node->is_table()) refuse(key, *node, "a table");
    return node == nullptr ? nullptr : node->as_table();
  }
  Fields fields(std::string_view key, const toml::table& table) const {
    Fields of_table(table, who_, file_, prefix_ + std::string(key) + ".");
    of_table.begin_record(type_);
    return of_table;
  }
  /// A direction of any length but zero, made a unit vector. False: it is not there.
  template <class Direction> bool direction(std::string_view key, Direction& unit, bool needed = false) {
    const toml::node* node = find(key, form_of<Direction>(), needed);
    if (node == nullptr) return false;
    convert(key, *node, unit);
    if (unit.isZero(0)) refuse(key, *node, "a direction, not zero");
    unit = unit.stableNormalized().eval();
    return true;
  }
  template <class Enum, std::size_t N>
  void choice(std::string_view key, Enum& value, const std::array<std::string_view, N>& names) {
    std::string word;
    record(key, Form::choice, false, {names.begin(), names.end()});
    const toml::node* node = find(key);
    if (node == nullptr) return;
    convert(key, *node, word);
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) refuse(key, *table_.get(key), "one of " + join({names.begin(), names.end()}));
    value = static_cast<Enum>(found - names.begin());
  }
  void done() const {
    for (const auto& [key, node] : table_)
      if (std::find(known_.begin(), known_.end(), key.str()) == known_.end())
        fail(node, "unknown key " + in_quotes(prefix_ + std::string(key.str())) + ": must be one of " + join(known_));
  }

  /// Form and whether the key must be there: for the schema of the format alone.
  const toml::node* find(std::string_view key, Form form = Form::any, bool needed = false) {
    known_.emplace_back(key);
    record(key, form, needed);
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
  void begin_record(const std::string& type) {
    FieldRecorder* recorder = FieldRecorder::active();
    if (recorder == nullptr) return;
    type_ = type;
    recorder->enter(element(), type_, without_places(prefix_));
  }
  void record(std::string_view key, Form form, bool needed, std::vector<std::string> choices = {}) const {
    if (FieldRecorder* recorder = FieldRecorder::active())
      recorder->add({element(), type_, without_places(prefix_ + std::string(key)), form, needed, std::move(choices)});
  }
  std::string element() const { return who_.substr(0, who_.find(' ')); }
  /// "shapes[2].radius" becomes "shapes[].radius".
  static std::string without_places(std::string path) {
    for (auto open = path.find('['); open != std::string::npos; open = path.find('[', open + 1))
      path.erase(open + 1, path.find(']', open) - open - 1);
    return path;
  }
  void convert(std::string_view key, const toml::node& node, double& value) const {
    const auto number = node.is_number() ? node.value<double>() : std::nullopt;
    if (!number) refuse(key, node, "a number");
    if (!std::isfinite(*number)) refuse(key, node, "finite");
    value = *number;
  }
  void convert(std::string_view key, const toml::node& node, bool& value) const {
    const auto answer = node.value_exact<bool>();
    if (!answer) refuse(key, node, "true or false");
    value = *answer;
  }
  void convert(std::string_view key, const toml::node& node, std::vector<double>& values) const {
    const toml::array* array = node.as_array();
    if (array == nullptr) refuse(key, node, "a list of numbers");
    values.resize(array->size());
    for (std::size_t i = 0; i < values.size(); ++i) convert(key, *array->get(i), values[i]);
  }
  void convert(std::string_view key, const toml::node& node, std::vector<std::vector<double>>& rows) const {
    const toml::array* array = node.as_array();
    if (array == nullptr) refuse(key, node, "a list of lists of numbers [[z, ...], ...]");
    rows.resize(array->size());
    for (std::size_t i = 0; i < rows.size(); ++i) convert(key, *array->get(i), rows[i]);
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
  void convert(std::string_view key, const toml::node& node, Vector3d& value) const {
    numbers(key, node, value, "three numbers [x, y, z]");
  }
  void convert(std::string_view key, const toml::node& node, Eigen::Vector4d& value) const {
    numbers(key, node, value, "four numbers [w, x, y, z]");
  }
  /// An inertia tensor: one number for three equal moments, three for a diagonal one, or three rows of three.
  void convert(std::string_view key, const toml::node& node, Eigen::Matrix3d& value) const {
    const toml::array* array = node.as_array();
    const char* const rule = "a number, three numbers, or three rows of three numbers";
    if (array == nullptr) {
      double one = 0;
      if (!node.is_number()) refuse(key, node, rule);
      convert(key, node, one);
      value = Eigen::Matrix3d(one * Eigen::Matrix3d::Identity());
      return;
    }
    if (array->size() != 3) refuse(key, node, rule);
    Vector3d row;
    if (array->get(0)->is_number()) {
      numbers(key, node, row, rule);
      value = Eigen::Matrix3d(row.asDiagonal());
      return;
    }
    for (int i = 0; i < 3; ++i) {
      numbers(key, *array->get(static_cast<std::size_t>(i)), row, rule);
      value.row(i) = row.transpose();
    }
  }
  void convert(std::string_view key, const toml::node& node, std::vector<Vector3d>& points) const {
    const toml::array* array = node.as_array();
    if (array == nullptr) refuse(key, node, "a list of points [[x, y, z], ...]");
    points.resize(array->size());
    for (std::size_t i = 0; i < points.size(); ++i) convert(key, *array->get(i), points[i]);
  }
  template <class V> void numbers(std::string_view key, const toml::node& node, V& value, const char* rule) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || static_cast<Eigen::Index>(array->size()) != value.size()) refuse(key, node, rule);
    for (Eigen::Index i = 0; i < value.size(); ++i) convert(key, *array->get(static_cast<std::size_t>(i)), value[i]);
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
  std::string type_;    // of the element; only while keys are recorded
  std::vector<std::string> known_;
};

/// The elements [[kind]]: calls read(fields, index) for each, with its name in `name`.
template <class Read>
void each_element(Fields& top, std::string_view kind, const std::string& file, std::string& name, const Read& read) {
  const toml::node* list = top.find(kind, Form::tables);
  if (list == nullptr) return;
  if (!list->is_array()) top.refuse(kind, *list, "a list of tables [[" + std::string(kind) + "]]");
  const toml::array& elements = *list->as_array();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const toml::table* table = elements.get(i)->as_table();
    if (table == nullptr) top.refuse(kind, *elements.get(i), "a table");
    name = name_of(*table, kind, i);
    Fields fields(*table, std::string(kind) + " " + in_quotes(name) + ": ", file);
    read(fields, i);
  }
}

}  // namespace orthant::scene_file
