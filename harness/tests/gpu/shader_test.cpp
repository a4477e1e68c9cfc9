#include "gpu_test.h"
#include "volmark/error.h"

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>

namespace volmark::gpu::test {

namespace {

using ShaderTest = ::testing::Test;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

std::string errorOf(const ShaderSource& source) {
  try {
    compileShader(source);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << source.path << " compiled";
  return {};
}

std::vector<fs::path> cachedFiles() {
  std::vector<fs::path> files;
  if (!fs::exists(testCache() + "/spirv")) return files;
  for (const auto& entry : fs::directory_iterator(testCache() + "/spirv"))
    files.push_back(entry.path());
  return files;
}

void clearCache() {
  fs::remove_all(testCache() + "/spirv");
}

/// Every SDK header of the source tree, by the name that shaders include it by.
std::vector<std::string> sdkIncludes() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(VOLMARK_SOURCE_DIR "/harness/shaders/volmark"))
    if (entry.path().stem().extension().empty()) names.push_back("volmark/" + entry.path().filename().string());
  for (const auto& entry : fs::directory_iterator(VOLMARK_SOURCE_DIR "/harness/include/volmark/shared"))
    names.push_back("volmark/" + entry.path().filename().string());
  return names;
}

std::string minimal(const std::string& extra) {
  return "#version 460\nlayout(local_size_x = 1) in;\n" + extra + "\nvoid main() {}\n";
}

} // namespace

TEST(ShaderTest, EveryIncludeCompilesAlone) {
  testCache();
  const auto names = sdkIncludes();
  EXPECT_GE(names.size(), 9u);
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const std::string once = "#include <" + name + ">\n";
    EXPECT_NO_THROW(compileShader({addShader("alone.comp.glsl", "#version 460\n" + once +
                                                                    "layout(local_size_x = 1) in;\n"
                                                                    "void main() {}\n")}));
    EXPECT_NO_THROW(compileShader({addShader("twice.comp.glsl", minimal(once + once))}));
  }
}

TEST(ShaderTest, ErrorsNameFileAndLine) {
  testCache();
  addShader("broken.glsl", "float fine() { return 1.0; }\n\nfloat broken() { return missingName; }\n");
  const std::string includer =
      addShader("includes_broken.comp.glsl", "#version 460\n#include \"broken.glsl\"\nvoid main() {}\n");
  EXPECT_THAT(errorOf({includer}), HasSubstr("probe/broken.glsl:3: 'missingName'"));
  const std::string after =
      addShader("after_include.comp.glsl", "#version 460\n#include <volmark/random.glsl>\n"
                                           "layout(local_size_x = 1) in;\nvoid main() { x = 1; }\n");
  EXPECT_THAT(errorOf({after}), HasSubstr("probe/after_include.comp.glsl:4: 'x'"));
  const std::string lost =
      addShader("lost_include.comp.glsl", "#version 460\n\n#include <volmark/none.glsl>\nvoid main() {}\n");
  EXPECT_THAT(errorOf({lost}), HasSubstr("probe/lost_include.comp.glsl:3:"));
  EXPECT_THAT(errorOf({lost}), HasSubstr("volmark/none.glsl"));
}

TEST(ShaderTest, UnknownFilesNameTheNearest) {
  testCache();
  addShader("existing.comp.glsl", minimal(""));
  EXPECT_THAT(errorOf({"probe/exsting.comp.glsl"}), HasSubstr("did you mean \"probe/existing.comp.glsl\""));
}

TEST(ShaderTest, MacrosAreDefined) {
  testCache();
  const std::string path = addShader("macro.comp.glsl", minimal("shared ELEMENT values[COUNT];"));
  EXPECT_NO_THROW(compileShader({path, VK_SHADER_STAGE_COMPUTE_BIT, {{"ELEMENT", "uvec2"}, {"COUNT", "7"}}}));
  EXPECT_NE(compileShader({path, VK_SHADER_STAGE_COMPUTE_BIT, {{"ELEMENT", "uint"}, {"COUNT", "7"}}}),
            compileShader({path, VK_SHADER_STAGE_COMPUTE_BIT, {{"ELEMENT", "vec4"}, {"COUNT", "7"}}}));
  EXPECT_THAT(errorOf({path}), HasSubstr("probe/macro.comp.glsl:3:"));
}

TEST(ShaderTest, CacheHoldsWhatWasCompiled) {
  testCache();
  clearCache();
  const std::string path = addShader("cached.comp.glsl", minimal("shared uint x[3];"));
  const auto words = compileShader({path});
  ASSERT_EQ(cachedFiles().size(), 1u);
  EXPECT_EQ(words.at(0), 0x07230203u);

  // A hit reads the file: other valid contents under the same name come back.
  const fs::path file = cachedFiles().front();
  addShader("other.comp.glsl", minimal("shared uint y[5];"));
  const auto other = compileShader({"probe/other.comp.glsl"});
  for (const fs::path& candidate : cachedFiles())
    if (candidate != file) fs::copy_file(candidate, file, fs::copy_options::overwrite_existing);
  EXPECT_EQ(compileShader({path}), other);
}

TEST(ShaderTest, DamagedCacheFilesAreRewritten) {
  testCache();
  clearCache();
  const std::string path = addShader("damaged.comp.glsl", minimal("shared uint x[4];"));
  const auto words = compileShader({path});
  const fs::path file = cachedFiles().at(0);
  const auto size = fs::file_size(file);
  const auto flip = [&](std::uintmax_t place) {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(place));
    const char byte = static_cast<char>(stream.get());
    stream.seekp(static_cast<std::streamoff>(place));
    stream.put(static_cast<char>(byte ^ 0x10));
  };
  for (const std::uintmax_t place : {std::uintmax_t(0), std::uintmax_t(9), std::uintmax_t(13), size / 2, size - 1}) {
    flip(place);
    EXPECT_EQ(compileShader({path}), words) << place;
  }
  fs::resize_file(file, size - 4);
  EXPECT_EQ(compileShader({path}), words);
  EXPECT_EQ(fs::file_size(file), size);
  fs::resize_file(file, 3);
  EXPECT_EQ(compileShader({path}), words);
  EXPECT_EQ(fs::file_size(file), size);
  EXPECT_EQ(cachedFiles().size(), 1u);
}

TEST(ShaderTest, ChangedIncludesMissTheCache) {
  testCache();
  const std::string path =
      addShader("root.comp.glsl", "#version 460\n#include \"leaf.glsl\"\nlayout(local_size_x = 1) in;\n"
                                  "layout(binding = 0) buffer B { uint b; };\n"
                                  "void main() { b = leaf(); }\n");
  addShader("leaf.glsl", "uint leaf() { return 1u; }\n");
  const auto one = compileShader({path});
  addShader("leaf.glsl", "uint leaf() { return 2u; }\n");
  EXPECT_NE(compileShader({path}), one);
  addShader("leaf.glsl", "uint leaf() { return 1u; }\n");
  EXPECT_EQ(compileShader({path}), one);
}

TEST(ShaderTest, LiveFilesComeBeforeEmbeddedOnes) {
  const std::string folder = testCache() + "/live";
  fs::create_directories(folder + "/probe");
  addShader("live.comp.glsl", minimal(""));
  EXPECT_NO_THROW(compileShader({"probe/live.comp.glsl"}));
  std::ofstream(folder + "/probe/live.comp.glsl") << minimal("int edited = nonsense;");
  setenv("VOLMARK_SHADERS", ("/nowhere:" + folder).c_str(), 1);
  EXPECT_THAT(errorOf({"probe/live.comp.glsl"}), HasSubstr("nonsense"));
  unsetenv("VOLMARK_SHADERS");
  EXPECT_NO_THROW(compileShader({"probe/live.comp.glsl"}));
}

TEST(ShaderTest, AnUnwritableCacheOnlyCostsTime) {
  testCache();
  const std::string before = std::getenv("VOLMARK_CACHE");
  setenv("VOLMARK_CACHE", "/proc/volmark", 1);
  EXPECT_NO_THROW(compileShader({addShader("uncached.comp.glsl", minimal("shared uint x[6];"))}));
  setenv("VOLMARK_CACHE", before.c_str(), 1);
}

} // namespace volmark::gpu::test
