// Bad input and broken output of every command: exit code 1, one line that says what and where.
#include "tests/support/cli.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <string>

namespace fs = std::filesystem;
using orthant::Cli, orthant::Reply, orthant::lines, orthant::slurp;

// One table of bad input and the words that it must give.
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
    CHECK(lines(a.out) == 1);
    CHECK("orthant: " + nlohmann::json::parse(a.out).at("error").get<std::string>() + "\n" == a.err);
    CHECK(lines(a.err) == 1);
    CHECK(a.err.starts_with("orthant: "));
    CHECK(a.err.find(word) != std::string::npos);
  }
  const std::array<std::pair<const char*, nlohmann::json>, 7> parts = {{
      {"simulate negative.toml",
       {{"where", "negative.toml:3: body \"b\""}, {"field", "mass"}, {"value", "-1"}, {"rule", "must be > 0"}}},
      {"simulate no_such_scene", {{"field", "scene"}, {"value", "no_such_scene"}}},
      {"simulate slider_crank --set mu=-1", {{"field", "mu"}, {"value", "-1"}}},
      {"simulate slider_crank --time-limit nan", {{"field", "--time-limit"}, {"value", "nan"}}},
      {"simulate slider_crank --solver nobody", {{"field", "solver"}, {"value", "nobody"}}},
      {"solve --matrix nan.mtx --vector q1.mtx", {{"where", "nan.mtx"}, {"field", "entry (1, 1)"}}},
      {"simulate broken.toml", nlohmann::json::object()},
  }};
  for (const auto& [arguments, expected] : parts) {
    CAPTURE(arguments);
    const Reply a = folder.orthant(std::string(arguments) + " --json");
    CAPTURE(a.out);
    const auto object = nlohmann::json::parse(a.out);
    for (const auto& [key, value] : expected.items()) CHECK(object.value(key, "") == value);
    CHECK(folder.orthant(arguments).out.empty());
  }
  for (const char* arguments : {"sing", "simulate", "solve", "list cats"}) {
    CAPTURE(arguments);
    const Reply a = folder.orthant(arguments);
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
  }
}

TEST_CASE("view: a page replaces an earlier page only, and NaN is said") {
  const Cli folder;
  folder.write("bouncing_ball.html", "<title>My door</title>");
  const std::string short_run = "view bouncing_ball --duration 0.1";
  const Reply kept = folder.orthant(short_run);
  CHECK(kept.exit_code == 1);
  CHECK(kept.err.find("bouncing_ball.html: exists, and is no page of orthant view: must be named by --output") !=
        std::string::npos);
  CHECK(slurp(folder / "bouncing_ball.html") == "<title>My door</title>");
  CHECK(folder.orthant(short_run + " --output bouncing_ball.html").exit_code == 0);
  CHECK(folder.orthant(short_run).exit_code == 0);  // its own page
  CHECK(folder.orthant(short_run + " --output ''").err.find("--output: must not be empty") != std::string::npos);

  folder.write("run.csv", "t,ball.x,ball.y,ball.theta\n0,0,1,0\n1,0,nan,0\n2,0,inf,0\n");
  const Reply odd = folder.orthant("view run.csv --json");
  CHECK(odd.exit_code == 0);
  CHECK(odd.err.find("orthant: warning: run.csv: 2 numbers are NaN or infinite, the first ball.y in row 2") !=
        std::string::npos);
  CHECK(slurp(folder / "run.html").find("2 numbers are NaN or infinite") != std::string::npos);
  folder.write("run.csv", "t,ball.x,ball.y,ball.theta\n0,0,1,0\n1,0,2,0\n");
  CHECK(folder.orthant("view run.csv").err.find("NaN") == std::string::npos);
}

TEST_CASE("view --serve answers requests for this machine only") {
  const Cli folder;
  folder.write("serve.py", R"(
import http.client, re, subprocess, sys
command = [sys.argv[1], "view", "bouncing_ball", "--duration", "0.1", "--serve", "0"]
server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
port = int(re.search(":([0-9]+)/", server.stdout.readline())[1])
for host in (f"127.0.0.1:{port}", "localhost", "LocalHost:1", "evil.example", f"evil.example:{port}",
             "127.0.0.1.evil.example", "localhost.", "", None):
    link = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    link.putrequest("GET", "/", skip_host=True)
    if host is not None:
        link.putheader("Host", host)
    link.endheaders()
    answer = link.getresponse()
    print(host, answer.status, b"Orthant" in answer.read())
link = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
link.request("GET", "/other")
print(link.getresponse().status)
server.terminate()
)");
  CHECK(folder
            .run("/usr/bin/python3 -s -E serve.py '" ORTHANT_CLI "' | sed 's/^127[.]0[.]0[.]1:[0-9]* /here /; "
                 "s/^evil.example:[0-9]*/evil:port/'")
            .out ==
        "here 200 True\nlocalhost 200 True\nLocalHost:1 200 True\nevil.example 403 False\nevil:port 403 False\n"
        "127.0.0.1.evil.example 403 False\nlocalhost. 403 False\n 403 False\nNone 403 False\n404\n");
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

TEST_CASE("control characters quoted from a file do not reach the terminal") {
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
