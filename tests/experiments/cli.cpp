// The command line as its users meet it: exit codes, JSON, files, and one clear line for bad input.
#include <orthant/core/scenes/slider_crank_exact.h>

#include <H5Cpp.h>
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <nlohmann/json.hpp>

#include "tests/support/folder.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace fs = std::filesystem;
using orthant::Folder, orthant::Reply, orthant::lines, orthant::slurp;

namespace {

struct Cli : Folder {
  Reply orthant(const std::string& arguments) const { return run("'" ORTHANT_CLI "' " + arguments); }
};

}  // namespace

TEST_CASE("orthant simulate: summary and trajectory of the slider-crank") {
  const Cli folder;
  const Reply a = folder.orthant("simulate slider_crank --step 1e-5 --output run.csv --every 100 --json");
  CHECK(a.exit_code == 0);
  CHECK(a.err.empty());
  const auto json = nlohmann::json::parse(a.out);
  CHECK(json.at("status") == "solved");
  CHECK(json.at("steps") == 20000);
  for (const char* key : {"seconds", "energy_initial", "energy_final", "max_joint_residual", "max_penetration",
                          "max_lcp_residual", "lcp_solves", "lcp_iterations"})
    CHECK(json.at(key).is_number());
  const auto exact = orthant::slider_crank_exact(0.01, 0.4);
  CHECK(std::abs(json.at("final").at("crank.theta").get<double>() - exact->theta1) < 2e-3);
  CHECK(json.at("energy_initial").get<double>() == doctest::Approx(7.49554875).epsilon(1e-12));

  const std::string csv = slurp(folder / "run.csv");
  CHECK(csv.starts_with("t,crank.x,crank.y,crank.theta,crank.vx,crank.vy,crank.omega,rod.x"));
  CHECK(lines(csv) == 1 + 201);  // header, start, 200 records
  const std::string header = csv.substr(0, csv.find('\n'));
  CHECK(static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1 == json.at("final").size());
}

TEST_CASE("orthant simulate: parameters by --set change the run; same input gives the same bytes") {
  const Cli folder;
  folder.orthant("simulate slider_crank --step 1e-4 --output a.csv");
  folder.orthant("simulate slider_crank --step 1e-4 --output b.csv");
  folder.orthant("simulate slider_crank --step 1e-4 --output c.csv --set mu=0.1 --set e=0");
  CHECK(slurp(folder / "a.csv") == slurp(folder / "b.csv"));
  CHECK(slurp(folder / "a.csv") != slurp(folder / "c.csv"));
}

TEST_CASE("orthant simulate: a failed step stops the run and leaves its problem to replay") {
  const Cli folder;
  const Reply a = folder.orthant("simulate slider_crank --solver pgs:max_sweeps=1 --step 1e-5 --json");
  CHECK(a.exit_code == 3);
  const auto json = nlohmann::json::parse(a.out);
  CHECK(json.at("status") != "solved");
  const long failed = json.at("steps").get<long>() + 1;
  CHECK(a.err.find("failed_step_" + std::to_string(failed) + ".json") != std::string::npos);
  const Reply again = folder.orthant("simulate slider_crank --solver pgs:max_sweeps=1 --step 1e-5 --set mu=0.1");
  CHECK(again.exit_code == 3);  // the first one's is not written over
  CHECK(again.err.find("failed_step_" + std::to_string(failed) + "_2.json") != std::string::npos);
  const Reply late = folder.orthant("simulate slider_crank --step 1e-9 --time-limit 0.05");
  CHECK((late.exit_code == 3 && late.err.find("time_limit") != std::string::npos));
  CHECK(late.err.find(".json") == std::string::npos);  // no problem failed
  const Reply replay = folder.orthant("solve failed_step_" + std::to_string(failed) + ".json --json");
  CHECK(replay.exit_code == 0);
  CHECK(nlohmann::json::parse(replay.out).at("status") == "solved");
}

TEST_CASE("bad input: exit code 1, one line that says what and where, nothing half-written") {
  const Cli folder;
  const std::string body = "[[body]]\nname = 'b'\nmass = 1\ninertia = 1\n";
  folder.write("negative.toml", "[[body]]\nname = 'b'\nmass = -1\ninertia = 1\n");
  folder.write("unknown.toml", body + "masss = 2\n");
  folder.write("nan.toml", "[[body]]\nname = 'b'\nmass = nan\ninertia = 1\n");
  folder.write("missing_body.toml", body +
                                        "[[contact]]\ntype = 'corner-wall'\nname = 'c'\nbody = 'nobody'\n"
                                        "point = [0, 0]\nwall = {body = 'ground', point = [0, 0], normal = [0, 1]}\n");
  folder.write("one_body.toml", body), folder.write("kept.csv", body);
  REQUIRE(::mkfifo((folder.path / "pipe").c_str(), 0600) == 0);
  folder.write("broken.toml", "gravity = [0, \n");
  folder.write("nonsquare.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\n2\n");
  folder.write("q.mtx", "%%MatrixMarket matrix array real general\n2 1\n-1\n-1\n");
  folder.write("nan.mtx", "%%MatrixMarket matrix array real general\n1 1\nnan\n");
  folder.write("q1.mtx", "%%MatrixMarket matrix array real general\n1 1\n-1\n");

  const std::array<std::array<std::string, 2>, 31> bad = {{
      {"simulate no_such_scene", "no_such_scene"},
      {"simulate missing.toml", "missing.toml"},
      {"simulate negative.toml", "mass"},
      {"simulate unknown.toml", "masss"},
      {"simulate nan.toml", "mass"},
      {"simulate missing_body.toml", "nobody"},
      {"simulate broken.toml", "broken.toml"},
      {"simulate slider_crank --step 0", "step"},
      {"simulate slider_crank --step ''", "--step: must not be empty"},
      {"simulate slider_crank --output ''", "--output: must not be empty"},
      {"simulate kept.csv --output ./kept.csv", "--output './kept.csv' and the scene 'kept.csv': must be two files"},
      {"simulate one_body.toml --checkpoint one_body.toml", "one_body.toml: is no checkpoint, and would be lost"},
      {"report kept.csv --output kept.csv", "--output 'kept.csv' and the results 'kept.csv': must be two files"},
      {"results pipe", "pipe: it is no regular file"},
      {"simulate slider_crank --step -1e-3", "step"},
      {"simulate slider_crank --step nan", "step"},
      {"simulate slider_crank --step 1e-5x", "step"},
      {"simulate slider_crank --duration 0", "duration"},
      {"simulate slider_crank --every 0", "every"},
      {"simulate slider_crank --every 99999999999999999999", "every"},
      {"simulate slider_crank --set mu=0.1 --set mu=0.2", "mu=0.2': is given twice"},
      {"simulate one_body.toml --set gravity=[0,0] --set gravity=[0,1]", "override gravity=[0,1]: is given twice"},
      {"simulate slider_crank --set mu=-1", "mu"},
      {"simulate slider_crank --set nu=1", "nu"},
      {"simulate slider_crank --set mu", "KEY=VALUE"},
      {"simulate slider_crank --solver nobody", "nobody"},
      {"simulate slider_crank --integrator nobody", "nobody"},
      {"simulate slider_crank --output no/such/folder.csv", "no/such"},
      {"simulate slider_crank --output run.vtk", "run.vtk: must end in .csv, .h5, .hdf5 or .pvd"},
      {"solve --matrix nonsquare.mtx --vector q.mtx", "nonsquare.mtx"},
      {"solve --matrix nan.mtx --vector q1.mtx", "nan.mtx"},
  }};
  for (const auto& [arguments, word] : bad) {
    CAPTURE(arguments);
    const Reply a = folder.orthant(arguments + " --json");
    CAPTURE(a.err);
    CHECK(a.exit_code == 1);
    CHECK(a.out.empty());
    CHECK(lines(a.err) == 1);
    CHECK(a.err.starts_with("orthant: "));
    CHECK(a.err.find(word) != std::string::npos);
  }
  for (const char* arguments : {"", "sing", "simulate", "solve", "list cats"}) {
    CAPTURE(arguments);
    const Reply a = folder.orthant(arguments);
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
  }
}

TEST_CASE("files that are taken for something else are refused, or read as what they say") {
  const Cli folder;
  const std::string banner = "%%MatrixMarket matrix coordinate real ";
  folder.write("long.mtx", banner + "general\n%" + std::string(1100, ' ') + "9 9 9\n1 1 1\n1 1 2\n");
  folder.write("upper.mtx", banner + "symmetric\n2 2 3\n1 1 2\n1 2 1\n2 2 2\n");
  folder.write("skew.mtx", banner + "skew-symmetric\n2 2 1\n1 1 5\n");
  folder.write("M.mtx", banner + "symmetric\n2 2 3\n1 1 2\n2 1 1\n2 2 2\n");
  folder.write("q.mtx", banner + "general\n2 1 1\n1 1 -3\n");
  folder.write("nested.json", R"({"format": "orthant-lcp", "version": 1, "b": )" + std::string(100000, '[') + "1");
  folder.write("twice.json", R"({"format": "orthant-lcp", "version": 1, "b": [1], "b": [2]})");
  for (const char* arguments : {"solve --matrix long.mtx --vector q.mtx", "solve --matrix upper.mtx --vector q.mtx",
                                "solve --matrix skew.mtx --vector q.mtx", "solve nested.json", "solve twice.json",
                                "solve /dev/zero", "solve .", "simulate slider_crank --set 'a\nb=1'"}) {
    CAPTURE(arguments);
    const Reply a = folder.orthant(arguments);
    CAPTURE(a.err);
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
  }
  const Reply good = folder.orthant("solve --matrix M.mtx --vector q.mtx --json");
  CHECK(good.exit_code == 0);
  CHECK(nlohmann::json::parse(good.out).at("z") == nlohmann::json::parse("[1.5, 0.0]"));
}

TEST_CASE(
    "files over the limit are refused with its name; --max-input, before or after the command, is another limit") {
  const Cli folder;
  const std::string blanks(2000, ' '), body = "[[body]]\nname = 'b'\nmass = 1\ninertia = 1\n";
  folder.write("p.json", R"({"format": "orthant-lcp", "version": 1,
    "A": {"storage": "dense", "n": 1, "rows": [[2]]}, "b": [-1]})" +
                             blanks);
  folder.write("M.mtx", "%%MatrixMarket matrix array real general\n" + std::string(2000, '\n') + "1 1\n2\n");
  folder.write("q.mtx", "%%MatrixMarket matrix array real general\n1 1\n-1\n");
  folder.write("s.toml", body + "# " + blanks);
  folder.write("s.sweep.toml",
               "question = 'none?'\nscene = 's.toml'\nduration = 0.1\nmeasure = 'energy'\n[[grid]]\n"
               "integrator = 'moreau-jean'\nsolver = 'lemke'\nstep = 0.1\n# " +
                   blanks + blanks);
  fs::copy_file(ORTHANT_TEST_DATA "/fclib/Box_Stacks-i0122-82-5.hdf5", folder / "box.hdf5");
  const std::array<std::array<std::string, 2>, 7> commands = {{
      {"solve p.json", "p.json: "},
      {"analyse M.mtx", "M.mtx: "},
      {"enumerate --matrix M.mtx --vector q.mtx", "M.mtx: "},
      {"replay p.json --solver lemke", "p.json: "},
      {"analyse box.hdf5 --time-limit 1", "box.hdf5: "},
      {"simulate s.toml --step 0.1 --duration 0.1", "s.toml: "},
      {"sweep s.sweep.toml --results s.sqlite --list", "s.sweep.toml: "},
  }};
  for (const auto& [command, file] : commands) {
    CAPTURE(command);
    for (const std::string& arguments : {"--max-input 1KiB " + command, command + " --max-input 1KiB"}) {
      const Reply a = folder.orthant(arguments);
      CAPTURE(a.err);
      CHECK(a.exit_code == 1);
      CHECK(a.out.empty());
      CHECK(lines(a.err) == 1);
      CHECK(a.err.starts_with("orthant: " + file));
      CHECK(a.err.find(" bytes: must be at most 1 KiB (more by --max-input") != std::string::npos);
    }
    CHECK(folder.orthant(command + " --max-input 1MiB").exit_code == 0);
  }
  // What stands in a file within the limit may be over it: the scene of a sweep, an array of an HDF5 file.
  CHECK(folder.orthant("sweep s.sweep.toml --results s.sqlite --list --max-input 4500").exit_code == 0);
  folder.write("s.toml", body + "# " + std::string(5000, ' '));
  CHECK(folder.orthant("sweep s.sweep.toml --results s.sqlite --list --max-input 4500").err.find("s.toml: 50") !=
        std::string::npos);
  // Larger than is usual.
  folder.write("s.toml", body + "# " + std::string(16 << 20, ' '));
  CHECK(folder.orthant("simulate s.toml --step 0.1 --duration 0.1").err.find("at most 16 MiB") != std::string::npos);
  CHECK(folder.orthant("simulate s.toml --step 0.1 --duration 0.1 --max-input 0").exit_code == 1);
  CHECK(folder.orthant("simulate s.toml --step 0.1 --duration 0.1 --max-input 17MiB").exit_code == 0);
  for (const char* size : {"-1", "many", "1e3", "99999999999EiB"}) {
    CAPTURE(size);
    const Reply a = folder.orthant("solve p.json --max-input " + std::string(size));
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
  }
}

TEST_CASE("output goes through a link to its target, and never replaces a device") {
  const Cli folder;
  folder.write("target.csv", "old");
  fs::create_symlink("target.csv", folder.path / "link.csv");
  CHECK(folder.orthant("simulate slider_crank --step 1e-3 --output link.csv").exit_code == 0);
  CHECK(fs::is_symlink(folder.path / "link.csv"));
  CHECK(slurp(folder / "target.csv").starts_with("t,crank.x"));
  const Reply a = folder.orthant("simulate slider_crank --step 1e-3 --output /dev/null");
  CHECK(a.exit_code == 1);
  CHECK(fs::is_character_file("/dev/null"));
}

TEST_CASE("a full disk behind standard output is no success") {
  const Cli folder;
  for (const char* arguments : {"list", "--version", "simulate bouncing_ball --duration 0.01", "solve --help"}) {
    CAPTURE(arguments);
    const Reply a = folder.run("('" ORTHANT_CLI "' " + std::string(arguments) + " > /dev/full)");
    CHECK(a.exit_code == 1);
    CHECK(a.err.find("orthant: cannot write standard output: No space left") != std::string::npos);
  }
}

TEST_CASE("what is quoted from a file does not reach the terminal as it is") {
  const Cli folder;
  folder.write("raw.mtx", "%%MatrixMarket matrix \xff\x1b[2J\xc2\x9b\xc3\xa9 real general\n1 1\n1\n");
  CHECK(folder.orthant("analyse raw.mtx").err.find("'\\xff [2j\\xc2\\x9b\xc3\xa9'") != std::string::npos);
}

TEST_CASE("time limits: numbers only, and each command says what is missing then") {
  const Cli folder;
  folder.write("M.mtx", "%%MatrixMarket matrix array real general\n2 2\n2\n1\n1\n2\n");
  folder.write("q.mtx", "%%MatrixMarket matrix array real general\n2 1\n-5\n-6\n");
  const std::string problem = " --matrix M.mtx --vector q.mtx";
  for (const std::string& command : {"solve" + problem, "replay" + problem, "enumerate" + problem,
                                     std::string("analyse M.mtx"), std::string("simulate bouncing_ball")})
    for (const char* limit : {"nan", "inf", "-1", "0", "soon"}) {
      const Reply a = folder.orthant(command + " --time-limit " + limit);
      CAPTURE(command);
      CAPTURE(a.err);
      CHECK(a.exit_code == 1);
      CHECK(a.err.find("--time-limit: '" + std::string(limit) + "': must be a time in") != std::string::npos);
    }
  std::string large = "%%MatrixMarket matrix array real general\n12 12\n";
  for (int i = 0; i < 144; ++i) large += i % 13 == 0 ? "1\n" : "0.5\n";
  folder.write("large.mtx", large);
  const auto open = nlohmann::json::parse(folder.orthant("analyse large.mtx --time-limit 1e-6 --json").out);
  CHECK(open.at("P") == "not decided");
  CHECK(open.at("condition") == "not decided");
  std::string minus = "%%MatrixMarket matrix coordinate real general\n18 18 18\n",
              ones = "%%MatrixMarket matrix array real general\n18 1\n";
  for (int i = 1; i <= 18; ++i) minus += std::to_string(i) + " " + std::to_string(i) + " -1\n", ones += "1\n";
  folder.write("minus.mtx", minus), folder.write("ones.mtx", ones);
  const Reply part = folder.orthant("enumerate --matrix minus.mtx --vector ones.mtx --time-limit 1e-6 --json");
  CHECK(part.exit_code == 3);
  CHECK(nlohmann::json::parse(part.out).at("complete") == false);
}

TEST_CASE("a drive through the floor: proved infeasible, and the shell is told so") {
  const Cli folder;
  folder.write("through.toml",
               "duration = 1\n[[body]]\nname = 'b'\nmass = 1\ninertia = 1\nposition = [0, 1]\n"
               "[[joint]]\ntype = 'drive'\nof = 'slide'\nbodies = ['ground', 'b']\naxis = [0, 1]\nrate = -2\n"
               "[[contact]]\ntype = 'corner-wall'\nbody = 'b'\nwall = {normal = [0, 1]}\n");
  const Reply a = folder.orthant("simulate through.toml --step 1e-2 --json");
  CHECK(a.exit_code == 2);
  CHECK(nlohmann::json::parse(a.out).at("status") == "infeasible");
}

TEST_CASE("a failed run ends its record with the state it reached") {
  const Cli folder;
  const Reply a = folder.orthant(
      "simulate slider_crank --integrator moreau-jean --solver pgs:max_sweeps=1 --step 1e-5 --every 1000 "
      "--output x.csv --json");
  CHECK(a.exit_code == 3);
  const auto json = nlohmann::json::parse(a.out);
  CHECK(json.at("final").at("t").get<double>() ==
        doctest::Approx(1e-5 * json.at("steps").get<double>()).epsilon(1e-12));
  const std::string csv = slurp(folder / "x.csv");
  CHECK(csv.find("\n" + json.at("final").at("t").dump() + ",") != std::string::npos);
}

TEST_CASE("a start that breaks its own joints is run, with a warning") {
  const Cli folder;
  folder.write("apart.toml",
               "duration = 0.01\n[[body]]\nname = 'b'\nmass = 1\ninertia = 1\n"
               "[[joint]]\ntype = 'revolute'\nbodies = ['ground', 'b']\npoint_a = [5, 0]\npoint_b = [0, 0]\n");
  const Reply a = folder.orthant("simulate apart.toml --json");
  CHECK(a.exit_code == 0);
  CHECK(a.err.find("warning: at the start joints are off by 5 m") != std::string::npos);
  folder.write("bent.toml",
               "[[body]]\nname = \"arm\"\nmass = 1\ninertia = 1\n[[contact]]\ntype = \"limit\"\nof = \"angle\"\n"
               "bodies = [\"ground\", \"arm\"]\nlower = 0.25\n");
  CHECK(folder.orthant("simulate bent.toml").err.find("contacts penetrate by 0.25 rad") != std::string::npos);
  CHECK(folder.orthant("simulate slider_crank --step 1e-3").err.empty());
}

TEST_CASE("bodies that pass through each other are told by name, with figures") {
  const Cli folder;
  const auto ball = [](const std::string& name, const std::string& x, const std::string& v) {
    return "[[body]]\nname = '" + name + "'\nmass = 1\ninertia = 1\nposition = [" + x + ", 0]\nvelocity = [" + v +
           ", 0]\n";
  };
  folder.write("fast.toml",
               "duration = 0.1\nstep = 0.05\n" + ball("shot", "-4", "200") + ball("wall", "0", "0") +
                   "[[collision]]\nshapes = [{body = 'shot', radius = 0.1}, {body = 'wall', radius = 1}]\n");
  const Reply r = folder.orthant("simulate fast.toml");
  CHECK(r.exit_code == 0);
  CHECK(r.out.find("passages = 1\n") != std::string::npos);
  CHECK(r.err.find(
            "warning: bodies passed through each other, unseen, in 1 step: first \"shot\" and \"wall\" at t = 0.05 s, "
            "where the one moved 10 m in a step and the thinner is 0.2 m wide") != std::string::npos);
}

TEST_CASE("names in a file lead nowhere: they are words, and nothing is written outside the folder") {
  const Cli folder;
  fs::create_directories(folder.path / "a/b");
  const auto scene = [](const std::string& body, const std::string& contact) {
    return "duration = 0.01\n[[body]]\nname = '" + body + "'\nmass = 1\ninertia = 1\n[[contact]]\ntype = 'limit'\n" +
           "of = 'angle'\nname = '" + contact + "'\nbodies = ['ground', '" + body + "']\nlower = -1\n";
  };
  for (const auto& [body, contact] : {std::array{"../../evil", "c"}, {"b", "/tmp/evil"}, {"b", "../evil"}}) {
    folder.write("a/b/s.toml", scene(body, contact));
    for (const char* output : {"out.csv", "out.h5", "out.pvd"}) {
      const Reply r = folder.orthant("simulate a/b/s.toml --output a/b/" + std::string(output));
      INFO(r.err);
      CHECK(r.exit_code == 1);
      CHECK(r.err.find("must be of letters, digits") != std::string::npos);
    }
  }
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path)) files += entry.is_regular_file();
  CHECK(files == 3);  // the scene, and what this test keeps of the command's words
}

TEST_CASE("eight times the bodies take eight times the time, from the file to the summary") {
  const Cli folder;
  const auto seconds = [&](int bodies) {  // of processor time
    std::string scene = "duration = 1e-3\nstep = 1e-3\n";
    for (int i = 0; i < bodies; ++i) scene += "[[body]]\nname = 'b" + std::to_string(i) + "'\nmass = 1\ninertia = 1\n";
    folder.write("many.toml", scene);
    const auto spent = [] {
      rusage all;
      getrusage(RUSAGE_CHILDREN, &all);
      return double(all.ru_utime.tv_sec) + 1e-6 * double(all.ru_utime.tv_usec);
    };
    const double before = spent();
    CHECK(folder.orthant("simulate many.toml").exit_code == 0);
    return spent() - before;
  };
  const double few = seconds(2000);
  CHECK(seconds(16000) < 20 * few);  // some 50 where each column's name is compared with all before it
}

TEST_CASE("a run that enters a limit of the numbers is told which, by name, and no other is") {
  const Cli folder;
  const auto scene = [&](const std::string& mass, const std::string& place, const std::string& spin,
                         const std::string& stiffness, const std::string& angle = "0") {
    folder.write("limits.toml",
                 "duration = 0.01\nstep = 1e-3\n[[body]]\nname = 'light'\nmass = 1\ninertia = 1\nposition = [" + place +
                     ", 0]\nangle = " + angle + "\nomega = " + spin + "\n[[body]]\nname = 'heavy'\nmass = " + mass +
                     "\ninertia = 1\n[[spring]]\ntype = 'point'\nname = 's'\nbodies = ['light', 'heavy']\n"
                     "point_a = [0, 0]\npoint_b = [0, 0]\nstiffness = " +
                     stiffness + "\n");
    return folder.orthant("simulate limits.toml").err;
  };
  const auto holds = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  CHECK(scene("1e8", "1", "400", "4e5").empty());
  CHECK(holds(scene("1e10", "1", "0", "0"), "\"heavy\" has 1e+10 times the mass of \"light\""));
  CHECK(holds(scene("1", "2e5", "0", "0"), "bodies are 200000 m from the origin"));
  CHECK(holds(scene("1", "1", "0", "0", "2e5"), "bodies are turned by 200000 rad"));
  CHECK(holds(scene("1", "1", "600", "0"), "\"light\" turns by 0.6 rad in a step"));
  const std::string swings = scene("1", "1", "0", "2e6");
  CHECK(holds(swings, "spring \"s\" swings by 2 rad in a step"));
  CHECK(lines(swings) == 1);
  CHECK(folder.orthant("simulate limits.toml --integrator adaptive").err.empty());

  std::string crushed = "gravity = [0, -9.81]\nduration = 0.6\nstep = 1e-2\n";  // the light disc, by the heavy one
  for (const auto& [name, mass, place] : {std::array{"a", "1", "0, 0.21"}, std::array{"b", "1000", "-0.0313, 0.7273"}})
    crushed += "[[body]]\nname = '" + std::string(name) + "'\nmass = " + mass + "\ninertia = 0.02\nposition = [" +
               place + "]\n[[contact]]\ntype = 'disc-wall'\nbody = '" + name +
               "'\nradius = 0.2\nwall = {normal = [0, 1]}\nmu = 0.1\ne_n = 0.8\n";
  folder.write("crushed.toml", crushed +
                                   "[[contact]]\ntype = 'disc-disc'\nbodies = ['a', 'b']\nradius_a = 0.2\n"
                                   "radius_b = 0.2\nmu = 0.1\ne_n = 0.8\n");
  CHECK(holds(folder.orthant("simulate crushed.toml --integrator event-driven").err,
              "crowds of events were crossed in "));
}

TEST_CASE("orthant list names everything, with options") {
  const Cli folder;
  const Reply a = folder.orthant("list");
  CHECK(a.exit_code == 0);
  for (const char* word : {"lemke", "pgs", "enumerate", "moreau-jean", "slider_crank", "slider_crank_ideal", "omega",
                           "joints", "clearance"})
    CHECK(a.out.find(word) != std::string::npos);
  CHECK(folder.orthant("list solvers").out.find("moreau-jean") == std::string::npos);

  const auto json = nlohmann::json::parse(folder.orthant("list --json").out);
  CHECK(json.at("solvers").size() > 15);
  const auto option = [&](const char* kind, const std::string& name, const std::string& asked) {
    for (const auto& entry : json.at(kind))
      if (entry.at("name") == name)
        for (const auto& o : entry.at("options"))
          if (o.at("name") == asked) return o;
    return nlohmann::json();
  };
  CHECK(option("solvers", "pgs", "omega").at("range") == nlohmann::json::parse("[0.001, 1.999]"));
  CHECK(option("solvers", "lemke", "rescue").at("default") == true);
  // What is printed is taken back: a whole number without exponent.
  CHECK(a.out.find("max_sweeps=100000 in [1, ") != std::string::npos);
  CHECK(a.out.find("max_sweeps=1e+05") == std::string::npos);
  CHECK(option("integrators", "moreau-jean", "joints").at("choices").size() > 1);
  CHECK(json.at("scenes")[0].at("name") == "bouncing_ball");
  CHECK(!nlohmann::json::parse(folder.orthant("list solvers --json").out).contains("scenes"));
  CHECK(folder.orthant("list --json --markdown").exit_code == 1);
}

TEST_CASE("orthant analyse and solve: the kind of matrix, the rows' places, the error bound") {
  const Cli folder;
  folder.write("M.mtx", "%%MatrixMarket matrix array real general\n2 2\n2\n-1\n-1\n2\n");
  folder.write("q.mtx", "%%MatrixMarket matrix array real general\n2 1\n-1\n5\n");
  const Reply kind = folder.orthant("analyse M.mtx --json");
  CHECK(kind.exit_code == 0);
  const auto json = nlohmann::json::parse(kind.out);
  CHECK(json.at("K") == "yes");
  CHECK(json.at("rank") == 2);
  CHECK(json.at("condition").get<double>() == doctest::Approx(3));
  CHECK(folder.orthant("analyse M.mtx").out.find("positive definite       yes") != std::string::npos);
  CHECK(folder.orthant("analyse missing.mtx").exit_code == 1);

  const Reply solved = folder.orthant("solve --matrix M.mtx --vector q.mtx --error-bound --json");
  const auto answer = nlohmann::json::parse(solved.out);
  CHECK(answer.at("active_set").at("inside") == std::vector<int>{0});
  CHECK(answer.at("active_set").at("lower") == std::vector<int>{1});
  CHECK(answer.at("uniqueness") == "isolated");
  CHECK(answer.at("error_bound").get<double>() < 1e-12);
}

TEST_CASE("experiments/README.md has the table of solvers that orthant list --markdown prints") {
  const Cli folder;
  const Reply a = folder.orthant("list --markdown");
  CHECK(a.exit_code == 0);
  CHECK(lines(a.out) > 5);
  CHECK(slurp(fs::path(ORTHANT_TEST_DATA) / "../../experiments/README.md").find(a.out) != std::string::npos);
}

TEST_CASE("every command that takes a problem takes Matrix Market files; solve asks auto") {
  const Cli folder;
  folder.write("M.mtx", "%%MatrixMarket matrix array real general\n2 2\n2\n1\n1\n2\n");
  folder.write("q.mtx", "%%MatrixMarket matrix array real general\n2 1\n-5\n-6\n");
  folder.write("u.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\n9\n");
  const auto json = [&](const std::string& arguments) {
    const Reply a = folder.orthant(arguments + " --json");
    CAPTURE(arguments);
    CHECK(a.exit_code == 0);
    return nlohmann::json::parse(a.out);
  };
  const std::string files = " --matrix M.mtx --vector q.mtx", box = files + " --upper u.mtx";
  CHECK(json("enumerate" + box).at("isolated") == nlohmann::json::parse("[[1.0, 2.5]]"));
  CHECK(json("replay --solver lemke" + box).at(0).at("status") == "solved");
  CHECK(json("analyse --matrix M.mtx").at("P") == "yes");
  CHECK(json("solve" + files).at("solver") == "auto");
  for (const char* arguments : {"enumerate", "replay", "analyse", "enumerate M.mtx", "enumerate --matrix M.mtx",
                                "solve p.json --lower u.mtx"}) {
    CAPTURE(arguments);
    const Reply a = folder.orthant(arguments);
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
  }
  CHECK(folder.orthant("enumerate M.mtx").err.find("--matrix M.mtx --vector FILE") != std::string::npos);
}

TEST_CASE("every command's --help has an example of its own and says what its exit codes mean") {
  const Cli folder;
  for (const std::string command :
       {"solve", "analyse", "enumerate", "replay", "simulate", "sweep", "results", "report", "list"}) {
    CAPTURE(command);
    const Reply a = folder.orthant(command + " --help");
    CHECK(a.exit_code == 0);
    CHECK(a.out.find("\n  orthant " + command + " ") != std::string::npos);
    CHECK(a.out.find("Exit codes: 0 ") != std::string::npos);
  }
  CHECK(folder.orthant("solv").err.starts_with("orthant: 'solv' is no subcommand, one of: solve "));
}

TEST_CASE("orthant enumerate, replay, --version, completion") {
  const Cli folder;
  const std::string file = folder.write("p.json", R"({"format": "orthant-lcp", "version": 1,
    "A": {"storage": "dense", "n": 2, "rows": [[-1, 0], [0, -1]]}, "b": [1, 1]})");
  const Reply all = folder.orthant("enumerate p.json --json");
  CHECK(all.exit_code == 0);
  CHECK(nlohmann::json::parse(all.out).at("isolated").size() == 4);
  const std::string none = folder.write("none.json", R"({"format": "orthant-lcp", "version": 1,
    "A": {"storage": "dense", "n": 1, "rows": [[-1]]}, "b": [-1]})");
  CHECK(folder.orthant("enumerate none.json").exit_code == 2);
  folder.write("beyond.json", R"({"format": "orthant-lcp", "version": 1,
    "A": {"storage": "dense", "n": 1, "rows": [[1e-200]]}, "b": [-1e200]})");
  CHECK(nlohmann::json::parse(folder.orthant("enumerate beyond.json --json").out).at("isolated")[0][0] == "inf");

  const Reply replay = folder.orthant("replay p.json --json");
  CHECK(replay.exit_code == 0);
  const auto table = nlohmann::json::parse(replay.out);
  CHECK(table.size() > 15);
  for (const auto& row : table) {
    if (row.at("solver") == "lemke") CHECK(row.at("status") == "solved");
    if (row.at("status") == "unsupported") CHECK(!row.at("why_not").get<std::string>().empty());
  }
  CHECK(folder.orthant("replay none.json --solver lemke").exit_code == 2);
  CHECK(folder.orthant("replay p.json --solver lemk").exit_code == 1);
  CHECK(folder.orthant("replay p.json --time-limit -1").exit_code == 1);
  CHECK(folder.orthant("replay '" ORTHANT_TEST_DATA "/fclib/Box_Stacks-i0122-82-5.hdf5' --solver path").exit_code == 0);

  const Reply version = folder.orthant("--version");
  CHECK(version.exit_code == 0);
  CHECK(version.out.find("Eigen 3.") != std::string::npos);
  CHECK(version.out.find("ipopt: ") != std::string::npos);

  const auto build = nlohmann::json::parse(folder.orthant("--version --json").out);
  CHECK(build.at("backends").at("ipopt").is_boolean());
  CHECK(version.out.find(build.at("revision").get<std::string>()) != std::string::npos);
  CHECK(folder.orthant("--json").exit_code == 1);

  const Reply script = folder.orthant("completion");
  CHECK(nlohmann::json::parse(folder.orthant("completion --json").out).at("bash") == script.out);
  folder.write("completion.bash",
               script.out +
                   "COMP_WORDS=(orthant solve --solver le) COMP_CWORD=3; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant sim) COMP_CWORD=1; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant solve --err) COMP_CWORD=2; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(build/orthant enu) COMP_CWORD=1; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant list s) COMP_CWORD=2; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant --max) COMP_CWORD=1; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant --max-input 8GiB sol) COMP_CWORD=3; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant --max-input 8GiB solve --max) COMP_CWORD=4; _orthant; echo ${COMPREPLY[@]}\n");
  CHECK(folder.run("bash completion.bash").out ==
        "lemke lemke-howson\nsimulate\n--error-bound\nenumerate\nsolvers scenes\n"
        "--max-input\nsolve\n--max-input\n");
}

TEST_CASE("orthant simulate: trajectories as HDF5 and for ParaView hold what the CSV does") {
  const Cli folder;
  for (const char* file : {"run.csv", "run.h5", "run.pvd"})
    REQUIRE(folder.orthant("simulate slider_crank --step 1e-3 --every 50 --output " + std::string(file)).exit_code ==
            0);
  std::istringstream csv(slurp(folder / "run.csv"));
  std::string header, line;
  std::getline(csv, header);
  for (int k = 0; k < 3; ++k) std::getline(csv, line);  // the third moment
  std::vector<double> row;
  std::istringstream cells(line);
  for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));

  const H5::H5File h5(folder / "run.h5", H5F_ACC_RDONLY);
  CHECK(h5.getNumObjs() == row.size());
  std::istringstream names(header);
  std::size_t c = 0;
  for (std::string name; std::getline(names, name, ','); ++c) {
    const H5::DataSet set = h5.openDataSet(name);
    REQUIRE(set.getSpace().getSimpleExtentNpoints() == 5);
    double values[5];
    set.read(values, H5::PredType::NATIVE_DOUBLE);
    CHECK(values[2] == row[c]);
  }

  const std::string index = slurp(folder / "run.pvd"), moment = slurp(folder / "run/run_2.vtu");
  CHECK(index.find("timestep=\"0.1") != std::string::npos);
  CHECK(index.find("file=\"run/run_4.vtu\"") != std::string::npos);
  const auto after = [&](const std::string& mark, std::size_t from = 0) {
    return std::istringstream(moment.substr(moment.find('\n', moment.find(mark, from)) + 1));
  };
  double x = 0, y = 0;
  int body = 0;
  after("Name=\"position\"") >> x >> y;  // the crank's first line begins at its centre of mass
  CHECK(x == row[1]);
  CHECK(y == row[2]);
  after("Name=\"body\"") >> body;
  CHECK(body == 0);
  double vx = 0;
  after("Name=\"velocity\"") >> vx;
  CHECK(vx == row[4]);
}
