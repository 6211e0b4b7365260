// integrators/step/formulate.h — one step's complementarity problem at velocity level, and its impulses' effect.
//
//   Unknown impulses z = [Λ_G; Λ_N; Λ_T] of the rows J = [G; W_N; W_T];  w = J v⁺ − target,  v⁺ = v_free + B Jᵀ z:
//     A = J B Jᵀ,  b = J v_free − target.    Wanted by the scheme: γ_N⁺ ≥ target, γ_T⁺ → target, G v⁺ = target;
//     by Newton's law −e γ_N⁻ and −e_T γ_T⁻.
//   Slip γ_T is against the moving surface. μ is the static one for a contact that sticks at the step's start and is
//   held by it, and for one whose slip would turn round within the step, as it passes through rest (a second solve,
//   coulomb only).
//   reduced: B is the inverse of the basic system with its joints (block elimination of Λ_G: the Schur complement onto
//            the contacts through one factorization of the saddle matrix); no joint rows in J.
//   full:    B = M̂⁻¹; the joints stay as equality rows.
//   Only closed contacts have rows, and only frictional ones a tangent row. Where B is diagonal and a scene has many
//   contacts, A is kept as a Delassus operator and never formed.
//   Both give the same step.
//   Bodies that do not act on one another in the step are solved apart, one problem an island (islands.h): the answer
//   of the whole one to rounding, found from smaller problems, large ones at the same time where there is a crew. The
//   whole one is formed all the same, for problem() to show.
// What joints immobilise (immobility.h) no impulse can move: such a contact has no rows, its rates are what the joints
// make them; one whose tangent alone is immobile has no friction. Where the joints' drives move it inwards it has a row
// of zeros with that rate, and the judge proves the contradiction. Combinations of contacts, too: where rounding, the
// discretisation or restitution make their rates inconsistent, targets give way by just as much, and the problem is
// solved again. A proof that is no such combination is due to rounding alone: numerical_error, never infeasible.
// Dry friction in joints (joint_friction.h): box rows −h bound ≤ Λ ≤ h bound after all others, w = the rate of the
// coordinate.
// Friction, by Cone:
//   coulomb  |Λ_T| ≤ μ Λ_N against the slip; the matrix of the pure problem is not symmetric.
//   relaxed  the cone's edges n ± μ t are the rows, impulses β± ≥ 0:  0 ≤ β± ⊥ (γ_N − target_N) ± μ (γ_T − target_T) ≥
//            0, Λ_N = β₊ + β₋, Λ_T = μ (β₊ − β₋). A is symmetric positive semidefinite, the problem a convex program;
//            its price: a contact that slides opens at the speed μ |γ_T|.
// Source: Brogliato & Acary (2008), ch. 10; Glocker, Set-Valued Force Laws (2001); Anitescu, Math. Program. 105 (2006).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/lcp/solution.h>
#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/solver_pool.h>
#include <orthant/integrators/step/immobility.h>
#include <orthant/integrators/step/islands.h>

#include <array>
#include <optional>
#include <string_view>

namespace orthant {

enum class Form { reduced, full };
inline constexpr std::array<std::string_view, 2> kFormNames = {"reduced", "full"};
enum class Cone { coulomb, relaxed };

/// What a closed contact's rates after the step are held against, its rates before and its law. [m/s]
struct Wanted {
  double normal = 0, tangent = 0;
  double slip = 0;                  // γ_T⁻, which chooses μ
  const ContactLaw* law = nullptr;  // stays where it is until the step is done
  double approach = 0;              // γ_N⁻
  double least = -kInf;             // of `normal`, whatever the law: asked for by the scheme
  // For energy_rise(): γ_T⁻ and, with the step's forces, γ_N and γ_T without contacts, see note_forces().
  double slip_before = 0, free = 0, free_slip = 0;
};

/// Newton's law: −e γ_N⁻ and −e_T γ_T⁻ (against the moving surface) of each closed contact, v before the step. `laws`,
/// one per contact of the scene: the system's, or others of a scheme's own.
void newtons_law(const std::vector<ContactLaw>& laws, const Terms& terms, const Eigen::VectorXd& v,
                 std::vector<Wanted>& wanted);

/// A slower approach is a contact at rest. [m/s]
inline constexpr double kRestSpeed = 1e-9;

/// Tangential restitution is for contacts that strike: that approach faster than kRestSpeed, and than the step's forces
/// make them (free − approach). All others slip under friction alone.
void restrict_to_strikes(std::vector<Wanted>& wanted);

class Formulation {
 public:
  explicit Formulation(const System& system, Form form = Form::reduced, Cone cone = Cone::coulomb);

  /// From now on dry friction in joints acts for `duration` [s] (of displacements: [s²]); 0, as at first: it has no
  /// rows.
  /// `loads`, one a friction of the scene [N], are those that its bound depends on; null: none does.
  void resist(double duration, const std::vector<double>* loads = nullptr) { duration_ = duration, loads_ = loads; }

  /// Coordinates near those of the terms, but such that they satisfy the joints, at time t: what joints immobilise is
  /// looked for there. They stay where they are until the problem is solved.
  void anchor(double t, const Eigen::VectorXd& q) { anchor_t_ = t, anchor_ = &q; }

  /// Builds the problem from terms.closed (and terms.G for the full form). v_free: velocities after the step without
  /// the impulses z; wanted: one entry a closed contact; joint_rate: the wanted G v⁺ (full form only), joint_rows
  /// entries. `basic` is factorized already, with joints for the reduced and without for the full form.
  void formulate(const Terms& terms, const BasicSystem& basic, const std::vector<Wanted>& wanted,
                 const Eigen::VectorXd& v_free, const Eigen::VectorXd& joint_rate);

  /// The same rows and matrix again with another v_free and other targets.
  void retarget(const std::vector<Wanted>& wanted, const Eigen::VectorXd& v_free, const Eigen::VectorXd& joint_rate);

  /// Normal impulses are at least e times those of `stored`, one per contact of the scene. Until the next collection.
  void release(const std::vector<Impulse>& stored);

  /// All rows become equations, w = 0.
  void bind();

  /// Finds z, from the last one as the first guess; true: solved, or nothing to solve. Large islands are shared
  /// with the crew, if there is one: the answer is the same to the last bit.
  bool solve(Solver& solver, StepReport& report, Crew* crew = nullptr);

  /// In words, why there is no solution: of which rows the proof is made (jam.h), what rounding leaves undecided, or
  /// which contact has no normal; empty: there is no such proof.
  std::string contradiction() const;

  /// Whether joints immobilise closed contact k, so that it has no rows.
  bool immobile(std::size_t k) const { return k < collected_ && places_[k].normal < 0; }
  /// The place in z and w of closed contact k's normal and tangent; −1: it has no such row. Cone::coulomb only.
  Index normal_row(std::size_t k) const { return places_[k].normal; }
  Index tangent_row(std::size_t k) const { return places_[k].tangent; }

  const Lcp& problem() const { return lcp_; }
  const Solution& solution() const { return solution_; }
  void remember(Memory& memory) { memory(solution_.z); }  // the next guess
  void clear() { lcp_.b.resize(0), collected_ = 0; }      // no problem, until the next is built

  /// The impulse of dry friction i of the scene, where it has rows.
  double joint_friction(std::size_t i) const {
    return solution_.z[solution_.z.size() - static_cast<Index>(system_.scene().frictions.size() - i)];
  }

  /// v += B Jᵀ z, and the contacts' impulses; those of open contacts are zero.
  void advance(Eigen::VectorXd& v, std::vector<Impulse>& impulses) const;

 private:
  struct Contact {           // a closed one, in the order of its normal row
    int index = 0;           // in the scene
    std::size_t closed = 0;  // among the closed ones
    const ContactLaw* law = nullptr;
    double mu = 0, slip = 0;
    bool frictional = false;      // has a tangent row (coulomb)
    const Row* jammed = nullptr;  // its normal, where the joints drive it inwards: its own row is zero then
    double rebound = 0;           // of its target, what restitution asks for
  };
  struct Place {
    Index normal = -1, tangent = -1;
  };
  enum class Held : char { nowhere, tangent, normal, inwards };  // by joints
  /// Fills held_. True: joints immobilise something.
  bool find_immobile(const Terms& terms);
  Held judge(const ContactRows& rows, bool frictional);
  bool stand(const std::vector<Pair>& pairs);
  Held held(std::size_t k) const { return k < held_.size() ? held_[k] : Held::nowhere; }
  /// After a solve: true when the problem was changed, so that it has to be solved once more.
  bool give_way(bool solved, StepReport& report);
  bool strained() const;
  Immobility::Verdict judge(const Vector& u, bool tangents = true);
  bool relax(const Vector& u);
  bool lifts(const Vector& u);
  template <class F> void each_row(F&& f) const;

  void collect(const Terms& terms, const std::vector<Wanted>& wanted);
  /// Where static friction exceeds kinetic: kinetic for contacts that static friction did not hold, static for those
  /// whose slip z turned round. True: there were some, solve once more.
  bool regrade();
  /// The problem, or one an island, to the solver.
  bool solve_once(Solver& solver, StepReport& report, Crew* crew);
  bool worth_sharing(const Crew* crew) const;
  struct Bench {       // what one worker needs for an island
    Lcp small, large;  // its problem: dense; an operator, where the whole one is
    Solution part;
    std::vector<Row> rows;
  };
  /// What an island's solve came to; its z and w are in found_.
  struct Outcome {
    Status status = Status::not_run;
    double residual = 0;
    Miss miss;
    int iterations = 0;
    Vector certificate, ray;
  };
  const Lcp& cut_out(std::span<const int> rows, Bench& bench);
  void add_bench();
  void solve_island(int island, Solver& solver, Bench& bench);
  void fill(const BasicSystem& basic);
  void fill_dense(const BasicSystem& basic, DenseMatrix& A);

  const System& system_;
  Form form_;
  Cone cone_;
  double duration_ = 0;
  const std::vector<double>* loads_ = nullptr;
  std::vector<Row> rows_;  // J
  std::vector<Contact> contacts_;
  DenseMatrix columns_;  // dof × n: B Jᵀ, dense storage only
  Lcp lcp_;
  Solution solution_;
  Eigen::VectorXd inverse_mass_;  // of the Delassus operator
  Islands islands_;
  std::vector<Bench> benches_;  // one a worker
  std::vector<Outcome> outcomes_;
  Solution found_;                            // by islands, so far
  int blank_ = -1;                            // a closed contact without a normal
  const std::vector<Pair>* pairs_ = nullptr;  // of the terms last formulated, for names
  std::vector<int> place_;                    // of a row within its island
  std::vector<const Friction*> friction_of_;  // a row; null: none
  // Of joints that immobilise contacts (formulate_immobile.cpp).
  double anchor_t_ = 0;
  const Eigen::VectorXd* anchor_ = nullptr;  // coordinates that satisfy the joints
  std::optional<Immobility> immobility_;     // from the first suspicion on
  bool stands_ = false;                      // immobility_ is at the anchor
  std::vector<Held> held_;                   // one a closed contact; empty: none is held
  std::vector<Place> places_;                // of the first collected_ closed contacts
  std::size_t collected_ = 0;
  const Terms* terms_ = nullptr;  // last formulated
  Vector direction_;              // of a combination that may be immobile
  bool relaxed_ = false;          // the relaxation of cones alone leaves the problem without a solution
  bool undecided_ = false;        // by rounding: whether the problem has a solution
};

}  // namespace orthant
