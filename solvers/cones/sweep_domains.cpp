#include <orthant/core/support/kept_memory.h>
#include <orthant/solvers/cones/sweep_domains.h>

#include <algorithm>
#include <numeric>

namespace orthant {
namespace {

std::uint64_t mixed(std::uint64_t x) {  // SplitMix64, by Steele, Lea & Flood (2014)
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

}  // namespace

void SweepDomains::load(const ConeForm& form) {
  const int count = form.blocks();
  contact_.resize(at(count));
  if (count < kAlone) {
    std::iota(contact_.begin(), contact_.end(), 0);
    start_.assign({0, count}), colour_start_.assign({0, 1}), domain_.assign(1, 0);
    return;
  }
  find_nodes(form);
  gather(count);
  colour();
  if (count > kKeptRows)
    free_memory(node_start_, node_, use_start_, use_, node_of_, of_, queue_, colour_of_, last_, first_domain_,
                next_domain_, entry_, hash_, queued_);
}

/// use(column) for the entries of a block's rows; rows with the columns of the first one are passed over.
template <class Use> void SweepDomains::each_column(const ConeForm& form, int c, const Use& use) {
  const RowSparse& W = form.operand().W;
  const auto columns = [&W](int row) {
    return std::span<const int>(W.column.data() + W.start[at(row)], W.column.data() + W.start[at(row) + 1]);
  };
  const auto rows = form.rows(c);
  const auto first = columns(rows[0]);
  for (const int k : first) use(k);
  for (const int row : rows.subspan(1))
    if (const auto own = columns(row); !std::ranges::equal(own, first))
      for (const int k : own) use(k);
}

void SweepDomains::find_nodes(const ConeForm& form) {
  const RowSparse& W = form.operand().W;
  hash_.assign(at(W.cols), 0);
  for (int c = 0; c < form.blocks(); ++c) {
    const std::uint64_t own = mixed(static_cast<std::uint64_t>(c));
    each_column(form, c, [&](int k) { hash_[at(k)] += own; });
  }
  node_of_.resize(at(W.cols));
  int nodes = 0;
  for (std::size_t k = 0; k < hash_.size(); ++k) node_of_[k] = k > 0 && hash_[k] == hash_[k - 1] ? nodes - 1 : nodes++;
  node_start_.assign(1, 0), node_.clear();
  last_.assign(at(nodes), -1);
  for (int c = 0; c < form.blocks(); ++c) {
    each_column(form, c, [&](int k) {
      const int node = node_of_[at(k)];
      if (last_[at(node)] != c) last_[at(node)] = c, node_.push_back(node);
    });
    node_start_.push_back(static_cast<int>(node_.size()));
  }
  use_start_.assign(at(nodes) + 1, 0);
  for (const int node : node_) ++use_start_[at(node) + 1];
  for (std::size_t i = 1; i < use_start_.size(); ++i) use_start_[i] += use_start_[i - 1];
  use_.resize(node_.size());
  last_.assign(use_start_.begin(), use_start_.end() - 1);
  for (int c = 0; c < form.blocks(); ++c)
    for (int k = node_start_[at(c)]; k < node_start_[at(c) + 1]; ++k) use_[at(last_[at(node_[at(k)])]++)] = c;
}

/// Domains grow breadth first. A new one begins at the oldest node that its predecessors have left in the queue.
void SweepDomains::gather(int count) {
  of_.assign(at(count), -1);
  const auto nodes = static_cast<int>(use_start_.size()) - 1;
  queued_.assign(at(nodes), 0);
  queue_.clear(), queue_.reserve(at(nodes));
  std::size_t head = 0;
  int domain = 0, size = 0;
  for (int seed = 0; seed < nodes; ++seed) {
    if (queued_[at(seed)]) continue;
    queued_[at(seed)] = 1, queue_.push_back(seed);
    while (head < queue_.size()) {
      const int node = queue_[head++];
      for (int u = use_start_[at(node)]; u < use_start_[at(node) + 1]; ++u) {
        const int c = use_[at(u)];
        if (of_[at(c)] >= 0) continue;
        of_[at(c)] = domain;
        if (++size == kContacts) ++domain, size = 0;
        for (int k = node_start_[at(c)]; k < node_start_[at(c) + 1]; ++k)
          if (const int other = node_[at(k)]; !queued_[at(other)]) queued_[at(other)] = 1, queue_.push_back(other);
      }
    }
  }
  for (int c = 0; c < count; ++c)  // of rows without an entry
    if (of_[at(c)] < 0) {
      of_[at(c)] = domain;
      if (++size == kContacts) ++domain, size = 0;
    }
  start_.assign(at(domain) + (size > 0 ? 2 : 1), 0);
  for (const int d : of_) ++start_[at(d) + 1];
  for (std::size_t d = 1; d < start_.size(); ++d) start_[d] += start_[d - 1];
  last_.assign(start_.begin(), start_.end() - 1);
  for (int c = 0; c < count; ++c) contact_[at(last_[at(of_[at(c)])]++)] = c;
}

/// The least colour that no earlier domain with a common node has.
void SweepDomains::colour() {
  const auto nodes = static_cast<int>(use_start_.size()) - 1;
  colour_of_.assign(at(count()), -1);
  // Domains at each node, as lists of entries.
  first_domain_.assign(at(nodes), -1), next_domain_.clear(), entry_.clear();
  std::vector<char>& taken = queued_;
  int colours = 0;
  for (int d = 0; d < count(); ++d) {
    taken.assign(at(colours) + 1, 0);
    for (const int c : contacts(d))
      for (int k = node_start_[at(c)]; k < node_start_[at(c) + 1]; ++k) {
        const int node = node_[at(k)];
        bool own = false;
        for (int e = first_domain_[at(node)]; e >= 0; e = next_domain_[at(e)]) {
          own = own || entry_[at(e)] == d;
          if (entry_[at(e)] != d) taken[at(colour_of_[at(entry_[at(e)])])] = 1;
        }
        if (own) continue;
        next_domain_.push_back(first_domain_[at(node)]);
        first_domain_[at(node)] = static_cast<int>(entry_.size());
        entry_.push_back(d);
      }
    const auto least = static_cast<int>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
    colour_of_[at(d)] = least;
    colours = std::max(colours, least + 1);
  }
  colour_start_.assign(at(colours) + 1, 0);
  for (const int colour : colour_of_) ++colour_start_[at(colour) + 1];
  for (std::size_t k = 1; k < colour_start_.size(); ++k) colour_start_[k] += colour_start_[k - 1];
  last_.assign(colour_start_.begin(), colour_start_.end() - 1);
  domain_.resize(at(count()));
  for (int d = 0; d < count(); ++d) domain_[at(last_[at(colour_of_[at(d)])]++)] = d;
}

}  // namespace orthant
