#include <orthant/integrators/step/wanted.h>

#include <cmath>

namespace orthant {

template <class Space> void newtons_law(const std::vector<ContactLaw>& laws, const TermsOf<Space>& terms,
                                        const Eigen::VectorXd& v, std::vector<WantedOf<Space>>& wanted) {
  wanted.clear();
  for (const auto& c : terms.closed) {
    const ContactLaw& law = laws[static_cast<std::size_t>(c.contact)];
    const auto belt = belt_of(law, c.rows);
    const Tangent<Space> slip = law.frictional() ? slip_rate(c.rows, v.data()) - belt : Tangent<Space>{};
    const double approach = apply(c.rows.normal, v.data());
    wanted.push_back({-law.e * approach, belt - law.e_t * slip, slip, &law, approach});
    wanted.back().slip_before = wanted.back().free_slip = slip, wanted.back().free = approach;
    wanted.back().belt = belt;
  }
}

template <class Space> void restrict_to_strikes(std::vector<WantedOf<Space>>& wanted) {
  for (auto& w : wanted)
    if (!(-w.approach > kRestSpeed + std::abs(w.free - w.approach))) w.tangent = belt_of(w);
}

template void newtons_law(const std::vector<ContactLaw>&, const TermsOf<Planar>&, const Eigen::VectorXd&,
                          std::vector<WantedOf<Planar>>&);
template void newtons_law(const std::vector<ContactLaw>&, const TermsOf<Spatial>&, const Eigen::VectorXd&,
                          std::vector<WantedOf<Spatial>>&);
template void restrict_to_strikes(std::vector<WantedOf<Planar>>&);
template void restrict_to_strikes(std::vector<WantedOf<Spatial>>&);

}  // namespace orthant
