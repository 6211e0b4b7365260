#include <orthant/integrators/step/wanted.h>

#include <cmath>

namespace orthant {

void newtons_law(const std::vector<ContactLaw>& laws, const Terms& terms, const Eigen::VectorXd& v,
                 std::vector<Wanted>& wanted) {
  wanted.clear();
  for (const ClosedContact& c : terms.closed) {
    const ContactLaw& law = laws[static_cast<std::size_t>(c.contact)];
    const double slip = law.frictional() ? apply(c.rows.tangent, v.data()) - law.belt : 0;
    const double approach = apply(c.rows.normal, v.data());
    wanted.push_back({-law.e * approach, law.belt - law.e_t * slip, slip, &law, approach});
    wanted.back().slip_before = wanted.back().free_slip = slip, wanted.back().free = approach;
  }
}

void restrict_to_strikes(std::vector<Wanted>& wanted) {
  for (Wanted& w : wanted)
    if (!(-w.approach > kRestSpeed + std::abs(w.free - w.approach))) w.tangent = w.law->belt;
}

}  // namespace orthant
