// core/mechanics/dynamics/contact_laws.h — laws of contacts of a system: of each listed one, and one a collision set.
//
//   A law has 176 bytes, and a set has room for millions of pairs: theirs is stored once.
#pragma once

#include <orthant/core/mechanics/planar/contact_law.h>

#include <algorithm>
#include <vector>

namespace orthant {

class ContactLaws {
 public:
  void add(const ContactLaw& law) { laws_.push_back(law), ++listed_; }
  /// Of so many further contacts; behind all that are listed.
  void add_many(const ContactLaw& law, int contacts) {
    if (contacts == 0) return;
    laws_.push_back(law);
    ends_.push_back((ends_.empty() ? listed_ : ends_.back()) + static_cast<std::size_t>(contacts));
  }

  const ContactLaw& operator[](std::size_t contact) const {
    if (contact < listed_) return laws_[contact];
    return laws_[listed_ + set_of(contact)];
  }

  /// The different ones: each listed contact's, then each set's that has room for a contact.
  auto begin() const { return laws_.begin(); }
  auto end() const { return laws_.end(); }
  /// Contacts that such a law holds for.
  template <class Is> std::ptrdiff_t contacts_with(const Is& is) const {
    std::ptrdiff_t count = std::count_if(laws_.begin(), laws_.begin() + static_cast<std::ptrdiff_t>(listed_), is);
    std::size_t begin = listed_;
    for (std::size_t k = 0; k < ends_.size(); begin = ends_[k++])
      if (is(laws_[listed_ + k])) count += static_cast<std::ptrdiff_t>(ends_[k] - begin);
    return count;
  }

 private:
  std::size_t set_of(std::size_t contact) const {
    if (ends_.size() == 1) return 0;
    return static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), contact) - ends_.begin());
  }

  std::vector<ContactLaw> laws_;  // listed ones, then one a set
  std::size_t listed_ = 0;
  std::vector<std::size_t> ends_;  // of each set's contacts
};

}  // namespace orthant
