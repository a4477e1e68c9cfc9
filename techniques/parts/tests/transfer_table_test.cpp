#include "parts/transfer_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace volmark::parts {
namespace {

TransferFunction band() {
  return {"band", {{0.3, {1, 0.5, 0}, 0}, {0.4, {1, 0.5, 0}, 0.6}, {0.55, {0, 0.5, 1}, 0}}};
}

TEST(TransferTable, TwoStepsAbsorbAsOneOfTwiceTheLength) {
  const TransferTable one = postClassifiedTable(band(), 256, 0.5);
  const TransferTable two = postClassifiedTable(band(), 256, 1.0);
  for (std::size_t i = 0; i < 256; ++i) {
    const double through = 1 - one.entries[i].a;
    EXPECT_NEAR(1 - through * through, two.entries[i].a, 1e-6);
  }
}

TEST(TransferTable, OpacityIsThatOfTheFunctionAtOneVoxel) {
  const TransferFunction function = band();
  const TransferTable table = postClassifiedTable(function, 101, 1);
  for (int i = 0; i <= 100; ++i)
    EXPECT_NEAR(table.entries[static_cast<std::size_t>(i)].a, function.evaluate(i / 100.0).a, 1e-6);
}

TEST(TransferTable, NothingShowsOutsideTheVisibleRange) {
  for (const bool preintegrated : {false, true}) {
    const TransferTable table =
        preintegrated ? preintegratedTable(band(), 101, 1) : postClassifiedTable(band(), 101, 1);
    EXPECT_NEAR(table.visibleLow, 0.3, 0.011);
    EXPECT_NEAR(table.visibleHigh, 0.55, 0.011);
    for (int row = 0; row < table.height; ++row) {
      for (int column = 0; column < table.width; ++column) {
        const float back = float(preintegrated ? row : column) / 100;
        const float front = float(column) / 100;
        const bool skipped = std::max(front, back) <= table.visibleLow || std::min(front, back) >= table.visibleHigh;
        const float opacity = table.entries[static_cast<std::size_t>(row) * 101 + column].a;
        EXPECT_TRUE(!skipped || opacity == 0) << front << " " << back;
      }
    }
  }
}

TEST(TransferTable, VisibleEndsOfTheScaleAreNeverSkipped) {
  const TransferFunction everywhere("everywhere", {{0, {1, 1, 1}, 0.1}, {1, {1, 1, 1}, 0.1}});
  const TransferTable table = postClassifiedTable(everywhere, 16, 1);
  EXPECT_LT(table.visibleLow, 0);
  EXPECT_GT(table.visibleHigh, 1);
}

TEST(TransferTable, TransparentFunctionsShowNothing) {
  const TransferFunction nothing("nothing", {{0, {1, 1, 1}, 0}});
  for (const TransferTable& table : {postClassifiedTable(nothing, 16, 1), preintegratedTable(nothing, 16, 1)})
    for (const float scalar : {0.0f, 0.5f, 1.0f})
      EXPECT_FALSE(scalar > table.visibleLow && scalar < table.visibleHigh) << scalar;
}

} // namespace
} // namespace volmark::parts
