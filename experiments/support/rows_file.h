// experiments/support/rows_file.h — CSV file that a study fills row by row: what is measured stays if the rest fails.
#pragma once

#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace orthant {

/// A cell that may hold commas and quotation marks (RFC 4180).
inline std::string text_cell(const std::string& text) {
  std::ostringstream cell;
  cell << std::quoted(text, '"', '"');
  return cell.str();
}

class RowsFile {
 public:
  /// A new file, or more rows of one with the same first line. Throws std::runtime_error where it cannot be written.
  RowsFile(const std::string& path, bool append, const std::string& columns) : path_(path) {
    std::string first;
    if (append) std::getline(std::ifstream(path), first);
    if (!first.empty() && first != columns) throw std::runtime_error(path + ": has other columns: must be " + columns);
    file_.open(path, append ? std::ios::app : std::ios::trunc);
    if (first.empty()) file_ << columns << std::endl;
    check();
  }

  /// Also on the standard output.
  void row(const std::string& cells) {
    file_ << cells << std::endl;
    check();
    std::cout << cells << std::endl;
  }

 private:
  void check() const {
    if (!file_) throw std::runtime_error(path_ + ": cannot write");
  }
  std::string path_;
  std::ofstream file_;
};

}  // namespace orthant
