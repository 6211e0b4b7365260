// Every registered solver on every hard case in every storage: what it answers is right, and what it answers is pinned.
#include <orthant/core/support/options.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "tests/support/backends.h"
#include "tests/support/hard_cases.h"
#include "tests/support/judge.h"

using namespace orthant;

namespace {

/// A as W M⁻¹ Wᵀ + R without rounding, where it is symmetric and diagonally dominant: one column of W for each A_ij ≠
/// 0.
std::optional<Lcp> as_delassus(const Lcp& problem) {
  DenseMatrix A;
  to_dense(problem.A, A);
  const Index n = problem.size();
  if (A != A.transpose()) return {};
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> inverse_mass;
  Delassus d;
  d.regularization.resize(n);
  for (Index i = 0; i < n; ++i) {
    double rest = A(i, i);
    for (Index j = 0; j < n; ++j)
      if (j != i) rest -= std::abs(A(i, j));
    if (rest < 0) return {};
    d.regularization[i] = rest;
    for (Index j = 0; j < i; ++j) {
      if (A(i, j) == 0) continue;
      const auto column = static_cast<int>(inverse_mass.size());
      entries.emplace_back(static_cast<int>(i), column, 1.0);
      entries.emplace_back(static_cast<int>(j), column, A(i, j) > 0 ? 1.0 : -1.0);
      inverse_mass.push_back(std::abs(A(i, j)));
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> W(n, static_cast<Index>(inverse_mass.size()));
  W.setFromTriplets(entries.begin(), entries.end());
  d.W = RowSparse::from(W);
  d.inverse_mass.resize(W.cols());
  std::copy(inverse_mass.begin(), inverse_mass.end(), d.inverse_mass.data());
  Lcp result = problem;
  result.A = d;
  return result;
}

std::vector<std::pair<std::string, Lcp>> storages(const Lcp& problem) {
  std::vector<std::pair<std::string, Lcp>> all{{"dense", problem}, {"sparse", as_sparse(problem)}};
  DenseMatrix dense;
  to_dense(problem.A, dense);
  all[0].second.A = dense;
  if (auto delassus = as_delassus(problem)) all.emplace_back("delassus", *delassus);
  return all;
}

/// What a method may be held to. Those not named here: first-order methods, and any newcomer.
struct Promise {
  double residual = 1e-9;  // independent_residual of what is called solved
  double error = 1e-6;     // of z, in a well conditioned problem
};
Promise promise(std::string_view solver) {
  const auto among = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), solver) != names.end();
  };
  if (among({"lemke", "dantzig", "enumerate"})) return {1e-14, 4e-16};  // z correctly rounded
  if (among({"murty", "path", "lemke-howson"})) return {1e-12, 1e-13};
  if (among({"block-pivot", "newton-min", "newton-fb", "ipopt", "nlopt"})) return {1e-12, 1e-12};
  return {};
}

/// The one loop: a solve, and everything about its answer that has to hold whatever the solver.
Status honest(const std::string& spec, const HardCase& hard, const Lcp& problem) {
  const auto solver = make_solver(spec);
  const bool refused = !solver->why_not(problem).empty();
  solver->set_time_limit(hard.seconds);
  Solution s;
  const auto begin = std::chrono::steady_clock::now();
  solver->solve(problem, s);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  INFO(name(s.status), ", residual ", s.residual, ", ", s.iterations, " iterations, ", spent.count(), " s");
  CHECK(spent.count() < 8 * (hard.seconds + 1));
  CHECK((s.status == Status::unsupported) == refused);
  CHECK(s.residual == s.residual);
  switch (s.status) {
    case Status::solved: {
      REQUIRE(hard.error);  // there is a solution to find
      const Promise held = promise(Spec::parse(spec).name);
      const double residual = independent_residual(problem, s.z);
      CHECK(residual <= held.residual);
      CHECK(runaway(problem, s.z) <= 1e-6);
      CHECK(s.w.allFinite());
      // The forward error may be larger than the residual by the condition, of which `accuracy` is ε times as much.
      CHECK(hard.error(s.z) <= std::max({held.error, hard.accuracy, hard.accuracy / 0x1p-52 * residual}));
      break;
    }
    case Status::rounded: {
      REQUIRE(hard.error);
      const Achieved reached = achieved(problem, s.z);
      CHECK(reached.residual <= 20.5 * 0x1p-52 * reached.size);
      CHECK(reached.residual <= 1e-4 * (1 + problem.b.lpNorm<Eigen::Infinity>()));
      break;
    }
    case Status::infeasible:
      if (s.cells.empty()) {
        CHECK(hard.answer == Answer::infeasible);
        CHECK(independent_proof(problem, s.certificate));
      } else {  // every cell searched: also where no vector proves it
        CHECK((hard.answer == Answer::infeasible || hard.answer == Answer::none));
        CHECK(no_cell_has_a_solution(problem, s.cells));
      }
      break;
    default:  // an honest failure
      CHECK((refused || s.status == Status::ray || s.status == Status::iteration_limit ||
             s.status == Status::time_limit || s.status == Status::stalled || s.status == Status::numerical_error));
      CHECK(s.z.size() == problem.size());
  }
  return s.status;
}

/// A word for the table: either limit is one.
std::string word(Status status, const HardCase& hard) {
  if (status == Status::time_limit || status == Status::iteration_limit) return "limit";
  if (status == (hard.answer == Answer::infeasible ? Status::infeasible : Status::solved)) return "answered";
  return std::string(name(status));
}

/// What is not answered, word by word; a word that most cases get names the others.
class KnownTable {
 public:
  explicit KnownTable(std::string solver) : solver_(std::move(solver)) {}
  void add(const std::string& word, const std::string& what) { runs_.emplace_back(word, what); }
  std::string text() const {
    std::map<std::string, std::size_t> count;
    for (const auto& run : runs_) ++count[run.first];
    std::string out =
        solver_ + ": " + std::to_string(count["answered"]) + " of " + std::to_string(runs_.size()) + " answered\n";
    for (const auto& [word, times] : count) {
      if (word == "answered" || times == 0) continue;
      const bool most = 2 * times > runs_.size();
      std::string line = "  " + word + (most ? ", all but:" : ":");
      for (const auto& [its_word, what] : runs_) {
        if ((its_word == word) == most) continue;
        if (line.size() + what.size() > 118) out += line + "\n", line = "   ";
        line += " " + what;
      }
      out += line + "\n";
    }
    return out;
  }

 private:
  std::string solver_;
  std::vector<std::pair<std::string, std::string>> runs_;  // word, case
};

/// The pinned table, cut into one text per solver.
std::map<std::string, std::string> pinned() {
  std::ifstream in(ORTHANT_TEST_DATA "/who_answers_what.txt");
  std::map<std::string, std::string> texts;
  std::string solver;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (line[0] != ' ') solver = line.substr(0, line.find(": "));
    texts[solver] += line + '\n';
  }
  return texts;
}

/// The word that a solver's pinned text has for a case in a storage.
std::string pinned_word(const std::string& text, const std::string& what, const std::string& storage) {
  std::istringstream lines(text);
  std::string word, otherwise = "answered";
  bool all_but = false;
  for (std::string line; std::getline(lines, line);) {
    if (line[0] != ' ') continue;
    if (line[3] != ' ') {  // a new word
      all_but = line.find(", all but:") != std::string::npos;
      word = line.substr(2, line.find_first_of(":,") - 2);
      if (all_but) otherwise = word;
    }
    std::istringstream names(line.substr(4));
    for (std::string name; !all_but && names >> name;)
      if (name == what || name == what + "/" + storage) return word;
  }
  return otherwise;
}

}  // namespace

TEST_CASE("every solver on every hard case in every storage: the right answer or an honest word, as pinned") {
  const auto expected = pinned();
  const auto cases = hard_cases();
  int delassus = 0;
  std::vector<std::vector<std::pair<std::string, Lcp>>> stored;
  for (const HardCase& hard : cases) stored.push_back(storages(hard.problem));
  std::vector<std::string> specs{"lemke:rescue=false"};  // the plain method
  for (const SolverEntry& entry : solvers())             // not every build has every back-end
    if (entry.make("")->why_not(Lcp::standard(DenseMatrix(), Vector())).find("built without") != 0)
      specs.emplace_back(entry.name);
  for (const std::string& solver : specs) {
    KnownTable table(solver);
    const std::string before = expected.count(solver) ? expected.at(solver) : "";
    for (std::size_t k = 0; k < cases.size(); ++k) {
      std::vector<std::string> words;
      for (const auto& [storage, problem] : stored[k]) {
        INFO(solver, " on ", cases[k].name, ", ", storage);
        delassus += storage == "delassus";
        const Status status = honest(solver, cases[k], problem);
        words.push_back(word(status, cases[k]));
        // What the clock decides differs from machine to machine.
        const std::string was = pinned_word(before, cases[k].name, storage);
        if (status == Status::time_limit || (was == "limit" && words.back() == "answered")) words.back() = was;
      }
      const bool same = std::all_of(words.begin(), words.end(), [&](const auto& w) { return w == words[0]; });
      for (std::size_t i = 0; i < (same ? 1 : words.size()); ++i)
        table.add(words[i], same ? cases[k].name : cases[k].name + "/" + stored[k][i].first);
    }
    const std::string now = table.text();
    INFO("tests/data/who_answers_what.txt says\n", before, "and should say, if this is meant,\n", now);
    CHECK(now == before);
  }
  CHECK(delassus > 40);
}

TEST_SUITE("slow") {
  TEST_CASE("every solver on large cases: the right answer or an honest word; the sparse ones solve the sparse") {
    for (HardCase hard : large_cases())
      for (const SolverEntry& entry : solvers()) {
        INFO(entry.name, " on ", hard.name);
        const bool able = (entry.name == "block-pivot" || entry.name == "newton-min") &&
                          std::holds_alternative<RowSparse>(hard.problem.A);
        hard.seconds = able ? 10 : 0.1;
        const Status status = honest(std::string(entry.name), hard, hard.problem);
        if (able) CHECK(has_answer(status));
      }
  }
}
