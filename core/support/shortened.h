// core/support/shortened.h — shortened text for messages: long quotations become one line.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace orthant {

/// The text in one line: control characters, line ends and the end of strings among them, as \xNN.
inline std::string in_one_line(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string all;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x20 && code != 0x7f)
      all += c;
    else if (code == 0)
      all += "\\0";
    else
      (all += "\\x") += {kDigits[code / 16], kDigits[code % 16]};
  }
  return all;
}

/// The text, or its beginning and its end where it has more than `most` characters.
inline std::string shortened(std::string_view text, std::size_t most = 60) {
  if (text.size() <= most) return in_one_line(text);
  const std::size_t end = most / 3;
  return in_one_line(text.substr(0, most - end)) + " ... " + in_one_line(text.substr(text.size() - end));
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
