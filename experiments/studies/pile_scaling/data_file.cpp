#include "experiments/studies/pile_scaling/data_file.h"

#include "experiments/support/isolated.h"
#include "experiments/support/rows_file.h"

#include <iomanip>
#include <iostream>
#include <sstream>

namespace orthant {

namespace {

/// Cells that the lines of one case begin with.
std::string beginning(const Bodies& bodies, int count, const Settling& way) {
  std::ostringstream line;
  line << bodies.name << ',' << count << ',' << way.steps() - way.last_steps() << ',' << text_cell(way.by) << ','
       << way.tolerance << ',' << way.threads[0] << ',';
  return line.str();
}

std::string cells(const Cost& cost) {
  std::ostringstream line;
  line << std::setprecision(4) << name(cost.status) << ',';
  if (cost.status != Status::solved) {
    line << ',' << cost.iterations << ",," << 1e3 * cost.wall[0] << ',' << cost.scale_free << ",,,,";
    return line.str();
  }
  line << std::lround(cost.contacts) << ',' << cost.iterations << ',' << 1e6 * cost.processor / cost.contacts << ','
       << 1e3 * cost.wall[0] << ',' << cost.scale_free << ',' << 1e6 * cost.penetration << ','
       << std::lround(1e-6 * cost.peak) << ',' << std::lround(cost.peak / cost.contacts) << ',' << std::hex
       << cost.state;
  return line.str();
}

/// All lines of one pile: it settles, and its last steps are taken from there in each way, by a process each.
template <class Space> std::string lines_of(PileMotion<Space>&& pile, const Bodies& bodies, int count,
                                            const Cases& cases, const Settling& way) {
  Settling before = way;
  before.threads = {1};
  const Cost settled = pile.settle(before);
  std::string lines;
  for (const std::string& solver : cases.solvers)
    for (const double tolerance : cases.tolerances)
      for (const int threads : way.threads) {
        Settling one = way;
        one.by = solver, one.tolerance = tolerance, one.threads = {threads};
        lines += beginning(bodies, count, one);
        if (settled.status != Status::solved) {
          lines += "settling: " + std::string(name(settled.status)) + ",,,,,,,,,\n";
          continue;
        }
        Isolated child(1, 0);
        child.start([&] { return cells(pile.last_steps(one)); }, 1e7,
                    [&](const Outcome& outcome) {
                      lines +=
                          (outcome.kind == Outcome::finished ? outcome.text : text_cell(outcome.text) + ",,,,,,,,,") +
                          '\n';
                    });
        child.wait_for_all();
      }
  if (!settled.end.empty()) std::cerr << "pile_scaling: " << count << ' ' << bodies.name << ", " << settled.end << '\n';
  return lines;
}

}  // namespace

int write_data(const std::string& path, bool append, const Cases& cases, const Settling& way) {
  RowsFile file(path, append,
                "kind,bodies,settling,solver,tolerance,threads,status,contacts,sweeps,processor_us_a_contact,wall_ms,"
                "scale_free,overlap_um,peak_MB,B_a_contact,state");
  Isolated children(1, 0);
  bool same = true;
  for (const Bodies& bodies : cases.kinds)
    for (const int count : cases.sizes) {
      const auto work = [&] {
        return bodies.in_motion(count,
                                [&](auto&& pile) { return lines_of(std::move(pile), bodies, count, cases, way); });
      };
      children.start(work, 1e7, [&](const Outcome& outcome) {
        if (outcome.kind != Outcome::finished) {
          file.row(bodies.name + ',' + std::to_string(count) + ",,,,," + text_cell(outcome.text) + ",,,,,,,,,");
          return;
        }
        std::istringstream lines(outcome.text);
        std::vector<std::string> states;
        for (std::string line; std::getline(lines, line);) {
          file.row(line);
          states.push_back(line.substr(line.rfind(',') + 1));
        }
        const std::size_t threads = way.threads.size();
        for (std::size_t i = 0; i < states.size(); ++i)
          if (const std::string& first = states[i - i % threads];
              states[i] != first && states[i] != "" && first != "") {
            std::cerr << "pile_scaling: " << count << ' ' << bodies.name
                      << ": the state depends on the number of threads\n";
            same = false;
          }
      });
      children.wait_for_all();
    }
  return same ? 0 : 3;
}

}  // namespace orthant
