// integrators/between_events/listed_contacts.h — collisions and dry friction in joints as listed contacts.
//
//   For schemes that follow every contact separately. Each pair of a collision becomes a contact of its own. Dry
//   friction of the bound B becomes a contact, too: a body next to the mechanism is pressed onto the ground by the
//   force B, and the friction of that contact, μ = 1, acts along the joint's coordinate:
//     λ_N = B always,  |λ_T| ≤ B,  λ_T against the rate: sticks, slides and changes between them as any contact does.
//   An impact does not press that body, so that a bounded friction has no impulse in it.
//   Limits: kMostPairs pairs, all evaluated in every step; no friction that depends on the joint's load.
#pragma once

#include <orthant/integrators/integrator.h>

#include <memory>

namespace orthant {

class ListedContacts {
 public:
  static constexpr int kMostPairs = 1000;

  static bool needed(const Scene& scene) { return !scene.collisions.empty() || !scene.frictions.empty(); }
  /// Throws std::invalid_argument where it is needed: `scheme` itself takes listed contacts only.
  static void refuse(const System& system, std::string_view scheme);

  /// Throws std::invalid_argument in the name of `scheme` for what it cannot stand for.
  ListedContacts(const System& system, std::string_view scheme);

  const System& system() const { return *inner_; }

  /// What a scheme hands out of its last step, of the scene itself.
  struct Records {
    Eigen::VectorXd& gaps;
    std::vector<Impulse>& impulses;
    std::vector<double>& frictions;
    std::vector<Event>& events;
  };
  /// One step of a scheme that works on system(); x is of the scene itself. Pairs are numbered again in each step, as
  /// those of other schemes are: those that push or have events first, then by their gaps; those without room are left
  /// out.
  StepReport step(Integrator& scheme, double h, Solver& solver, State& x, Records out);

  void remember(CheckpointData& memory) { memory(state_); }

 private:
  void number_pairs(const Integrator& scheme);

  const System& system_;
  std::unique_ptr<System> inner_;
  std::vector<int> first_pair_;     // of each collision, among the contacts of inner_; at the end their number
  std::vector<int> friction_of_;    // of each friction: its contact there; −1: it has no bound
  State state_;                     // of inner_
  std::vector<int> place_, order_;  // of each contact there, in the scene itself; −1: none
  std::vector<char> has_event_;
};

/// `scheme`, made for the equivalent scene, as an integrator of the scene itself.
class ListedContactsIntegrator final : public Integrator {
 public:
  using Make = std::unique_ptr<Integrator> (*)(const System& system, std::string_view options);
  ListedContactsIntegrator(const System& system, std::string_view scheme, const Capabilities& can, Make make,
                           std::string_view options)
      : Integrator(system, scheme, can), listed_(system, scheme), scheme_(make(listed_.system(), options)) {}

  StepReport step(double h, Solver& solver, State& x) override;
  void remember(CheckpointData& memory) override { memory(listed_, *scheme_); }
  const Lcp& problem() const override { return scheme_->problem(); }
  bool controls_step() const override { return scheme_->controls_step(); }

 private:
  ListedContacts listed_;
  std::unique_ptr<Integrator> scheme_;
};

}  // namespace orthant
