// core/mechanics/dynamics/system.h — mechanical system: index layout of a checked scene. Absent features cost nothing.
#pragma once

#include <orthant/core/mechanics/dynamics/contact_laws.h>
#include <orthant/core/mechanics/dynamics/state.h>
#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

/// yes: check() has accepted this very scene. A scene that comes from a file was examined by its reader.
enum class Examined { no, yes };

/// Coordinates stand in a block per body (blocks.h); joint rows stand in the order of the scene's joints.
template <class Space> class SystemOf {
 public:
  using Scene = typename ElementsOf<Space>::Scene;

  /// Throws std::invalid_argument where check(scene) does.
  explicit SystemOf(Scene scene, Examined examined = Examined::no);

  const Scene& scene() const { return scene_; }
  int bodies() const { return static_cast<int>(scene_.bodies.size()); }
  int dof() const { return Space::kVelocities * bodies(); }           // numbers of v
  int coordinates() const { return Space::kCoordinates * bodies(); }  // numbers of q
  int joint_rows() const { return joint_rows_; }
  int first_row(std::size_t joint) const { return first_row_[joint]; }
  bool driven() const { return driven_; }  // some joint is given in time
  /// Of each body the first one that joints and springs connect it with, itself maybe.
  const std::vector<int>& assembly() const { return assembly_; }
  /// Likewise the first one of all whose motion can ever meet its own, through contacts too.
  const std::vector<int>& cluster() const { return cluster_; }
  /// The listed ones, then room for the pairs of each collision that are near each other.
  int contacts() const { return listed() + pairs_.back(); }
  int listed() const { return static_cast<int>(scene_.contacts.size()); }
  /// Where the pairs of each collision begin, counted from listed(); at the end their number.
  const std::vector<int>& pairs() const { return pairs_; }

  const Eigen::VectorXd& mass() const { return mass_; }  // dof: m, m, J of each body; in space m, m, m, J1, J2, J3
  const Eigen::VectorXd& inverse_mass() const { return inverse_mass_; }  // dof
  const Eigen::VectorXd& weight() const { return weight_; }  // dof: M g [N, N, 0]; in space [N, N, N, 0, 0, 0]
  const ContactLaws& laws() const { return laws_; }          // by contact
  const ContactLaw& law(int contact) const { return laws_[static_cast<std::size_t>(contact)]; }

  /// The first time > t [s] at which an applied force or its slope jumps; infinity.
  double next_breakpoint(double t) const;
  /// [m] Unit of the limits of lengths and speeds (per second) that rounding needs: 1 m, for planar scenes smaller
  /// than 1/64 m a power of two below their size. The size is the largest of all coordinates at the start and of the
  /// lengths of the elements. A scene scaled in length so has the same motion, to rounding.
  double length_unit() const { return length_unit_; }
  /// [rad/s] of the fastest swing that a load or drive is given with; 0.
  double swing() const { return swing_; }

  State initial_state() const;

 private:
  Scene scene_;
  int joint_rows_ = 0;
  std::vector<int> first_row_;  // of each joint
  std::vector<int> assembly_, cluster_;
  bool driven_ = false;
  Eigen::VectorXd mass_, inverse_mass_, weight_;
  ContactLaws laws_;
  std::vector<int> pairs_ = {0};
  std::vector<double> breakpoints_;  // [s] ascending, of all loads and drives
  double swing_ = 0, length_unit_ = 1;
};

extern template class SystemOf<Planar>;
extern template class SystemOf<Spatial>;
using System = SystemOf<Planar>;

/// − Σ m g · x, of the weights and the places [J].
template <class Space> double potential_of_weight(const SystemOf<Space>& system, const Eigen::VectorXd& q);

/// Kinetic energy + potential of gravity (zero at the origin) and springs [J].
template <class Space> double energy(const SystemOf<Space>& system, const State& state);

}  // namespace orthant
