#include "parts/transfer_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace volmark::parts {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Finds the scalars that can show at all. Linear interpolation spreads an entry to its neighbours.
void setVisibleRange(TransferTable& table) {
  int first = table.width;
  int last = -1;
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      if (table.entries[static_cast<std::size_t>(row) * table.width + column].a <= 0) continue;
      first = std::min(first, table.height > 1 ? std::max(row, column) : column);
      last = std::max(last, table.height > 1 ? std::min(row, column) : column);
    }
  }
  // Scalars are clamped after this test: nothing lies beyond a visible end of the scale.
  const auto scalarOf = [&](int entry) { return static_cast<float>(entry) / static_cast<float>(table.width - 1); };
  table.visibleLow = first == 0 ? -kInfinity : scalarOf(first - 1);
  table.visibleHigh = last == table.width - 1 ? kInfinity : scalarOf(last + 1);
}

} // namespace

std::vector<bool> visibleEntries(const TransferTable& table) {
  std::vector<bool> visible(static_cast<std::size_t>(table.width));
  for (int i = 0; i < table.width; ++i) {
    const auto index = static_cast<std::size_t>(i);
    if (table.height == 1) {
      visible[index] = table.entries[index].a > 0;
    } else if (i + 1 < table.width && table.entries[(index + 1) * table.width + index].a > 0) {
      visible[index] = visible[index + 1] = true; // the slab from entry i to the next
    }
  }
  return visible;
}

TransferTable postClassifiedTable(const TransferFunction& function, int size, double stepVoxels) {
  TransferTable table{.width = size, .height = 1};
  table.entries.reserve(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    glm::dvec4 entry = function.evaluate(static_cast<double>(i) / (size - 1));
    entry.a = -std::expm1(stepVoxels * std::log1p(-entry.a));
    table.entries.emplace_back(entry);
  }
  setVisibleRange(table);
  return table;
}

TransferTable preintegratedTable(const TransferFunction& function, int size, double stepVoxels) {
  TransferTable table{.width = size, .height = size, .entries = function.preintegratedTable(size, stepVoxels)};
  setVisibleRange(table);
  return table;
}

} // namespace volmark::parts
