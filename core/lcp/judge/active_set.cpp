#include <orthant/core/lcp/judge/active_set.h>

#include <orthant/core/lcp/judge/definite.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

constexpr Index kMostRows = 1000;
constexpr std::size_t kMostChoices = 256;

enum Place : signed char { at_lower, between, at_upper };

bool regular(Eigen::MatrixXd J) {
  for (Index i = 0; i < J.rows(); ++i) {  // units of rows and columns must not decide
    const double size = J.row(i).cwiseAbs().maxCoeff();
    if (!(size > 0)) return false;
    J.row(i) /= size;
  }
  for (Index j = 0; j < J.cols(); ++j) {
    const double size = J.col(j).cwiseAbs().maxCoeff();
    if (!(size > 0)) return false;
    J.col(j) /= size;
  }
  if (J.rows() == 0) return true;
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(J);
  const double noise = 32 * static_cast<double>(J.rows()) * std::numeric_limits<double>::epsilon();
  return lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0 && lu.rcond() > noise;  // rcond is no use with a zero pivot
}

}  // namespace

std::string_view name(Isolation isolation) {
  return isolation == Isolation::isolated    ? "isolated"
         : isolation == Isolation::maybe_not ? "maybe not unique"
                                             : "not decided";
}

ActiveSet active_set(const Lcp& problem, const Solution& s) {
  const Index n = problem.size();
  if (s.z.size() != n || s.w.size() != n)
    throw std::invalid_argument("active_set: z and w must have " + std::to_string(n) + " entries");
  const Formed::Sparse A = formed(problem.A).value;
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(n);
  for (Index j = 0; j < n; ++j)
    for (Formed::Sparse::InnerIterator it(A, j); it; ++it) weight[j] = std::max(weight[j], std::abs(it.value()));

  ActiveSet result;
  std::vector<std::vector<Place>> choices(static_cast<std::size_t>(n));
  const double threshold = std::max(s.residual, 20 * s.rounding);
  const auto stand = [&](Index i, double lo, double hi, bool fixed) {
    const double z = s.z[i], w = s.w[i];
    const bool low = weight[i] * (z - lo) <= threshold, high = weight[i] * (hi - z) <= threshold;
    auto& choice = choices[static_cast<std::size_t>(i)];
    if (fixed || (low && w > threshold)) {
      result.lower.push_back(i), choice = {at_lower};
    } else if (high && w < -threshold) {
      result.upper.push_back(i), choice = {at_upper};
    } else if (!low && !high) {
      result.inside.push_back(i), choice = {between};
    } else {
      result.degenerate.push_back(i);
      if (low) choice.push_back(at_lower);
      choice.push_back(between);
      if (high) choice.push_back(at_upper);
    }
  };
  std::vector<const Friction*> coupled(static_cast<std::size_t>(n));
  for (const Friction& f : problem.friction) coupled[static_cast<std::size_t>(f.first)] = &f;
  std::size_t combinations = 1;
  std::vector<char> disc(static_cast<std::size_t>(n), 0);
  for (const Friction& f : problem.friction) {
    if (f.rows == 1) continue;
    const double radius = f.mu * s.z[f.normal], room = radius - std::hypot(s.z[f.first], s.z[f.first + 1]);
    const double slip = std::hypot(s.w[f.first], s.w[f.first + 1]);
    const bool at_edge = std::max(weight[f.first], weight[f.first + 1]) * room <= threshold;
    for (Index i = f.first; i < f.first + f.rows; ++i) {
      disc[static_cast<std::size_t>(i)] = 1;
      (!at_edge ? result.inside : slip > threshold ? result.upper : result.degenerate).push_back(i);
    }
  }
  for (Index i = 0; i < n; ++i) {
    if (disc[static_cast<std::size_t>(i)]) continue;
    if (const Friction* f = coupled[static_cast<std::size_t>(i)]; f != nullptr)
      stand(i, -f->mu * s.z[f->normal], f->mu * s.z[f->normal], f->mu == 0);
    else
      stand(i, problem.lo[i], problem.hi[i], problem.lo[i] == problem.hi[i]);
    combinations = std::min(combinations * choices[static_cast<std::size_t>(i)].size(), kMostChoices + 1);
  }
  if (problem.discs()) {
    for (auto* rows : {&result.lower, &result.inside, &result.upper, &result.degenerate})
      std::sort(rows->begin(), rows->end());
    return result;
  }
  if (n > kMostRows || combinations > kMostChoices) return result;

  result.isolation = Isolation::isolated;
  Eigen::MatrixXd J(n, n);
  for (std::size_t k = 0; k < combinations; ++k) {
    std::size_t rest = k;
    for (Index i = 0; i < n; ++i) {
      const auto& choice = choices[static_cast<std::size_t>(i)];
      const Place place = choice[rest % choice.size()];
      rest /= choice.size();
      if (place == between) {
        J.row(i) = A.row(i);
        continue;
      }
      J.row(i) = Eigen::RowVectorXd::Unit(n, i);
      if (const Friction* f = coupled[static_cast<std::size_t>(i)]; f != nullptr)
        J(i, f->normal) = place == at_lower ? f->mu : -f->mu;
    }
    if (regular(J)) continue;
    result.isolation = Isolation::maybe_not;
    break;
  }
  return result;
}

}  // namespace orthant
