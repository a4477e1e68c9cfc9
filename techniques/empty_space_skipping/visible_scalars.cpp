#include "visible_scalars.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace volmark::empty_space_skipping {

VisibleScalars::VisibleScalars(const parts::TransferTable& table) {
  m_before.reserve(static_cast<std::size_t>(table.width) + 1);
  m_before.push_back(0);
  for (const bool shows : parts::visibleEntries(table))
    m_before.push_back(m_before.back() + (shows ? 1 : 0));
}

VisibleScalars VisibleScalars::either(const VisibleScalars& other) const {
  assert(m_before.size() == other.m_before.size());
  VisibleScalars result;
  result.m_before.push_back(0);
  for (std::size_t i = 1; i < m_before.size(); ++i) {
    const bool shows = m_before[i] > m_before[i - 1] || other.m_before[i] > other.m_before[i - 1];
    result.m_before.push_back(result.m_before.back() + (shows ? 1 : 0));
  }
  return result;
}

bool VisibleScalars::anyBetween(float low, float high) const {
  const auto scale = static_cast<float>(entries() - 1);
  const int from = std::max(static_cast<int>(std::floor(low * scale)) - 1, 0);
  const int to = std::min(static_cast<int>(std::ceil(high * scale)) + 1, entries() - 1);
  return m_before[static_cast<std::size_t>(to) + 1] > m_before[static_cast<std::size_t>(from)];
}

glm::uvec4 VisibleScalars::mask(int bits) const {
  assert(bits >= 8 && bits <= 128);
  glm::uvec4 mask(0);
  for (int bit = 0; bit < bits; ++bit) {
    const float low = static_cast<float>(bit) / static_cast<float>(bits);
    const float high = static_cast<float>(bit + 1) / static_cast<float>(bits);
    if (anyBetween(low, high)) mask[bit / 32] |= 1u << (bit % 32);
  }
  return mask;
}

} // namespace volmark::empty_space_skipping
