#include "experiments/support/help_text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace orthant {
namespace {

/// Where a broken line goes on.
std::size_t hanging_indent(std::string_view line, std::size_t columns) {
  const std::size_t text = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t gap = line.find("  ", text);
  const std::size_t described = gap == line.npos ? gap : line.find_first_not_of(' ', gap);
  if (described != line.npos && described < columns / 2) return described;
  return std::min(text + 2, columns / 2);
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t columns) {
  if (columns == 0) return std::string(text);
  std::string out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    const std::size_t indent = hanging_indent(line, columns);
    std::size_t before = 0;  // columns in front of what is left of the line
    while (before + line.size() > columns) {
      const std::size_t room = columns - before;
      const std::size_t first = before == 0 ? std::min(indent, room) : 1;  // no break inside the indent
      std::size_t at = line.rfind(' ', room);
      if (at == line.npos || at < first) at = line.find(' ', std::max(room, first));
      if (at == line.npos) break;  // a word longer than the line
      out.append(line.substr(0, at)).append("\n").append(indent, ' ');
      line.remove_prefix(std::min(line.find_first_not_of(' ', at), line.size()));
      before = indent;
    }
    out.append(line);
    if (end != text.npos || !text.empty()) out += '\n';
  }
  return out;
}

std::size_t terminal_width() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* columns = std::getenv("COLUMNS");
  const long given = columns != nullptr ? std::strtol(columns, nullptr, 10) : 0;
  return given >= 20 && given <= 10000 ? static_cast<std::size_t>(given) : 0;
}

}  // namespace orthant
