// orthant enumerate — every solution of a small problem, exactly.
#include "commands.h"

#include "../support/problem_file.h"

#include <orthant/solvers/enumerate.h>

#include <nlohmann/json.hpp>

#include <iostream>

namespace orthant {
namespace {

std::vector<std::vector<double>> lists(const std::vector<Vector>& vectors) {
  std::vector<std::vector<double>> all;
  for (const Vector& x : vectors) all.emplace_back(x.data(), x.data() + x.size());
  return all;
}

int run_enumerate(const std::string& file, bool as_json) {
  const SolutionSet set = enumerate_solutions(read_problem_file(file));
  nlohmann::ordered_json json = {{"isolated", lists(set.isolated)}, {"faces", nlohmann::ordered_json::array()}};
  for (const SolutionFace& f : set.faces)
    json["faces"].push_back({{"dimension", f.dimension},
                             {"vertices", lists(f.vertices)},
                             {"directions", lists(f.directions)},
                             {"lines", lists(f.lines)}});
  if (as_json) {
    std::cout << json.dump(2) << '\n';
  } else {
    std::cout << set.isolated.size() << " isolated, " << set.faces.size() << " faces of solutions\n";
    for (const auto& z : json["isolated"]) std::cout << "z = " << z << '\n';
    for (const auto& face : json["faces"]) std::cout << "face = " << face << '\n';
  }
  return set.isolated.empty() && set.faces.empty() ? exit_code_of(Status::infeasible) : 0;
}

}  // namespace

void add_enumerate(CLI::App& app, int& exit_code) {
  auto file = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("enumerate", "All solutions of a small problem (20 rows, 12 of them boxes)");
  command->add_option("problem", *file, "JSON problem file or FCLIB file (.hdf5)")->required();
  command->add_flag("--json", *json, "answer as one JSON object");
  command->callback([file, json, &exit_code] { exit_code = run_enumerate(*file, *json); });
}

}  // namespace orthant
