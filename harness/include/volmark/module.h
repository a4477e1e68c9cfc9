// How a loadable module offers its techniques. The C++ ABI is not promised between SDK versions, compilers
// or SDK headers: the module carries all three, and the loader refuses a mismatch.
#pragma once

#include "volmark/build_id.h"
#include "volmark/gpu/shader.h"
#include "volmark/technique.h"

#include <vector>

namespace volmark {

/// Layout of ModuleDescription up to and including `buildId`; never changes its meaning.
inline constexpr unsigned kModuleMagic = 0x766d6b01u;

struct ModuleDescription {
  unsigned magic = kModuleMagic;
  const char* sdkVersion = kSdkVersion;
  const char* compiler = kCompiler;
  const char* buildId = kBuildId; ///< digest of the SDK's headers
  const char* family = "";
  std::vector<gpu::EmbeddedShader> shaders;
  std::vector<TechniqueFactory> techniques;
};

} // namespace volmark

/// The one function that a module exports. Written by VOLMARK_MODULE in exactly one source file.
extern "C" const volmark::ModuleDescription* volmarkModule();

/// VOLMARK_MODULE(family, factory...): `factory` are expressions of type TechniqueFactory. The family's
/// embedded GLSL is added by volmark_add_technique().
#define VOLMARK_MODULE(family_name, ...)                                                                               \
  namespace volmark_embedded {                                                                                         \
  extern const std::vector<volmark::gpu::EmbeddedShader> shaders;                                                      \
  }                                                                                                                    \
  extern "C" __attribute__((visibility("default"))) const volmark::ModuleDescription* volmarkModule() {                \
    static const volmark::ModuleDescription description{                                                               \
        .family = #family_name, .shaders = volmark_embedded::shaders, .techniques = {__VA_ARGS__}};                    \
    return &description;                                                                                               \
  }
