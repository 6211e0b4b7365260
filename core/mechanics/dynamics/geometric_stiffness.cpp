#include <orthant/core/mechanics/dynamics/geometric_stiffness.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

/// What the joint's rows with the forces λ, per duration, add to the diagonal of K.
struct AddStiffness {
  const Kinematics& at;
  const Eigen::VectorXd& mass;
  const Row* G;
  const double* lambda;
  double by;  // 1 / duration
  Eigen::VectorXd& K;

  void operator()(const Revolute& j) const { pin(j.a, j.b); }
  void operator()(const Fixed& j) const { pin(j.a, j.b); }
  void operator()(const Distance& j) const {
    const Vector2d r_a = at.at(j.a).turn(j.point_a), r_b = at.at(j.b).turn(j.point_b);
    const Vector2d d = at.at(j.a).x + r_a - at.at(j.b).x - r_b;
    const double length = d.norm(), force = by * lambda[0];
    if (!(length > 0)) return;
    const Vector2d n = d / length;
    if (j.a >= 0) rotation(K, j.a) += force * r_a.dot(n);
    if (j.b >= 0) rotation(K, j.b) -= force * r_b.dot(n);
    if (!(force < 0)) return;
    const Row across = pair_row(j.a, j.b, perp(n), r_a, r_b);
    double sum = 0;  // e eᵀ ≤ diag(|e_k| √M_k Σ |e_l| / √M_l)
    each_entry(across, [&](Index k, double e) { sum += std::abs(e) / std::sqrt(mass[k]); });
    each_entry(across, [&](Index k, double e) { K[k] -= force / length * std::abs(e) * std::sqrt(mass[k]) * sum; });
  }
  template <class J> void operator()(const J& /*joint*/) const {}

 private:
  /// Rows (1, 0, −r_y) and (0, 1, r_x) of a, the negative ones of b: r · F from their last entries.
  void pin(BodyId a, BodyId b) const {
    if (a >= 0) rotation(K, a) += by * (lambda[0] * G[1].ja[2] - lambda[1] * G[0].ja[2]);
    if (b >= 0) rotation(K, b) += by * (lambda[0] * G[1].jb[2] - lambda[1] * G[0].jb[2]);
  }
};

/// [m] from the centre of mass: where a joint of these kinds holds body b. 0: another kind.
double lever(const Joint& joint, BodyId b) {
  return std::visit(
      [b](const auto& j) {
        if constexpr (requires { j.point_a; })
          return std::max(j.a == b ? j.point_a.norm() : 0.0, j.b == b ? j.point_b.norm() : 0.0);
        else
          return 0.0;
      },
      joint);
}

}  // namespace

GeometricStiffness::GeometricStiffness(const System& system) : system_(system) {
  constexpr double kLight = 100;  // inertia of all on the lever over a body's own; a bar among five like it has 15
  const Scene& scene = system.scene();
  if (scene.joints.empty()) return;
  for (Eigen::VectorXd* each : {&K_, &x_, &force_}) each->setZero(system.dof());
  zero_.setZero(system.joint_rows()), lambda_.setZero(system.joint_rows());
  const auto body_count = static_cast<std::size_t>(system.bodies());
  std::vector<double> mass(body_count), levers(body_count);
  for (std::size_t i = 0; i < body_count; ++i)
    mass[static_cast<std::size_t>(system.assembly()[i])] += scene.bodies[i].mass;
  for (const Joint& joint : scene.joints) {
    const auto [a, b] = std::visit([](const auto& j) { return bodies_of(j); }, joint);
    for (const BodyId body : {a, b})
      if (body >= 0) {
        double& most = levers[static_cast<std::size_t>(body)];
        most = std::max(most, lever(joint, body));
      }
  }
  bool jointed = false;
  for (std::size_t i = 0; i < body_count; ++i) {
    if (levers[i] == 0) continue;
    jointed = true;
    const double all = mass[static_cast<std::size_t>(system.assembly()[i])];
    possible_ = possible_ || all * levers[i] * levers[i] > kLight * scene.bodies[i].inertia;
  }
  const bool distances = std::any_of(scene.joints.begin(), scene.joints.end(),
                                     [](const Joint& j) { return std::holds_alternative<Distance>(j); });
  if (distances)
    for (std::size_t i = 0; i < body_count; ++i)
      possible_ = possible_ || mass[static_cast<std::size_t>(system.assembly()[i])] > kLight * scene.bodies[i].mass;
  const bool pulled = std::any_of(scene.loads.begin(), scene.loads.end(),
                                  [](const Load& load) { return load.force != Vector2d(0, 0); });
  possible_ = possible_ || ((jointed || distances) && (pulled || !scene.springs.empty()));
}

bool GeometricStiffness::raise(const Terms& terms, const double* lambda, double duration, double weight, double share,
                               Eigen::VectorXd& added) const {
  K_.setZero();
  const auto& joints = system_.scene().joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto row = static_cast<std::size_t>(system_.first_row(j));
    std::visit(AddStiffness{terms.at, system_.mass(), terms.G.data() + row, lambda + row, 1 / duration, K_}, joints[j]);
  }
  bool counts = false;
  for (Index k = 0; k < K_.size(); ++k) {
    const double more = weight * K_[k];
    if (!(more > added[k])) continue;
    added[k] = more;
    counts = counts || more > share * system_.mass()[k];
  }
  return counts;
}

bool GeometricStiffness::swings(const BasicSystem& basic, const Eigen::VectorXd& added, double bound) const {
  constexpr int kSteps = 4;
  constexpr double kNear = 0.7;  // what so few steps find of the eigenvalue
  // As good as random, and the same motion in whatever units of length and mass.
  for (Index i = 0; i < x_.size(); ++i) x_[i] = std::cos(static_cast<double>(i * i + 1)) / std::sqrt(system_.mass()[i]);
  for (int i = 0; i < kSteps; ++i) {
    force_ = added.cwiseProduct(x_);
    const double before = x_.dot(force_);
    if (!(before > 0)) return false;
    basic.solve(force_.data(), zero_.data(), x_.data(), lambda_.data());
    const double after = x_.dot(added.cwiseProduct(x_));
    if (after > kNear * kNear * bound * bound * before) return true;
    x_ /= std::sqrt(before);
  }
  return false;
}

}  // namespace orthant
