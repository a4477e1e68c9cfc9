#include "volmark/gpu/shader.h"

#include "gpu/shader_files.h"
#include "gpu/spirv_cache.h"
#include "volmark/error.h"
#include "volmark/parameters.h"

#include <fmt/format.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <glslang/build_info.h>
#include <xxhash.h>

#include <memory>
#include <sstream>

namespace volmark::gpu {

namespace {

constexpr int kDefaultVersion = 460;
constexpr EShMessages kMessages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);

/// "<family>/<file>" names; quoted names are looked for beside the file that includes them first.
class Includer : public glslang::TShader::Includer {
public:
  IncludeResult* includeSystem(const char* name, const char*, std::size_t) override { return open(name); }

  IncludeResult* includeLocal(const char* name, const char* includer, std::size_t) override {
    const std::string from(includer);
    const std::size_t slash = from.rfind('/');
    return slash == std::string::npos ? nullptr : open(from.substr(0, slash + 1) + name);
  }

  void releaseInclude(IncludeResult* result) override {
    if (!result) return;
    delete static_cast<std::string*>(result->userData);
    delete result;
  }

private:
  static IncludeResult* open(const std::string& path) {
    auto text = findShaderFile(path);
    if (!text) return nullptr;
    auto kept = std::make_unique<std::string>(std::move(*text));
    auto result = std::make_unique<IncludeResult>(path, kept->data(), kept->size(), kept.get());
    static_cast<void>(kept.release()); // owned by the result, see releaseInclude()
    return result.release();
  }
};

EShLanguage languageOf(VkShaderStageFlagBits stage) {
  switch (stage) {
  case VK_SHADER_STAGE_VERTEX_BIT: return EShLangVertex;
  case VK_SHADER_STAGE_FRAGMENT_BIT: return EShLangFragment;
  case VK_SHADER_STAGE_GEOMETRY_BIT: return EShLangGeometry;
  case VK_SHADER_STAGE_TASK_BIT_EXT: return EShLangTask;
  case VK_SHADER_STAGE_MESH_BIT_EXT: return EShLangMesh;
  default: return EShLangCompute;
  }
}

/// Keeps the lines that say what is wrong.
std::string errorLines(const std::string& log) {
  std::istringstream stream(log);
  std::string result;
  for (std::string line; std::getline(stream, line);) {
    constexpr std::string_view mark = "ERROR: ";
    if (!line.starts_with(mark) || line.ends_with("No code generated.")) continue;
    if (!result.empty()) result += '\n';
    result.append(line, mark.size());
  }
  return result.empty() ? log : result;
}

/// One translation unit; glslang refers to the texts as long as it lives.
class Unit {
public:
  explicit Unit(const ShaderSource& source) : m_path(source.path), m_shader(languageOf(source.stage)) {
    const auto text = findShaderFile(source.path);
    if (!text) throw InputError(notFound());
    m_text = *text;
    m_preamble = "#extension GL_GOOGLE_include_directive : require\n";
    for (const auto& [name, value] : source.macros)
      m_preamble += fmt::format("#define {} {}\n", name, value);
    m_textPointer = m_text.c_str();
    m_length = static_cast<int>(m_text.size());
    m_name = m_path.c_str();
    m_shader.setStringsWithLengthsAndNames(&m_textPointer, &m_length, &m_name, 1);
    m_shader.setPreamble(m_preamble.c_str());
    m_shader.setEnvInput(glslang::EShSourceGlsl, languageOf(source.stage), glslang::EShClientVulkan, 100);
    m_shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
    m_shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
  }

  std::string preprocess() {
    std::string result;
    Includer includer;
    if (!m_shader.preprocess(GetDefaultResources(), kDefaultVersion, ENoProfile, false, false, kMessages, &result,
                             includer))
      throw InputError(errorLines(m_shader.getInfoLog()));
    return result;
  }

  std::vector<std::uint32_t> compile() {
    Includer includer;
    if (!m_shader.parse(GetDefaultResources(), kDefaultVersion, ENoProfile, false, false, kMessages, includer))
      throw InputError(errorLines(m_shader.getInfoLog()));
    glslang::TProgram program;
    program.addShader(&m_shader);
    if (!program.link(kMessages)) throw InputError(m_path + ": " + errorLines(program.getInfoLog()));
    std::vector<std::uint32_t> words;
    glslang::GlslangToSpv(*program.getIntermediate(m_shader.getStage()), words);
    return words;
  }

private:
  std::string notFound() const {
    const auto names = embeddedShaderNames();
    const auto nearest = nearestName(m_path, names);
    return fmt::format("shader \"{}\" was not found{}", m_path,
                       nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : "");
  }

  std::string m_path;
  std::string m_text;
  std::string m_preamble;
  const char* m_textPointer = nullptr;
  const char* m_name = nullptr;
  int m_length = 0;
  glslang::TShader m_shader;
};

/// glslang's global tables, for as long as the library is loaded.
void initialiseGlslang() {
  struct Process {
    Process() { glslang::InitializeProcess(); }
    ~Process() { glslang::FinalizeProcess(); }
  };
  static const Process process;
}

std::string keyOf(const std::string& preprocessed, VkShaderStageFlagBits stage) {
  const std::string text =
      fmt::format("glslang {}.{}.{} spirv 1.6 stage {}\n{}", GLSLANG_VERSION_MAJOR, GLSLANG_VERSION_MINOR,
                  GLSLANG_VERSION_PATCH, static_cast<int>(stage), preprocessed);
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

} // namespace

std::vector<std::uint32_t> compileShader(const ShaderSource& source) {
  initialiseGlslang();
  const std::filesystem::path file = spirvCacheFile(keyOf(Unit(source).preprocess(), source.stage));
  if (auto words = readSpirv(file)) return *words;
  std::vector<std::uint32_t> words = Unit(source).compile();
  writeSpirv(file, words);
  return words;
}

} // namespace volmark::gpu
