// experiments/cli/error_object.h — bad input as a JSON object: the words, and field, value and rule as parts of them.
//
//   "mine.toml:3: body "b": mass = -1: must be > 0"
//   {"error": …, "where": "mine.toml:3: body \"b\"", "field": "mass", "value": "-1", "rule": "must be > 0"}
// All messages have that form, WHERE: FIELD = VALUE: must RULE, or in place of FIELD = VALUE a word and 'VALUE'. What a
// message does not have is left out.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace orthant {

nlohmann::ordered_json error_object(const std::string& words);

}  // namespace orthant
