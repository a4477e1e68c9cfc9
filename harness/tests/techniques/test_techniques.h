// The test techniques of this folder; each proves one part of the technique interface.
#pragma once

#include "volmark/technique.h"

namespace volmark::test {

TechniqueFactory accumulateFactory();       ///< visible history: the mean of noise over frames since reset
TechniqueFactory losslessFactory();         ///< lossless history: recomputes only when the camera moved
TechniqueFactory hostThreadsFactory();      ///< no GPU: maximum intensity projection on host threads
TechniqueFactory streamedFactory();         ///< one time step resident, streamed when it changes
TechniqueFactory asymmetricStereoFactory(); ///< shows ray directions: frusta, layers, views
TechniqueFactory faultsFactory();           ///< crashes, hangs, throws or lies, as its parameter says

} // namespace volmark::test
