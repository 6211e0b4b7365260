#include "experiments/studies/support/rivals.h"

#include "experiments/studies/support/independent_judge.h"

#include <orthant/core/lcp/pure_form.h>

#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace orthant {
namespace {

/// A file without a place: a child that inherits it opens its path, and nothing is left behind, whoever is killed.
struct MemoryFile {
  int descriptor = memfd_create("orthant", 0);
  std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  MemoryFile() {
    if (descriptor < 0) throw std::system_error(errno, std::generic_category(), "memfd_create");
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(descriptor); }
};

template <class T, class Values> void put(std::ofstream& out, const Values& values) {
  const std::vector<T> raw(values.begin(), values.end());
  out.write(reinterpret_cast<const char*>(raw.data()), static_cast<std::streamsize>(raw.size() * sizeof(T)));
}

/// The format that benchmarks/lcp/driver.h tells.
void write_for_driver(const std::filesystem::path& file, const Lcp& p) {
  std::vector<std::int64_t> start(static_cast<std::size_t>(p.size()) + 1);
  std::vector<Index> column, row, normal, rows;
  std::vector<double> value, mu;
  RowSparse formed;
  const RowSparse& A = *rows_of(p.A, formed);
  for (Index i = 0; i < A.rows; ++i) {
    A.for_each_in_row(i, [&](Index j, double a) {
      if (a != 0) column.push_back(j), value.push_back(a);
    });
    start[static_cast<std::size_t>(i) + 1] = static_cast<std::int64_t>(value.size());
  }
  for (const Friction& f : p.friction)
    row.push_back(f.first), normal.push_back(f.normal), rows.push_back(f.rows), mu.push_back(f.mu);
  std::ofstream out(file, std::ios::binary);
  out.exceptions(std::ios::failbit | std::ios::badbit);
  put<std::int64_t>(out, std::array{static_cast<std::size_t>(p.size()), value.size(), mu.size()});
  put<std::int64_t>(out, start), put<std::int32_t>(out, column), put<double>(out, value);
  put<double>(out, p.b), put<double>(out, p.lo), put<double>(out, p.hi);
  put<std::int32_t>(out, row), put<std::int32_t>(out, normal), put<double>(out, mu);
  put<std::int32_t>(out, rows);
}

bool boxes(const Lcp& p) { return (p.lo.array() != 0).any() || (p.hi.array() != kInf).any(); }
bool free_rows(const Lcp& p) {
  std::vector<char> friction(static_cast<std::size_t>(p.size()));
  for (const Friction& f : p.friction) friction[static_cast<std::size_t>(f.first)] = 1;
  for (Index i = 0; i < p.size(); ++i)
    if (friction[static_cast<std::size_t>(i)] == 0 && p.lo[i] == -kInf && p.hi[i] == kInf) return true;
  return false;
}

Trial unsupported(const char* why) {
  Trial t;
  t.status = name(Status::unsupported);
  t.note = why;
  return t;
}

}  // namespace

std::string output_of(const std::vector<std::string>& command) {
  int out[2], err[2];
  if (pipe(out) != 0 || pipe(err) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const pid_t process = fork();
  if (process < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (process == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(out[1], STDOUT_FILENO), dup2(err[1], STDERR_FILENO);
    for (const int end : {out[0], out[1], err[0], err[1]}) close(end);
    execv(words[0], words.data());
    constexpr char kWords[] = "cannot be run";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kWords, sizeof kWords - 1);
    _exit(127);
  }
  close(out[1]), close(err[1]);
  std::array<std::string, 2> said;
  std::array<pollfd, 2> ends{{{out[0], POLLIN, 0}, {err[0], POLLIN, 0}}};
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {  // poll passes over negative ones
    poll(ends.data(), ends.size(), -1);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (ends[i].fd < 0 || ends[i].revents == 0) continue;
      char buffer[65536];
      const ssize_t got = read(ends[i].fd, buffer, sizeof buffer);
      if (got > 0) said[i].append(buffer, static_cast<std::size_t>(got));
      if (got == 0) close(std::exchange(ends[i].fd, -1));
    }
  }
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) throw std::runtime_error(strsignal(WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0) {
    const std::string words_of_end = said[1].substr(0, said[1].find_last_not_of(" \n") + 1);
    const auto line = words_of_end.rfind('\n');  // the last says what it was
    throw std::runtime_error(words_of_end.empty() ? "exit code " + std::to_string(WEXITSTATUS(status))
                                                  : words_of_end.substr(line == std::string::npos ? 0 : line + 1));
  }
  return said[0];
}

std::vector<Rival> rivals(const std::filesystem::path& folder) {
  std::ifstream list(folder / "drivers.txt");
  if (!list)
    throw std::invalid_argument("rivals '" + folder.string() +
                                "': must be a folder of drivers, named in its drivers.txt (experiments/run peers)");
  std::vector<Rival> all;
  for (std::string file; std::getline(list, file);) {
    if (file.empty()) continue;
    if (std::filesystem::path(file).filename() != file)
      throw std::invalid_argument("rivals '" + folder.string() + "': drivers.txt: '" + file +
                                  "': must be the name of a file in the same folder");
    const auto program = std::filesystem::absolute(folder / file);
    const std::string owner = program.stem().string();
    try {
      std::istringstream lines(output_of({program.string()}));
      std::string method, takes;
      while (lines >> method && std::getline(lines >> std::ws, takes))
        all.push_back({owner + "/" + method, program, method, takes, {}});
    } catch (const std::runtime_error& why) {
      all.push_back({owner, program, {}, {}, why.what()});
    }
  }
  std::ranges::sort(all, {}, &Rival::name);
  return all;
}

Vector answer_of_rival(const Lcp& problem, const Rival& rival, double tolerance, Trial& trial) {
  const MemoryFile file, answer;
  write_for_driver(file.path, problem);
  std::ostringstream asked;
  asked << tolerance;
  output_of({rival.program.string(), rival.method, file.path, answer.path, asked.str()});
  std::ifstream in(answer.path);
  in >> trial.status >> trial.iterations >> trial.runs >> trial.seconds;
  std::getline(in >> std::ws, trial.note);
  Vector y;
  y.resize(problem.size());
  std::string number;  // strtod and not >>, which knows no nan
  for (Index i = 0; i < y.size(); ++i) y[i] = in >> number ? std::strtod(number.c_str(), nullptr) : std::nan("");
  return y;
}

Trial try_rival(const Lcp& problem, const Rival& rival, double tolerance) {
  if (!rival.absent.empty()) return unsupported(rival.absent.c_str());
  const bool pure = rival.takes == "pure", plain = rival.takes != "friction" && !problem.friction.empty();
  if (pure && free_rows(problem)) return unsupported("free rows");
  const bool rewritten = plain || (pure && boxes(problem));
  Pyramid pyramid;
  const Lcp& given = rewritten ? pyramid.pure(problem, Pyramid::Form::stewart_trinkle) : problem;
  Trial t;
  Vector z;
  const Vector y = answer_of_rival(given, rival, tolerance, t);
  if (rewritten)
    pyramid.restore(problem, y, z);
  else
    z = y;
  if (t.status != name(Status::unsupported)) judge_solution(problem, z, t);
  return t;
}

}  // namespace orthant
