// experiments/studies/identify/table.h — results table: printed row by row as Markdown, kept as CSV. Texts hold no
// quotation marks.
#pragma once

#include <initializer_list>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace orthant {

class Table {
 public:
  explicit Table(std::initializer_list<const char*> columns) {
    std::string line = "|", rule = "|", heads;
    for (const char* column : columns) {
      line += ' ' + std::string(column) + " |", rule += "---|";
      heads += (heads.empty() ? "" : ",") + quoted(column);
    }
    std::cout << line << '\n' << rule << std::endl;
    csv_ = heads + '\n';
  }
  struct Number {
    double value = 0;
    int digits = 6;  // printed; all are kept
  };
  using Cell = std::variant<std::string, Number, int>;
  void row(const std::vector<Cell>& cells) {
    std::ostringstream line, kept;
    kept << std::setprecision(17);
    for (const Cell& cell : cells) {
      line << (line.tellp() > 0 ? " | " : "| "), kept << (kept.tellp() > 0 ? "," : "");
      if (const auto* number = std::get_if<Number>(&cell)) {
        line << std::setprecision(number->digits) << number->value, kept << number->value;
      } else if (const auto* text = std::get_if<std::string>(&cell)) {
        line << *text, kept << quoted(*text);
      } else {
        line << std::get<int>(cell), kept << std::get<int>(cell);
      }
    }
    std::cout << line.str() << " |" << std::endl;
    csv_ += kept.str() + '\n';
  }
  const std::string& csv() const { return csv_; }

 private:
  static std::string quoted(const std::string& text) {
    return text.find(',') == std::string::npos ? text : '"' + text + '"';
  }
  std::string csv_;
};

}  // namespace orthant
