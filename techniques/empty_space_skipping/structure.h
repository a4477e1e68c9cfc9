// What tells a ray where nothing is: the part of a technique that differs.
#pragma once

#include "parts/min_max_grid.h"
#include "shared.h"
#include "visible_scalars.h"
#include "volmark/gpu/commands.h"
#include "volmark/gpu/volume_texture.h"
#include "volmark/scene.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace volmark::empty_space_skipping {

enum class StructureKind : std::uint8_t {
  bitfieldOctree, ///< which bins of scalars a node holds (Faludi et al. 2021, section 3)
  minMaxOctree,   ///< smallest and largest (Lacroute and Levoy 1994)
  booleanOctree,  ///< whether the transfer function shows any of it
  distanceMap,    ///< Euclidean distance to what it shows
  chebyshevMap,   ///< the same in octants, by the maximum norm
  bricks,         ///< boxes of occupied bricks, for ray queries
  labelOctree,    ///< which segments a node holds (section 5); asked beside a bitfield octree
};

/// Parameters, checked.
struct StructureSettings {
  StructureKind kind = StructureKind::bitfieldOctree;
  int blockEdge = 4;                ///< voxels of a leaf's or texel's edge: 2, 4, ..., 64
  int bits = 32;                    ///< bitfieldOctree: 8, 16, 32, 64 or 128
  std::optional<int> skippedLevels; ///< octrees: levels below the root that are never asked; absent: up to 3
  bool voxelBlocks = false;         ///< blocks of voxels, as in the paper, instead of cells: may lose what lies between
};

class Structure {
public:
  virtual ~Structure() = default;

  /// Whether build() uses what is visible; if not, one build lasts as long as the volume.
  virtual bool dependsOnTransferFunction() const = 0;
  /// The host's part of a build, if it has one: before build().
  virtual void prepareBuild(int /*timeStep*/, const VisibleScalars& /*visible*/) {}
  /// Records all of it; what rays read is visible to compute shaders afterwards.
  virtual void build(gpu::Commands& commands, const gpu::SampledImage& volume, const VisibleScalars& visible) = 0;
  /// What rays read, of the types of structureBindings().
  virtual std::vector<gpu::Resource> resources() const = 0;
  /// For the ray marcher; cheap, and all that a bitfield octree needs of a new transfer function. `kept` and `beyond`:
  /// what shows on either side of clipping planes.
  virtual SkippingConstants constants(const VisibleScalars& kept, const VisibleScalars& beyond) const = 0;
};

/// Pipelines and memory. `volume` is what build() will be given. Throws UnsupportedError.
std::unique_ptr<Structure> makeStructure(gpu::Device& device, const Scene& scene, const gpu::VolumeTexture& volume,
                                         const StructureSettings& settings);

/// Why settings don't fit a volume (one sentence), or nothing.
std::optional<std::string> whyStructureUnsupported(const StructureSettings& settings, const Volume& volume,
                                                   const gpu::Device& device);

/// From kBindingStructure on.
std::vector<VkDescriptorType> structureBindings(StructureKind kind);

/// The macro that dvr_skipping.comp.glsl and the builders know a structure by.
const char* macroOf(StructureKind kind);

/// Cells along each axis, at least one: what blocks are made of. With `voxelBlocks`, voxels.
glm::ivec3 cellsOf(const Grid& grid, bool voxelBlocks);

/// What the builders have to know of a volume.
BuildConstants buildConstants(const Scene& scene, const gpu::VolumeTexture& volume, const StructureSettings& settings);

/// A storage buffer with the sums of a transfer function, of this frame.
gpu::BufferRange visibleBuffer(gpu::Commands& commands, const VisibleScalars& visible);

} // namespace volmark::empty_space_skipping
