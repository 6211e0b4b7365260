// experiments/sweep/case.h — sweep case: the inputs of one run, and the row of figures that it gives.
//
//   key = FNV-1a (64 bits) of the text of everything that determines the result: the scene (name and parameters, the
//   text of a file), integrator, solver, step, duration, what is measured and against what, revision, compiler, flags.
//   A tree with changes that are in no revision counts the program itself in.
// Of two different cases in a million the keys are alike with probability 3e-8.
#pragma once

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <nlohmann/json.hpp>

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace orthant {

/// Where a grid lists scenes, its name is a parameter as well: so rows of different scenes are never taken together.
inline constexpr const char* kSceneParameter = "scene";

struct Case {
  std::string scene, scene_text;                                   // built-in name or file; the text of a file
  std::vector<std::pair<std::string, nlohmann::json>> parameters;  // of the scene, by name
  std::string integrator, solver;                                  // specs, without the tolerance below
  std::optional<double> rtol;     // given to the integrator as rtol, with atol = max(rtol / 1000, 1e-15)
  double step = 0, duration = 0;  // [s]
  std::string measure;            // of measures_of(), at the end of the run
  std::string reference;          // "exact" (the slider-crank's table), an integrator's spec, or empty: no error
  std::optional<double> known;    // where the reference is a number or a table: its value; `reference` says where from
  int repeats = 0;                // 0: among others on all cores; else alone on the machine, the fastest of so many
  double time_limit = 60;         // [s] of the run as a whole; determines no result but that it is missing

  std::string integrator_spec() const;
  std::vector<std::string> sets() const;  // KEY=VALUE for make_scene()
  std::string key() const;                // 16 hexadecimal digits
  /// The run that this one is compared with; nothing for "exact", a known value and none.
  std::optional<Case> reference_case() const;
};

/// Results of a run, in the order of columns_of_cases() (results.h): numbers, texts, null where there is no value.
/// Integrators that refuse the scene, unsolved steps, absent references are rows with a "why", no exceptions.
/// Deterministic except "slowest" and "seconds", and "time_limit", which is an input.
using ResultRow = nlohmann::ordered_json;

/// `reference`: the measure of the reference run where that is known, NaN where it failed; else it is run here as well.
ResultRow run_case(const Case& c, std::optional<double> reference = {});

/// The measure that a run gives as a reference; NaN when it is not solved.
double answer_of(const ResultRow& row);

/// The row of a case that did not come to an end (crashed, out of time).
ResultRow unfinished_row(const Case& c, const std::string& status, const std::string& why);

/// The exact measure. Throws std::invalid_argument where the table has none.
double exact_measure(const Case& c);

/// Columns of a trajectory; in space the coordinates of joints too, NAME.angle and NAME.displacement.
std::vector<std::string> measures_of(const Scene& scene);
std::vector<std::string> measures_of(const spatial::Scene& scene);

/// The revision that keys are made of.
std::string revision();

}  // namespace orthant
