#include <orthant/solvers/pivoting/lemke_howson.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace orthant {
namespace {

/// {u ≥ 0, G u + s = e} as a tableau [slacks | u | right-hand side]. Each variable bears a label.
class Polytope {
 public:
  static constexpr int kLost = -1;

  Polytope(const Eigen::MatrixXd& G, int first_slack, int first_u) : t_(G.rows(), G.rows() + G.cols() + 1) {
    t_ << Eigen::MatrixXd::Identity(G.rows(), G.rows()), G, Eigen::VectorXd::Ones(G.rows());
    for (int i = 0; i < G.rows(); ++i) label_.push_back(first_slack + i), basic_.push_back(i);
    for (int j = 0; j < G.cols(); ++j) label_.push_back(first_u + j);
  }

  /// Brings the variable of this label into the basis; the label of the one that leaves, kLost when rounding lets none
  /// leave.
  int enter(int label) {
    const Eigen::Index s = std::find(label_.begin(), label_.end(), label) - label_.begin();
    Eigen::Index r = -1;
    for (Eigen::Index i = 0; i < t_.rows(); ++i)
      if (t_(i, s) > kZero && (r < 0 || before(i, r, s))) r = i;
    if (r < 0) return kLost;  // a polytope is bounded
    t_.row(r) /= t_(r, s);
    for (Eigen::Index i = 0; i < t_.rows(); ++i) {
      if (i == r || t_(i, s) == 0) continue;
      const Eigen::RowVectorXd before_row = t_.row(i);
      t_.row(i) -= t_(i, s) * t_.row(r);
      t_(i, s) = 0;
      for (Eigen::Index c = 0; c < t_.cols(); ++c)  // what cancels to rounding was a tie
        if (std::abs(t_(i, c)) <= 1e-14 * std::abs(before_row[c])) t_(i, c) = 0;
    }
    const int leaving = label_[static_cast<std::size_t>(basic_[static_cast<std::size_t>(r)])];
    basic_[static_cast<std::size_t>(r)] = s;
    return leaving;
  }

  /// The basic columns, in ascending order.
  std::vector<Eigen::Index> basis() const {
    auto columns = basic_;
    std::sort(columns.begin(), columns.end());
    return columns;
  }

  /// The variable of this label is at zero and may enter.
  bool rests(int label) const {
    const auto column = std::find(label_.begin(), label_.end(), label) - label_.begin();
    return std::find(basic_.begin(), basic_.end(), column) == basic_.end();
  }

  /// Values of the variables that bear the labels first, …, first + count − 1.
  Eigen::VectorXd values(int first, Eigen::Index count) const {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(count);
    for (Eigen::Index i = 0; i < t_.rows(); ++i) {
      const int label = label_[static_cast<std::size_t>(basic_[static_cast<std::size_t>(i)])];
      if (label >= first && label < first + count) u[label - first] = std::max(0.0, t_(i, t_.cols() - 1));
    }
    return u;
  }

 private:
  static constexpr double kZero = 1e-12, kTie = 1e-12;

  /// Ratio of row i below that of row r: by the right-hand side, then by the columns of the slacks.
  bool before(Eigen::Index i, Eigen::Index r, Eigen::Index s) const {
    for (Eigen::Index step = 0; step <= t_.rows(); ++step) {
      const Eigen::Index c = step == 0 ? t_.cols() - 1 : step - 1;
      const double a = t_(i, c) / t_(i, s), b = t_(r, c) / t_(r, s);
      if (std::abs(a - b) > kTie * std::max(std::abs(a), std::abs(b))) return a < b;
    }
    return false;
  }

  Eigen::MatrixXd t_;
  std::vector<int> label_;           // of each column
  std::vector<Eigen::Index> basic_;  // column of each row
};

enum class PathOfGame { there, stopped, lost };  // lost: by rounding it went in circles, or nowhere

/// A pair of vertices that has every label: the origin, or an equilibrium.
struct Game {
  const Eigen::MatrixXd &A, &B;
  int m, k;  // labels 0…m−1: strategies of player 1, m…m+k−1: of player 2
  Polytope p, q;

  Game(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b)
      : A(a),
        B(b),
        m(static_cast<int>(a.rows())),
        k(static_cast<int>(a.cols())),
        p(gains(b).transpose(), m, 0),
        q(gains(a), 0, m) {}

  /// Gains between 1 and 2: the same equilibria, whatever unit and offset the costs have.
  static Eigen::MatrixXd gains(const Eigen::MatrixXd& costs) {
    const double high = costs.maxCoeff(), span = std::max(high - costs.minCoeff(), std::numeric_limits<double>::min());
    return ((high - costs.array()) / span + 1).matrix();
  }
  /// Drops a label and continues until it returns. `stop` is polled at each pivot. No path comes twice to a pair of
  /// bases; with rounding it may: one that it had is kept, of the pivots 1, 2, 4, 8, … the last (Brent).
  PathOfGame follow(int label, const std::function<bool()>& stop) {
    Polytope* turn = p.rests(label) ? &p : &q;
    std::pair<std::vector<Eigen::Index>, std::vector<Eigen::Index>> kept;
    long pivots = 0, next = 1;
    for (int entering = label;;) {
      if (stop && stop()) return PathOfGame::stopped;
      const int leaving = turn->enter(entering);
      if (leaving == label) return PathOfGame::there;
      if (leaving == Polytope::kLost) return PathOfGame::lost;
      std::pair now(p.basis(), q.basis());
      if (now == kept) return PathOfGame::lost;
      if (++pivots == next) kept = std::move(now), next *= 2;
      turn = turn == &p ? &q : &p;
      entering = leaving;
    }
  }
  bool at_origin() const { return p.values(0, m).sum() == 0 || q.values(m, k).sum() == 0; }
  Equilibrium equilibrium(int label) const {
    Equilibrium e;
    e.x = p.values(0, m), e.y = q.values(m, k);
    e.x /= e.x.sum(), e.y /= e.y.sum();
    const Eigen::VectorXd by_row = A * e.y, by_column = B.transpose() * e.x;
    e.cost_1 = e.x.dot(by_row), e.cost_2 = e.y.dot(by_column);
    e.regret = std::max(e.cost_1 - by_row.minCoeff(), e.cost_2 - by_column.minCoeff());
    e.label = label;
    return e;
  }
};

void check_game(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  if (A.rows() != B.rows() || A.cols() != B.cols() || A.size() == 0)
    throw std::invalid_argument("lemke_howson: A is " + std::to_string(A.rows()) + " x " + std::to_string(A.cols()) +
                                ", B is " + std::to_string(B.rows()) + " x " + std::to_string(B.cols()) +
                                ": must have the same shape and not be empty");
  if (!A.allFinite() || !B.allFinite()) throw std::invalid_argument("lemke_howson: A, B: entries must be finite");
}

}  // namespace

Equilibrium lemke_howson(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, int label,
                         const std::function<bool()>& stop) {
  check_game(A, B);
  Game game(A, B);
  if (label < 0 || label >= game.m + game.k)
    throw std::invalid_argument("lemke_howson: label = " + std::to_string(label) + ": must be in [0, " +
                                std::to_string(game.m + game.k - 1) + "]");
  const PathOfGame path = game.follow(label, stop);
  if (path == PathOfGame::lost)
    throw std::runtime_error("lemke_howson: rounding leads the path of label " + std::to_string(label) +
                             " in circles: the costs span too many orders");
  if (path == PathOfGame::stopped) return {};
  return game.equilibrium(label);
}

std::vector<Equilibrium> lemke_howson_all(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                          const std::function<bool()>& stop) {
  check_game(A, B);
  std::vector<Game> open = {Game(A, B)};  // the origin, then every equilibrium: paths start from each
  std::vector<Equilibrium> found;
  for (std::size_t from = 0; from < open.size(); ++from)
    for (int label = 0; label < open[from].m + open[from].k; ++label) {
      Game game = open[from];
      const PathOfGame path = game.follow(label, stop);
      if (path == PathOfGame::stopped) return found;
      if (path == PathOfGame::lost || game.at_origin()) continue;
      const Equilibrium e = game.equilibrium(label);
      const bool known = std::any_of(found.begin(), found.end(), [&](const Equilibrium& f) {
        return (e.x - f.x).lpNorm<Eigen::Infinity>() < 1e-9 && (e.y - f.y).lpNorm<Eigen::Infinity>() < 1e-9;
      });
      if (known) continue;
      found.push_back(e);
      open.push_back(game);
    }
  return found;
}

std::string LemkeHowson::why_not(const Lcp& p) const {
  if (!p.friction.empty()) return "friction rows: a bimatrix game has none";
  const Index n = p.size();
  for (Index i = 0; i < n; ++i)
    if (p.lo[i] != 0 || p.hi[i] != kInf || p.b[i] != -1)
      return "row " + std::to_string(i) + ": a bimatrix game has bounds [0, inf) and -1 in the vector";
  if (n > 10000) return "n = " + std::to_string(n) + ": the dense tableaus take at most 10000 rows";
  DenseMatrix M;
  to_dense(p.A, M);
  // The first row's zeros are the strategies of player 1, wherever they stand.
  order_.clear();
  for (Index j = 0; j < n; ++j)
    if (M(0, j) == 0) order_.push_back(j);
  const auto m = static_cast<Index>(order_.size());
  for (Index j = 0; j < n; ++j)
    if (M(0, j) != 0) order_.push_back(j);
  M = M(order_, order_).eval();
  if (m == 0 || m == n || (M.topLeftCorner(m, m).array() != 0).any() ||
      (M.bottomRightCorner(n - m, n - m).array() != 0).any())
    return "the matrix has no zero blocks on its diagonal, in whatever order: it is no bimatrix game [0, A; B^T, 0]";
  if (!(M.topRightCorner(m, n - m).array() > 0).all() || !(M.bottomLeftCorner(n - m, m).array() > 0).all())
    return "costs must be > 0 (add a constant: the equilibria stay)";
  A_ = M.topRightCorner(m, n - m);
  B_ = M.bottomLeftCorner(n - m, m).transpose();
  if (options_.label >= n) return "label = " + std::to_string(options_.label) + ": must be below " + std::to_string(n);
  return {};
}

Claim LemkeHowson::follow(int label, Solution& s) {
  Game game(A_, B_);
  const PathOfGame path = game.follow(label, [&] {
    log(++s.iterations, 0, 0, "pivot");
    return budget().exhausted();
  });
  if (path == PathOfGame::stopped) return Claim::time_limit;
  if (path == PathOfGame::lost) return Claim::stalled;  // z as it was: the next label's turn
  const Equilibrium e = game.equilibrium(label);
  for (Index i = 0; i < s.z.size(); ++i)
    s.z[order_[static_cast<std::size_t>(i)]] = i < A_.rows() ? e.x[i] / e.cost_2 : e.y[i - A_.rows()] / e.cost_1;
  return Claim::candidate;
}

Claim LemkeHowson::run(const Lcp&, Solution& s, Start) { return follow(std::max(0, options_.label), s); }

bool LemkeHowson::run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) {
  if (options_.label >= 0 || attempt >= problem.size()) return false;
  claim = follow(attempt, s);
  return true;
}

}  // namespace orthant
