// core/support/options.h — options with names and ranges, listed once in visit() (see solvers/first_order/pgs.h).
//
//   struct Options { double omega = 1; template <class V> void visit(V&& v) { v("omega", omega, 0.0, 2.0); } };
//   set_options(options, "omega=1.3,max_sweeps=50")  // unknown key, bad number or out of range: throws, in words
//   list_options<Options>()                          // names, defaults and ranges (option_list.h)
#pragma once

#include <orthant/core/support/shortened.h>

#include <array>
#include <charconv>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace orthant {

/// "name:key=value,key=value" cut at the first colon.
struct Spec {
  std::string_view name, options;
  static Spec parse(std::string_view text) {
    const auto colon = text.find(':');
    if (colon == std::string_view::npos) return {text, {}};
    return {text.substr(0, colon), text.substr(colon + 1)};
  }
};

namespace detail {

/// Shortest text that reads back as the same number; a whole number's without exponent.
template <class Number> std::string text_of(Number value) {
  std::array<char, 40> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

template <class Number> Number parse_number(std::string_view key, std::string_view text) {
  Number value{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size())
    throw std::invalid_argument("option " + std::string(key) + " = '" + shortened(text) + "': must be " +
                                (std::is_integral_v<Number> ? "a whole number" : "a number"));
  return value;
}

class OptionSetter {
 public:
  OptionSetter(std::string_view key, std::string_view text) : key_(key), text_(text) {}
  bool found() const { return found_; }
  const std::string& known() const { return known_; }

  template <class Number>
    requires(std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>)
  void operator()(std::string_view name, Number& field, Number low, Number high) {
    if (!matches(name)) return;
    const auto value = parse_number<Number>(name, text_);
    if (!(value >= low && value <= high))
      throw std::invalid_argument("option " + std::string(name) + " = " + shortened(text_) + ": must be in [" +
                                  text_of(low) + ", " + text_of(high) + "]");
    field = value;
  }
  void operator()(std::string_view name, bool& field) {
    if (!matches(name)) return;
    if (text_ != "true" && text_ != "false")
      throw std::invalid_argument("option " + std::string(name) + " = '" + shortened(text_) +
                                  "': must be true or false");
    field = text_ == "true";
  }
  template <class Enum, std::size_t N>
    requires std::is_enum_v<Enum>
  void operator()(std::string_view name, Enum& field, const std::array<std::string_view, N>& choices) {
    if (!matches(name)) return;
    std::string list;
    for (std::size_t i = 0; i < N; ++i) {
      if (choices[i] == text_) {
        field = static_cast<Enum>(i);
        return;
      }
      list += (i ? ", " : "") + std::string(choices[i]);
    }
    throw std::invalid_argument("option " + std::string(name) + " = '" + shortened(text_) + "': must be one of " +
                                list);
  }

 private:
  bool matches(std::string_view name) {
    known_ += (known_.empty() ? "" : ", ") + std::string(name);
    if (found_ || name != key_) return false;
    return found_ = true;
  }
  std::string_view key_, text_;
  std::string known_;
  bool found_ = false;
};

}  // namespace detail

/// Applies "key=value,key=value" to `options`. Throws std::invalid_argument naming key, value and rule.
template <class Options> void set_options(Options& options, std::string_view text) {
  std::string given = ",";  // keys so far
  while (!text.empty()) {
    const auto comma = text.find(',');
    const auto item = text.substr(0, comma);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
    const auto equals = item.find('=');
    if (equals == std::string_view::npos)
      throw std::invalid_argument("option '" + shortened(item) + "': must have the form key=value");
    const std::string key = std::string(item.substr(0, equals)) + ',';
    if (given.find(',' + key) != std::string::npos)
      throw std::invalid_argument("option '" + shortened(item) + "': is given twice");
    given += key;
    detail::OptionSetter setter(item.substr(0, equals), item.substr(equals + 1));
    options.visit(setter);
    if (!setter.found())
      throw std::invalid_argument("unknown option '" + shortened(item.substr(0, equals)) + "': must be one of " +
                                  (setter.known().empty() ? "(this one has no options)" : setter.known()));
  }
}

}  // namespace orthant
