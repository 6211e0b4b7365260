// core/support/registered.h — names and texts of registered rows: checked, and kept as long as the process lives.
#pragma once

#include <orthant/core/support/shortened.h>

#include <algorithm>
#include <deque>
#include <stdexcept>
#include <string>
#include <string_view>

namespace orthant {

inline std::string_view kept_text(std::string_view text) {
  static std::deque<std::string> all;
  return all.emplace_back(text);
}

/// The name, kept; throws std::invalid_argument where it is taken or made of other than a–z, 0–9, - and `also`.
template <class Rows> std::string_view registered_name(std::string_view kind, std::string_view name, const Rows& rows,
                                                       std::string_view also = "") {
  const auto good = [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || also.find(c) != also.npos;
  };
  const std::string what = std::string(kind) + " '" + shortened(name) + "'";
  if (name.empty() || !std::all_of(name.begin(), name.end(), good))
    throw std::invalid_argument(what + ": a name must be of a-z, 0-9, -" + (also.empty() ? "" : " and ") +
                                std::string(also));
  for (const auto& row : rows)
    if (row.name == name) throw std::invalid_argument(what + ": is registered already");
  return kept_text(name);
}

}  // namespace orthant
