// experiments/report/parts.h — HTML pages that need nothing else: a template with its parts and its data put in.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace orthant {

/// The template NAME with every /*PART*/ that it names replaced by that file, /*data*/ by the data, and <!--space--> by
/// the scripts of animations in space, where there is one. Throws std::runtime_error when a part is missing (set-up
/// fetches the libraries).
std::string assembled(const std::string& name, const nlohmann::ordered_json& data, bool in_space);

/// Where the parts are, from now on. Otherwise: next to the installed program, else in the source tree.
void set_folder_of_parts(const std::filesystem::path& folder);

}  // namespace orthant
