// experiments/sweep/reference_table.h — reference values of a sweep from a CSV file.
//
//   The first line names the columns. One is the measure ("crank.theta"), or "value". Rows are chosen by the columns
//   with a parameter's name, where the value must be the case's, and by "t", which must be its duration: so a
//   trajectory of `orthant simulate --output` serves as it is. Exactly one row must be left. Lines that begin with #
//   are comments.
#pragma once

#include "experiments/sweep/case.h"

#include <filesystem>

namespace orthant {

class ReferenceTable {
 public:
  /// Throws std::invalid_argument naming file, line and rule.
  explicit ReferenceTable(const std::filesystem::path& file);

  /// Throws std::invalid_argument where no row, or more than one, is of the case.
  double value_for(const Case& c) const;

 private:
  std::string file_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace orthant
