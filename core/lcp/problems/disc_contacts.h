// core/lcp/problems/disc_contacts.h — random contact problems with Coulomb's cone, solution known.
//
//   Built backwards: z and w that obey the law are drawn first (open, stick and slip contacts at random), then A, and
//   b = w − A z in rounded numbers: z solves the problem to rounding. A = W M⁻¹ Wᵀ, W normal.
#pragma once

#include <orthant/core/lcp/problems/collection.h>

namespace orthant {

struct DiscContacts {
  Index contacts = 5;
  Index freedoms = 20;  // fewer than rows: redundant, A singular
  double mu = 0.5;
  bool rolling = false;      // five rows a contact: a disc of moments as well
  bool unsymmetric = false;  // a skew part of a tenth
  bool degenerate = false;   // contacts that open without force, sticks at the edge, slips with no velocity
  bool jammed = false;       // no contact opens or slides
  double spread = 1;  // inverse masses log-uniform in [1/spread, 1], each contact's unit in [1/√spread, √spread]
};

/// Rows N T₁ T₂ (R₁ R₂) contact by contact; `answer` is one_of. Dense.
Known disc_contacts(const DiscContacts& kind, Random& random);

}  // namespace orthant
