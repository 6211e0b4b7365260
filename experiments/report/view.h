// experiments/report/view.h — one run as one HTML page that needs nothing else: motion, forces, columns, events.
//
//   run → view_data(): JSON → view_page(): view.html with style, plotting library, scripts and data put in.
//   JSON  name, note; dimension: 2 or 3; scene: drawing.h; columns: names; values: numbers by column, of at most 1200
//         frames (impulses summed over a frame, of others the last); events: [t, kind, contact, normal, tangential];
//         event_count; pushes: [[x, y, nx, ny, impulse] of each pair of searched collisions that pushed, in the plane]
//         by frame, the strongest
#pragma once

#include "experiments/runs/recorded_run.h"

#include <orthant/core/mechanics/scene/scene.h>

#include <nlohmann/json.hpp>

#include <string_view>

namespace orthant {

/// `note`: the page's first line about the run. `drawing`: of drawing.h; null: the run's own, else bodies as
/// points.
nlohmann::ordered_json view_data(const std::string& name, const std::string& note, const RecordedRun& run,
                                 const nlohmann::ordered_json& drawing = nullptr);

/// Near the begin of each page, and of no other file.
inline constexpr std::string_view kViewMark = "<title>Orthant: a run</title>";

/// The whole page, at most 2 MB of most runs.
std::string view_page(const nlohmann::ordered_json& data);

}  // namespace orthant
