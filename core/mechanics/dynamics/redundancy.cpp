#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/core/mechanics/dynamics/joint_load.h>
#include <orthant/core/mechanics/dynamics/redundancy.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kIndependent = 3e-7;  // length left of a row of length 1
constexpr double kPart = 1e-6;         // coefficient of a row that takes part in a combination
constexpr double kMove = 0.1;          // [rad], or of the scene's size

constexpr double kOff = 1e-6;  // [m, rad] by which a combination of rows may miss: rounding of a scene's digits

struct Share {
  int row;
  double of_it;  // of the row made length 1
};
using Repeats = std::vector<std::vector<Share>>;  // of each row; empty: independent

template <class Space> void evaluate(const SystemOf<Space>& system, const Eigen::VectorXd& q, TermsOf<Space>& terms) {
  set_poses(system, system.initial_state().t, q, terms.at);
  evaluate_joint_residual(system, terms);
  evaluate_joint_rows(system, terms);
}

/// The rows as columns M^(-1/2) Gᵀ.
template <class Space> Eigen::MatrixXd mass_rows(const SystemOf<Space>& system, const TermsOf<Space>& terms) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(system.dof(), system.joint_rows());
  for (Index i = 0; i < columns.cols(); ++i)
    apply_transposed(terms.G[static_cast<std::size_t>(i)], 1.0, columns.col(i).data());
  columns = system.inverse_mass().cwiseSqrt().asDiagonal() * columns;
  return columns;
}

/// `basis`: orthonormal columns that span all rows.
Repeats dependencies(Eigen::MatrixXd rows, Eigen::MatrixXd& basis) {
  for (Index i = 0; i < rows.cols(); ++i) rows.col(i).normalize();
  Repeats repeats(static_cast<std::size_t>(rows.cols()));
  std::vector<int> independent;
  basis.resize(rows.rows(), std::min(rows.rows(), rows.cols()));
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(basis.cols(), basis.cols());  // independent rows = basis R
  Index rank = 0;
  for (Index i = 0; i < rows.cols(); ++i) {
    const auto known = basis.leftCols(rank);
    Eigen::VectorXd left = rows.col(i), parts = Eigen::VectorXd::Zero(rank);
    for (int twice = 0; twice < 2; ++twice) {
      const Eigen::VectorXd part = known.transpose() * left;
      left -= known * part;
      parts += part;
    }
    if (left.norm() > kIndependent && rank < basis.cols()) {
      R.col(rank).head(rank) = parts;
      R(rank, rank) = left.norm();
      basis.col(rank++) = left.normalized();
      independent.push_back(static_cast<int>(i));
      continue;
    }
    const Eigen::VectorXd share = R.topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(parts);
    for (Index k = 0; k < rank; ++k)
      if (std::abs(share[k]) > kPart)
        repeats[static_cast<std::size_t>(i)].push_back({independent[static_cast<std::size_t>(k)], share[k]});
  }
  basis.conservativeResize(Eigen::NoChange, rank);
  return repeats;
}

/// A pose near q, along a motion that the joints allow; false: there is none.
template <class Space>
bool move_on(const SystemOf<Space>& system, const Eigen::MatrixXd& basis, TermsOf<Space>& terms, Eigen::VectorXd& q) {
  Eigen::VectorXd u(system.dof());
  for (Index i = 0; i < u.size(); ++i) u[i] = std::cos(static_cast<double>(i * i + 1));  // as good as random
  u -= basis * (basis.transpose() * u);
  if (u.norm() < 1e-6) return false;
  u = system.inverse_mass().cwiseSqrt().cwiseProduct(u);
  double size = 0, turn = 0, shift = 0;
  for (Index i = 0; i < u.size(); ++i) {
    double& most = is_rotation<Space>(i) ? turn : shift;
    most = std::max(most, std::abs(u[i]));
  }
  for (Index i = 0; i < system.bodies(); ++i)
    size = std::max(size, (place_of<Space>(q, i) - place_of<Space>(q, 0)).cwiseAbs().maxCoeff());
  move<Space>(q, kMove / std::max(turn, shift / std::max(size, 1e-9)) * u);
  BasicSystemOf<Space> basic(system);
  Eigen::VectorXd step(system.dof()), lambda(system.joint_rows());
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(system.dof());
  for (int i = 0; i < 50; ++i) {
    evaluate(system, q, terms);
    double off = 0;
    for (Index k = 0; k < terms.phi.size(); ++k) off = std::max(off, std::abs(terms.phi[k]) / terms.unit_of_row(k));
    if (off <= 1e-12 * (1 + largest_of_all(q, terms.unit) / terms.unit)) return true;
    if (!basic.factorize(system, terms)) return false;
    const Eigen::VectorXd back = -terms.phi;
    basic.solve(none.data(), back.data(), step.data(), lambda.data());
    move<Space>(q, step);
  }
  return false;
}

/// Φ of each joint in the order of its rows.
template <class Joint> std::string row_name(const Joint& joint, int row) {
  const auto pick = [&](std::initializer_list<const char*> names) { return std::string(names.begin()[row]); };
  return std::visit(
      [&](const auto& j) -> std::string {
        using T = std::decay_t<decltype(j)>;
        if constexpr (std::is_same_v<T, Revolute>) return pick({"x", "y"});
        if constexpr (std::is_same_v<T, Prismatic>) return pick({"across", "angle"});
        if constexpr (std::is_same_v<T, Fixed>) return pick({"x", "y", "angle"});
        if constexpr (std::is_same_v<T, Distance>) return pick({"length"});
        if constexpr (std::is_same_v<T, Drive>) return pick({"motion"});
        if constexpr (std::is_same_v<T, CustomJoint>) return std::to_string(row + 1);
        if constexpr (std::is_same_v<T, spatial::Spherical>) return pick({"x", "y", "z"});
        if constexpr (std::is_same_v<T, spatial::Revolute>) return pick({"x", "y", "z", "tilt 1", "tilt 2"});
        if constexpr (std::is_same_v<T, spatial::Cylindrical>)
          return pick({"across 1", "across 2", "tilt 1", "tilt 2"});
        if constexpr (std::is_same_v<T, spatial::Universal>) return pick({"x", "y", "z", "square"});
        if constexpr (std::is_same_v<T, spatial::PlaneJoint>) return pick({"across", "tilt 1", "tilt 2"});
        if constexpr (std::is_same_v<T, spatial::Prismatic>)
          return pick({"across 1", "across 2", "turn 1", "turn 2", "turn 3"});
        if constexpr (std::is_same_v<T, spatial::Fixed>) return pick({"x", "y", "z", "turn 1", "turn 2", "turn 3"});
        if constexpr (std::is_same_v<T, spatial::PointInPlane>) return pick({"across"});
        if constexpr (std::is_same_v<T, spatial::PointOnLine>) return pick({"across 1", "across 2"});
        if constexpr (std::is_same_v<T, spatial::Distance>) return pick({"length"});
        if constexpr (std::is_same_v<T, spatial::Drive>) return pick({"motion"});
        if constexpr (std::is_same_v<T, spatial::Screw>)
          return pick({"across 1", "across 2", "tilt 1", "tilt 2", "pitch"});
        if constexpr (std::is_same_v<T, spatial::Gear>) return pick({"ratio"});
      },
      joint);
}

}  // namespace

bool Redundancy::redundant() const {
  return std::any_of(dependent.begin(), dependent.end(), [](const Repeat& r) { return r.permanent; });
}
bool Redundancy::singular() const {
  return std::any_of(dependent.begin(), dependent.end(), [](const Repeat& r) { return !r.permanent; });
}

template <class Space> Redundancy find_redundancy(const SystemOf<Space>& system, const Eigen::VectorXd& q) {
  Redundancy found{.rows = system.joint_rows(), .rank = 0, .dof = system.dof(), .dependent = {}};
  if (found.rows == 0) return found;
  TermsOf<Space> terms(system);
  evaluate(system, q, terms);
  Eigen::MatrixXd basis;
  const Eigen::MatrixXd rows = mass_rows(system, terms);
  const Repeats here = dependencies(rows, basis);
  // What a row misses, Φ and ṡ in units of its length; a row that says the same misses by as much as its combination.
  const Eigen::VectorXd length = rows.colwise().norm();
  const auto contradicts = [&](Index i, const Eigen::VectorXd& missed) {
    double left = missed[i] / length[i];
    for (const Share& s : here[static_cast<std::size_t>(i)]) left -= s.of_it * missed[s.row] / length[s.row];
    return std::abs(left) * length[i] > kOff * terms.unit_of_row(i);
  };
  found.rank = static_cast<int>(basis.cols());
  found.dof -= found.rank;
  if (found.rank == found.rows) return found;
  Eigen::VectorXd next = q;
  Repeats there = here;
  const Eigen::VectorXd phi = terms.phi, rate = terms.joint_rate;
  if (move_on(system, basis, terms, next)) there = dependencies(mass_rows(system, terms), basis);
  // Of rows that depend on each other, another one may come out as the dependent one there: then the rank is the same.
  const auto count = [](const Repeats& all) {
    return std::ranges::count_if(all, [](const auto& r) { return !r.empty(); });
  };
  const bool all_permanent = count(there) >= count(here);
  for (std::size_t i = 0; i < here.size(); ++i)
    if (!here[i].empty()) {
      auto& repeat = found.dependent.emplace_back();
      const auto row = static_cast<Index>(i);
      repeat.row = static_cast<int>(i), repeat.permanent = all_permanent || !there[i].empty();
      repeat.contradicts = contradicts(row, phi) || contradicts(row, rate);
      for (const Share& s : here[i]) repeat.repeats.push_back(s.row);
    }
  return found;
}

template <class Space> double pivoted_independence(const SystemOf<Space>& system, const Eigen::VectorXd& q, int rank) {
  TermsOf<Space> terms(system);
  evaluate(system, q, terms);
  Eigen::MatrixXd rows = mass_rows(system, terms);
  if (rank < 1 || rank > std::min(rows.rows(), rows.cols())) return 0;
  rows.colwise().normalize();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rows);
  return std::abs(qr.matrixR()(rank - 1, rank - 1));
}

template <class Space> std::string describe(const Redundancy& redundancy, const SystemOf<Space>& system) {
  if (redundancy.dependent.empty()) return {};
  const auto& joints = system.scene().joints;
  std::vector<std::size_t> joint_of;  // of each row
  std::vector<int> row_in;            // its place in that joint
  for (std::size_t j = 0; j < joints.size(); ++j)
    for (int k = 0; k < row_count(joints[j]); ++k) joint_of.push_back(j), row_in.push_back(k);
  const auto name = [&](std::size_t j) {
    return "\"" + std::visit([](const auto& x) { return x.name; }, joints[j]) + "\"";
  };
  std::string words = "the joints' " + std::to_string(redundancy.rows) + " rows have rank " +
                      std::to_string(redundancy.rank) + ", which leaves " + std::to_string(redundancy.dof) +
                      (redundancy.dof == 1 ? " degree of freedom" : " degrees of freedom");
  for (std::size_t k = 0; k < redundancy.dependent.size();) {  // rows of one joint that repeat the same ones, together
    const auto joint = joint_of[static_cast<std::size_t>(redundancy.dependent[k].row)];
    const bool permanent = redundancy.dependent[k].permanent, against = redundancy.dependent[k].contradicts;
    std::string rows, others;
    std::vector<std::size_t> repeated;
    int count = 0;
    for (; k < redundancy.dependent.size(); ++k, ++count) {
      const Redundancy::Repeat& repeat = redundancy.dependent[k];
      const auto row = static_cast<std::size_t>(repeat.row);
      if (joint_of[row] != joint || repeat.permanent != permanent || repeat.contradicts != against) break;
      rows += (rows.empty() ? "" : ", ") + row_name(joints[joint], row_in[row]);
      for (const int r : repeat.repeats) repeated.push_back(joint_of[static_cast<std::size_t>(r)]);
    }
    std::sort(repeated.begin(), repeated.end());
    repeated.erase(std::unique(repeated.begin(), repeated.end()), repeated.end());
    for (const std::size_t j : repeated) others += (others.empty() ? "" : ", ") + name(j);
    words += "; row" + std::string(count > 1 ? "s " : " ") + rows + " of joint " + name(joint) +
             (against ? " contradict" : " repeat") + (count > 1 ? "" : "s") + " what joint" +
             (repeated.size() > 1 ? "s " : " ") + others + " already say" + (repeated.size() > 1 ? "" : "s") +
             (permanent ? "" : " in this singular pose");
  }
  // A friction's load is determined unless a joint that is no copy shares it.
  if constexpr (kPlanar<Space>)
    for (const JointFriction& f : system.scene().frictions) {
      if (!f.loaded()) continue;
      const std::vector<int> copies = copies_of(system.scene(), f.joint);
      const auto of_them = [&](int row) {
        const auto joint = static_cast<int>(joint_of[static_cast<std::size_t>(row)]);
        return std::find(copies.begin(), copies.end(), joint) != copies.end();
      };
      if (std::any_of(redundancy.dependent.begin(), redundancy.dependent.end(), [&](const Redundancy::Repeat& r) {
            const auto count = std::count_if(r.repeats.begin(), r.repeats.end(), of_them) + (of_them(r.row) ? 1 : 0);
            return count > 0 && count <= static_cast<std::ptrdiff_t>(r.repeats.size());
          }))
        words += "; so the load of joint " + name(static_cast<std::size_t>(f.joint)) + ", on which friction \"" +
                 f.name + "\" depends, is not determined: the joints share it evenly";
    }
  return words;
}

template Redundancy find_redundancy(const SystemOf<Planar>&, const Eigen::VectorXd&);
template Redundancy find_redundancy(const SystemOf<Spatial>&, const Eigen::VectorXd&);
template double pivoted_independence(const SystemOf<Planar>&, const Eigen::VectorXd&, int);
template double pivoted_independence(const SystemOf<Spatial>&, const Eigen::VectorXd&, int);
template std::string describe(const Redundancy&, const SystemOf<Planar>&);
template std::string describe(const Redundancy&, const SystemOf<Spatial>&);

}  // namespace orthant
