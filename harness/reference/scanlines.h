// Spreads a picture's rows over all cores.
#pragma once

#include <functional>

namespace volmark::reference {

/// Calls `drawRow(y)` once for every y in [0, height), in any order, from as many threads as the machine has
/// cores. Returns when all rows are drawn. `drawRow` must not throw.
void forEachScanline(int height, const std::function<void(int)>& drawRow);

} // namespace volmark::reference
