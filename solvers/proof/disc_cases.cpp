#include <orthant/solvers/proof/disc_cases.h>
#include <orthant/solvers/proof/farkas.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace orthant {
namespace {

constexpr int kMostCases = 4000;
constexpr std::size_t kMostContacts = 4;
constexpr double kRaised = 1e-9;      // of the largest coefficient
constexpr double kMostImpulse = 1e5;  // A_nn z_n over the largest |b|
constexpr double kFirstArc = std::numbers::pi / 2;
constexpr double kAskew = 0.3;                 // [rad] ends of arcs along the tangents leave entries of 1e-17
constexpr double kLeastArc = kFirstArc / 256;  // narrower: undecided

struct CaseOfContact {
  enum class Mode { any, open, sticks, slides } mode = Mode::any;
  double from = 0, arc = 0;  // [rad]
};

struct ContactOfProblem {
  Index normal = 0, tangent = -1;  // rows; −1: it has no friction
  double mu = 0;
};

class Exhaustion {
 public:
  /// False: the problem has rows that are not of contacts, or too many contacts.
  bool load(const Lcp& problem) {
    std::vector<char> taken(static_cast<std::size_t>(problem.size()), 0);
    for (Index i = 0; i < problem.size(); ++i)
      if (problem.lo[i] == 0 && problem.hi[i] == kInf) contacts_.push_back({.normal = i}), taken[at(i)] = 1;
    for (const Friction& f : problem.friction) {
      const auto c = std::ranges::find(contacts_, f.normal, &ContactOfProblem::normal);
      if (f.rows != 2 || c == contacts_.end() || c->tangent >= 0) return false;
      c->tangent = f.first, c->mu = f.mu, taken[at(f.first)] = taken[at(f.first + 1)] = 1;
    }
    if (contacts_.size() > kMostContacts || !std::ranges::all_of(taken, [](char t) { return t != 0; })) return false;
    A_ = std::get<DenseMatrix>(with_dense_matrix(problem, room_).A), b_ = problem.b;
    return A_.allFinite() && b_.allFinite();
  }

  bool run() {
    std::vector<std::vector<CaseOfContact>> open(1, std::vector<CaseOfContact>(contacts_.size()));
    for (int count = 0; !open.empty(); ++count) {
      if (count == kMostCases) return false;
      const std::vector<CaseOfContact> one = std::move(open.back());
      open.pop_back();
      if (!excluded(one) && !divide(one, open)) return false;
    }
    return true;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Eigen::Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

  /// The parts of a case, behind `open`. False: it is not divided further.
  bool divide(const std::vector<CaseOfContact>& one, std::vector<std::vector<CaseOfContact>>& open) const {
    using Mode = CaseOfContact::Mode;
    const auto add = [&](std::size_t k, const CaseOfContact& as) { open.push_back(one), open.back()[k] = as; };
    for (std::size_t k = 0; k < one.size(); ++k) {
      if (one[k].mode != Mode::any) continue;
      add(k, {Mode::open});
      if (contacts_[k].tangent < 0) return add(k, {Mode::sticks}), true;
      for (int quarter = 0; quarter < 4; ++quarter)
        for (const Mode mode : {Mode::sticks, Mode::slides}) add(k, {mode, kAskew + quarter * kFirstArc, kFirstArc});
      return true;
    }
    const auto widest = std::ranges::max_element(one, {}, &CaseOfContact::arc);
    if (widest == one.end() || widest->arc <= kLeastArc) return false;
    const auto k = static_cast<std::size_t>(widest - one.begin());
    const double half = widest->arc / 2;
    add(k, {widest->mode, widest->from, half}), add(k, {widest->mode, widest->from + half, half});
    return true;
  }

  /// Columns of z, z = Z y with y ≥ 0, and rows R of w with R w ≥ 0.
  bool excluded(const std::vector<CaseOfContact>& one) {
    using Mode = CaseOfContact::Mode;
    rays_.clear(), signs_.clear();
    for (std::size_t k = 0; k < one.size(); ++k) {
      const ContactOfProblem& c = contacts_[k];
      const CaseOfContact& as = one[k];
      demand(c.normal, 1);
      if (as.mode == Mode::open) continue;
      if (as.mode != Mode::any) demand(c.normal, -1);
      if (c.tangent < 0 || c.mu == 0 || as.mode == Mode::sticks) push(c, {0, 0});
      if (c.tangent < 0) continue;
      if (as.mode == Mode::any) {
        for (int side = 0; side < 8; ++side)
          push(c, c.mu / std::cos(std::numbers::pi / 8) * direction(side * std::numbers::pi / 4));
        continue;
      }
      const double sign = as.mode == Mode::sticks ? 1 : -1, mid = as.from + as.arc / 2;
      for (const double edge : {as.from, as.from + as.arc}) push(c, sign * c.mu * direction(edge));
      push(c, sign * c.mu / std::cos(as.arc / 2) * direction(mid));
      if (as.mode == Mode::sticks) {
        for (const Index row : {c.tangent, c.tangent + 1}) demand(row, 1), demand(row, -1);
      } else {
        const Eigen::Vector2d first = direction(as.from), last = direction(as.from + as.arc);
        demand(c.tangent, -first.y(), first.x()), demand(c.tangent, last.y(), -last.x());
      }
    }
    return infeasible();
  }
  void push(const ContactOfProblem& c, const Eigen::Vector2d& along) {
    Eigen::VectorXd ray = Eigen::VectorXd::Unit(b_.size(), c.normal);
    if (c.tangent >= 0) ray.segment<2>(c.tangent) = along;
    rays_.push_back(ray);
  }
  void demand(Index row, double sign, double next = 0) {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(b_.size());
    weights[row] = sign;
    if (next != 0) weights[row + 1] = next;
    signs_.push_back(weights);
  }

  /// Of M y + q ≥ 0, y ≥ 0 with its coefficients raised.
  bool infeasible() {
    const auto rows = std::ssize(signs_), columns = std::ssize(rays_), bounds = std::ssize(contacts_);
    const Index n = std::max(rows + bounds, columns);
    const double largest = b_.lpNorm<Eigen::Infinity>(), raise = kRaised * A_.cwiseAbs().maxCoeff();
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
    for (Index i = 0; i < rows; ++i) {
      const Eigen::VectorXd row = A_.transpose() * signs_[at(i)];
      for (Index j = 0; j < columns; ++j) M(i, j) = row.dot(rays_[at(j)]) + raise;
      q[i] = b_.dot(signs_[at(i)]) + kRaised * largest;
    }
    for (Index k = 0; k < bounds; ++k) {
      const Index normal = contacts_[at(k)].normal;
      q[rows + k] = largest;  // a row of the size of the others: small multipliers are taken for noise
      for (Index j = 0; j < columns; ++j) M(rows + k, j) = -A_(normal, normal) / kMostImpulse * rays_[at(j)][normal];
    }
    const Lcp program = Lcp::standard(DenseMatrix(M), Vector(q));
    if (!farkas_.propose(program, u_) || u_.size() != n || u_.minCoeff() < 0) return false;
    const Eigen::VectorXd u = u_;
    const double size = u.head(rows).sum();  // what is left of the raise proves
    return (M.transpose() * u).maxCoeff() <= raise / 10 * size && q.dot(u) < -kRaised / 10 * largest * size;
  }

  std::vector<ContactOfProblem> contacts_;
  Lcp room_;
  Eigen::MatrixXd A_;
  Eigen::VectorXd b_;
  std::vector<Eigen::VectorXd> rays_, signs_;
  Farkas farkas_;
  Vector u_;
};

}  // namespace

bool excludes_all_cases(const Lcp& problem) {
  Exhaustion all;
  return problem.discs() && all.load(problem) && all.run();
}

}  // namespace orthant
