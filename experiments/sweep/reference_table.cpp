#include "experiments/sweep/reference_table.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/core/support/shortened.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace orthant {
namespace {

constexpr std::uintmax_t kLargestTable = 1 << 30;  // [bytes] a trajectory of millions of rows
constexpr double kSame = 1e-12;                    // relative: decimals that were printed with fewer digits

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const auto first = cell.find_first_not_of(" \t\r"), last = cell.find_last_not_of(" \t\r");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

std::optional<double> number_in(const std::string& cell) {
  char* end = nullptr;
  const double x = std::strtod(cell.c_str(), &end);
  return !cell.empty() && end == cell.c_str() + cell.size() ? std::optional(x) : std::nullopt;
}

bool agrees(const std::string& cell, const nlohmann::json& value) {
  if (!value.is_number()) return cell == (value.is_string() ? value.get<std::string>() : value.dump());
  const auto x = number_in(cell);
  const auto wanted = value.get<double>();
  return x && std::abs(*x - wanted) <= kSame * std::abs(wanted);
}

}  // namespace

ReferenceTable::ReferenceTable(const std::filesystem::path& file) : file_(file.string()) {
  std::istringstream text(read_whole(file, largest_input(kLargestTable)));
  long number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    const auto cells = cells_of(line);
    if (cells.empty() || cells.front().starts_with('#') || (cells.size() == 1 && cells.front().empty())) continue;
    if (columns_.empty()) {
      columns_ = cells;
      continue;
    }
    if (cells.size() != columns_.size())
      throw std::invalid_argument(file_ + ":" + std::to_string(number) + ": has " + std::to_string(cells.size()) +
                                  " columns: must have " + std::to_string(columns_.size()) + ", as the first line");
    rows_.push_back(cells);
  }
  if (rows_.empty()) throw std::invalid_argument(file_ + ": must have a line of names and one row at least");
}

double ReferenceTable::value_for(const Case& c) const {
  const auto place = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(columns_.begin(), columns_.end(), name) - columns_.begin());
  };
  std::size_t measure = place(c.measure);
  if (measure == columns_.size()) measure = place("value");
  if (measure == columns_.size())
    throw std::invalid_argument(file_ + ": has no column \"" + in_one_line(c.measure) + "\" and none \"value\"");
  std::vector<std::pair<std::size_t, nlohmann::json>> conditions;
  if (const std::size_t t = place("t"); t < columns_.size() && t != measure) conditions.emplace_back(t, c.duration);
  for (const auto& [name, value] : c.parameters)
    if (const std::size_t column = place(name); column < columns_.size() && column != measure)
      conditions.emplace_back(column, value);
  const std::vector<std::string>* found = nullptr;
  std::size_t count = 0;
  for (const auto& row : rows_)
    if (std::ranges::all_of(conditions, [&](const auto& one) { return agrees(row[one.first], one.second); }))
      found = &row, ++count;
  std::string of;
  for (const auto& [column, value] : conditions)
    of += (of.empty() ? " with " : ", ") + columns_[column] + " = " + value.dump();
  if (count != 1)
    throw std::invalid_argument(file_ + ": has " + (count == 0 ? "no row" : std::to_string(count) + " rows") + of +
                                ": must have one");
  const auto value = number_in((*found)[measure]);
  if (!value || !std::isfinite(*value))
    throw std::invalid_argument(file_ + ": " + columns_[measure] + " = " + in_one_line((*found)[measure]) + of +
                                ": must be a finite number");
  return *value;
}

}  // namespace orthant
