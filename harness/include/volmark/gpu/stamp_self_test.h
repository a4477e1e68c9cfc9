// Do this device's stamps tell passes apart? Some drivers give a draw's time to a later pass.
#pragma once

#include "volmark/gpu/device.h"

#include <array>
#include <string>

namespace volmark::gpu {

/// Three dispatches and three draws of 1 : 2 : 4 work, each a pass of a breakdown frame.
struct StampSelfTest {
  std::array<double, 3> computeMs{}; ///< shortest over the repetitions
  std::array<double, 3> drawMs{};
  std::array<double, 3> computeRatios{}; ///< relative to the first pass; 1 : 2 : 4 if the stamps are right
  std::array<double, 3> drawRatios{};
  bool trusted = false; ///< times per unit of work within a factor of 2; false without timestamps
};

/// Takes some tenths of a second, longer on a busy machine: it repeats until the ratios are right or 30 times.
StampSelfTest runStampSelfTest(Device& device);

/// "trusted: dispatches 1 : 2.01 : 4.02, draws 1 : 1.98 : 4.00" or why not.
std::string describe(const StampSelfTest& test);

} // namespace volmark::gpu
