// core/support/shortened.h — messages quote the text of strangers, which may be long; a message is a line.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace orthant {

/// The text, or its beginning and its end where it has more than `most` characters.
inline std::string shortened(std::string_view text, std::size_t most = 60) {
  if (text.size() <= most) return std::string(text);
  const std::size_t end = most / 3;
  return std::string(text.substr(0, most - end)) + " ... " + std::string(text.substr(text.size() - end));
}

/// What work() returns; what it says of a bad argument as one line: where at its beginning, the rule at its end.
template <class Work> decltype(auto) in_a_line(Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(shortened(error.what(), 1000));
  }
}

}  // namespace orthant
