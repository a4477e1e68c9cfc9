#include "reference/scanlines.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace volmark::reference {

namespace {

// Few enough rows that the last block doesn't keep one core busy alone.
constexpr int kRowsPerBlock = 4;

} // namespace

void forEachScanline(int height, const std::function<void(int)>& drawRow) {
  std::atomic<int> nextRow{0};
  const auto drawBlocks = [&] {
    for (int first; (first = nextRow.fetch_add(kRowsPerBlock)) < height;)
      for (int y = first; y < std::min(first + kRowsPerBlock, height); ++y)
        drawRow(y);
  };

  const int blocks = (height + kRowsPerBlock - 1) / kRowsPerBlock;
  const int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, std::max(blocks, 1));
  std::vector<std::jthread> others;
  for (int i = 1; i < threads; ++i)
    others.emplace_back(drawBlocks);
  drawBlocks();
}

} // namespace volmark::reference
