// experiments/sweep/sweep.h — sweep definition from a TOML file: scene, integrators, solvers, parameter grid.
//
//   question  = "…"                       what the sweep answers; the report begins with it
//   scene     = "slider_crank"            built-in name, or a file's path from the sweep file's folder; of every grid
//             that
//                                         has no scenes of its own
//   duration  = 0.2                       [s]; default: the scene's
//   measure   = "crank.theta"             a column of `orthant simulate --output`, at the end of the run
//   reference = "exact"                   the slider-crank's table; or an integrator that is run once for all cases of
//   the
//                                         same scene: "event-driven:rtol=1e-12"; or a number, of all cases; or a table
//                                         in the sweep file's folder, "truth.csv" (reference_table.h); default: no
//                                         errors
//   [[grid]]                              every combination of what the lists hold; a value by itself is a list of one
//   scene      = ["chain", "n_four_bar"]  these instead of the above; the name is then a parameter of the rows
//   duration   = 20                       [s] instead of the above
//   integrator = ["rattle", "moreau-jean:theta=0.6"]
//   solver     = ["auto"]                 default
//   step       = {from = 1e-3, to = 1e-6, count = 20, scale = "log"}   [s] moved so that it divides the duration;
//                                         default: the scene's.  scale: "linear" (default) or "log"
//   rtol       = [1e-3, 1e-6]             for integrators to a tolerance; atol = max(rtol / 1000, 1e-15)
//   set        = {mu = [0, 0.1]}          parameters of the scene; of a scene file: "contact.corner1.mu" = […]
//   repeats    = 3                        runs alone, timed in processor time, the fastest counts (of those longer
//                                         than 0.1 s two), the slowest is kept, too; default 0: on all cores, not timed
//   time_limit = 60                       [s] a case; past it a failure; a later run with more time repeats it
//   quick      = {step = …, set = {…}}    what --quick puts in place of the above; quick = false leaves the grid out
//   [[figure]], [[animation]]             what the report shows: experiments/report/report.h
// Everything wrong throws std::invalid_argument naming file, key, value and rule.
#pragma once

#include "experiments/sweep/case.h"

#include <filesystem>

namespace orthant {

struct Sweep {
  std::string name;             // the file's, without .sweep.toml
  std::string question, scene;  // the scene as the file names it, or empty
  std::string scene_text;       // what that file holds; empty: a built-in scene
  std::vector<Case> cases;      // in the order of the file; no two alike
  nlohmann::ordered_json page;  // figures and animations as they stand in the file

  /// The runs that cases are compared with: each once, with the longest time limit of those that need it.
  std::vector<Case> reference_cases() const;
};

Sweep read_sweep(const std::filesystem::path& file, bool quick);

}  // namespace orthant
