#include "experiments/cli/output_schemas.h"

#include <orthant/core/lcp/solution.h>
#include <orthant/integrators/capabilities.h>
#include <orthant/integrators/run_fields.h>

#include <functional>
#include <utility>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;

Json with_words(Json schema, const std::string& words) {
  if (!words.empty()) schema["description"] = words;
  return schema;
}
Json text(const std::string& words = "") { return with_words({{"type", "string"}}, words); }
Json number(const std::string& words = "") { return with_words({{"type", "number"}}, words); }
Json whole(const std::string& words = "") { return with_words({{"type", "integer"}}, words); }
Json flag(const std::string& words = "") { return with_words({{"type", "boolean"}}, words); }
Json list(const Json& items, const std::string& words = "") {
  return with_words({{"type", "array"}, {"items", items}}, words);
}
Json maybe(Json schema) {  // or null: no finite number
  schema["type"] = {schema.at("type"), "null"};
  return schema;
}
Json one_of(std::vector<std::string> words, const std::string& description = "") {
  return with_words({{"enum", std::move(words)}}, description);
}
Json by_name(const Json& value, const std::string& words) {
  return with_words({{"type", "object"}, {"additionalProperties", value}}, words);
}

/// An object with these keys and no others; "key?" may be absent.
Json object(const std::vector<std::pair<std::string, Json>>& keys, const std::string& words = "") {
  Json properties = Json::object(), required = Json::array();
  for (const auto& [key, schema] : keys) {
    const bool optional = key.ends_with('?');
    const std::string name = optional ? key.substr(0, key.size() - 1) : key;
    properties[name] = schema;
    if (!optional) required.push_back(name);
  }
  return with_words({{"type", "object"},
                     {"properties", std::move(properties)},
                     {"required", std::move(required)},
                     {"additionalProperties", false}},
                    words);
}

Json status() { return text("solved, rounded, infeasible, ray, iteration_limit, ... (statuses.md)"); }
Json rows(const std::string& words) { return list(whole(), words + ", from 0"); }
/// Where doubles may overflow: a number, or the text "inf" or "-inf".
Json extended() { return {{"anyOf", {number(), one_of({"inf", "-inf"})}}}; }

Json simulate() {
  std::vector<std::pair<std::string, Json>> keys = {{"status", text("solved, or why the run ended")},
                                                    {"why?", text("in words, of a run that is not solved")},
                                                    {"final", by_name(number(), "last record by column")}};
  Run run;
  visit_fields(run, [&](const std::string& field, const std::string& unit, const std::string& meaning, auto& value) {
    const std::string words = unit.empty() ? meaning : meaning + " [" + unit + "]";
    constexpr bool kWhole = std::is_same_v<std::remove_cvref_t<decltype(value)>, long>;
    keys.emplace_back(field + "?", kWhole ? whole(words) : number(words));
  });
  keys.insert(keys.end(), {{"check_against?", text("of --check: the repetitions that were compared")},
                           {"check_left_out?", text("of --check: repetitions that failed")},
                           {"check_error?", by_name(maybe(number()), "of --check: estimated errors by column")},
                           {"check_digits?", by_name(number(), "of --check: digits that agree, by column")},
                           {"warnings", list(text())},
                           {"event_table?", list(object({{"t", number("[s]")},
                                                         {"kind", {{"enum", kEventNames}}},
                                                         {"contact", text("name of a contact or collision")},
                                                         {"impulse_n", number("[N s]")},
                                                         {"impulse_t", number("[N s]")}}))}});
  return object(keys);
}

Json solve() {
  const Json vector = list(maybe(number()));
  return object(
      {{"status", status()},
       {"residual", maybe(number("how far a w_i is from what its z_i allows, at most; units of w"))},
       {"residual_scale_free?", maybe(number("of friction discs, in units of each contact"))},
       {"residual_natural?", maybe(number("of friction discs"))},
       {"rounding", maybe(number("w cannot be known below this"))},
       {"iterations", whole()},
       {"factorizations", whole()},
       {"seconds", number("[s] of wall time")},
       {"solver", text()},
       {"z", with_words(vector, "the solution, or the last z")},
       {"w", with_words(vector, "M z + q")},
       {"certificate",
        maybe(with_words(vector,
                         "u that proves that there is no solution, as it is or as the doubles nearest to an exact u"))},
       {"velocity?", with_words(vector, "of --velocity")},
       {"facets?", object({{"sides", whole()},
                           {"pyramid_status", status()},
                           {"disc_status", status()},
                           {"distance_z?", maybe(number())},
                           {"distance_w?", maybe(number())}},
                          "of --facets: how far the pyramid's answer is from the disc's")},
       {"cells?", object({{"count", number("choices of sides")},
                          {"order", rows("rows in the order of decision")},
                          {"classes", list(object({{"sides", text("a letter a row: L lower, I inside, U upper")},
                                                   {"expressed", whole()},
                                                   {"why", text()},
                                                   {"row", whole()}}))}},
                         "the search of all choices of sides, where that is the proof")},
       {"why?", text("why the status is not solved")},
       {"active_set?", object({{"lower", rows("rows at their lower bounds")},
                               {"inside", rows("rows between their bounds")},
                               {"upper", rows("rows at their upper bounds")},
                               {"degenerate", rows("rows at a bound with w = 0")}})},
       {"uniqueness?", one_of({"isolated", "maybe not unique", "not decided"})},
       {"error_bound?", maybe(number("of --error-bound; null: none is known"))},
       {"why_not?", text("why the solver does not take the problem")},
       {"log?",
        list(object(
            {{"iteration", whole()}, {"merit", maybe(number())}, {"step", maybe(number())}, {"event", text()}}))}});
}

Json analyse() {
  const Json verdict = one_of({"yes", "no", "not decided"});
  std::vector<std::pair<std::string, Json>> keys = {{"n", whole("rows")}};
  for (const char* property : {"symmetric", "positive definite", "positive semidefinite", "diagonally dominant", "Z",
                               "K", "H+", "P", "P0", "copositive", "column sufficient", "row sufficient"})
    keys.emplace_back(property, verdict);
  keys.insert(keys.end(), {{"rank", {{"anyOf", {whole(), one_of({"not decided"})}}}},
                           {"smallest entry", number("of |M_ij|, zeros left out")},
                           {"largest entry", number()},
                           {"condition", {{"anyOf", {number(), one_of({"infinite", "not decided"})}}}},
                           {"minor not positive?", rows("rows of a principal minor that is not positive")}});
  return object(keys);
}

Json enumerate() {
  const Json points = list(list(extended()));
  return object({{"isolated", points},
                 {"faces", list(object({{"dimension", whole()},
                                        {"vertices", points},
                                        {"directions", with_words(points, "nonnegative multiples belong to the face")},
                                        {"lines", with_words(points, "any multiples belong to the face")}}))},
                 {"complete", flag("false: the time was over, there may be more")}});
}

Json replay() {
  return list(object({{"solver", text()},
                      {"status", status()},
                      {"residual", maybe(number("units of w"))},
                      {"iterations", whole()},
                      {"seconds", number("[s] of wall time")},
                      {"why_not", text("why the solver does not take the problem, or empty")}}));
}

Json list_of_names() {
  const Json value = Json::object();  // a number, a word, true or false
  const Json option = object({{"name", text()},
                              {"default", value},
                              {"range?", {{"type", "array"}, {"minItems", 2}, {"maxItems", 2}}},
                              {"choices?", list(text())}});
  std::vector<std::pair<std::string, Json>> can;
  Capabilities{}.visit([&](const char* name, bool, const char* words) { can.emplace_back(name, flag(words)); });
  const auto entries = [&](const std::vector<std::pair<std::string, Json>>& more) {
    std::vector<std::pair<std::string, Json>> keys = {{"name", text()}, {"summary", text()}, {"options", list(option)}};
    keys.insert(keys.end(), more.begin(), more.end());
    return list(object(keys));
  };
  return object({{"solvers?", entries({})},
                 {"integrators?", entries({{"can", object(can, "what scenes it takes")}})},
                 {"scenes?", entries({})},
                 {"spatial_scenes?", entries({})},
                 {"summary?", list(object({{"name", text()}, {"unit", text()}, {"meaning", text()}}))}});
}

Json check_scene() {
  return object({{"dimension", whole("2, or 3: in space")},
                 {"bodies", whole()},
                 {"mass", number("[kg]")},
                 {"joints", whole()},
                 {"joint_rows", whole("equations of the joints")},
                 {"contacts", whole()},
                 {"collisions", whole()},
                 {"pairs", whole("of bodies that collisions search")},
                 {"mobility_gruebler", whole("3 bodies - joint_rows; in space 6 bodies - joint_rows")},
                 {"mobility_rank?", whole("degrees of freedom by the rank of the joints' rows")},
                 {"rank?", whole("of the joints' rows")},
                 {"redundant_rows?", text("in words, or empty")},
                 {"drives", list(text())},
                 {"jam", text("drives and stops that contradict each other, or empty")},
                 {"clearances", by_name(number(), "[m] by contact")},
                 {"warnings", list(text())},
                 {"suggested_integrator", text()},
                 {"why", text("this integrator")},
                 {"suggested_step", number("[s]")}});
}

Json sweep() {
  return object({{"sweep", text()},
                 {"results", text("the SQLite file")},
                 {"cases", whole()},
                 {"new", whole("cases that were run now")},
                 {"not_solved", whole()}});
}

/// A case of a sweep: its keys and parameters, and what the run gave.
Json result_row(const char* more = nullptr) {
  Json row = {{"type", "object"},
              {"properties",
               {{"sweep", text()},
                {"key", text("of the case: a hash of all that determines it")},
                {"scene", text()},
                {"integrator", text()},
                {"solver", text()},
                {"step", number("[s]")},
                {"rtol", maybe(number())},
                {"duration", number("[s]")},
                {"measure", text("column of the run")},
                {"compared_with", text("the reference, or empty")},
                {"repeats", whole()},
                {"time_limit", number("[s]")},
                {"revision", text()},
                {"status", status()},
                {"why", maybe(text())},
                {"value", maybe(number("of the measure at the end"))},
                {"reference", maybe(number())},
                {"error", maybe(number())},
                {"seconds", maybe(number("[s] of processor time"))}}},
              {"required", {"sweep", "key", "scene", "integrator", "solver", "step", "status"}},
              {"additionalProperties", {{"type", {"number", "string", "boolean", "null"}}}}};
  row["description"] = "further keys are the parameters of --set, and fields of the run's summary";
  if (more != nullptr) {
    row["properties"][more] = maybe(text("file with the problem that was not solved"));
    row["required"].push_back(more);
  }
  return list(row);
}

Json orders() {
  return list(with_words({{"type", "object"},
                          {"properties",
                           {{"sweep", text()},
                            {"integrator", text()},
                            {"solver", text()},
                            {"order", number("slope of the worst error by octave against the step")},
                            {"scatter", number("[ln]")},
                            {"failed", whole("cases")},
                            {"worst", list(list(number()), "[step, worst error] of each octave")},
                            {"worst_error_finest_octave", number()},
                            {"h_finest_octave", number("[s]")}}},
                          {"required", {"sweep", "integrator", "solver", "order", "scatter", "failed", "worst"}},
                          {"additionalProperties", {{"type", {"number", "string", "boolean", "null"}}}}},
                         "further keys are the parameters of --set"));
}

Json times() {
  return list({{"type", "object"},
               {"properties", {{"sweep", text()}, {"integrator", text()}, {"solver", text()}}},
               {"required", {"sweep", "integrator", "solver"}},
               {"patternProperties", {{"^to_", maybe(number("[s] to this error; null: not reached"))}}},
               {"additionalProperties", false}});
}

Json version() {
  return object({{"version", text()},
                 {"revision", text()},
                 {"compiler", text()},
                 {"flags", text()},
                 {"cpu", text()},
                 {"cores", whole()},
                 {"packages", by_name(text(), "versions of libraries")},
                 {"backends", by_name(flag(), "whether the optional libraries are built in")}});
}

Json bad_input() {
  return object({{"error", text("in one line; also on standard error")},
                 {"where?", text("file and line, element")},
                 {"field?", text()},
                 {"value?", text("that was given")},
                 {"rule?", text("for it")}});
}

struct Entry {
  const char *name, *command;
  std::function<Json()> schema;
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = {
      {"version", "--version --json", version},
      {"error", "COMMAND --json with bad input", bad_input},
      {"solve", "solve --json", solve},
      {"analyse", "analyse --json", analyse},
      {"enumerate", "enumerate --json", enumerate},
      {"replay", "replay --json", replay},
      {"simulate", "simulate --json", simulate},
      {"list", "list --json", list_of_names},
      {"check", "check --json", check_scene},
      {"sweep", "sweep --json", sweep},
      {"sweep-list", "sweep --list --json", [] { return list(text("key of a case that is missing")); }},
      {"results", "results --json", [] { return result_row(); }},
      {"results-failures", "results --failures --json", [] { return result_row("dump"); }},
      {"results-orders", "results --orders --json", orders},
      {"results-times", "results --times --json", times},
      {"report", "report --json",
       [] {
         return object({{"report", text("the page")}});
       }},
      {"view", "view --json",
       [] {
         return object({{"view", text("the page")}, {"bytes", whole()}, {"status", status()}});
       }},
      {"new", "new --json",
       [] {
         return object({{"scene", text("the file")}});
       }},
      {"gradient", "gradient --json",
       [] {
         return object({{"status", status()},
                        {"why?", text("why the status is not solved")},
                        {"t", number("[s] reached")},
                        {"values?", by_name(number(), "by column of --of, at the end")},
                        {"derivatives?", by_name(by_name(number(), "by parameter of --wrt"), "by column of --of")},
                        {"warnings", list(text())}});
       }},
      {"lyapunov", "lyapunov --json",
       [] {
         return object({{"status", status()},
                        {"why?", text("why the status is not solved")},
                        {"t", number("[s] reached")},
                        {"exponents?", list(maybe(number("[1/s]; null: minus infinity")), "the largest first")},
                        {"last_half?", list(maybe(number("[1/s]")), "of the second half of the time")}});
       }},
      {"import", "import --json",
       [] {
         return object({{"scene?", text("the file, of --output")},
                        {"toml?", text("its text, otherwise")},
                        {"notes", list(text(), "what of the model the scene has not, or has in another form")}});
       }},
      {"completion", "completion --json", [] { return by_name(text(), "the script by shell"); }},
      {"man", "man --json",
       [] {
         return object({{"page", text("for troff")}});
       }},
  };
  return all;
}

}  // namespace

std::vector<std::string> output_schema_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) names.emplace_back(entry.name);
  return names;
}

nlohmann::ordered_json output_schema(const std::string& name) {
  for (const Entry& entry : entries()) {
    if (name != entry.name) continue;
    Json whole_schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                         {"title", std::string("orthant ") + entry.command}};
    whole_schema.update(entry.schema());
    return whole_schema;
  }
  throw std::invalid_argument("no schema '" + name + "'");
}

}  // namespace orthant
