// solvers/pivoting/path_work.h — state of one solve by path.h: variation, problem, points and merits.
#pragma once

#include <orthant/core/lcp/pure_form.h>
#include <orthant/solvers/active_set/coarse_start.h>
#include <orthant/solvers/pivoting/normal_path.h>
#include <orthant/solvers/pivoting/path.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace orthant {

/// A restart changes these. The first is the method as it stands in path.h; the others go where theory promises most.
enum class PathDigits { plain, extended, wide };  // double, long double, 256 bits (scalars.h)
struct PathVariation {
  const char* name;
  bool crash, ray;    // crash first; paths start on the ray
  PathDigits digits;  // to pivot in
  double proximal;    // ε relative to the largest entry of J
  unsigned seed;      // 0: the given start and e as covering vector; else random ones
};

/// The problem as the method sees it, linear or not.
struct PathModel {
  const Vector *lo = nullptr, *hi = nullptr;
  std::function<bool(const Vector& z, Vector& F)> F;         // false: not finite
  std::function<bool(const Vector& z, Matrix const*& J)> J;  // false: not finite
  const Vector* constant = nullptr;                          // of a linear problem: b
  double goal = 0;                                           // natural residual at which to stop
  std::function<bool(const Vector&)> enough;                 // nonlinear: whether the judge would accept z
  Index size() const { return lo->size(); }
};

struct Path::Work {
  explicit Work(Path& owner) : path(owner) {}
  Path& path;
  Pyramid pyramid;
  const Lcp* pure = nullptr;
  bool reduced = false;
  std::size_t variation = 0;
  PathModel model;
  Matrix J;
  Vector start, y, scratch;

  Columns columns;
  Basis<double> basis;  // of the crash
  CoarseStart coarse;
  NormalPath<double> normal_path;
  NormalPath<long double> long_path;
  NormalPath<detail::Float256> wide_path;
  PathPoints points, good_points;  // of the last step; of the one from good_x, while steps are taken on trust
  Vector z, x, F, q, trial_z, trial_x, trial_F, good_x, ray, cover, step, gradient, best_z;
  static constexpr double kDescent = 1e-4;  // share of the promised decrease that must be had
  std::vector<double> merits;
  int iterations = 0;
  unsigned tie_breaker = 0;

  double merit(const Vector& at_z, const Vector& at_F) const;
  double natural_residual(const Vector& at_z, const Vector& at_F) const;
  void project(const Vector& from, Vector& to) const;
  /// The x that stands for z: beyond a bound by as much as F presses against it.
  void lift(const Vector& at_z, const Vector& at_F, Vector& to) const;
  double largest() const;
  bool linear() const { return model.constant != nullptr; }
  int max_pivots() const {
    return path.options_.max_pivots > 0 ? path.options_.max_pivots : 3000 + 50 * static_cast<int>(model.size());
  }
  bool stop() const { return path.budget().exhausted(); }

  /// Trial point x moved to z = π(x) and its F: false when F is not finite there.
  bool visit(const Vector& to_x);
  void accept() { x = trial_x, z = trial_z, F = trial_F; }

  // Projected Newton steps while they do some good. z, F: start and result.
  void crash();

  // The step: points holds the path from x for the linearization there; claims like NormalPath. pivots: of this path.
  PathEnd pursue(const Matrix& A, PathDigits digits, bool on_ray, int& pivots);

  // Backwards along the path, then along the first piece, then down the gradient of the merit. x, z, F: the good point.
  bool search(double reference);

  // One variation from `start`; the result in z.
  Claim iterate(const PathVariation& v);

 private:
  template <class T> PathEnd follow(NormalPath<T>& p, const Matrix& A, bool on_ray);
  bool descend();
  double reference() const { return *std::max_element(merits.begin(), merits.end()); }
  void remember(double value) {
    if (merits.size() >= static_cast<std::size_t>(path.options_.memory)) merits.erase(merits.begin());
    merits.push_back(value);
  }
};

}  // namespace orthant
