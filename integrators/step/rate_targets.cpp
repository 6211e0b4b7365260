#include <orthant/integrators/step/rate_targets.h>

#include <cmath>

namespace orthant {

template <class Space> void newtons_law(const ContactLaws& laws, const TermsOf<Space>& terms, const Eigen::VectorXd& v,
                                        std::vector<RateTargetOf<Space>>& targets) {
  targets.clear();
  for (const auto& c : terms.closed) {
    const ContactLaw& law = laws[static_cast<std::size_t>(c.contact)];
    const auto belt = belt_of(law, c.rows);
    const Tangent<Space> slip = law.frictional() ? slip_rate(c.rows, v.data()) - belt : Tangent<Space>{};
    const double approach = apply(c.rows.normal, v.data());
    targets.push_back({-law.e * approach, belt - law.e_t * slip, slip, &law, approach});
    targets.back().slip_before = targets.back().free_slip = slip, targets.back().free = approach;
    targets.back().belt = belt;
  }
}

template <class Space> void restrict_to_strikes(std::vector<RateTargetOf<Space>>& targets) {
  for (auto& w : targets)
    if (!(-w.approach > kRestSpeed * w.law->unit + std::abs(w.free - w.approach))) w.tangent = belt_of(w);
}

template void newtons_law(const ContactLaws&, const TermsOf<Planar>&, const Eigen::VectorXd&,
                          std::vector<RateTargetOf<Planar>>&);
template void newtons_law(const ContactLaws&, const TermsOf<Spatial>&, const Eigen::VectorXd&,
                          std::vector<RateTargetOf<Spatial>>&);
template void restrict_to_strikes(std::vector<RateTargetOf<Planar>>&);
template void restrict_to_strikes(std::vector<RateTargetOf<Spatial>>&);

}  // namespace orthant
