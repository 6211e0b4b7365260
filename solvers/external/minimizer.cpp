#include <orthant/solvers/external/minimizer.h>

#include <cmath>
#include <random>

namespace orthant {

std::string Minimizer::why_not(const Lcp& problem) const {
  if (plan().form != Form::quadratic) return {};
  if (!problem.friction.empty()) return "friction rows: their pure form is not symmetric, as form=quadratic needs it";
  Columns A;
  A.load(problem.A);
  return std::holds_alternative<Delassus>(problem.A) || A.symmetric()
             ? ""
             : "the matrix is not symmetric, as form=quadratic needs it";
}

Claim Minimizer::run(const Lcp& problem, Solution& s, Start start) {
  if (problem.size() == 0) return Claim::candidate;
  const bool friction = !problem.friction.empty();
  pure_ = friction ? &pyramid_.pure(problem, Pyramid::Form::stewart_trinkle) : &problem;
  if (friction)
    pyramid_.guess(problem, s.z, start_);
  else
    start_ = s.z;
  scaled_.load(*pure_);
  iterations_ = 0;
  warm_ = start == Start::warm;
  Claim claim = Claim::candidate;
  if (z_ = start_; !warm_ || !plan().polish || !polish_.improve(*pure_, z_, budget()))
    run_again(problem, s, 0, claim);
  else if (friction)
    pyramid_.restore(problem, z_, s.z);
  else
    s.z = z_;
  return claim;
}

bool Minimizer::run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) {
  const Plan p = plan();
  const int quadratics = scaled_.symmetric && p.form != Form::merit;
  const int kinds = quadratics + (p.form != Form::quadratic);
  if (problem.size() == 0 || attempt >= kinds + p.restarts) return false;
  const bool quadratic = attempt < quadratics || p.form == Form::quadratic;
  scaled_.enter(start_, z_);
  if (attempt >= kinds) {
    std::minstd_rand random(static_cast<unsigned>(attempt));
    const double reach = std::exp2(attempt - kinds);
    for (double& z : z_) z = reach * static_cast<double>(random() % 1024) / 1024;
  }
  z_ = z_.cwiseMax(scaled_.lo).cwiseMin(scaled_.hi);
  claim = minimize(scaled_, quadratic, warm_ && attempt < kinds, z_);
  s.iterations = iterations_;
  scaled_.leave(z_, z_);
  if (z_.allFinite()) z_ = z_.cwiseMax(pure_->lo).cwiseMin(pure_->hi);
  if (p.polish) polish_.improve(*pure_, z_, budget());
  if (problem.friction.empty())
    s.z = z_;
  else
    pyramid_.restore(problem, z_, s.z);
  return true;
}

}  // namespace orthant
