#include <orthant/solvers/active_set/fischer_burmeister.h>
#include <orthant/solvers/pivoting/path_work.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr int kCrashNonlinear = 2;  // a step costs a Jacobian there, and is counted as one

}  // namespace

double Path::Work::merit(const Vector& at_z, const Vector& at_F) const {
  double sum = 0;
  for (Index i = 0; i < at_z.size(); ++i) {
    const double phi = detail::complementarity_row(1, at_z[i], at_F[i], (*model.lo)[i], (*model.hi)[i]).value;
    sum += phi * phi;
  }
  return std::isfinite(sum) ? 0.5 * sum : kInf;
}

double Path::Work::natural_residual(const Vector& at_z, const Vector& at_F) const {
  double r = 0;
  for (Index i = 0; i < at_z.size(); ++i)
    r = std::max(r, std::abs(at_z[i] - std::clamp(at_z[i] - at_F[i], (*model.lo)[i], (*model.hi)[i])));
  return r;
}

void Path::Work::project(const Vector& from, Vector& to) const {
  to.resize(from.size());
  for (Index i = 0; i < from.size(); ++i) to[i] = std::clamp(from[i], (*model.lo)[i], (*model.hi)[i]);
}

void Path::Work::lift(const Vector& at_z, const Vector& at_F, Vector& to) const {
  to = at_z;
  for (Index i = 0; i < to.size(); ++i)
    if ((at_z[i] == (*model.lo)[i] && at_F[i] > 0) || (at_z[i] == (*model.hi)[i] && at_F[i] < 0)) to[i] -= at_F[i];
}

double Path::Work::largest() const {
  double size = 0;
  for (const double value : columns.value) size = std::max(size, std::abs(value));
  return size;
}

bool Path::Work::visit(const Vector& to_x) {
  trial_x = to_x;
  project(trial_x, trial_z);
  return model.F(trial_z, trial_F);
}

void Path::Work::crash() {
  double now = merit(z, F);
  const int most = linear() ? path.options_.max_crash : std::min(path.options_.max_crash, kCrashNonlinear);
  for (int k = 0; k < most && !stop(); ++k) {
    if (natural_residual(z, F) <= model.goal) return;
    const Matrix* A = nullptr;
    if (!model.J(z, A)) return;
    if (!linear() || k == 0) columns.load(*A);
    const auto pressed = [&](Index i) {
      return (z[i] == (*model.lo)[i] && F[i] >= 0) || (z[i] == (*model.hi)[i] && F[i] <= 0);
    };
    basis.reset(model.size(), storage_of(*A), 64, &path.budget());
    if (!basis.factorize([&](Index i, const auto& add) {
          if (pressed(i))
            add(i, 1.0);
          else
            columns.each(i, add);
        }))
      return;
    if (!linear()) ++iterations;
    step = -F;
    basis.solve(step);
    bool moved = false;
    for (double length = 1; length > 0.1 && !moved; length /= 2) {
      scratch = z;
      for (Index i = 0; i < model.size(); ++i)
        if (!pressed(i)) scratch[i] += length * step[i];
      if (!scratch.allFinite() || !visit(scratch)) continue;
      const double value = merit(trial_z, trial_F);
      if (value > (1 - 0.1 * length) * now) continue;
      z = trial_z, F = trial_F, now = value, moved = true;
      path.log(iterations, std::sqrt(2 * now), length, "crash");
    }
    if (!moved) return;
  }
}

template <class T> PathEnd Path::Work::follow(NormalPath<T>& p, const Matrix& A, bool on_ray) {
  using End = PathEnd;
  p.load(columns, q, *model.lo, *model.hi, storage_of(A), path.budget());
  p.break_ties_by(tie_breaker);
  if (!(on_ray ? p.start_on_ray(cover) : p.start(x))) return End::singular;
  const auto end = p.follow(
      max_pivots(), [&](double) { return stop(); }, linear() ? nullptr : &points);
  p.point(trial_z, trial_x);
  if (end == End::ray) p.direction(ray);
  return end;
}

PathEnd Path::Work::pursue(const Matrix& A, PathDigits digits, bool on_ray, int& pivots) {
  const auto along = [&](auto& p) {
    const PathEnd end = follow(p, A, on_ray);
    pivots = p.pivots();
    return end;
  };
  return digits == PathDigits::plain      ? along(normal_path)
         : digits == PathDigits::extended ? along(long_path)
                                          : along(wide_path);
}

bool Path::Work::search(double reference) {
  const auto n = static_cast<std::size_t>(model.size());
  const auto good_enough = [&](double gain) { return merit(trial_z, trial_F) <= (1 - kDescent * gain) * reference; };
  const Vector origin = x;
  for (std::size_t p = points.t.size(); p-- > 1;) {
    const std::size_t left = points.t.size() - p;
    if (left > 8 && (left & (left - 1)) != 0 && p > 1) continue;  // the last ones, then ever fewer, and the first
    scratch = Eigen::Map<const Eigen::VectorXd>(points.x.data() + p * n, model.size());
    if (scratch.allFinite() && visit(scratch) && good_enough(std::max(points.t[p], 0.01))) return accept(), true;
  }
  if (points.t.size() > 1) {
    const Eigen::Map<const Eigen::VectorXd> first(points.x.data() + n, model.size());
    for (double length = 0.5; length > 1e-6; length /= 2) {
      scratch = (1 - length) * origin + length * first;
      if (scratch.allFinite() && visit(scratch) && good_enough(0.01 * length)) return accept(), true;
    }
  }
  return descend();
}

bool Path::Work::descend() {
  const Index n = model.size();
  const Matrix* A = nullptr;
  if (!model.J(z, A)) return false;
  columns.load(*A);
  Vector da, right;
  da.resize(n), right.resize(n), gradient.resize(n);
  for (Index i = 0; i < n; ++i) {
    const auto s = detail::complementarity_row(1, z[i], F[i], (*model.lo)[i], (*model.hi)[i]);
    da[i] = s.da * s.value, right[i] = s.db * s.value;
  }
  for (Index j = 0; j < n; ++j) {
    gradient[j] = da[j];
    columns.each(j, [&](Index i, double value) { gradient[j] += value * right[i]; });
  }
  const double now = merit(z, F), size = gradient.squaredNorm();
  const double longest = 2 * now / size;  // infinite where the gradient's square is lost to underflow
  if (!(size > 0) || !std::isfinite(size) || !std::isfinite(longest)) return false;
  const Vector from = z;
  for (double length = longest; length > 5e-15 * longest && !stop(); length /= 4) {
    scratch = from - length * gradient;
    if (!scratch.allFinite() || !visit(scratch)) continue;
    const double promised = gradient.dot(from - trial_z);
    if (promised > 0 && merit(trial_z, trial_F) <= now - kDescent * promised) {
      lift(trial_z, trial_F, trial_x);
      return accept(), true;
    }
  }
  return false;
}

}  // namespace orthant
