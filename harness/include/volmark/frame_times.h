// What a recorder measured of one frame, or of one generation.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace volmark {

/// What a frame's recorder stamps.
enum class StampMode {
  headline,  ///< a first and a last stamp, and one after update if update recorded a GPU pass
  breakdown, ///< also at both ends of every GPU pass
};

struct RecordedPass {
  std::string name;
  bool onGpu = false;
  double ms = 0;     ///< on the GPU: between the pass's stamps; else host wall time
  double hostMs = 0; ///< host wall time of the scope; for GPU passes: of recording and of waits inside it
};

/// GPU times are NaN where the device has no timestamps.
struct FrameTimes {
  double gpuMs = std::numeric_limits<double>::quiet_NaN(); ///< first stamp to last; NaN without a GPU
  double updateGpuMs = 0;                                  ///< 0 if update recorded no GPU pass
  double drawGpuMs = 0;
  double updateHostMs = 0; ///< GPU techniques: host passes; host techniques: wall time
  double drawHostMs = 0;

  /// In order of first use; passes of one name add up. GPU passes appear only if they were stamped.
  std::vector<RecordedPass> passes;

  double updateMs() const { return updateGpuMs + updateHostMs; }
  double drawMs() const { return drawGpuMs + drawHostMs; }
  double frameMs() const { return updateMs() + drawMs(); }
};

} // namespace volmark
