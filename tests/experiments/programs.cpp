// The programs of experiments/ refuse what they cannot do in one line, before they begin: nothing printed, exit code 1.
#include <doctest/doctest.h>

#include "tests/support/folder.h"
#include "tests/support/sanitized.h"

using namespace orthant;

TEST_CASE("a program refuses what it cannot do in one line, before it begins") {
  if (kSanitized) return;  // they are not built
  const struct {
    std::string command, says;
  } refused[] = {
      {"bare_loop --restitution 2", "--restitution: '2': must be in [0, 1]"},
      {"determinism --only zzz", "--only 'zzz': no run's scene,integrator,solver holds it"},
      {"determinism --table missing.csv", "missing.csv: cannot read: no such file"},
      {"determinism --table err.txt", "err.txt: names no build"},
      {"determinism --pin --only nix", "--only 'nix': no run"},
      {"identify --parts nix", "--parts: nix not in"},
      {"identify --samples 0", "--samples"},
      {"identify --sigma nan", "--sigma: 'nan': must be in"},
      {"identify --parts shot --output /dev/null/x", "cannot create directories"},
      {"lcp_shootout --largest 0", "--largest"},
      {"lcp_shootout --largest 99999999999999999999", "--largest"},
      {"lcp_shootout --families nix", "'nix'"},
      {"lcp_shootout --scenes nix", "'nix'"},
      {"exact_cases --levels 0", "--levels"},
      {"exact_cases --cases Z9", "--cases: no case has this number"},
      {"exact_cases --solvers nix", "solver 'nix'"},
      {"mechanism_scaling --data /dev/null/x", "/dev/null/x: cannot write"},
      {"obstacle_grids --solvers nix", "solver 'nix'"},
      {"pile_scaling --solvers nix", "solver 'nix'"},
      {"pile_scaling --by nix", "solver 'nix'"},
      {"pile_scaling --data x --solvers pgs nix", "solver 'nix'"},
      {"pile_scaling --data /dev/null/x", "/dev/null/x: cannot write"},
      {"pile_scaling --kinds discs", "--kinds requires --data"},
      {"scene_content --solver nix", "solver 'nix'"},
      {"stability --only zzz", "--only 'zzz': no study's name has it"},
      {"stability --dimension 3 --only zzz", "--only 'zzz': no study's name has it"},
      {"stability --dimension 4", "--dimension"},
      {"step_race --finest 1", "--finest: '1': must be in [1e-08, 1e-05]"},
      {"verdict_storm --jobs 0", "--jobs"},
      {"verdict_storm --only -3", "--only"},
      {"verdict_storm --only 99999999999999999999", "--only"},
      {"verdict_storm --solvers nix", "solver 'nix'"},
      {"verdict_storm --only 1 --output /dev/null/x", "cannot create directories"},
      {"tilted_start --omega3 nan", "--omega3: 'nan': must be in"},
      {"tilted_start --integrators moreau-jean nix", "integrator 'nix'"},
      {"time_per_pivot --solvers nix", "solver 'nix'"},
      {"work_precision --nix", "--nix"},
      {"work_precision --integrators nix", "integrator 'nix'"},
      {"work_precision --solver nix", "solver 'nix'"},
  };
  const Folder folder;
  for (const auto& [command, says] : refused) {
    CAPTURE(command);
    const bool optimizers = std::filesystem::exists(ORTHANT_EXPERIMENTS "/identify");  // Ipopt and NLopt
    if (command.starts_with("identify ") && !optimizers) continue;
    const Reply reply = folder.run("'" ORTHANT_EXPERIMENTS "'/" + command);
    CHECK(reply.exit_code == 1);
    CHECK(reply.out == "");
    CHECK(lines(reply.err) == 1);
    CHECK(reply.err.starts_with(command.substr(0, command.find(' ')) + ": "));
    INFO(reply.err);
    CHECK(reply.err.find(says) != std::string::npos);
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 2);  // out.txt, err.txt
  }
}
