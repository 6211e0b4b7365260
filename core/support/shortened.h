// core/support/shortened.h — shortened text for messages: long quotations become one line.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace orthant {

/// The text, with \0 as \\0: what() ends there.
inline std::string without_end(std::string_view text) {
  std::string all;
  for (const char c : text) c == '\0' ? all += "\\0" : all += c;
  return all;
}

/// The text, or its beginning and its end where it has more than `most` characters.
inline std::string shortened(std::string_view text, std::size_t most = 60) {
  if (text.size() <= most) return without_end(text);
  const std::size_t end = most / 3;
  return without_end(text.substr(0, most - end)) + " ... " + without_end(text.substr(text.size() - end));
}

/// Returns work()'s result. Shortens its message about a bad argument to one line: place first, rule last.
template <class Work> decltype(auto) in_a_line(Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(shortened(error.what(), 1000));
  }
}

}  // namespace orthant
