#include "gpu_test.h"
#include "volmark/error.h"
#include "volmark/gpu/driver_environment.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>

namespace volmark::gpu::test {

namespace {

using DeviceTest = GpuTest;
using ::testing::HasSubstr;

std::string upperCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

template <class Error, class Function> std::string errorOf(Function function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing of this type was thrown";
  return {};
}

} // namespace

TEST_F(DeviceTest, ListsDevicesByTheirIndex) {
  const auto devices = listDevices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i].index, static_cast<int>(i));
    EXPECT_FALSE(devices[i].name.empty());
  }
}

TEST_F(DeviceTest, FactsArePlausible) {
  const DeviceFacts& facts = device().facts();
  EXPECT_TRUE(facts.missing.empty());
  EXPECT_GE(facts.subgroupSize, 1u);
  EXPECT_LE(facts.minimumSubgroupSize, facts.maximumSubgroupSize);
  EXPECT_GE(facts.maximumImageDimension3D, 256u);
  EXPECT_GE(facts.maximumWorkgroupInvocations, 128u);
  EXPECT_GT(facts.deviceMemoryBytes, 0u);
  EXPECT_GT(facts.maximumAllocationBytes, 0u);
  EXPECT_EQ(facts.timestampPeriodNs > 0, facts.timestampValidBits > 0);
  EXPECT_EQ(facts.meshShader, device().cmdDrawMeshTasks != nullptr);
}

TEST_F(DeviceTest, IsChosenByIndexOrPartOfItsName) {
  const DeviceFacts& facts = device().facts();
  EXPECT_EQ(Device({std::to_string(facts.index)}).facts().index, facts.index);
  EXPECT_EQ(Device({upperCase(facts.name.substr(1, 5))}).facts().name, facts.name);
}

TEST_F(DeviceTest, UnknownSelectorListsTheDevices) {
  for (const char* selector : {"no such device", "97"}) {
    const std::string text = errorOf<InputError>([&] { Device unknown({selector}); });
    EXPECT_THAT(text, HasSubstr(selector));
    EXPECT_THAT(text, HasSubstr(device().facts().name));
    EXPECT_THAT(text, ::testing::Not(HasSubstr("\n")));
  }
}

TEST_F(DeviceTest, DriverEnvironmentIsSetAndReported) {
  const auto variables = driverEnvironment();
  const auto valueOf = [&](const std::string& name) {
    for (const auto& [key, value] : variables)
      if (key == name) return value;
    return std::string("unset");
  };
  EXPECT_EQ(valueOf("LP_NATIVE_VECTOR_WIDTH"), "256");
  EXPECT_NE(valueOf("MESA_SHADER_CACHE_DIR"), "unset");
  EXPECT_TRUE(std::is_sorted(variables.begin(), variables.end()));
}

TEST_F(DeviceTest, ResultsBecomeTheRightErrors) {
  EXPECT_NO_THROW(check(VK_SUCCESS, "x"));
  EXPECT_THAT(errorOf<DeviceError>([] { check(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2"); }), HasSubstr("device lost"));
  EXPECT_THAT(errorOf<UnsupportedError>([] { check(VK_ERROR_OUT_OF_DEVICE_MEMORY, "vkAllocateMemory"); }),
              HasSubstr("vkAllocateMemory"));
  EXPECT_THAT(errorOf<DeviceError>([] { check(VK_ERROR_INITIALIZATION_FAILED, "vkCreateDevice"); }),
              HasSubstr("vkCreateDevice"));
}

TEST_F(DeviceTest, WrongUseIsToldByValidation) {
  // A buffer without the usage that it is bound for.
  const std::string shader = addShader("wrong_use.comp.glsl", "#version 460\nlayout(local_size_x = 1) in;\n"
                                                              "layout(binding = 0) buffer B { uint b; };\n"
                                                              "void main() { b = 1; }\n");
  const Pipeline pipeline(device(),
                          ComputePipelineDescription{"wrong use", {shader}, {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}}});
  const Buffer buffer(device(), {"wrong", 64, VK_BUFFER_USAGE_TRANSFER_DST_BIT});
  Commands commands(device());
  commands.begin();
  const Resource resources[] = {buffer.range()};
  commands.bind(pipeline, resources);
  EXPECT_THAT(messages(), ::testing::Contains(HasSubstr("VUID-VkWriteDescriptorSet-descriptorType-00331")));
  forgetMessages();
  commands.submit();
}

TEST_F(DeviceTest, SynchronisationIsValidated) {
  const Buffer buffer(device(), {"raced", 64, VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT});
  Commands commands(device());
  commands.begin();
  commands.fill(buffer, 1);
  commands.fill(buffer, 2);
  EXPECT_THAT(messages(), ::testing::Contains(HasSubstr("SYNC-HAZARD-WRITE-AFTER-WRITE")));
  forgetMessages();
  commands.submit();
}

} // namespace volmark::gpu::test
