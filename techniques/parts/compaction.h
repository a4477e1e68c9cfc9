// Chooses items in order on the GPU, and says how many there are, in three dispatches (compact.glsl).
#pragma once

#include "parts/surface_shared.h"
#include "volmark/gpu/buffer.h"
#include "volmark/gpu/commands.h"
#include "volmark/gpu/pipeline.h"

#include <span>
#include <string>
#include <vector>

namespace volmark::parts {

struct CompactionDescription {
  std::string name;          ///< of the list, in the ledger
  gpu::ShaderSource shader;  ///< includes <parts/compact.glsl>
  gpu::Specialisation timed; ///< of frames
  gpu::Specialisation counting;
  std::vector<VkDescriptorType> bindings; ///< before those of the compaction
  std::uint32_t items = 0;                ///< to choose from
  std::uint32_t perTask = 1;              ///< kept items of one workgroup of the draws
  std::uint32_t chunk = 0;                ///< kept items of one draw, at most
};

/// Exclusive sums of counts, in place, and their total; and workgroups of draws.
class Scan {
public:
  explicit Scan(gpu::Device& device);
  /// `arguments`: a uvec3 for each draw; `sizes`: what ScanConstants::sizeIndex is of. Barriers around it are the
  /// caller's.
  void record(gpu::Commands& commands, const gpu::BufferRange& counts, const gpu::BufferRange& arguments,
              const gpu::BufferRange& sizes, const ScanConstants& constants) const;

private:
  gpu::Pipeline m_pipeline;
};

class Compaction {
public:
  Compaction(gpu::Device& device, const CompactionDescription& description);

  /// What it wrote is visible to all shaders and to indirect draws afterwards. `resources` are those of
  /// CompactionDescription::bindings.
  void record(gpu::Commands& commands, std::span<const gpu::Resource> resources, bool counting) const;

  gpu::BufferRange kept() const { return m_kept.range(); }
  /// The last word is how many there are.
  gpu::BufferRange counts() const { return m_counts.range(); }
  /// Index of that word.
  std::uint32_t totalIndex() const { return m_groups; }
  std::uint32_t draws() const { return m_draws; }
  /// Of one draw: workgroups along x, y and z.
  gpu::BufferRange arguments(std::uint32_t draw) const;

private:
  CompactionDescription m_description;
  std::uint32_t m_groups;
  std::uint32_t m_draws;
  gpu::Buffer m_counts;
  gpu::Buffer m_kept;
  gpu::Buffer m_arguments;
  gpu::Pipeline m_count;
  gpu::Pipeline m_write;
  gpu::Pipeline m_writeCounting;
  Scan m_scan;
};

/// Workgroups of a dispatch over `groups` of them, in rows if there are many (workgroupIndex() in surface.glsl).
glm::uvec3 rowsOf(std::uint32_t groups);

/// Reads by any shader, or as arguments.
inline constexpr gpu::Use kAnyShaderRead{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                         VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};

} // namespace volmark::parts
