// experiments/support/between.h — range check of a real program option; CLI::Range would let NaN pass.
#pragma once

#include <CLI/CLI.hpp>

#include <sstream>
#include <string>

namespace orthant {

inline CLI::Validator between(double least, double most) {
  std::ostringstream range;
  range << '[' << least << ", " << most << ']';
  return CLI::Validator(
      [=, range = range.str()](std::string& text) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
        return good ? std::string() : "'" + text + "': must be in " + range;
      },
      range.str());
}

}  // namespace orthant
