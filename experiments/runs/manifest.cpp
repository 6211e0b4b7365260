#include "experiments/runs/manifest.h"

#include "orthant_build.h"

#include <SuiteSparse_config.h>
#include <toml++/toml.h>
#include <CLI/Version.hpp>
#include <Eigen/Core>

#include <chrono>
#include <ctime>
#include <fstream>
#include <thread>

namespace orthant {
namespace {

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

template <class... Numbers> std::string version(Numbers... numbers) {
  std::string text;
  ((text += (text.empty() ? "" : ".") + std::to_string(numbers)), ...);
  return text;
}

}  // namespace

nlohmann::ordered_json manifest() {
  return {{"version", ORTHANT_VERSION},
          {"revision", ORTHANT_REVISION},
          {"compiler", ORTHANT_COMPILER},
          {"flags", ORTHANT_FLAGS},
          {"cpu", cpu_model()},
          {"cores", std::thread::hardware_concurrency()},
          {"packages",
           {{"Eigen", version(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
            {"SuiteSparse", version(SUITESPARSE_MAIN_VERSION, SUITESPARSE_SUB_VERSION, SUITESPARSE_SUBSUB_VERSION)},
            {"nlohmann_json",
             version(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
            {"toml++", version(TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH)},
            {"CLI11", CLI11_VERSION}}},
          {"written", utc_now()}};
}

}  // namespace orthant
