// What the tests of the Vulkan layer share: one validated device per process, and small compute programs.
#pragma once

#include "volmark/gpu/commands.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace volmark::gpu::test {

/// Sets VOLMARK_CACHE to a fresh folder of the build tree, once; before the first device.
const std::string& testCache();

/// Makes "probe/<name>" known to the compiler; the text is kept for the life of the process.
std::string addShader(const std::string& name, const std::string& text);

/// Every test must leave the ledger as it was and the validation layer silent.
class GpuTest : public ::testing::Test {
protected:
  /// Null when the machine has no device; SetUp() skips then.
  static Device* sharedDevice();
  static Device& device() { return *sharedDevice(); }

  void SetUp() override;
  void TearDown() override;

  /// Validation messages of this test so far.
  std::vector<std::string> messages() const;
  /// For tests that provoke messages.
  void forgetMessages() { m_messagesBefore = device().validationMessages().size(); }

  /// Runs `count` invocations of a compute shader with the given declarations and main() body, in which `i` is
  /// the invocation and `result[i]` (a `glslType`) is to be written. `resources` start at binding 1.
  template <class T>
  std::vector<T> evaluate(const std::string& glslType, std::size_t count, const std::string& declarations,
                          const std::string& body, const std::vector<VkDescriptorType>& types = {},
                          const std::vector<Resource>& resources = {}, const Specialisation& specialisation = {}) {
    const std::vector<std::byte> bytes =
        evaluateBytes(glslType, count, sizeof(T), declarations, body, types, resources, specialisation);
    std::vector<T> values(count);
    std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
    return values;
  }

  /// A host-visible buffer with these values, for binding.
  template <class T> Buffer bufferOf(const std::vector<T>& values) {
    Buffer buffer(device(),
                  {"input", values.size() * sizeof(T),
                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, MemoryAccess::upload});
    std::memcpy(buffer.mapped().data(), values.data(), values.size() * sizeof(T));
    return buffer;
  }

private:
  std::vector<std::byte> evaluateBytes(const std::string& glslType, std::size_t count, std::size_t size,
                                       const std::string& declarations, const std::string& body,
                                       std::vector<VkDescriptorType> types, std::vector<Resource> resources,
                                       const Specialisation& specialisation);

  std::size_t m_messagesBefore = 0;
  std::uint64_t m_bytesBefore = 0;
};

} // namespace volmark::gpu::test
