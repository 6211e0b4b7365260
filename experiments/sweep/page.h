// experiments/sweep/page.h — report settings in a sweep file (experiments/report/report.h),
// checked when the file is read, before anything is computed.
#pragma once

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <nlohmann/json.hpp>

#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace orthant {

/// The columns of results that a figure may have as x, y or by, and those that follow from them.
std::span<const char* const> columns_of_figures();

/// Refuses keys other than `known`: std::invalid_argument naming key, value and what there is. So do those below.
void check_keys(const nlohmann::ordered_json& table, const std::string& where, const std::set<std::string>& known);

/// KEY=VALUE for make_scene().
std::vector<std::string> sets_of(const nlohmann::ordered_json& set);

/// [[figure]]s whose texts are lists: as many figures, one a place of the lists.
nlohmann::ordered_json one_by_one(const nlohmann::ordered_json& figures);

/// [[figure]]: a list of tables; `parameters`: names that the sweep sets, which are columns, too.
void check_figures(const nlohmann::ordered_json& figures, const std::set<std::string>& parameters);

/// The sweep's scene with KEY=VALUE set.
using SceneWith = std::function<AnyScene(const std::vector<std::string>& sets)>;

/// [[animation]]: a list of tables, of runs of a scene; each run of a million steps at most. Of a file's own words, and
/// once more of what a results file holds, which may be anybody's.
void check_animations(const nlohmann::ordered_json& animations, const SceneWith& scene);

}  // namespace orthant
