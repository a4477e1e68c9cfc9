#include "volmark/module.h"

#include "test_techniques.h"

VOLMARK_MODULE(test_techniques, volmark::test::accumulateFactory(), volmark::test::losslessFactory(),
               volmark::test::hostThreadsFactory(), volmark::test::streamedFactory(),
               volmark::test::asymmetricStereoFactory(), volmark::test::faultsFactory())
