#include "results/provenance.h"

#include "results/files.h"
#include "volmark/build_facts.h"
#include "volmark/build_id.h"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <unistd.h>

namespace volmark {

namespace {

nlohmann::json deviceDocument(const gpu::DeviceFacts& facts) {
  return {{"identity", deviceIdentity(&facts)},
          {"index", facts.index},
          {"name", facts.name},
          {"driver_name", facts.driverName},
          {"driver_info", facts.driverInfo},
          {"api_version", facts.apiVersion},
          {"type", facts.type},
          {"vendor_id", facts.vendorId},
          {"device_id", facts.deviceId},
          {"subgroup_size", facts.subgroupSize},
          {"minimum_subgroup_size", facts.minimumSubgroupSize},
          {"maximum_subgroup_size", facts.maximumSubgroupSize},
          {"maximum_image_dimension_2d", facts.maximumImageDimension2D},
          {"maximum_image_dimension_3d", facts.maximumImageDimension3D},
          {"maximum_workgroup_invocations", facts.maximumWorkgroupInvocations},
          {"maximum_workgroup_count", facts.maximumWorkgroupCount},
          {"maximum_storage_buffer_range", facts.maximumStorageBufferRange},
          {"maximum_allocation_bytes", facts.maximumAllocationBytes},
          {"device_memory_bytes", facts.deviceMemoryBytes},
          {"timestamp_period_ns", facts.timestampPeriodNs},
          {"timestamp_valid_bits", facts.timestampValidBits},
          {"mesh_shader", facts.meshShader},
          {"maximum_task_workgroups", facts.maximumTaskWorkgroups},
          {"maximum_total_task_workgroups", facts.maximumTotalTaskWorkgroups},
          {"maximum_mesh_vertices", facts.maximumMeshVertices},
          {"maximum_mesh_primitives", facts.maximumMeshPrimitives},
          {"representative_fragment_test", facts.representativeFragmentTest},
          {"sub_pixel_bits", facts.subPixelBits},
          {"multiview", facts.multiview},
          {"int64", facts.int64},
          {"int64_buffer_atomics", facts.int64BufferAtomics},
          {"ray_query", facts.rayQuery},
          {"pipeline_statistics", facts.pipelineStatistics}};
}

// Variables that change what drivers and volmark do.
nlohmann::json driverEnvironment() {
  nlohmann::json variables = nlohmann::json::object();
  for (char** entry = environ; entry && *entry; ++entry) {
    const std::string_view text(*entry);
    for (const std::string_view prefix : {"LP_", "MESA_", "VK_", "VOLMARK_"}) {
      const auto equals = text.find('=');
      if (text.starts_with(prefix) && equals != std::string_view::npos)
        variables[std::string(text.substr(0, equals))] = text.substr(equals + 1);
    }
  }
  return variables;
}

nlohmann::json libraryVersions() {
  nlohmann::json versions = nlohmann::json::object();
  for (const auto& [name, version] : build_facts::kLibraries)
    versions[name] = version;
  return versions;
}

} // namespace

ProgramVersion programVersion() {
  const std::string_view dirty = build_facts::kDirty;
  return {build_facts::kVersion, build_facts::kCommit,
          dirty == "unknown" ? std::nullopt : std::optional(dirty == "yes")};
}

std::string deviceIdentity(const gpu::DeviceFacts* device) {
  if (!device) return "host";
  return fmt::format("{} / {} / {}", device->name, device->driverName, device->driverInfo);
}

nlohmann::json provenance(const gpu::DeviceFacts* device) {
  const ProgramVersion program = programVersion();
  nlohmann::json deviceFacts{{"identity", deviceIdentity(nullptr)}};
  if (device) deviceFacts = deviceDocument(*device);
  return {{"program",
           {{"version", program.version},
            {"commit", program.commit},
            {"dirty", program.dirty ? nlohmann::json(*program.dirty) : nlohmann::json(nullptr)},
            {"digest", buildDigest("")}}},
          {"build", {{"compiler", kCompiler}, {"flags", build_facts::kFlags}, {"type", build_facts::kType}}},
          {"libraries", libraryVersions()},
          {"host", hostFacts()},
          {"environment", driverEnvironment()},
          {"device", deviceFacts},
          {"process", getpid()},
          {"started", utcNow()}};
}

} // namespace volmark
