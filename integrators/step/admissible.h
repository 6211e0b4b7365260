// integrators/step/admissible.h — energy balance and penetration of a run, for every integrator: is it admissible.
//
//   Overlap of contact i: o_i = f_i − g_i, with f_i ≤ 0 the gap at the start where bodies overlapped already. Its
//   length L_i is the clearance of a journal or between opposite walls (on either side), else the thinner body's half
//   width.
//   A run is reported from ½ L_i of a clearance or L_i / 10 of a body on. It ends at 10 L_i of a clearance or L_i / 2
//   of a body, if that is more than 3 h v, too: a scheme of fixed step may overlap by the way h v of a step. v is the
//   speed of the lighter body at the peak kinetic energy; in a clearance that of the surfaces against each other, with
//   what impulses took from it, the largest so far. Driven scenes: from L_i / 20 on a jam is searched for (jam.h),
//   which ends the run at the step before.
//   Energy: D = E − W must not rise, W the work of step_work.h. The defect is the largest rise of D above its least
//   value before; where nothing dissipates (no friction, no dampers, all e = 1) the largest change. Its scale is the
//   kinetic energy of the start, the potential energy released, Σ |W| and ½ h² f M⁻¹ f, what the forces of a step do.
//   Σ |W| and the release of weight count within a step, too, where the integrator divides it: bodies may be at rest
//   at all its ends.
//   A run is reported from 5 % of it on; it ends where D rises by all of it. Steps with several complementarity
//   problems (a position stage) are checked for rises separately: later steps may lose these again.
//   In space a jam is searched for from L_i / 1000 on, from 1e-5 L_i of integrators that divide their step.
// Cost: an energy every 8th step (springs: 16th), and in each that solves several complementarity problems or whose
// work is measured; gaps only beyond the least limit.
#pragma once

#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/jam.h>
#include <orthant/integrators/step/step_work.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace orthant {

/// The length that an overlap is compared with: a body's half width, a clearance, 1 rad of an angle's limit, or a
/// body's half width for the limit of a length (a stop, a rope).
enum class OverlapScale { body, clearance, angle, length };

/// Overlaps and energy balance of a run so far.
struct Admissibility {
  double smallest_clearance = kInf;  // [m] of the scene; infinity: it has none
  double max_overlap = 0;            // [m, rad] beyond the start's, where it is largest against its contact's length
  double overlap_length = kInf;      // [m, rad] that contact's length
  double overlap_time = 0;           // [s]
  std::string overlap_contact;       // quoted
  OverlapScale overlap_scale = OverlapScale::body;
  double work = 0;                // [J] of drives, loads and moving surfaces
  double energy_defect = 0;       // [J]
  double energy_scale = 0;        // [J]
  double energy_defect_time = 0;  // [s]

  bool deep() const;        // beyond kDeep of the length
  bool energy_off() const;  // beyond 5 % of the scale
  void remember(CheckpointData& memory) {
    memory(smallest_clearance, max_overlap, overlap_length, overlap_time, overlap_contact, overlap_scale, work,
           energy_defect, energy_scale, energy_defect_time);
  }
};

/// In words, each limit that the motion came near to or passed.
std::vector<std::string> warnings_of(const Admissibility& motion);

template <class Space> class MotionWatchOf {
 public:
  /// Both must outlive this. start: of the run, with its gaps.
  MotionWatchOf(const IntegratorOf<Space>& integrator, const State& start, const Eigen::VectorXd& gaps);

  /// Whether admits() reads the state before each step.
  bool measures_work() const { return meter_.has_value(); }

  /// After a step of h [s] to `after`. False: the motion is not admissible from there on; status() and why() say so. A
  /// jam began before.
  bool admits(const State& before, const State& after, double h, const StepReport& report, bool last);
  bool jammed() const { return status_ == Status::infeasible; }
  Status status() const { return status_; }
  const std::string& why() const { return why_; }

  /// Of a step of h [s] from x that failed as `status`: the jam that explains it, if there is one, in why().
  bool explains(const State& x, double h, Status status);

  const Admissibility& motion() const { return motion_; }
  void remember(CheckpointData& memory);

 private:
  struct Length {
    double size = kInf;  // [m, rad]
    OverlapScale scale = OverlapScale::body;

    bool clearance() const { return scale == OverlapScale::clearance; }
  };
  void measure_lengths(const Eigen::VectorXd& gaps);
  Length length(int contact) const;
  bool looks_fine(const State& before, const State& after, double h);
  bool balances(const State& after, double h, bool regular);
  double potential(const State& x);
  double surface_speed(const State& x, int contact);
  double kick(const State& x, double h);
  bool end(Status status, std::string why);
  std::optional<Jam> jam(const State& x, double until);
  bool fits(double t, Eigen::VectorXd q);

  const IntegratorOf<Space>& integrator_;
  const SystemOf<Space>& system_;
  std::optional<StepWorkOf<Space>> meter_;
  std::unique_ptr<JamSearchOf<Space>> search_;
  std::vector<Length> lengths_;  // of listed contacts
  std::vector<double> widths_;   // of each collision its thinnest shape's half [m]
  Eigen::VectorXd floor_;        // f of listed contacts
  TermsOf<Space> terms_;         // for springs, in kick() and surface_speed()
  Admissibility motion_;
  bool conserves_ = false;
  int every_ = 1;
  double quick_ = kInf;  // [m, rad] less overlap needs no look
  double looked_ = 0;    // [m, rad] at the last search for a jam
  long steps_ = 0, looked_at_ = 0;
  double start_energy_ = 0, start_kinetic_ = 0, start_potential_ = 0, least_potential_ = 0, peak_kinetic_ = 0;
  double fastest_ = 0;  // [m/s] of surfaces that overlap in a clearance
  struct Rise {         // of D [J]
    double lowest = 0;
    std::array<double, 2> last{};  // the newest first
    double add(double D);          // above the least before
  };
  double effort_ = 0, kick_ = 0;  // [J] Σ |W|; what a step's forces do
  Rise rise_, between_;           // of every so many steps; of those with several problems, too
  Status status_ = Status::solved;
  std::string why_;
};

extern template class MotionWatchOf<Planar>;
extern template class MotionWatchOf<Spatial>;
using MotionWatch = MotionWatchOf<Planar>;

}  // namespace orthant
