#include <orthant/solvers/pivoting/enumerate.h>

#include <orthant/solvers/pivoting/cell_walk.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

using cell_walk::Piece;
using cell_walk::Support;
using cell_walk::Walk;
using cell_walk::within;
using exact::Rational;
using exact::Table;

constexpr double kMostChoices = 1 << 20;
constexpr Index kMostRows = 100;

Vector rounded(const exact::Row& x) {
  Vector result;
  result.resize(static_cast<Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) result[static_cast<Index>(i)] = exact::nearest(x[i]);
  return result;
}

Vector direction(exact::Row x) {
  Rational largest = 0;
  for (const Rational& entry : x) largest = std::max(largest, Rational(abs(entry)));
  for (Rational& entry : x) entry /= largest;
  return rounded(x);
}

SolutionFace face(const Piece& piece) {
  SolutionFace result;
  Table span = piece.directions;
  span.insert(span.end(), piece.lines.begin(), piece.lines.end());
  for (const exact::Row& vertex : piece.vertices) {
    span.push_back(vertex);
    for (std::size_t i = 0; i < vertex.size(); ++i) span.back()[i] -= piece.vertices.front()[i];
    result.vertices.push_back(rounded(vertex));
  }
  for (const exact::Row& d : piece.directions) result.directions.push_back(direction(d));
  for (const exact::Row& d : piece.lines) result.lines.push_back(direction(d));
  result.dimension = static_cast<Index>(exact::reduce(span, piece.vertices.front().size()).size());
  return result;
}

/// Rationals may rule out a class that doubles have divided already: a part of another class goes.
void keep_widest(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.sides < b.sides; });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto& wide = cells[kept].sides;
    const auto& sides = cells[k].sides;
    const bool part = k > 0 && wide.size() <= sides.size() && std::equal(wide.begin(), wide.end(), sides.begin());
    if (k > 0 && !part) ++kept;
    if (!part && kept != k) cells[kept] = std::move(cells[k]);
  }
  if (!cells.empty()) cells.resize(kept + 1);
}

}  // namespace

SolutionSet enumerate_solutions(const Lcp& problem, const std::function<bool()>& stop) {
  check(problem);
  if (!finite(problem))
    throw std::invalid_argument("enumerate_solutions: every number of matrix and vector must be finite");
  if (const std::string reason = Enumerate().why_not(problem); !reason.empty()) throw std::invalid_argument(reason);
  std::vector<std::pair<Support, SolutionFace>> all;
  std::vector<Support> faces;  // only these can hold others: no two pieces are the same
  Walk walk(
      problem,
      [&](const Piece& piece) {
        all.emplace_back(piece.support, face(piece));
        if (all.back().second.dimension > 0) faces.push_back(piece.support);
        return false;
      },
      [&] { return stop && stop(); });
  SolutionSet result;
  result.complete = walk.run();
  for (auto& [support, f] : all) {
    const auto holds_it = [&part = support](const Support& s) { return s != part && within(part, s); };
    if (std::any_of(faces.begin(), faces.end(), holds_it)) continue;
    if (f.dimension == 0)
      result.isolated.push_back(std::move(f.vertices.front()));
    else
      result.faces.push_back(std::move(f));
  }
  return result;
}

std::string Enumerate::why_not(const Lcp& problem) const {
  if (problem.discs()) return "friction discs: enumeration takes linear problems";
  if (problem.size() > kMostRows)
    return "n = " + std::to_string(problem.size()) + ": enumeration takes at most " + std::to_string(kMostRows);
  double choices = 1;
  for (Index i = 0; i < problem.size(); ++i)
    if (problem.lo[i] != problem.hi[i]) choices *= 1 + std::isfinite(problem.lo[i]) + std::isfinite(problem.hi[i]);
  for (const Friction& f : problem.friction) choices *= f.mu == 0 ? 1 : 3;
  if (choices <= kMostChoices) return {};
  return "2^" + std::to_string(static_cast<int>(std::ceil(std::log2(choices)))) +
         " choices of sides: enumeration takes at most 2^20";
}

Claim Enumerate::run(const Lcp& problem, Solution& s, Start) {
  Solution candidate;
  bool accepted = false, found = false, late = false;
  s.cells.clear();
  const auto passes = [&](const exact::Row& vertex) {
    candidate.z = rounded(vertex);
    for (const Friction& f : problem.friction)  // exactly at its bound, that of the rounded z_n
      if (abs(vertex[at(f.first)]) == Rational(f.mu) * vertex[at(f.normal)])
        candidate.z[f.first] = std::copysign(f.mu * candidate.z[f.normal], candidate.z[f.first]);
    candidate_judge_.certify(problem, options_.tolerance, Claim::candidate, candidate);
    if (!found || has_answer(candidate.status)) s.z = candidate.z;
    found = true;
    return has_answer(candidate.status) && !candidate_judge_.coarse();
  };
  Walk walk(
      problem,
      [&](const Piece& piece) { return accepted = std::any_of(piece.vertices.begin(), piece.vertices.end(), passes); },
      [&] { return late = budget().exhausted(); }, &s.cells);
  walk.run();
  s.iterations = static_cast<int>(walk.nodes());
  if (found || late || s.cells.size() > cell_walk::kMostCells) s.cells.clear();
  keep_widest(s.cells);
  if (found) return Claim::candidate;
  return late ? Claim::time_limit : s.cells.empty() ? Claim::stalled : Claim::exhausted;
}

}  // namespace orthant
