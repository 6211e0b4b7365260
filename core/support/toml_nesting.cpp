#include <orthant/core/support/toml_nesting.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace orthant {
namespace {

constexpr int kMaxNesting = 16;  // brackets around a value, and dots in a key

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

}  // namespace

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
                                  std::to_string(kMaxNesting) + " levels: no file of ours needs more than 4");
  }
}

}  // namespace orthant
