// What a finished run comes to, on one line.
#pragma once

#include "results/experiment.h"

#include <string>

namespace volmark {

/// "iso_raymarch step=0.5: 41.2 ms (24.3 fps), 1 % low 44.0 ms, PSNR 48.2 dB, depth 0.01 voxel", or the status
/// and reason of a run that did not complete.
std::string summaryOf(const Experiment& experiment, const RunIdentity& identity);

} // namespace volmark
