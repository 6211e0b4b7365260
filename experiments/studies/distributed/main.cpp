// What does an obstacle problem cost on several ranks of MPI, and what would it cost on a thousand?
//
// Each rank assembles its own rows of a grid; the active set or semismooth Newton solves it (solvers/distributed), the
// distributed judge accepts. Counted on rank 0, PETSc's and hypre's calls included: messages, bytes, collective
// operations, memory; timed: processor and wall time. One row of CSV a run; --network measures messages and reductions
// between the ranks. mpirun -n 2 build/release/experiments/distributed --problem ball --side 255
// plots/plot_distributed.py models more ranks from these rows.
#include "experiments/runs/manifest.h"
#include "experiments/studies/distributed/grids.h"
#include "experiments/studies/distributed/traffic.h"
#include "experiments/support/command_line.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/solvers/distributed/distributed_newton.h>

#include <sys/resource.h>

#include <chrono>
#include <fstream>
#include <sstream>

using namespace orthant;
using namespace orthant::distributed;

namespace {

constexpr const char* kRunColumns =
    "problem,side,n,ranks,rows_per_rank,options,status,residual,iterations,krylov,preconditioners,judge_rounds,"
    "wall_s,cpu_s,halo_entries,halo_messages,halo_bytes,messages,bytes,collectives,memory_mb\n";

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

double memory_mb() {  // the most that this process has held
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_maxrss) / 1024;
}

struct Case {
  std::string problem = "ball", options, output;
  Index side = 127;
  int repeats = 1;
  double time_limit = 300;
};

std::string run(const Case& c, int rank, int ranks, bool& answered) {
  Grid grid = Grid::ball;
  for (std::size_t k = 0; k < kGridNames.size(); ++k)
    if (kGridNames[k] == c.problem) grid = static_cast<Grid>(k);
  NewtonOptions options;
  set_options(options, c.options);
  const double empty = memory_mb();
  const Index n = rows_of_grid(grid, c.side), first = n * rank / ranks;
  const DistributedLcp problem(MPI_COMM_WORLD, part_of_grid(grid, c.side, first, n * (rank + 1) / ranks - first));
  NewtonSolution s;
  double wall = kInf, cpu = kInf;
  Traffic spent;
  for (int k = 0; k < c.repeats; ++k) {
    DistributedNewton newton(problem, options);
    newton.set_time_limit(c.time_limit);
    const Traffic before = traffic();
    const auto begin = std::chrono::steady_clock::now();
    const double cpu_begin = cpu_seconds();
    newton.solve(s);
    cpu = std::min(cpu, cpu_seconds() - cpu_begin);
    wall = std::min(wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    const Traffic after = traffic();
    spent = {after.messages - before.messages, after.bytes - before.bytes, after.collectives - before.collectives};
  }
  answered = has_answer(s.status);
  const double memory = largest_of_all(MPI_COMM_WORLD, memory_mb() - empty);
  const double halo = largest_of_all(MPI_COMM_WORLD, static_cast<double>(problem.halo()));
  const double neighbours = largest_of_all(MPI_COMM_WORLD, problem.neighbours());
  std::ostringstream row;
  row << c.problem << ',' << c.side << ',' << n << ',' << ranks << ',' << n / ranks << ",\"" << c.options << "\","
      << name(s.status) << ',' << s.residual << ',' << s.iterations << ',' << s.krylov_iterations << ','
      << s.preconditioners << ',' << s.rounds << ',' << wall << ',' << cpu << ',' << halo << ',' << neighbours << ','
      << 8 * halo << ',' << spent.messages << ',' << spent.bytes << ',' << spent.collectives << ',' << memory << '\n';
  return row.str();
}

std::string network(int repeats) {
  const int large = 1 << 20;
  const double small = time_of_message(8, repeats), megabyte = time_of_message(large, 1 + repeats / 100);
  const double reduction = time_of_reduction(repeats);
  std::ostringstream rows;
  rows << "quantity,value,unit\nmessage of 8 bytes," << small << ",s\nmessage of 2^20 bytes," << megabyte
       << ",s\nbandwidth," << (megabyte > small ? large / (megabyte - small) : 0) << ",byte/s\nall-reduction,"
       << reduction << ",s\n";
  return rows.str();
}

/// Appends, with the columns where the file is new.
void append(const std::string& file, const std::string& columns, const std::string& row) {
  std::ifstream old(file);
  const bool is_new = old.peek() == std::ifstream::traits_type::eof();
  std::ofstream out(file, std::ios::app);
  out << (is_new ? columns : "") << row << std::flush;
  if (!out) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Obstacle problems over the ranks of MPI: time, messages, memory; a row of CSV");
  Case c;
  bool measure_network = false;
  app.add_option("--problem", c.problem, "grid")
      ->check(CLI::IsMember(std::vector<std::string>(kGridNames.begin(), kGridNames.end())))
      ->capture_default_str();
  app.add_option("--side", c.side, "inner nodes a side")->check(CLI::Range(2, 20000))->capture_default_str();
  app.add_option("--options", c.options, "as of the solver petsc: method=semismooth,pc=gamg");
  app.add_option("--repeats", c.repeats, "of each time, the least is kept")->check(CLI::Range(1, 100));
  app.add_option("--time-limit", c.time_limit, "of a solve [s]")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--output", c.output, "CSV file to append to; else to the terminal");
  app.add_flag("--network", measure_network, "times of messages and reductions instead");
  if (const auto end = parse(app, argc, argv)) return *end;

  start_petsc();
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  bool answered = true;
  std::string failed;
  try {
    const std::string row = measure_network ? network(1000) : run(c, rank, ranks, answered);
    const std::string columns = measure_network ? "" : kRunColumns;
    if (rank == 0 && c.output.empty()) std::cout << columns << row;
    if (rank == 0 && !c.output.empty()) append(c.output, columns, row);
    if (rank == 0 && !c.output.empty() && measure_network)
      write_whole(std::filesystem::path(c.output).parent_path() / "manifest.json", manifest().dump(2) + "\n");
  } catch (const std::exception& error) {
    failed = error.what();
  }
  if (failed.empty()) return answered ? 0 : 3;
  std::cerr << (rank == 0 ? "distributed: " + failed + '\n' : "");
  return 1;
}
