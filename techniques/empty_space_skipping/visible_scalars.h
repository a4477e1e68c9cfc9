// Which scalars a transfer function shows: for whole ranges, and as a bitfield (Faludi et al. 2021, section 3.2).
#pragma once

#include "parts/transfer_table.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace volmark::empty_space_skipping {

class VisibleScalars {
public:
  VisibleScalars() = default;
  explicit VisibleScalars(const parts::TransferTable& table);

  /// What one or the other shows; both of tables of the same width.
  VisibleScalars either(const VisibleScalars& other) const;

  /// Whether anything between two normalised scalars shows, one entry of the table beyond each end included: what the
  /// table's lookups and the sampler's rounding can reach. Equal to showsBetween() of visible.glsl, bit by bit.
  bool anyBetween(float low, float high) const;

  /// Bit b stands for the closed bin [b/bits, (b+1)/bits]. `bits`: 8, 16, 32, 64 or 128.
  glm::uvec4 mask(int bits) const;

  /// Entry i: how many of the table's entries before i show; one more than the table has.
  const std::vector<std::uint32_t>& before() const { return m_before; }
  int entries() const { return static_cast<int>(m_before.size()) - 1; }

private:
  std::vector<std::uint32_t> m_before;
};

} // namespace volmark::empty_space_skipping
