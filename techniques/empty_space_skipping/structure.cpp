#include "structure.h"

#include "brick_boxes.h"
#include "distance_map.h"
#include "min_max_octree.h"
#include "octree.h"

namespace volmark::empty_space_skipping {

std::unique_ptr<Structure> makeStructure(gpu::Device& device, const Scene& scene, const gpu::VolumeTexture& volume,
                                         const StructureSettings& settings) {
  if (settings.kind == StructureKind::distanceMap || settings.kind == StructureKind::chebyshevMap)
    return std::make_unique<DistanceMap>(device, scene, volume, settings);
  if (settings.kind == StructureKind::bricks) return std::make_unique<BrickBoxes>(device, scene, settings);
  if (settings.kind == StructureKind::minMaxOctree)
    return std::make_unique<MinMaxOctree>(device, *scene.volume, settings);
  return std::make_unique<Octree>(device, scene, volume, settings);
}

std::optional<std::string> whyStructureUnsupported(const StructureSettings& settings, const Volume& volume,
                                                   const gpu::Device& device) {
  if (settings.kind == StructureKind::distanceMap || settings.kind == StructureKind::chebyshevMap)
    return whyDistanceMapUnsupported(settings, volume, device);
  if (settings.kind == StructureKind::bricks) return whyBrickBoxesUnsupported(settings, volume, device);
  return whyOctreeUnsupported(settings, volume, device);
}

std::vector<VkDescriptorType> structureBindings(StructureKind kind) {
  if (kind == StructureKind::bricks)
    return {VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
  return {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER};
}

const char* macroOf(StructureKind kind) {
  switch (kind) {
  case StructureKind::bitfieldOctree: return "BITFIELD";
  case StructureKind::minMaxOctree: return "MINMAX";
  case StructureKind::booleanOctree: return "BOOLEAN";
  case StructureKind::distanceMap: return "EUCLIDEAN";
  case StructureKind::chebyshevMap: return "CHEBYSHEV";
  case StructureKind::bricks: return "BRICKS";
  case StructureKind::labelOctree: return "LABELS";
  }
  return "";
}

glm::ivec3 cellsOf(const Grid& grid, bool voxelBlocks) {
  return voxelBlocks ? grid.dims : parts::cellsOf(grid);
}

BuildConstants buildConstants(const Scene& scene, const gpu::VolumeTexture& volume, const StructureSettings& settings) {
  const Grid& grid = scene.volume->grid();
  // Integers are sampled as UNORM, 1.0 being the type's largest.
  double largest = 0;
  switch (scene.volume->type()) {
  case ScalarType::int8:
  case ScalarType::uint8: largest = 255; break;
  case ScalarType::int16:
  case ScalarType::uint16: largest = 65535; break;
  case ScalarType::float32: break;
  }
  BuildConstants constants{};
  constants.dims = grid.dims;
  constants.blockEdge = settings.blockEdge;
  constants.blocks = parts::blocksOf(cellsOf(grid, settings.voxelBlocks), glm::ivec3(settings.blockEdge));
  constants.rawScale = static_cast<float>(largest);
  constants.scalarScale = largest > 0 ? static_cast<float>(volume.scale() / largest) : volume.scale();
  constants.scalarBias = volume.bias();
  constants.bits = settings.bits;
  constants.voxelBlocks = settings.voxelBlocks ? 1 : 0;
  return constants;
}

gpu::BufferRange visibleBuffer(gpu::Commands& commands, const VisibleScalars& visible) {
  return commands.constants(std::as_bytes(std::span(visible.before())));
}

} // namespace volmark::empty_space_skipping
