#include "experiments/report/view.h"
#include "experiments/support/printable.h"

#include <array>

#include "target.h"

namespace {

using namespace orthant;

/// What surrounds the data of a page: it must not depend on them.
std::pair<std::string, std::string> frame_of(const std::string& page, std::string& data) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">", end = "</script>";
  const auto first = page.find(begin) + begin.size(), last = page.find(end, first);
  data = page.substr(first, last - first);
  return {page.substr(0, first), page.substr(last)};
}

const std::pair<std::string, std::string>& known_frame(bool in_space) {
  const auto make = [](bool space) {
    std::string data;
    return frame_of(view_page({{"dimension", space ? 3 : 2}}), data);
  };
  static const std::array<std::pair<std::string, std::string>, 2> known = {make(false), make(true)};
  return known[in_space ? 1 : 0];
}

}  // namespace

// A trajectory, its events, a drawing and the run's name, between lines of %%: the page holds them as data, nothing
// else of it changes, and a browser that reads the data finds what was given.
bool orthant::fuzz::view(std::string_view bytes) {
  std::array<std::string, 4> parts;
  for (std::string& part : parts) {
    const auto end = std::min(bytes.find("\n%%\n"), bytes.size());
    part = bytes.substr(0, end);
    bytes = end < bytes.size() ? bytes.substr(end + 4) : std::string_view();
  }
  const NamedFile file("view.csv", parts[0]), events("view.events.csv", parts[1]);
  return parse([&] {
    RecordedRun run = read_run(file.path());
    run.drawing = parts[2];
    const auto data = view_data(printable(parts[3]), "recorded in " + printable(parts[3]), run);
    const std::string page = view_page(data);
    std::string held;
    if (frame_of(page, held) != known_frame(data.at("dimension") == 3)) broken("a page of the same frame", held);
    if (held.find('<') != std::string::npos) broken("data without a tag", held);
    if (nlohmann::ordered_json::parse(held, nullptr, false) != data) broken("the data that were given", held);
  });
}
