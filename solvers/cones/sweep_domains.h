// solvers/cones/sweep_domains.h — domains and colours of an operator's contacts: order of a sweep that threads share.
//
//   Nodes are the columns of W that always occur together (the six velocities of a body): equal sets of rows,
//   compared by a hash of them. Contacts are gathered into domains of up to kContacts, breadth first over common
//   nodes, so that a domain is compact in space and stays in the cache. Domains without a common node may share a
//   colour; a sweep visits colour by colour. Domains of one colour write different velocities: any number of threads
//   gives the same bits.
//   Fewer than kAlone contacts are one domain, in the problem's order.
//   O(entries of W). Equal hashes of different sets would make a node larger than needed, which is harmless.
// Source: Davis, Direct Methods for Sparse Linear Systems (2006), ch. 7 (breadth-first search); Saad, Iterative Methods
// for Sparse Linear Systems (2003), ch. 12 (multicolouring).
#pragma once

#include <orthant/solvers/cones/cone_form.h>

#include <cstdint>
#include <span>
#include <vector>

namespace orthant {

class SweepDomains {
 public:
  static constexpr int kContacts = 256, kAlone = 2048;

  void load(const ConeForm& form);

  int count() const { return static_cast<int>(start_.size()) - 1; }
  /// Blocks of the form, ascending.
  std::span<const int> contacts(int domain) const {
    return {contact_.data() + start_[at(domain)], contact_.data() + start_[at(domain) + 1]};
  }
  int colours() const { return static_cast<int>(colour_start_.size()) - 1; }
  std::span<const int> domains(int colour) const {
    return {domain_.data() + colour_start_[at(colour)], domain_.data() + colour_start_[at(colour) + 1]};
  }

 private:
  template <class Use> static void each_column(const ConeForm& form, int c, const Use& use);
  void find_nodes(const ConeForm& form);
  void gather(int count);
  void colour();

  std::vector<int> start_, contact_, colour_start_, domain_;
  // Nodes of each contact; contacts of each node.
  std::vector<int> node_start_, node_, use_start_, use_;
  // Scratch.
  std::vector<std::uint64_t> hash_;
  std::vector<int> node_of_, of_, queue_, colour_of_, last_, first_domain_, next_domain_, entry_;
  std::vector<char> queued_;
};

}  // namespace orthant
