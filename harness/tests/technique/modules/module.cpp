// A module of one technique that draws nothing. Macros make the broken ones that the loader must refuse.
#include "volmark/module.h"

namespace volmark {
namespace {

class Nothing final : public Technique {
public:
  void prepare(const Preparation&, Recorder&) override {}
  void reset(std::uint64_t) override {}
  void update(const Changes&, const FrameInputs&, Recorder&) override {}
  void draw(const Frame&, Recorder&) override {}
  std::vector<gpu::MemoryItem> memory() const override { return {}; }
};

[[maybe_unused]] TechniqueFactory nothing(const char* name) {
  TechniqueFactory factory;
  factory.info.name = name;
  factory.info.summary = "draws nothing";
  factory.info.needsGpu = false;
  factory.create = []() -> std::unique_ptr<Technique> { return std::make_unique<Nothing>(); };
  return factory;
}

} // namespace
} // namespace volmark

#if defined(TEST_HEAD)

// Only the head that never changes: a loader that reads past it reads foreign memory.
namespace {
struct Head {
  unsigned magic = volmark::kModuleMagic;
  const char* sdkVersion = volmark::kSdkVersion;
  const char* compiler = volmark::kCompiler;
  const char* buildId = volmark::kBuildId;
};
} // namespace

extern "C" __attribute__((visibility("default"))) const volmark::ModuleDescription* volmarkModule() {
  static const Head head{TEST_HEAD};
  return reinterpret_cast<const volmark::ModuleDescription*>(&head);
}

#elif !defined(TEST_NO_ENTRY)

VOLMARK_MODULE(test_module, volmark::nothing("zebra"), volmark::nothing(TEST_NAME))

#endif
