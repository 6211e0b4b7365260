#include <orthant/core/lcp/problems/disc_contacts.h>

#include <cmath>

namespace orthant {

Known disc_contacts(const DiscContacts& kind, Random& random) {
  using Eigen::MatrixXd, Eigen::VectorXd;
  const Index d = kind.rolling ? 5 : 3, n = d * kind.contacts;
  MatrixXd W(n, kind.freedoms);
  for (double& value : W.reshaped()) value = random.normal();
  VectorXd inverse_mass(kind.freedoms);
  for (double& value : inverse_mass) value = std::exp(-random.uniform(0, std::log(kind.spread)));
  for (Index k = 0; k < kind.contacts; ++k) {
    const double unit = std::exp(random.uniform(-0.5, 0.5) * std::log(kind.spread));
    W.middleRows(d * k, d) *= unit;
  }
  MatrixXd A = W * inverse_mass.asDiagonal() * W.transpose();
  if (kind.unsymmetric) {
    MatrixXd skew = MatrixXd::Zero(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < i; ++j) {
        skew(i, j) = 0.1 * random.normal() * std::sqrt(A(i, i) * A(j, j) / static_cast<double>(n));
        skew(j, i) = -skew(i, j);
      }
    A += skew;
  }
  Known known{"disc_contacts", {}, Answer::one_of, {}, 1e-8, false};
  Lcp& p = known.problem;
  p.lo = VectorXd::Constant(n, -kInf), p.hi = VectorXd::Constant(n, kInf);
  VectorXd z = VectorXd::Zero(n), w = VectorXd::Zero(n);
  for (Index k = 0; k < kind.contacts; ++k) {
    const Index normal = d * k;
    const double z_unit = 1 / std::sqrt(A(normal, normal)), w_unit = std::sqrt(A(normal, normal));
    p.lo[normal] = 0;
    const int draw = kind.jammed ? 1 : random.integer(0, 2);  // open, stick, slip
    if (draw == 0) {
      w[normal] = kind.degenerate && random.integer(0, 2) == 0 ? 0 : w_unit * random.uniform();
      for (Index t = 1; t < d; ++t) w[normal + t] = w_unit * random.normal();
    } else {
      z[normal] = z_unit * random.uniform(0.1, 1);
    }
    for (Index first = normal + 1; first < normal + d; first += 2) {
      const double mu = first == normal + 1 ? kind.mu : 0.1 * kind.mu;
      p.friction.push_back({.normal = normal, .first = first, .rows = 2, .mu = mu});
      if (draw == 0) continue;
      const double angle = random.uniform(0, 2 * M_PI);
      const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
      const bool slips = draw == 2;
      const bool edge = slips || (kind.degenerate && random.integer(0, 2) == 0);
      z.segment(first, 2) = (edge ? 1 : random.uniform(0, 0.95)) * mu * z[normal] * direction;
      if (slips && !(kind.degenerate && random.integer(0, 2) == 0))
        w.segment(first, 2) = -w_unit * random.uniform(0.1, 1) * direction;
    }
  }
  p.A = DenseMatrix(A);
  p.b = w - A * z;
  known.z = z;
  return known;
}

}  // namespace orthant
