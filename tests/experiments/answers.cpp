// Reports: the effect of a parameter that is followed, who converges slowest, outlines, events; and the
// references of a sweep that are numbers or tables.
#include "experiments/report/report.h"
#include "experiments/runs/outlines.h"
#include "experiments/sweep/analysis.h"
#include "experiments/sweep/sweep.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/cli.h"

using namespace orthant;

namespace {

struct AnswerFolder : Cli {
  std::string error_of(const std::string& file, const std::string& text) const {
    write(file.c_str(), text);
    try {
      read_sweep(path / file, false);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
};

ResultRow result_row(const std::string& integrator, const std::string& parameters, double step, double error) {
  return {{"integrator", integrator},
          {"solver", "lemke"},
          {"parameters", parameters},
          {"step", step},
          {"rtol", nullptr},
          {"repeats", 0},
          {"error", error},
          {"seconds", 1},
          {"status", "solved"},
          {"measure", "angle"},
          {"value", 1},
          {"energy_initial", 2},
          {"energy_final", 1}};
}

bool says(const std::vector<ResultRow>& rows, const std::string& words) {
  const std::string text = answer(rows);
  CAPTURE(text);
  const bool found = text.find(words) != std::string::npos;
  if (!found) MESSAGE(text);
  return found;
}

const std::string kBallSweep =
    "scene = 'bouncing_ball'\nmeasure = 'ball.y'\nduration = 0.1\n[[grid]]\nintegrator = 'rattle'\nstep = 1e-2\n";

}  // namespace

TEST_CASE("the answer of a sweep over friction says what changes with friction, and where runs fail") {
  std::vector<ResultRow> rows;
  for (int mu = 0; mu <= 6; ++mu) {
    rows.push_back(result_row("a", "{\"mu\":" + std::to_string(mu) + "}", 1e-3, 0));
    rows.back()["value"] = mu == 4 ? 0.5 : 10 - mu, rows.back()["energy_final"] = 2 - 0.1 * mu;
    if (mu >= 5) rows.push_back(rows.back()), rows.back()["status"] = "ray";
  }
  CHECK(says(rows,
             "As mu goes from 0 to 6, the median of angle at the end goes from 10 to 4 (least, 0.5, at mu = 4), "
             "the energy lost [J] from 0 to 0.6, runs that are not solved begin at mu = 5"));
}

TEST_CASE("the most accurate method is named as such, and never as the slowest to converge") {
  std::vector<ResultRow> rows;
  for (int i = 0; i < 40; ++i) {
    const double h = std::exp2(-i / 10.0);
    rows.push_back(result_row("first", "{}", h, h)), rows.push_back(result_row("second", "{}", h, h * h));
    rows.push_back(result_row("to-a-tolerance", "{}", h, 1e-9 * (1 + i % 3)));
  }
  CHECK(says(rows,
             "the error falls fastest by second, as h^2 (median over the cases), slowest by first, as h^1; the "
             "most accurate is to-a-tolerance, at the finest steps off by 3e-9"));
  CHECK_FALSE(answer(rows).find("slowest by to-a-tolerance") != std::string::npos);
}

TEST_CASE("a reference is a number, or a row of a table by parameters and time") {
  const AnswerFolder folder;
  folder.write("number.sweep.toml", "reference = 0.25\n" + kBallSweep);
  const Sweep number = read_sweep(folder / "number.sweep.toml", false);
  REQUIRE(number.cases.size() == 1);
  CHECK(number.cases[0].known == 0.25);
  CHECK(number.reference_cases().empty());
  const ResultRow row = run_case(number.cases[0]);
  CHECK(row.at("reference") == 0.25);
  CHECK(row.at("error") == std::abs(row.at("value").get<double>() - 0.25));
  folder.write("other.sweep.toml", "reference = 0.5\n" + kBallSweep);
  CHECK(read_sweep(folder / "other.sweep.toml", false).cases[0].key() != number.cases[0].key());

  folder.write("truth.csv", "# measured\ne, value\n0, 1.5\n0.5, 2.5\n");
  const std::string by_table = "reference = 'truth.csv'\n" + kBallSweep + "set = {e = [0.5, 0]}\n";
  folder.write("table.sweep.toml", by_table);
  const Sweep table = read_sweep(folder / "table.sweep.toml", false);
  REQUIRE(table.cases.size() == 2);
  CHECK(table.cases[0].known == 2.5);
  CHECK(table.cases[1].known == 1.5);

  REQUIRE(folder.orthant("simulate bouncing_ball --duration 0.2 --step 1e-2 --output run.csv").exit_code == 0);
  folder.write("run.sweep.toml", "reference = 'run.csv'\n" + kBallSweep);  // a trajectory: the row at t = 0.1
  const auto known = read_sweep(folder / "run.sweep.toml", false).cases[0].known;
  REQUIRE(known.has_value());
  CHECK(std::abs(*known - run_case(number.cases[0]).at("value").get<double>()) < 1e-3);

  CHECK(folder.error_of("a.sweep.toml", "reference = 'none.csv'\n" + kBallSweep).find("none.csv") != std::string::npos);
  folder.write("truth.csv", "e,value\n0,1.5\n0.1,2\n");
  CHECK(folder.error_of("a.sweep.toml", by_table).find("has no row with e = 0.5: must have one") != std::string::npos);
  folder.write("truth.csv", "e,value\n0,1.5\n0,1\n");
  CHECK(folder.error_of("a.sweep.toml", "reference = 'truth.csv'\n" + kBallSweep).find("has 2 rows: must have one") !=
        std::string::npos);
  folder.write("truth.csv", "e,other\n0,1.5\n");
  CHECK(folder.error_of("a.sweep.toml", by_table).find("has no column \"ball.y\" and none \"value\"") !=
        std::string::npos);
  folder.write("truth.csv", "e,value\n0.5\n");
  CHECK(folder.error_of("a.sweep.toml", by_table).find("truth.csv:2: has 1 columns: must have 2") != std::string::npos);
  CHECK(folder.error_of("a.sweep.toml", "reference = true\n" + kBallSweep).find("reference") != std::string::npos);
}

TEST_CASE("links to journals are drawn, by one function for files and animations") {
  const AnswerFolder folder;
  const std::string text = slurp(ORTHANT_ROOT "/core/scenes/slider_crank_pin.toml");
  const Scene scene = parse_scene(text);
  const auto is_journal = [](const Contact& c) { return std::holds_alternative<Journal>(c); };
  const auto found = std::find_if(scene.contacts.begin(), scene.contacts.end(), is_journal);
  REQUIRE(found != scene.contacts.end());
  const auto& journal = std::get<Journal>(*found);
  const auto shapes = outlines(scene);
  int links = 0;
  for (const auto& [body, centre] : {std::pair{journal.a, journal.centre_a}, std::pair{journal.b, journal.centre_b}}) {
    if (centre == Vector2d(0, 0)) continue;  // nothing to draw: it is the centre of mass
    ++links;
    CHECK(std::any_of(shapes.begin(), shapes.end(), [&, body = body, centre = centre](const Outline& o) {
      const bool is_line = o.body == body && !o.closed && o.corners.size() == 2;
      return is_line && o.corners[0] == Vector2d(0, 0) && o.corners[1] == centre;
    }));
  }
  CHECK(links > 0);

  folder.write("pin.toml", text);
  folder.write("s.sweep.toml",
               "scene = 'pin.toml'\nduration = 0.02\n[[grid]]\nintegrator = 'rattle'\nstep = 1e-3\n"
               "[[animation]]\ntitle = 'Motion'\nruns = [{integrator = 'event-driven'}]\n");
  REQUIRE(folder.orthant("sweep s.sweep.toml --results r.sqlite").exit_code == 0);
  const auto data = report_data(Results(folder / "r.sqlite", Results::read_only));
  const auto& shown = data.at("sweeps")[0].at("animations")[0];
  CHECK(shown.at("scene").at("outlines").size() == shapes.size());
  const auto& film = shown.at("films")[0];
  REQUIRE(film.at("event_count").get<std::size_t>() > 0);
  CHECK(film.at("events").size() == film.at("event_count").get<std::size_t>());
  const auto& event = film.at("events")[0];
  CHECK(event[0].get<double>() > 0);
  CHECK(shown.at("scene").at("event_contacts")[event[2].get<std::size_t>()].is_string());
}
