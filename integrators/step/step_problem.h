// integrators/step/step_problem.h — complementarity problem of one step: rows, bounds, targets, matrix, impulses.
//
//   J = [G (full form); normals, or each contact's edges (relaxed); tangents (coulomb); dry friction in joints]
//   A = J B Jᵀ,  b = J v_free − target,  lo ≤ z ≤ hi, with friction's bounds          (formulate.h has the laws)
// A is formed where it is read (step_matrix.h): whole by whole(), or of some rows by cut().
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/lent_rows.h>
#include <orthant/integrators/step/rate_targets.h>
#include <orthant/integrators/step/row_list.h>
#include <orthant/integrators/step/step_matrix.h>

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace orthant {

enum class Form { reduced, full };
inline constexpr std::array<std::string_view, 2> kFormNames = {"reduced", "full"};
enum class Cone { coulomb, relaxed };

/// Of a closed contact, what joints immobilise; inwards: the normal, which their drives move inwards.
enum class Held : char { nowhere, tangent, normal, inwards };

template <class Space> class StepProblemOf {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;
  using Row = RowOf<Space>;
  using RateTarget = RateTargetOf<Space>;
  using Impulse = ImpulseOf<Space>;
  using BasicSystem = BasicSystemOf<Space>;
  using ClosedContacts = std::vector<ClosedContactOf<Space>>;

  struct Contact {             // a closed one, in the order of its normal row
    int index = 0;             // in the scene
    std::uint32_t closed = 0;  // among the closed ones
    const ContactLaw* law = nullptr;
    double mu = 0;
    Tangent<Space> slip{};        // before the step; relaxed, in space: unit vector of the first edge's tangent
    bool frictional = false;      // has tangent rows (coulomb)
    const Row* jammed = nullptr;  // its normal, where the joints drive it inwards: its own row is zero then
    double rebound = 0;           // of its target, what restitution asks for
    double elastic = 0;  // of its target: what is gone with e = 0 and overlaps left as they are; its tangent's: e_T = 0
    Tangent<Space> elastic_along{};
  };
  /// Matrix and vectors of some of the rows; one worker's.
  struct Block {
    Lcp small, large;          // dense; an operator, where the whole problem has one
    std::vector<int> columns;  // scratch of large
    std::vector<int> place;    // of a row of the whole problem
  };

  StepProblemOf(const System& system, Form form, Cone cone);

  /// See Formulation::resist().
  void resist(double duration, const std::vector<double>* loads) { duration_ = duration, loads_ = loads; }

  /// Rows with their bounds, of terms.closed with one `wanted` each; `held`: one each, or empty where none is held.
  void collect(const Terms& terms, const std::vector<RateTarget>& targets, std::span<const Held> held);
  void respond(const BasicSystem& basic);  // B Jᵀ
  void retarget(const std::vector<RateTarget>& targets, const Eigen::VectorXd& v_free,
                const Eigen::VectorXd& joint_rate);
  void release(const std::vector<Impulse>& stored);
  void bind();
  void clear() { lcp_.b.resize(0), collected_ = 0; }
  void clear_rows() { rows_.clear(), contacts_.clear(), clear(), no_normal_ = -1; }
  /// Contacts are held against e = e_T = 0, and what overlaps need not come apart. False: so they were.
  bool drop_restitution();
  bool dropped_restitution() const { return dropped_; }  // since the last retarget()
  /// b of row i grows by `by`.
  void give(Index i, double by) { lcp_.b[i] += by; }
  /// Where static friction exceeds kinetic: kinetic for contacts that static friction did not hold, static for those
  /// that turned their slip round. True: there were some, solve once more.
  bool regrade(const Vector& z, const Vector& w);

  /// Whether no rows come of so many closed contacts.
  bool empty(std::size_t closed) const;
  Index size() const { return lcp_.size(); }
  Index most_rows() const { return most_; }  // of any step
  Form form() const { return form_; }
  Cone cone() const { return cone_; }
  Index joint_rows() const { return form_ == Form::full ? system_.joint_rows() : 0; }  // that come first
  Index friction_row(std::size_t friction) const { return resisted_ + static_cast<Index>(friction); }
  const RowList<Row>& rows() const { return rows_; }
  std::vector<Contact>& contacts() { return contacts_; }
  const std::vector<Contact>& contacts() const { return contacts_; }
  const Vector& b() const { return lcp_.b; }
  const std::vector<Friction>& friction() const { return lcp_.friction; }
  bool dense() const { return matrix_.dense(); }
  double entry(Index i, Index j) const { return matrix_.entry(rows_, i, j); }  // A_ij
  int no_normal() const { return no_normal_; }  // a closed contact without a normal; −1: none
  /// The place of closed contact k's normal and (first) tangent row; −1: it has none.
  Index normal_row(std::size_t k) const { return places_[k].normal; }
  Index tangent_row(std::size_t k) const { return places_[k].tangent; }
  bool immobile(std::size_t k) const { return k < collected_ && places_[k].normal < 0; }

  /// f(place of the normal's row, of the edge across from it or −1, of the tangent or −1, contact).
  template <class F> void each_contact(F&& f) const {
    Index i = joint_rows();
    for (const Contact& c : contacts_) {
      const bool edges = has_edges(c);
      f(i, edges ? i + kEdges / 2 : -1, places_[c.closed].tangent, c);
      i += edges ? kEdges : 1;
    }
  }
  static constexpr std::size_t kReferred = 1000;  // closed contacts from which on rows refer to the terms
  /// Of a contact with friction, relaxed: opposite ones kEdges / 2 places apart.
  static constexpr Index kEdges = kPlanar<Space> ? 2 : 8;
  bool has_edges(const Contact& c) const { return cone_ == Cone::relaxed && c.mu > 0; }

  const Lcp& whole() const;
  void prepare(Block& block) const { matrix_.prepare(block.large.A); }
  /// The problem of these rows, ascending.
  const Lcp& cut(std::span<const int> rows, Block& block) const;

  /// Of a large operator that is formed: frees the rows of the terms' closed contacts until take_back(), as W has them
  /// (lent_rows.h). rows() cannot be read meanwhile. False: they stay.
  bool lend(ClosedContacts& closed);
  void take_back(ClosedContacts& closed);

  /// v += B Jᵀ z, and the contacts' impulses; those of open contacts are zero.
  void advance(const Vector& z, Eigen::VectorXd& v, std::vector<Impulse>& impulses) const;

 private:
  struct Place {
    int normal = -1, tangent = -1;
  };
  void add_turning(const Terms& terms);
  const Friction* friction_of(int row) const;  // null: none

  const System& system_;
  Form form_;
  Cone cone_;
  Index most_;
  double duration_ = 0;
  const std::vector<double>* loads_ = nullptr;
  RowList<Row> rows_;  // J
  std::vector<Contact> contacts_;
  std::vector<Place> places_;  // of the first collected_ closed contacts
  std::size_t collected_ = 0;
  Index resisted_ = 0;                // the first row of dry friction in joints
  Index turning_ = 0;                 // space: the first row of rolling and spinning friction, behind the tangents
  std::vector<double> turn_targets_;  // likewise, of each such row [rad/s]
  int no_normal_ = -1;
  mutable Lcp lcp_;  // its A only where formed_
  StepMatrixOf<Space> matrix_;
  mutable bool formed_ = false;
  bool dropped_ = false;
  LentRows lent_;
};
extern template class StepProblemOf<Planar>;
extern template class StepProblemOf<Spatial>;
using StepProblem = StepProblemOf<Planar>;

}  // namespace orthant
