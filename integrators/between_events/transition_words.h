// integrators/between_events/transition_words.h — Painlevé's paradox in words: no mode transition, or several.
#pragma once

#include <orthant/core/lcp/solution.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace orthant {

inline constexpr std::string_view kNoAcceleration =
    "no acceleration-level solution (none: friction and contact are inconsistent here, Painleve)";
inline constexpr std::string_view kNotSolved =
    "the problem at acceleration level was not solved, nor is it proved that it cannot be";

/// "PREFIX contacts "a", "b" together with the joints": the candidates with a part in the certificate u.
template <class System, class Candidates> std::string contacts_together(std::string_view prefix, const System& system,
                                                                        const Candidates& candidates, const Vector& u) {
  constexpr double kPart = 1e-6;
  std::string names;
  for (std::size_t i = 0; i < candidates.size() && u.size() > 0; ++i)
    if (std::abs(u[static_cast<Index>(i)]) > kPart * u.lpNorm<Eigen::Infinity>())
      names += (names.empty() ? "\"" : ", \"") +
               std::visit([](const auto& c) { return c.name; },
                          system.scene().contacts[static_cast<std::size_t>(candidates[i].contact)]) +
               "\"";
  return std::string(prefix) + " contacts " + names +
         (system.joint_rows() > 0 ? " together with the joints" : " together");
}

/// Solutions of A z + b with different accelerations, of those found; forces so large that all digits are lost are left
/// out. free: the accelerations without contact forces.
template <class Equations> std::vector<Vector> with_different_accelerations(const std::vector<Vector>& found,
                                                                            const Equations& equations, const Vector& b,
                                                                            const Eigen::VectorXd& free) {
  constexpr double kSameMotion = 1e-9;  // of what the forces add up to
  constexpr double kLost = 1e12;        // of all accelerations
  std::vector<Vector> different;
  Eigen::VectorXd one, other;
  for (const Vector& z : found) {
    const double forces = (equations.A.cwiseAbs() * z.cwiseAbs()).maxCoeff();
    if (forces > kLost * b.lpNorm<Eigen::Infinity>()) continue;
    const auto same = [&](const Vector& known) {
      one = free, other = free;
      equations.act(known, one), equations.act(z, other);
      return (one - other).lpNorm<Eigen::Infinity>() <= kSameMotion * (free.lpNorm<Eigen::Infinity>() + forces);
    };
    if (std::none_of(different.begin(), different.end(), same)) different.push_back(z);
  }
  return different;
}

/// "several ... (0, 1.5) (2, 0)": the normal forces of each solution, the first entries.
inline std::string several_in_words(const std::vector<Vector>& solutions, std::size_t normals) {
  std::string text = "several acceleration-level solutions (Painleve), normal forces [N]:";
  for (const Vector& z : solutions) {
    for (std::size_t i = 0; i < normals; ++i)
      text += (i == 0 ? " (" : ", ") + detail::text_of(z[static_cast<Index>(i)]);
    text += ")";
  }
  return text;
}

}  // namespace orthant
