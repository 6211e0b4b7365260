#include "experiments/cli/error_object.h"

#include <nlohmann/json.hpp>

#include <string_view>

namespace orthant {

nlohmann::ordered_json error_object(const std::string& words) {
  nlohmann::ordered_json object = {{"error", words}};
  const auto must = words.find(": must ");
  if (must == std::string::npos) return object;
  std::string_view where = std::string_view(words).substr(0, must), last = where;
  const auto cut = [&] {  // off the last part of `where`
    const auto colon = where.rfind(": ");
    last = colon == std::string_view::npos ? where : where.substr(colon + 2);
    where = colon == std::string_view::npos ? std::string_view() : where.substr(0, colon);
  };
  cut();
  std::string_view field = last, value;
  bool given = true;
  if (const auto equals = last.find(" = "); equals != std::string_view::npos) {
    field = last.substr(0, equals), value = last.substr(equals + 3);
  } else if (const auto quote = last.find('\''); quote != std::string_view::npos && last.ends_with('\'')) {
    value = last.substr(quote + 1, last.size() - quote - 2), field = last.substr(0, quote);
    if (field.empty()) cut(), field = last;
    if (field.starts_with("unknown ")) field.remove_prefix(8);
    while (field.ends_with(' ')) field.remove_suffix(1);
  } else {
    given = false;
  }
  if (field.starts_with("option ")) field.remove_prefix(7);
  if (!where.empty()) object["where"] = where;
  if (!field.empty()) object["field"] = field;
  if (given) object["value"] = value;
  object["rule"] = words.substr(must + 2);
  return object;
}

}  // namespace orthant
