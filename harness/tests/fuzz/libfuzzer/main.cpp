// The long run, with clang's libFuzzer: fuzz_<target> of the fuzz preset (CONTRIBUTING.md).
#include "fuzz/targets.h"

#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const auto& target : volmark::fuzz::targets())
    if (target.name == VOLMARK_FUZZ_TARGET) {
      target.run(std::string(reinterpret_cast<const char*>(data), size));
      return 0;
    }
  std::abort();
}
