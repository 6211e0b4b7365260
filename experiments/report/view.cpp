#include "experiments/report/view.h"

#include "experiments/report/parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostFrames = 1200, kFewestFrames = 100;
constexpr std::size_t kMostNumbers = 150'000;        // about 1.3 MB of text
constexpr std::size_t kMostNumbersInSpace = 90'000;  // there three.js takes 570 kB of the page
constexpr std::size_t kMostPushes = 12'000;          // 500 kB
constexpr std::size_t kMostListed = 2000;            // 100 kB
constexpr int kDeepest = 16;                         // brackets of a drawing: Json::dump() recurses

/// Digits of a drawing and of a plot; of times more, for frames lie close.
Json digits_of(double x, int digits) {
  if (!std::isfinite(x)) return nullptr;
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, x);
  return std::strtod(text, nullptr);
}

bool is_sum(const std::string& column) {
  const auto at = column.rfind('.');
  return at != std::string::npos && column.compare(at, 8, ".impulse") == 0;
}

/// Bodies and contacts as the columns name them, for a run whose scene is not at hand.
Json points_only(const std::vector<std::string>& columns) {
  const std::set<std::string> known(columns.begin(), columns.end());
  Json bodies = Json::array(), contacts = Json::array(), names = Json::array();
  bool in_space = false;
  for (const std::string& column : columns) {
    const std::string stem = column.substr(0, column.rfind('.'));
    if (column.ends_with(".qw") && known.contains(stem + ".x") && known.contains(stem + ".qz"))
      bodies.push_back({{"name", stem}}), in_space = true;
    if (column.ends_with(".theta") && known.contains(stem + ".x") && known.contains(stem + ".y"))
      bodies.push_back({{"name", stem}});
    if (column.ends_with(".gap")) contacts.push_back({{"name", stem}}), names.push_back(stem);
  }
  if (in_space)
    return {{"dimension", 3},          {"bodies", bodies},     {"solids", Json::array()},
            {"joints", Json::array()}, {"contacts", contacts}, {"event_contacts", names}};
  return {{"bodies", bodies},
          {"outlines", Json::array()},
          {"pins", Json::array()},
          {"contacts", contacts},
          {"event_contacts", names}};
}

bool is_spatial(const Json& drawing) {
  const auto dimension = drawing.is_object() ? drawing.find("dimension") : drawing.end();
  return drawing.is_object() && dimension != drawing.end() && *dimension == 3;
}

/// By frame the pairs that pushed since the one before, each once: where it was last, impulses summed. Frames end at
/// `times`.
Json pushes_by_frame(const std::vector<Push>& pushes, const std::vector<double>& times) {
  Json frames = Json::array();
  const std::size_t most = std::max<std::size_t>(8, kMostPushes / std::max<std::size_t>(1, times.size()));
  auto next = pushes.begin();
  for (const double time : times) {
    std::map<Pair, Push> at;
    for (; next != pushes.end() && next->t <= time; ++next) {
      Push& sum = at.try_emplace(next->pair, Push{.impulse = 0}).first->second;
      const double impulse = sum.impulse + next->impulse;
      sum = *next, sum.impulse = impulse;
    }
    std::vector<Push> frame;
    for (const auto& [pair, push] : at) frame.push_back(push);
    std::sort(frame.begin(), frame.end(), [](const Push& a, const Push& b) { return a.impulse > b.impulse; });
    Json list = Json::array();
    for (std::size_t i = 0; i < std::min(most, frame.size()); ++i) {
      const Push& p = frame[i];
      list.push_back({digits_of(p.point.x(), 5), digits_of(p.point.y(), 5), digits_of(p.normal.x(), 4),
                      digits_of(p.normal.y(), 4), digits_of(p.impulse, 4)});
    }
    frames.push_back(std::move(list));
  }
  return frames;
}

/// The drawing of a file: a stranger's, so that only what the page expects is let through.
Json drawing_of(const RecordedRun& run) {
  if (run.drawing.empty()) return points_only(run.columns);
  const auto shallow = [](int depth, Json::parse_event_t /*event*/, const Json& /*parsed*/) {
    if (depth > kDeepest)
      throw std::runtime_error("scene/drawing: brackets nested " + std::to_string(depth) +
                               " deep: must be a drawing that orthant wrote");
    return true;
  };
  Json drawing = Json::parse(run.drawing, shallow, false);
  const bool in_space = is_spatial(drawing);
  for (const char* part :
       {"bodies", in_space ? "solids" : "outlines", in_space ? "joints" : "pins", "contacts", "event_contacts"})
    if (!drawing.is_object() || !drawing.contains(part) || !drawing.at(part).is_array())
      throw std::runtime_error("scene/drawing: must be a drawing that orthant wrote");
  return drawing;
}

}  // namespace

nlohmann::ordered_json view_data(const std::string& name, const std::string& note, const RecordedRun& run,
                                 const nlohmann::ordered_json& drawing) {
  const Json scene = drawing.is_null() ? drawing_of(run) : drawing;
  const bool in_space = is_spatial(scene);
  const std::size_t width = run.columns.size(), rows = run.rows();
  const std::size_t frames =
      std::clamp((in_space ? kMostNumbersInSpace : kMostNumbers) / width, kFewestFrames, kMostFrames);
  const std::size_t every = std::max<std::size_t>(1, (rows + frames - 1) / frames);
  Json values = Json::object();
  std::vector<double> times;  // of the frames
  for (std::size_t i = 0; i < rows; ++i)
    if (i % every == 0 || i + 1 == rows) times.push_back(run.table[i * width]);
  for (std::size_t c = 0; c < width; ++c) {
    Json& column = values[run.columns[c]] = Json::array();
    const bool sum = is_sum(run.columns[c]);
    double collected = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      const double x = run.table[i * width + c];
      collected = sum ? collected + x : x;
      if (i % every != 0 && i + 1 != rows) continue;  // the first and the last are frames
      column.push_back(digits_of(collected, c == 0 ? 12 : 7));
      collected = 0;
    }
  }
  Json events = Json::array();
  for (const RecordedEvent& e : run.events) {
    if (events.size() == kMostListed) break;
    events.push_back({digits_of(e.t, 15), e.kind, e.contact, digits_of(e.normal, 7), digits_of(e.tangent, 7)});
  }
  return {{"name", name},
          {"note", note},
          {"dimension", in_space ? 3 : 2},
          {"rows", rows},
          {"every", every},
          {"scene", scene},
          {"columns", run.columns},
          {"values", values},
          {"events", events},
          {"event_count", run.events.size()},
          {"pushes", run.pushes.empty() ? Json::array() : pushes_by_frame(run.pushes, times)}};
}

std::string view_page(const nlohmann::ordered_json& data) {
  return assembled("view.html", data, data.at("dimension") == 3);
}

}  // namespace orthant
