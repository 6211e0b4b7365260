#include <orthant/core/support/kept_memory.h>
#include <orthant/integrators/step/islands.h>
#include <orthant/integrators/step/row_list.h>

#include <algorithm>
#include <numeric>

namespace orthant {
template <class Space> Islands::Islands(const SystemOf<Space>& system)
    : fixed_(system.assembly()), sets_(fixed_.size()), block_(fixed_.size()) {
  sets_.assign(fixed_);
  whole_ = std::ranges::count(fixed_, fixed_.empty() ? 0 : fixed_[0]) == std::ssize(fixed_);
  const auto most = static_cast<std::size_t>((1 + Space::kTangents) * system.contacts() + system.joint_rows()) +
                    system.scene().frictions.size();
  if (most > at(kKeptRows)) return;
  of_row_.reserve(most), row_.reserve(most), start_.reserve(most + 1);
}

template <class Rows> void Islands::sort(const Rows& rows) {
  if (whole_ && !rows.empty()) {
    row_.resize(rows.size()), start_.assign({0, rows.size()});
    std::iota(row_.begin(), row_.end(), 0);
    return;
  }
  sets_.assign(fixed_);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].a >= 0 && rows[i].b >= 0) sets_.join(rows[i].a, rows[i].b);
  std::fill(block_.begin(), block_.end(), -1);
  of_row_.clear(), row_.resize(rows.size()), start_.assign(1, 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    int& block = block_[static_cast<std::size_t>(sets_.find(rows[i].a >= 0 ? rows[i].a : rows[i].b))];
    if (block < 0) block = count(), start_.push_back(0);
    of_row_.push_back(block);
    ++start_[static_cast<std::size_t>(block) + 1];
  }
  for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
  for (std::size_t i = 0; i < rows.size(); ++i)
    row_[start_[static_cast<std::size_t>(of_row_[i])]++] = static_cast<int>(i);
  for (std::size_t b = start_.size(); b-- > 1;) start_[b] = start_[b - 1];
  start_[0] = 0;
  if (rows.size() > at(kKeptRows)) free_memory(of_row_);
}

template Islands::Islands(const SystemOf<Planar>&);
template Islands::Islands(const SystemOf<Spatial>&);
template void Islands::sort(const std::vector<RowOf<Planar>>&);
template void Islands::sort(const std::vector<RowOf<Spatial>>&);
template void Islands::sort(const RowList<RowOf<Planar>>&);
template void Islands::sort(const RowList<RowOf<Spatial>>&);

}  // namespace orthant
