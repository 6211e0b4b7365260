// experiments/report/report.h — results of sweeps as one HTML page that needs nothing else.
//
//   results file → report_data(): JSON → page(): page.html with style, plotting library, data and script put in.
// Everything drawn is drawn by page.js in the browser; nothing here knows of pixels. The sweep's file says what to
// show:
//   [[figure]]     title, x, y: columns of the results or parameters;  by = "integrator" (a line each);
//                  solver, integrator: rows of this one only;  energy_lost and lost_per_turn are columns as well;
//                  log = "xy" | "x" | "y" | "";  dots = true: no lines;  timed = true: rows with times only;  worst =
//                  true: one point a setting,
//                  the worst of all parameters;  octaves = true: a line through the worst of each octave of x;
//                  where = {clearance = 1e-3, integrator = ["…"]}: rows with these values only;
//                  x_label, y_label, note; first: the parameters shown to begin with, as text;
//                  title, note, x, y and labels may be lists: several figures that are alike in the rest
//   [[animation]]  title, note, set = {…}, magnify = "slider" (the body whose gaps are drawn larger), seconds (how long
//                  it plays), duration [s] (default: the sweep's, then the scene's),
//                  runs = [{label, integrator, solver, step, set}, {…}], shown side by side
// Both are checked when the sweep's file is read (experiments/sweep/page.h), animations also when they are shown.
#pragma once

#include "experiments/sweep/results.h"

namespace orthant {

/// About every sweep of the file: question, answer, its rows by column, orders, times, animations (run again, of
/// the built-in scene or of the text that the file holds: no file that it names is opened).
nlohmann::ordered_json report_data(const Results& results);

/// The whole page. Throws std::runtime_error when a part of it is missing (set-up fetches the plotting library).
std::string page(const nlohmann::ordered_json& data);

}  // namespace orthant
