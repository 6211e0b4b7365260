#include "experiments/report/parts.h"

#include <orthant/core/support/file.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace orthant {
namespace {

std::filesystem::path& chosen_folder() {
  static std::filesystem::path folder;
  return folder;
}

std::filesystem::path folder_of_parts() {
  if (!chosen_folder().empty()) return chosen_folder();
  std::error_code error;
  const auto installed =
      std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "../share/orthant/report";
  return !error && std::filesystem::is_directory(installed, error) ? installed : std::filesystem::path(ORTHANT_REPORT);
}

constexpr std::array<std::pair<const char*, const char*>, 9> kParts = {{
    {"page.css", "page.css"},
    {"uPlot.css", "node_modules/uplot/dist/uPlot.min.css"},
    {"uPlot.js", "node_modules/uplot/dist/uPlot.iife.min.js"},
    {"plots.js", "plots.js"},
    {"animation.js", "animation.js"},
    {"three.js", "node_modules/three/build/three.bundle.js"},
    {"space.js", "space.js"},
    {"page.js", "page.js"},
    {"view.js", "view.js"},
}};

}  // namespace

void set_folder_of_parts(const std::filesystem::path& folder) { chosen_folder() = folder; }

std::string assembled(const std::string& name, const nlohmann::ordered_json& data, bool in_space) {
  std::string html = read_whole(folder_of_parts() / name);
  const auto put = [&](const std::string& mark, const std::string& text) {
    const auto at = html.find(mark);
    if (at == std::string::npos) throw std::runtime_error(name + " has no place " + mark);
    html.replace(at, mark.size(), text);
  };
  put("<!--space-->\n", in_space ? "<script>/*three.js*/</script>\n<script>/*space.js*/</script>\n" : "");
  for (const auto& [part, file] : kParts)
    if (const std::string mark = "/*" + std::string(part) + "*/"; html.find(mark) != std::string::npos)
      put(mark, read_whole(folder_of_parts() / file));
  const std::string json = data.dump();
  std::string safe;
  for (const char c : json) c == '<' ? safe += "\\u003c" : safe += c;  // no tag, no comment
  put("/*data*/", safe);                                               // last: nothing is looked for in it
  return html;
}

}  // namespace orthant
