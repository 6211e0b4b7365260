// orthant schema — JSON Schema of scene files and of the JSON that commands print.
#include "commands.h"

#include <orthant/core/lcp/solution.h>
#include <orthant/core/mechanics/scene/scene_schema.h>
#include <orthant/integrators/run_fields.h>

#include <nlohmann/json.hpp>

#include <iostream>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

Json typed(const char* type, const std::string& description) { return {{"type", type}, {"description", description}}; }

Json numbers_by_name(const std::string& description, bool may_be_null = false) {
  Json number = {{"type", "number"}};
  if (may_be_null) number["type"] = {"number", "null"};
  return {{"type", "object"}, {"description", description}, {"additionalProperties", number}};
}

/// Of `orthant simulate --json`; the fields of the summary are those of run_fields.h.
Json simulate_schema() {
  Json properties = {{"status", typed("string", "solved, or why the run ended")},
                     {"why", typed("string", "in words, of a run that is not solved")},
                     {"final", numbers_by_name("last record by column")}};
  Run run;
  visit_fields(run, [&](const char* field, const std::string& unit, const std::string& meaning, auto& value) {
    const bool whole = std::is_same_v<std::remove_cvref_t<decltype(value)>, long>;
    properties[field] = typed(whole ? "integer" : "number", unit.empty() ? meaning : meaning + " [" + unit + "]");
  });
  properties["check_against"] = typed("string", "of --check: the repetitions that were compared");
  properties["check_left_out"] = typed("string", "of --check: repetitions that failed");
  properties["check_error"] = numbers_by_name("of --check: estimated errors by column", true);
  properties["check_digits"] = numbers_by_name("of --check: digits that agree, by column");
  properties["warnings"] = {{"type", "array"}, {"items", {{"type", "string"}}}};
  const Json event = {{"type", "object"},
                      {"properties",
                       {{"t", typed("number", "[s]")},
                        {"kind", {{"enum", kEventNames}}},
                        {"contact", typed("string", "name of a contact or collision")},
                        {"impulse_n", typed("number", "[N s]")},
                        {"impulse_t", typed("number", "[N s]")}}},
                      {"required", {"t", "kind", "contact", "impulse_n", "impulse_t"}},
                      {"additionalProperties", false}};
  properties["event_table"] = {{"type", "array"}, {"items", event}};
  return {{"$schema", "http://json-schema.org/draft-07/schema#"},
          {"title", "orthant simulate --json"},
          {"type", "object"},
          {"properties", properties},
          {"required", {"status", "final", "warnings", "event_table"}},
          {"additionalProperties", false}};
}

}  // namespace

void add_schema(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("schema", "JSON Schema of scene files, and of what simulate prints");
  auto what = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("what", *what, "scene: TOML scene files; simulate: orthant simulate --json")
      ->required()
      ->check(CLI::IsMember({"scene", "simulate"}));
  command->add_flag("--json", *json, "a schema is JSON: no difference");
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Example, for completion in an editor with taplo (#:schema ./scene.schema.json as the scene's first line):\n"
      "  orthant schema scene > scene.schema.json");
  command->callback([what, &exit_code] {
    std::cout << (*what == "scene" ? scene_schema() : simulate_schema().dump(2) + "\n");
    exit_code = 0;
  });
}

}  // namespace orthant
