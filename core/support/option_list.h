// core/support/option_list.h — list of options: names, defaults, ranges and choices as text, from visit().
#pragma once

#include <orthant/core/support/options.h>

#include <string>
#include <vector>

namespace orthant {

struct OptionEntry {
  std::string name, value;           // value: the default
  std::string low, high;             // of a number; else empty
  std::vector<std::string> choices;  // of an enumeration

  /// "omega=1 in [0, 2]", "form=auto of {auto|dense}" or "rescue=true".
  std::string text() const {
    std::string out = name + "=" + value;
    if (!low.empty()) out += " in [" + low + ", " + high + "]";
    for (std::size_t i = 0; i < choices.size(); ++i) out += (i > 0 ? "|" : " of {") + choices[i];
    return choices.empty() ? out : out + "}";
  }
};

namespace detail {

struct OptionLister {
  std::vector<OptionEntry>& list;

  template <class Number>
    requires(std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>)
  void operator()(std::string_view name, Number& field, Number low, Number high) {
    list.push_back({std::string(name), text_of(field), text_of(low), text_of(high), {}});
  }
  void operator()(std::string_view name, bool& field) {
    list.push_back({std::string(name), field ? "true" : "false", {}, {}, {}});
  }
  template <class Enum, std::size_t N>
    requires std::is_enum_v<Enum>
  void operator()(std::string_view name, Enum& field, const std::array<std::string_view, N>& choices) {
    list.push_back({std::string(name),
                    std::string(choices[static_cast<std::size_t>(field)]),
                    {},
                    {},
                    {choices.begin(), choices.end()}});
  }
};

}  // namespace detail

/// Every option with its default and range.
template <class Options> std::vector<OptionEntry> list_options() {
  std::vector<OptionEntry> list;
  Options options;
  options.visit(detail::OptionLister{list});
  return list;
}

/// Likewise on one line.
inline std::string text_of(const std::vector<OptionEntry>& options) {
  std::string out;
  for (const OptionEntry& option : options) out += (out.empty() ? "" : ", ") + option.text();
  return out;
}

}  // namespace orthant
