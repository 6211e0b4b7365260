// orthant simulate: summary, trajectory files, failed runs, warnings.
#include "tests/support/cli.h"

#include <orthant/core/scenes/slider_crank_exact.h>

#include <H5Cpp.h>
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

namespace fs = std::filesystem;
using orthant::Cli, orthant::Reply, orthant::lines, orthant::slurp;

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

TEST_CASE("a run that --rounded stop ends is not whole: exit code 3; taken and counted it is") {
  const Cli folder;
  const std::string tower = "simulate tower --set blocks=2 --set ratio=1e9 --duration 0.02 --failed-steps none";
  CHECK(folder.orthant(tower + " --rounded stop").exit_code == 3);
  CHECK(folder.orthant(tower).exit_code == 0);
}

TEST_CASE("a drive through the floor: proved infeasible, with its exit code") {
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

TEST_CASE("orthant simulate: events of dry friction in a joint have its name") {
  const Cli folder;
  folder.write("brake.toml",
               "duration = 4\nstep = 0.001\n[[body]]\nname = \"f\"\nmass = 10\ninertia = 2\nomega = 3\n"
               "[[joint]]\ntype = \"revolute\"\nname = \"ax\"\nbodies = [\"ground\", \"f\"]\n"
               "[[friction]]\nname = \"br\"\njoint = \"ax\"\nbound = 2\n");
  for (const std::string scheme : {"adaptive", "event-driven"}) {
    const Reply a = folder.orthant("simulate brake.toml --integrator " + scheme + " --output run.csv --json");
    REQUIRE(a.exit_code == 0);
    const auto events = nlohmann::json::parse(a.out).at("event_table");
    REQUIRE(events.size() == 1);
    CHECK(events[0].at("contact") == "br");
    CHECK(events[0].at("t").get<double>() == doctest::Approx(3));
    CHECK(slurp(folder / "run.events.csv").find(",stick,br,") != std::string::npos);
  }
}

TEST_CASE("a start that breaks its own joints is run, with a warning") {
  const Cli folder;
  folder.write("apart.toml",
               "duration = 0.01\n[[body]]\nname = 'b'\nmass = 1\ninertia = 1\n"
               "[[joint]]\ntype = 'revolute'\nbodies = ['ground', 'b']\npoint_a = [5, 0]\npoint_b = [0, 0]\n");
  const Reply a = folder.orthant("simulate apart.toml --json");
  CHECK(a.exit_code == 0);
  CHECK(a.err.find("warning: at the start joints are off by 5 m") != std::string::npos);
  const auto warnings = nlohmann::json::parse(a.out).at("warnings");
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].get<std::string>().starts_with("at the start joints are off by 5 m"));
  folder.write("bent.toml",
               "[[body]]\nname = \"arm\"\nmass = 1\ninertia = 1\n[[contact]]\ntype = \"limit\"\nof = \"angle\"\n"
               "bodies = [\"ground\", \"arm\"]\nlower = 0.25\n");
  CHECK(folder.orthant("simulate bent.toml").err.find("contacts penetrate by 0.25 rad") != std::string::npos);
  CHECK(folder.orthant("simulate slider_crank --step 1e-3").err.find("overlap by up to 0.00095") != std::string::npos);
  CHECK(folder.orthant("simulate slider_crank --step 1e-4").err.empty());
}

TEST_CASE("tunnelling bodies are reported by name, with figures") {
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

TEST_CASE("a run beyond a limit of the numbers is warned of that limit by name, and no other run is") {
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

  CHECK(holds(folder.orthant("simulate painleve_rod --integrator adaptive").err,
              "crowds of events, or instants without a single answer, were crossed in "));
}

TEST_CASE("a run in space beyond a limit of the numbers is warned of that limit, and its events have times") {
  const Cli folder;
  const auto holds = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  // Painlevé's rod in space: no acceleration at the start.
  folder.write(
      "rod.toml",
      "dimension = 3\ngravity = [0, 0, -9.81]\nduration = 0.01\nstep = 1e-3\n[[body]]\nname = 'rod'\nmass = 1\n"
      "inertia = [0.01, 0.3333333333333333, 0.3333333333333333]\nposition = [0, 0, 0.8944271909999159]\n"
      "angle = 1.1071487177940904\naxis = [0, 1, 0]\nvelocity = [1, 0, 0]\n"
      "[[contact]]\ntype = 'corner-wall'\nname = 'tip'\nbody = 'rod'\npoint = [1, 0, 0]\n"
      "wall = {body = 'ground', point = [0, 0, 0], normal = [0, 0, 1]}\nmu = 1.5\n");
  const Reply crossed = folder.orthant("simulate rod.toml --integrator adaptive --json");
  INFO(crossed.err);
  REQUIRE(crossed.exit_code == 0);
  const auto json = nlohmann::json::parse(crossed.out);
  REQUIRE(json.at("crossings").get<long>() > 0);
  REQUIRE(json.at("warnings").size() == 1);
  CHECK(holds(json.at("warnings")[0].get<std::string>(),
              "crowds of events, or instants without a single answer, were crossed in "));
  REQUIRE(!json.at("event_table").empty());
  for (const auto& event : json.at("event_table")) CHECK(event.at("t").is_number());

  const auto scene = [&](const std::string& mass, const std::string& place, const std::string& spin,
                         const std::string& stiffness) {
    folder.write(
        "limits.toml",
        "dimension = 3\nduration = 0.01\nstep = 1e-3\n[[body]]\nname = 'light'\nmass = 1\ninertia = [1, 1, 1]\n"
        "position = [0, " +
            place + ", 0]\nomega = [0, " + spin + ", 0]\n[[body]]\nname = 'heavy'\nmass = " + mass +
            "\ninertia = [1, 1, 1]\n[[spring]]\ntype = 'point'\nname = 's'\nbodies = ['light', 'heavy']\n"
            "point_a = [0, 0, 0]\npoint_b = [0, 0, 0]\nstiffness = " +
            stiffness + "\n");
    return folder.orthant("simulate limits.toml").err;
  };
  CHECK(scene("1e8", "1", "400", "4e5").empty());
  CHECK(holds(scene("1e10", "1", "0", "0"), "\"heavy\" has 1e+10 times the mass of \"light\""));
  CHECK(holds(scene("1", "2e5", "0", "0"), "bodies are 200000 m from the origin"));
  CHECK(holds(scene("1", "1", "600", "0"), "\"light\" turns by 0.6 rad in a step"));
  CHECK(holds(scene("1", "1", "0", "2e6"), "spring \"s\" swings by 2 rad in a step"));
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
  CHECK(h5.getNumObjs() == row.size() + 1);  // and the group "scene" with the drawing
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
