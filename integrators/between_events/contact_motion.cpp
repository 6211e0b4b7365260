#include <orthant/integrators/between_events/contact_motion.h>
#include <orthant/integrators/between_events/lasting_rows.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kNear = 1e-5;  // of the coordinates: one Newton step closes a gap that small
constexpr int kMostPasses = 10;

}  // namespace

double slip_rate(const ContactLaw& law, const ContactRows& rows, const Eigen::VectorXd& v) {
  return apply(rows.tangent, v.data()) - law.belt;
}
double static_mu(const ContactLaw& law) { return std::max(law.mu, law.mu_static); }

Watched::Watched(Index n)
    : gap(n),
      gap_rate(n),
      gap_acceleration(n),
      slip(n),
      slip_acceleration(n),
      normal(n),
      tangent(n),
      gap_scale(n),
      gap_rate_scale(n),
      slip_scale(n) {}

ContactMotion::ContactMotion(const System& system)
    : modes(system.scene().contacts.size()),
      system_(system),
      terms_(system),
      basic_(system),
      projection_(system),
      equations_(system, 2 * modes.size()),
      far_(system.assembly()),
      fast_(system.cluster()),
      free_(system.dof()),
      zero_(Eigen::VectorXd::Zero(system.dof())),
      rate_(system.joint_rows()),
      lambda_(system.joint_rows()) {
  lasting_.reserve(modes.size()), normal_.reserve(modes.size()), tangent_.reserve(modes.size()),
      taken_.reserve(modes.size());
  share_.resize(static_cast<Index>(2 * modes.size()));
}

void ContactMotion::modes_changed() {
  lasting_.clear();
  for (int i = 0; i < system_.contacts(); ++i)
    if (modes[static_cast<std::size_t>(i)].lasting) lasting_.push_back(i);
  knows_ = std::ranges::any_of(modes, [](const ContactMode& mode) { return mode.lasting && mode.known; });
  normal_.assign(lasting_.size(), 0), tangent_.assign(lasting_.size(), 0), taken_.assign(lasting_.size(), 0);
}

void ContactMotion::remember(CheckpointData& memory) {
  memory(modes);
  if (memory.reading()) modes_changed();
  basic_.forget(), projection_.forget();
}

bool ContactMotion::accelerations(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a) {
  set_poses(system_, t, q, terms_.at);
  set_twists(system_, v, terms_.at);
  evaluate_forces(system_, t, v, terms_);
  evaluate_joint_rows(system_, terms_);
  evaluate_closed(system_, lasting_, terms_);
  evaluate_biases(system_, terms_);
  if (!basic_.factorize(system_, terms_)) return false;
  rate_ = -terms_.joint_bias;
  basic_.solve(terms_.f.data(), rate_.data(), free_.data(), lambda_.data());
  a = free_;
  if (!lasting_.empty()) impose(terms_, basic_, terms_.contact_bias, a);
  return a.allFinite();
}

void ContactMotion::impose(const Terms& terms, const BasicSystem& basic, std::span<const ContactBias> missing,
                           Eigen::VectorXd& x) {
  equations_.clear();
  share_.resize(static_cast<Index>(2 * lasting_.size()));
  if (knows_) known_.resize(share_.size()), known_.setZero();
  for (std::size_t i = 0; i < lasting_.size(); ++i) {
    const ContactMode& mode = modes[static_cast<std::size_t>(lasting_[i])];
    const ContactRows& rows = terms.closed[i].rows;
    const double mu = system_.law(lasting_[i]).mu;
    share_[equations_.size()] = mode.share_normal;
    if (knows_) known_[equations_.size()] = mode.known_normal;
    if (mode.slip != 0)
      equations_.add_sliding(rows, mode.slip * mu, missing[i].normal);
    else
      equations_.add(rows.normal, rows.normal, missing[i].normal);
    if (!mode.sticks) continue;
    share_[equations_.size()] = mode.share_tangent;
    if (knows_) known_[equations_.size()] = mode.known_tangent;
    equations_.add(rows.tangent, rows.tangent, missing[i].tangent);
  }
  share_.resize(equations_.size());
  equations_.assemble(basic, x);
  if (knows_) known_.resize(equations_.size());
  equations_.solve(share_, knows_ ? &known_ : nullptr);
  equations_.act(equations_.z, x);
  Index k = 0;
  for (std::size_t i = 0; i < lasting_.size(); ++i) {
    const ContactMode& mode = modes[static_cast<std::size_t>(lasting_[i])];
    normal_[i] = equations_.z[k++];
    tangent_[i] = mode.sticks ? equations_.z[k++] : -mode.slip * system_.law(lasting_[i]).mu * normal_[i];
  }
}

void ContactMotion::share_anew(const Watched& w) {
  const double most = w.normal.maxCoeff();
  for (const int c : lasting_) {
    ContactMode& mode = modes[static_cast<std::size_t>(c)];
    mode.share_normal = std::max(w.normal[c], 1e-3 * most);
    mode.share_tangent = static_mu(system_.law(c)) * mode.share_normal;
  }
}

double ContactMotion::power(double t, const Eigen::VectorXd& v, const Eigen::VectorXd& a) {
  double sum = 0;
  if (system_.driven()) sum = v.dot(system_.mass().cwiseProduct(a) - terms_.f);
  const bool found = for_each_lasting<Planar>(terms_.closed, lasting_, [&](std::size_t i, const ContactRows& rows) {
    sum += tangent_[i] * system_.law(lasting_[i]).belt;
    if (system_.driven())
      sum -= normal_[i] * apply(rows.normal, v.data()) + tangent_[i] * apply(rows.tangent, v.data());
  });
  if (!found) return std::numeric_limits<double>::quiet_NaN();
  load_.setZero(system_.dof());
  for (const Load& load : system_.scene().loads) load.add(terms_.at, t, load_.data());
  return sum + load_.dot(v);
}

double ContactMotion::power_of(const Eigen::VectorXd& v_off, const Eigen::VectorXd& a) const {
  return v_off.dot((system_.mass().cwiseProduct(a) - terms_.f).cwiseAbs());
}

void ContactMotion::watch_lasting(const Eigen::VectorXd& v, const Eigen::VectorXd& a, Watched& w) const {
  w.normal.setZero(), w.tangent.setZero();
  for (std::size_t i = 0; i < lasting_.size(); ++i) {
    const int c = lasting_[i];
    const Row& tangent = terms_.closed[i].rows.tangent;
    w.normal[c] = normal_[i], w.tangent[c] = tangent_[i];
    w.slip[c] = slip_rate(system_.law(c), terms_.closed[i].rows, v);
    w.slip_acceleration[c] = apply(tangent, a.data()) + terms_.contact_bias[i].tangent;
  }
}

void ContactMotion::watch(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a, Watched& w) {
  watch_lasting(v, a, w);
  evaluate_gaps(system_, terms_);
  evaluate_closed(system_, kInf, terms_);
  evaluate_biases(system_, terms_);
  w.gap = terms_.gap;
  // Translations couple: the largest of a group counts. A rotation counts on its own body.
  const auto magnitude = [](const Row& row, const Magnitudes& linear, const Eigen::VectorXd& x) {
    return reach(row, x, [&](BodyId body) { return linear.of(body); });
  };
  far_.measure([&](Index i) { return largest_translation(q, i); });
  fast_.measure([&](Index i) { return largest_translation(v, i); });
  for (Index i = 0; i < w.gap.size(); ++i) {
    const auto& [contact, rows] = terms_.closed[static_cast<std::size_t>(i)];
    const ContactBias& bias = terms_.contact_bias[static_cast<std::size_t>(i)];
    w.gap_rate[i] = apply(rows.normal, v.data());
    w.gap_acceleration[i] = apply(rows.normal, a.data()) + bias.normal;
    w.slip[i] = slip_rate(system_.law(contact), rows, v);
    w.slip_acceleration[i] = apply(rows.tangent, a.data()) + bias.tangent;
    w.gap_scale[i] = magnitude(rows.normal, far_, q);
    w.gap_rate_scale[i] = magnitude(rows.normal, fast_, v), w.slip_scale[i] = magnitude(rows.tangent, fast_, v);
  }
}

ContactMotion::Residual ContactMotion::residual(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  set_poses(system_, t, q, terms_.at);
  evaluate_joint_residual(system_, terms_);
  evaluate_joint_rows(system_, terms_);
  Residual left;
  for (Index i = 0; i < terms_.phi.size(); ++i) {
    left.joint = std::max(left.joint, std::abs(terms_.phi[i]));
    left.rate = std::max(left.rate, std::abs(terms_.missing_rate(i, v)));
  }
  left.off = projection_.off(terms_, q);
  return left;
}

bool ContactMotion::changed_places(int contact, double gap) const {
  if (!(gap > 0)) return false;
  const Contact& one = system_.scene().contacts[static_cast<std::size_t>(contact)];
  const auto far = [gap](const Polygon& p) { return gap > kAside / 2 * shortest_face(p); };
  if (const auto* pair = std::get_if<PolygonPolygon>(&one))
    return gap > 1e-3 * (pair->corners_a[1] - pair->corners_a[0]).norm() || far(pair->corners_a) ||
           far(pair->corners_b);
  const auto* disc = std::get_if<DiscPolygon>(&one);
  return disc != nullptr && far(disc->corners);
}

double ContactMotion::largest_gap() const {
  double most = 0;
  for (const int c : lasting_) most = std::max(most, std::abs(terms_.gap[c]));
  return most;
}

ContactMotion::Residual ContactMotion::project(double t, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  Residual left;
  left.joint = projection_.position(t, terms_, q);
  if (!(left.joint < kInf)) return left;
  const auto correct = [&](bool position, Eigen::VectorXd& x) {
    equations_.clear();
    for (std::size_t i = 0; i < lasting_.size(); ++i) {
      const ContactRows& rows = terms_.closed[i].rows;
      equations_.add(rows.normal, rows.normal, position ? terms_.gap[lasting_[i]] : apply(rows.normal, v.data()));
      if (!position && modes[static_cast<std::size_t>(lasting_[i])].sticks)
        equations_.add(rows.tangent, rows.tangent, slip_rate(system_.law(lasting_[i]), rows, v));
    }
    share_.resize(equations_.size());
    equations_.assemble(basic_, zero_);
    for (Index i = 0; i < share_.size(); ++i) share_[i] = 1 / equations_.A(i, i);
    equations_.solve(share_);
    equations_.act(equations_.z, x);
  };
  if (!lasting_.empty()) {
    evaluate_gaps(system_, terms_);
    for (std::size_t i = 0; i < lasting_.size(); ++i) {
      const bool changed = changed_places(lasting_[i], terms_.gap[lasting_[i]]);
      taken_[i] = changed ? kInf : 0, left.changed = left.changed || changed;
    }
    if (left.changed) {
      left.off = projection_.off(terms_, q);
      return left;
    }
    double off = largest_gap();
    for (int pass = 0; pass < kMostPasses; ++pass) {
      evaluate_joint_rows(system_, terms_);
      evaluate_closed(system_, lasting_, terms_);
      if (!basic_.factorize(system_, terms_)) return {kInf, kInf};
      correct(true, q);
      left.joint = projection_.position(t, terms_, q);
      if (off <= (pass == 0 ? kNear : kSame) * largest_of_all(q, terms_.unit) || !(left.joint < kInf)) break;
      set_poses(system_, t, q, terms_.at);
      evaluate_gaps(system_, terms_);
      const double before = off;
      off = largest_gap();
      if (!(off < before)) break;
    }
  }
  left.off = projection_.off(terms_, q);
  left.rate = projection_.velocity(terms_, v);
  if (lasting_.empty()) return left;
  for (std::size_t i = 0; i < lasting_.size(); ++i) taken_[i] = apply(terms_.closed[i].rows.normal, v.data());
  correct(false, v);
  return left;
}

}  // namespace orthant
