// tests/support/told_time.h — time in a run's message: reads "since t = ..." out of it.
#pragma once

#include <string>

inline double told_time(const std::string& why) {
  const auto at = why.find("since t = ");
  return at == std::string::npos ? -1 : std::stod(why.substr(at + 10));
}
