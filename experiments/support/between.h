// experiments/support/between.h — the range of a program's option in real numbers; CLI::Range would let NaN pass.
#pragma once

#include <CLI/CLI.hpp>

#include <sstream>
#include <string>

namespace orthant {

/// `unit` as its words are to name it, with a space before it: " s".
inline CLI::Validator between(double least, double most, const std::string& unit = "") {
  std::ostringstream range;
  range << '[' << least << ", " << most << ']' << unit;
  return CLI::Validator(
      [=, range = range.str()](std::string& text) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
        return good ? std::string() : "'" + text + "': must be in " + range;
      },
      range.str());
}

}  // namespace orthant
