// solvers/pivoting/cell_walk.h — search tree of enumerate.h: one polyhedron for each choice of sides, cut where it is
// empty.
//
//   A node is a choice for the first rows. Their equations are solved: each expresses one entry by the others, so that
//   every form (z − lo, hi − z, w of each row) is a constant plus a combination of the entries that are left. A form
//   that has the wrong sign wherever the entries have theirs cuts the node with all below it. In doubles with error
//   bounds (exact.h), and in rationals where these leave a sign open.
#pragma once

#include <orthant/core/lcp/judge/cells.h>
#include <orthant/core/lcp/judge/exact.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <vector>

namespace orthant::cell_walk {

using exact::Filtered;
using exact::Rational;
using exact::Sign;
using exact::Table;

constexpr std::size_t kMostCells = 100000;  // classes kept as a proof, some 200 bytes each

enum Choice : signed char { lower, inside, upper };

// Forms that are ≠ 0 somewhere in a polyhedron: z − lo > 0, hi − z > 0, w > 0, w < 0; one bit a row.
using Support = std::array<std::uint32_t, 4>;
/// Whether b has all that a has.
bool within(const Support& a, const Support& b);

struct Piece {  // the solutions of one choice
  Support support{};
  Table vertices, directions, lines;  // values of z
};

struct Line {  // a row of the problem: its choices and the numbers of its forms, −1: none
  Index row = 0;
  std::vector<Choice> choices;
  int z = -1, from_lower = -1, to_upper = -1, w = -1;
  bool fixed = false;  // one value only: w has any sign
  int wanted = 0;      // sign of w in all choices
  std::uint32_t bit = 0;
};

// Forms c + Σ a_k x_k in the entries x that are left, at most `columns` − 1 of them.
template <class T> struct Node {
  int left = 0;                     // entries
  std::vector<T> forms;             // [constant | coefficients] each
  std::vector<char> any_sign;       // of an entry; else ≥ 0
  std::vector<std::int16_t> entry;  // of z, by place
  int expressed = -1;               // by the last equation
  std::vector<int> wanted;          // per form: sign that it must have, 0: any
};

class Walk {
 public:
  using Found = std::function<bool(const Piece&)>;  // true: enough
  using Stop = std::function<bool()>;

  Walk(const Lcp& problem, Found found, Stop stop, std::vector<Cell>* cells = nullptr)
      : found_(std::move(found)), stop_(std::move(stop)), cells_(cells) {
    form(problem);
  }
  long nodes() const { return nodes_; }

  /// True when the walk went to its end.
  bool run();

 private:
  void form(const Lcp& problem);
  template <class T> T* form_of(Node<T>& node, int f) const { return node.forms.data() + f * columns_; }
  template <class T> std::vector<Node<T>>& nodes_of() {
    if constexpr (std::is_same_v<T, Filtered>)
      return filtered_;
    else
      return exact_;
  }
  template <class T> Sign equate(Node<T>& node, int f, int preferred);
  template <class T> Sign child(std::size_t depth, Choice choice);
  template <class T> int impossible(Node<T>& node);
  template <class T> void cut(std::size_t depth, Cell::Why why, int row);
  template <class T> void cut_by_form(std::size_t depth, int form);
  template <class T> bool vanishes(Node<T>& node, int f) const;
  template <class T> bool visit(std::size_t depth);
  template <class T> bool visit_child(std::size_t depth, Choice choice);
  bool visit_exactly(std::size_t depth, std::size_t agreed);
  std::optional<Support> support(Node<Filtered>& node);
  bool leaf(Node<Filtered>& node);
  bool leaf(Node<Rational>& node);
  exact::Row point(Node<Rational>& node, const exact::Row& x, const Rational& one);

  Found found_;
  Stop stop_;
  std::vector<Cell>* cells_;  // where classes without a solution are written, in the order of the search; or null
  std::size_t agreed_ = 0;    // depth down to which rationals express the same entries as doubles did
  std::vector<Line> lines_;   // in the order of decision
  Vector lo_, hi_;
  std::vector<Friction> friction_;
  Index rows_ = 0;
  int columns_ = 0, forms_ = 0;
  long nodes_ = 0;
  std::vector<Node<Filtered>> filtered_;  // per depth
  std::vector<Node<Rational>> exact_;
  std::vector<Choice> path_, exact_path_;  // choices so far; those that exact_ was made for
  std::set<Support> seen_;
};

}  // namespace orthant::cell_walk
