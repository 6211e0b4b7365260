// core/mechanics/scene/toml/field_record.h — record of the keys that the reader of scenes requests: element, key, form.
//
// Not installed. While a recorder lives in a thread, Fields reports each key to it. The format's schema is made of that
// (scene_schema.h), so that no key is written down twice.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace orthant::scene_file {

enum class Form {
  any,
  number,
  boolean,
  word,
  pair,
  triple,
  quadruple,
  tensor,
  numbers,
  rows,
  points,
  points_in_space,
  table,
  tables,
  body,
  bodies,
  choice
};

struct FieldRecord {
  std::string element;  // "body", "contact"; empty: the scene itself
  std::string type;     // its `type`; empty: it has none
  std::string key;      // a path: "wall.normal", "shapes[].radius"
  Form form = Form::any;
  bool needed = false;  // of every table that was read
  std::vector<std::string> choices;
};

class FieldRecorder {
 public:
  FieldRecorder() : before_(active()) { active() = this; }
  FieldRecorder(const FieldRecorder&) = delete;
  FieldRecorder& operator=(const FieldRecorder&) = delete;
  ~FieldRecorder() { active() = before_; }

  static FieldRecorder*& active() {
    static thread_local FieldRecorder* recorder = nullptr;
    return recorder;
  }

  /// A table begins whose keys are PREFIX and a name.
  void enter(const std::string& element, const std::string& type, const std::string& prefix) {
    ++tables_[{element, type, prefix}];
  }
  void add(const FieldRecord& one) {
    if (one.needed) ++needed_[{one.element, one.type, one.key}];
    for (FieldRecord& known : all_)
      if (known.element == one.element && known.type == one.type && known.key == one.key) {
        if (one.form != Form::any) known.form = one.form;
        if (!one.choices.empty()) known.choices = one.choices;
        return;
      }
    all_.push_back(one);
  }
  std::vector<FieldRecord> all() const {
    std::vector<FieldRecord> fields = all_;
    for (FieldRecord& field : fields) {
      const std::string prefix = field.key.substr(0, field.key.rfind('.') + 1);
      const auto needed = needed_.find({field.element, field.type, field.key});
      const auto tables = tables_.find({field.element, field.type, prefix});
      field.needed = needed != needed_.end() && tables != tables_.end() && needed->second == tables->second;
    }
    return fields;
  }

 private:
  using Place = std::tuple<std::string, std::string, std::string>;
  FieldRecorder* before_;
  std::vector<FieldRecord> all_;
  std::map<Place, int> tables_, needed_;
};

/// Form of the C++ type that a key is read into.
template <class T> constexpr Form form_of() {
  if constexpr (std::is_same_v<T, double>) return Form::number;
  if constexpr (std::is_same_v<T, bool>) return Form::boolean;
  if constexpr (std::is_same_v<T, std::string>) return Form::word;
  if constexpr (std::is_same_v<T, std::vector<double>>) return Form::numbers;
  if constexpr (std::is_same_v<T, std::vector<std::vector<double>>>) return Form::rows;
  if constexpr (requires { T::SizeAtCompileTime; }) {
    constexpr int size = T::SizeAtCompileTime;
    static_assert(size == 2 || size == 3 || size == 4 || size == 9);
    return size == 2 ? Form::pair : size == 3 ? Form::triple : size == 4 ? Form::quadruple : Form::tensor;
  }
  if constexpr (requires { T::value_type::SizeAtCompileTime; })
    if (T::value_type::SizeAtCompileTime == 3) return Form::points_in_space;
  return Form::points;
}

}  // namespace orthant::scene_file
