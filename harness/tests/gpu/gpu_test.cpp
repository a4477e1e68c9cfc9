#include "gpu_test.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <list>
#include <unistd.h>

namespace volmark::gpu::test {

namespace {

/// Removes the folder when the process ends.
struct TestCache {
  std::string folder = fmt::format("{}/test_cache/gpu.{}", VOLMARK_BINARY_DIR, getpid());
  TestCache() {
    std::filesystem::remove_all(folder);
    setenv("VOLMARK_CACHE", folder.c_str(), 1);
    // Drivers may share their cache of compiled pipelines between test processes.
    setenv("MESA_SHADER_CACHE_DIR", VOLMARK_BINARY_DIR "/test_cache", 0);
    std::filesystem::create_directories(VOLMARK_BINARY_DIR "/test_cache");
  }
  ~TestCache() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

} // namespace

const std::string& testCache() {
  static const TestCache cache;
  return cache.folder;
}

std::string addShader(const std::string& name, const std::string& text) {
  static std::list<std::string> kept;
  const std::string& path = kept.emplace_back("probe/" + name);
  const EmbeddedShader file{path.c_str(), kept.emplace_back(text).c_str()};
  registerShaders(std::span(&file, 1));
  return path;
}

Device* GpuTest::sharedDevice() {
  testCache();
  static const std::unique_ptr<Device> device = [] {
    return listDevices().empty() ? nullptr : std::make_unique<Device>(DeviceOptions{"", true});
  }();
  return device.get();
}

void GpuTest::SetUp() {
  if (!sharedDevice()) GTEST_SKIP() << "no Vulkan device";
  forgetMessages();
  m_bytesBefore = device().ledger().totalBytes();
}

void GpuTest::TearDown() {
  if (!sharedDevice()) return;
  for (const std::string& message : messages())
    ADD_FAILURE() << message;
  EXPECT_EQ(device().ledger().totalBytes(), m_bytesBefore);
}

std::vector<std::string> GpuTest::messages() const {
  const auto all = device().validationMessages();
  return {all.begin() + static_cast<std::ptrdiff_t>(m_messagesBefore), all.end()};
}

std::vector<std::byte> GpuTest::evaluateBytes(const std::string& glslType, std::size_t count, std::size_t size,
                                              const std::string& declarations, const std::string& body,
                                              std::vector<VkDescriptorType> types, std::vector<Resource> resources,
                                              const Specialisation& specialisation) {
  const std::string text = fmt::format("#version 460\n"
                                       "#extension GL_EXT_scalar_block_layout : require\n"
                                       "{}\n"
                                       "layout(local_size_x = 64) in;\n"
                                       "layout(set = 0, binding = 0, scalar) buffer ResultBlock {{ {} result[]; }};\n"
                                       "void main() {{\n"
                                       "  int i = int(gl_GlobalInvocationID.x);\n"
                                       "  if (i >= {}) return;\n"
                                       "  {}\n"
                                       "}}\n",
                                       declarations, glslType, count, body);
  const Buffer output(device(), {"result", count * size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, MemoryAccess::readback});
  types.insert(types.begin(), VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  resources.insert(resources.begin(), output.range());
  const Pipeline pipeline(
      device(), ComputePipelineDescription{"probe", {addShader("evaluate.comp.glsl", text)}, {types}, specialisation});
  Commands commands(device());
  commands.begin();
  commands.dispatch(pipeline, resources, {}, {static_cast<std::uint32_t>((count + 63) / 64), 1, 1});
  commands.submit();
  commands.wait();
  return {output.mapped().begin(), output.mapped().end()};
}

} // namespace volmark::gpu::test
