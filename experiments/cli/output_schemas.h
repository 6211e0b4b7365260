// experiments/cli/output_schemas.h — JSON Schema (draft 7) of all that commands print with --json.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace orthant {

/// "solve", "results-orders", ...: the command, and the option that changes what it prints.
std::vector<std::string> output_schema_names();
/// Of one of these names.
nlohmann::ordered_json output_schema(const std::string& name);

}  // namespace orthant
