#include <orthant/integrators/step/jam.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <type_traits>

namespace orthant {
namespace {

constexpr double kOverlap =
    1e-9;  // of 1 m (or length_unit()) + the largest coordinate: less is rounding and the end of the search
constexpr double kShortestTime = 1e-10;  // of 1 s + the time: the resolution of its beginning
constexpr double kStart = 1e-7;          // [s] joints hold to 1e-8: what begins sooner begins at the start
constexpr double kShare = 1e-3;          // of the largest share: takes part
constexpr double kLargestTurn = 0.3;     // [rad] a longer step of the search might end in another pose of the mechanism
constexpr double kTurn = 0.1;            // [rad] of a body, in one step in time: a finger's width would be stepped over
constexpr int kMostPositions = 20000;    // of a search: some seconds
constexpr Index kMostContacts = 500;     // nearby: more make dense matrices too large

/// `drives "a", "b" and "c"`, or nothing.
std::string listed(const char* one, const char* many, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  std::string text = names.size() == 1 ? one : many;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? " " : i + 1 < names.size() ? ", " : " and ") + names[i];
  return text;
}

/// With masses of 1 (in space from ½ to 1: the principal axes stay the same to the bit) and the same radii of gyration:
/// ratios of masses would make each pass of the search move light bodies alone.
template <class Scene> Scene of_one_mass(Scene scene) {
  for (auto& body : scene.bodies) {
    double by = body.mass;
    if constexpr (!std::is_same_v<Scene, orthant::Scene>) {
      int power = 0;
      std::frexp(body.mass, &power);
      by = std::ldexp(1, power);
    }
    body.inertia /= by, body.mass /= by;
  }
  return scene;
}

/// [kg m²] The largest principal moment of a body; [rad] of a step, the angle that it turns by.
double largest_moment(const System& system, Index i) { return rotation(system.mass(), i); }
double largest_moment(const SystemOf<Spatial>& system, Index i) {
  return rotation<Spatial>(system.mass(), i).maxCoeff();
}
template <class Space> double turn_of(const Eigen::VectorXd& step, Index i) {
  if constexpr (kPlanar<Space>)
    return std::abs(rotation(step, i));
  else
    return rotation<Space>(step, i).norm();
}

std::string quoted(const std::string& name) { return "\"" + name + "\""; }

}  // namespace

std::string words(const Jam& jam) {
  std::string text = "jammed: ";
  auto add = [&, first = true](const std::string& group) mutable {
    if (!group.empty()) text += (first ? "" : ", ") + group, first = false;
  };
  add(listed("drive", "drives", jam.drives));
  add(listed("contact", "contacts", jam.contacts));
  if (jam.joints) add("the joints");
  const bool one = !jam.joints && jam.drives.size() + jam.contacts.size() == 1;
  return text + (one ? " leaves" : " leave") + " no motion" + (jam.since < kInf ? since(jam.since) : "");
}

std::string since(double t) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", t < kStart ? 0 : t);
  return std::string("; since t = ") + digits;
}

template <class Space>
std::string contact_name(const SystemOf<Space>& system, std::span<const Pair> pairs, int contact) {
  const auto& scene = system.scene();
  const auto i = static_cast<std::size_t>(contact);
  if (i < scene.contacts.size()) return quoted(std::visit([](const auto& x) { return x.name; }, scene.contacts[i]));
  const auto& of = scene.collisions[static_cast<std::size_t>(pairs[i - scene.contacts.size()].collision)];
  const auto body = [&](BodyId b) { return b < 0 ? "the ground" : quoted(scene.bodies[at(b)].name); };
  const Pair& pair = pairs[i - scene.contacts.size()];
  const BodyId a = of.shapes[at(pair.a)].body, b = of.shapes[at(pair.b)].body;
  return "of collision " + quoted(of.name) + " between " + body(a) + " and " + body(b);
}
template std::string contact_name(const SystemOf<Planar>&, std::span<const Pair>, int);
template std::string contact_name(const SystemOf<Spatial>&, std::span<const Pair>, int);

template <class Space> JamSearchOf<Space>::JamSearchOf(const System& system)
    : system_(of_one_mass(system.scene())),
      terms_(system_),
      broad_phase_(system_),
      projection_(system_),
      basic_(system_),
      floor_(Eigen::VectorXd::Zero(system.contacts())),
      trial_(system.coordinates()),
      force_(system.dof()),
      change_(system.dof()),
      lambda_(system.joint_rows()) {
  const State start = system.initial_state();
  trial_ = start.q;
  if (!onto_joints(0, trial_)) set_poses(system, 0, start.q, terms_.at);
  evaluate_gaps(system, terms_);
  floor_.head(system.listed()) = terms_.gap.head(system.listed()).cwiseMin(0);
}

template <class Space> bool JamSearchOf<Space>::onto_joints(double t, Eigen::VectorXd& q) {
  constexpr int kPasses = 5;
  double left = kInf;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double now = projection_.position(t, terms_, q);
    if (!(now < left)) break;
    left = now;
  }
  return q.allFinite() && projection_.off(terms_, q) <= kJointsHold;
}

template <class Space> double JamSearchOf<Space>::overlap() {
  evaluate_gaps(system_, terms_);
  over_ = (floor_ - terms_.gap).cwiseMax(0);
  if (terms_.unit != 1)
    for (Index i = 0; i < over_.size(); ++i) over_[i] *= terms_.unit / system_.law(static_cast<int>(i)).unit;
  worst_ = over_.size() > 0 ? over_.maxCoeff() : 0;
  return over_.squaredNorm() / 2;
}

/// Contacts that overlap, or are as near as the largest overlap: their problem without ε.
template <class Space> bool JamSearchOf<Space>::linearize() {
  constexpr double kNear = 4;
  terms_.closed.clear();
  for (int i = 0; i < system_.contacts(); ++i)
    if (terms_.gap[i] - floor_[i] <= kNear * worst_) add_closed(system_, i, terms_);
  const auto n = static_cast<Index>(terms_.closed.size());
  evaluate_joint_rows(system_, terms_);
  if (n > kMostContacts || !basic_.factorize(system_, terms_)) return false;
  columns_.resize(system_.dof(), n);
  auto& A = as<DenseMatrix>(lcp_.A);
  A.resize(n, n), lcp_.b.resize(n), lcp_.lo.resize(n), lcp_.hi.resize(n);
  lcp_.lo.setZero(), lcp_.hi.setConstant(kInf);
  for (Index j = 0; j < n; ++j) {
    const ClosedContactOf<Space>& c = terms_.closed[static_cast<std::size_t>(j)];
    basic_.solve_row(c.rows.normal, columns_.col(j).data());
    lcp_.b[j] = terms_.gap[c.contact] - floor_[c.contact];
    for (Index i = j; i < n; ++i)
      A(i, j) = A(j, i) = apply(terms_.closed[static_cast<std::size_t>(i)].rows.normal, columns_.col(j).data());
  }
  return A.diagonal().maxCoeff() > 0;
}

/// One accepted step from q, with the problem of linearize(). False: none makes the overlap less.
template <class Space> bool JamSearchOf<Space>::improve(double t, Eigen::VectorXd& q, double& sum) {
  constexpr double kMostCompliance = 1e6, kLeastCompliance = 1e-10;
  auto& A = as<DenseMatrix>(lcp_.A);
  const Vector diagonal = A.diagonal();
  for (; compliance_ <= kMostCompliance; compliance_ *= 10) {
    A.diagonal() = diagonal.array() + compliance_ * diagonal.maxCoeff();
    if (!has_answer(solver_.solve(lcp_, solution_).status)) continue;
    force_ = columns_ * solution_.z;
    const double turn = largest_rotation<Space>(force_);
    if (turn > kLargestTurn) continue;
    move<Space>(q, force_, trial_);
    if (!onto_joints(t, trial_)) continue;
    const double next = overlap();
    if (!(next < sum)) continue;
    q = trial_, sum = next;
    compliance_ = std::max(compliance_ / 100, kLeastCompliance);
    return true;
  }
  return false;
}

template <class Space> double JamSearchOf<Space>::allowed(const Eigen::VectorXd& q) const {
  return kOverlap * (terms_.unit + (kPlanar<Space> ? largest_of_all(q, terms_.unit) : q.lpNorm<Eigen::Infinity>()));
}

template <class Space> bool JamSearchOf<Space>::fits(double t, Eigen::VectorXd& q) {
  constexpr int kPasses = 200, kSlow = 5;
  constexpr double kProgress = 1e-6;  // of the overlap, squared: slower passes end the search
  joints_off_ = !onto_joints(t, q);
  if (joints_off_) return false;
  if (broad_phase_.any()) {
    force_ = Eigen::VectorXd::Constant(system_.dof(), kLargestTurn);
    if (!broad_phase_.find(force_, terms_)) return true;
  }
  double sum = overlap();
  compliance_ = 1e-8;
  for (int pass = 0, slow = 0; pass < kPasses && slow < kSlow; ++pass) {
    if (worst_ <= allowed(q)) return true;
    const double before = sum;
    if (!linearize() || !improve(t, q, sum)) break;
    slow = sum > (1 - kProgress) * before ? slow + 1 : 0;
  }
  onto_joints(t, q), overlap();
  return worst_ <= allowed(q);
}

/// Where fits() ended without success at the time t.
template <class Space> Jam JamSearchOf<Space>::participants(double t) {
  Jam jam{.since = t, .drives = {}, .contacts = {}, .joints = joints_off_};
  const auto& joints = system_.scene().joints;
  std::vector<char> part(joints.size());
  if (joints_off_) {  // drives of what is tied to the rows that are off
    const auto group = [&](const RowOf<Space>& row) { return system_.assembly()[at(std::max(row.a, row.b))]; };
    for (std::size_t j = 0; j < joints.size(); ++j)
      for (Index i = 0; i < terms_.phi.size(); ++i)
        part[j] |= std::abs(terms_.phi[i]) > kJointsHold &&
                   group(terms_.G[static_cast<std::size_t>(i)]) ==
                       group(terms_.G[static_cast<std::size_t>(system_.first_row(j))]);
  } else {
    evaluate_joint_rows(system_, terms_);
    terms_.closed.clear();
    force_.setZero();
    for (int i = 0; i < system_.contacts(); ++i) {
      if (!(over_[i] > kShare * worst_)) continue;
      add_closed(system_, i, terms_);
      apply_transposed(terms_.closed.back().rows.normal, over_[i] / worst_, force_.data());
      std::string name = contact_name<Space>(system_, terms_.pairs, i);  // that of two polytopes has several points
      if (std::find(jam.contacts.begin(), jam.contacts.end(), name) == jam.contacts.end())
        jam.contacts.push_back(std::move(name));
    }
    if (!basic_.factorize(system_, terms_)) return jam;
    const double all = std::sqrt(force_.dot(system_.inverse_mass().cwiseProduct(force_)));
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(lambda_.size());
    basic_.solve(force_.data(), none.data(), change_.data(), lambda_.data());
    for (std::size_t j = 0; j < joints.size(); ++j)
      for (int k = 0; k < row_count(joints[j]); ++k) {
        const int i = system_.first_row(j) + k;
        force_.setZero();
        apply_transposed(terms_.G[static_cast<std::size_t>(i)], lambda_[i], force_.data());
        part[j] |= std::sqrt(force_.dot(system_.inverse_mass().cwiseProduct(force_))) > kShare * all;
      }
  }
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (part[j] && driven(joints[j]))
      jam.drives.push_back(quoted(std::visit([](const auto& x) { return x.name; }, joints[j])));
  return jam;
}

/// The largest motion of a body, over the longest that a step of the search may have.
template <class Space> double JamSearchOf<Space>::way(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const {
  const Eigen::VectorXd step = between<Space>(from, to);
  double most = 0;
  for (Index i = 0; i < system_.bodies(); ++i) {
    const double gyration = std::sqrt(largest_moment(system_, i) / system_.mass()[Space::kVelocities * i]);
    most = std::max({most, translation<Space>(step, i).norm() / gyration, turn_of<Space>(step, i) / kTurn});
  }
  return most;
}

template <class Space> std::optional<Jam> JamSearchOf<Space>::find(const State& x, double until) {
  looked_until_ = x.t;
  if (!x.q.allFinite() || !(until >= x.t)) return {};
  double low = x.t, step = std::max(until - low, kShortestTime * (1 + std::abs(until)));
  Eigen::VectorXd good = x.q, q = x.q;
  if (!fits(low, q)) {
    double back = step;
    do {
      if (low <= 0 || !system_.driven()) {
        Jam jam = participants(low);
        if (jam.drives.empty()) return {};
        return jam;
      }
      low = std::max(0.0, low - back), back *= 2;
      q = x.q;
    } while (!fits(low, q));
    until = std::max(until, x.t);
  } else {
    step *= 0x1p-20;
  }
  if (!system_.driven()) return looked_until_ = until, std::nullopt;
  good = q;
  for (int positions = 0; low < until && positions < kMostPositions; ++positions) {
    step = std::min(step, until - low);
    q = good;
    const bool there = fits(low + step, q), shortest = step <= kShortestTime * (1 + std::abs(low));
    const double farther = there ? way(good, q) : 0;
    if (there && (farther <= 1 || shortest)) {
      looked_until_ = low += step, good = q, step *= std::min(2.0, 0.8 / farther);
      continue;
    }
    if (there) {
      step *= std::max(0.25, 0.8 / farther);
      continue;
    }
    if (shortest) {
      Jam jam = participants(low + step);
      if (jam.drives.empty()) return {};
      return jam;
    }
    step = std::max(step / 4, kShortestTime * (1 + std::abs(low)) / 2);
  }
  return {};
}

template class JamSearchOf<Planar>;
template class JamSearchOf<Spatial>;

}  // namespace orthant
