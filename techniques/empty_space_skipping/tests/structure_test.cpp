// Structures built on the GPU equal plain ones of the CPU, bit for bit, and know of everything that rays can meet.
#include "brick_boxes.h"
#include "distance_map.h"
#include "min_max_octree.h"
#include "octree.h"
#include "parts/marcher.h"
#include "parts/testing/random_scenes.h"
#include "volmark/gpu/buffer.h"
#include "volmark/module.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace volmark::empty_space_skipping {
namespace {

/// A volume on the GPU and a structure built from it.
class Built {
public:
  Built(const Scene& scene, const StructureSettings& settings, const VisibleScalars& visible)
      : m_commands(parts::device()), m_recorder(m_commands) {
    static const bool registered = (gpu::registerShaders(volmarkModule()->shaders), true);
    static_cast<void>(registered);
    parts::registerPartsShaders();
    m_commands.begin();
    m_texture.emplace(parts::device(), scene, gpu::Filtering::shader, m_recorder);
    structure = makeStructure(parts::device(), scene, *m_texture, settings);
    constants = buildConstants(scene, *m_texture, settings);
    structure->prepareBuild(0, visible);
    structure->build(m_commands, m_texture->at(0), visible);
    // Once more: a second build must not depend on the first.
    structure->build(m_commands, m_texture->at(0), visible);
    m_commands.submit();
    m_commands.wait();
  }
  ~Built() { parts::device().waitIdle(); }

  /// Texels of a level, tightly packed.
  std::vector<std::byte> read(const gpu::Image& image, std::uint32_t level, glm::ivec3 size, std::size_t texelBytes) {
    const std::size_t bytes = texelBytes * static_cast<std::size_t>(size.x) * size.y * size.z;
    const gpu::Buffer buffer(
        parts::device(),
        {.bytes = bytes, .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT, .access = gpu::MemoryAccess::readback});
    m_commands.begin();
    m_commands.barrier(gpu::kComputeWrite, gpu::kTransferRead);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
    region.imageExtent = {static_cast<std::uint32_t>(size.x), static_cast<std::uint32_t>(size.y),
                          static_cast<std::uint32_t>(size.z)};
    vkCmdCopyImageToBuffer(m_commands.handle(), image.handle(), VK_IMAGE_LAYOUT_GENERAL, buffer.handle(), 1, &region);
    m_commands.barrier(gpu::kTransferWrite, gpu::kHostRead);
    m_commands.submit();
    m_commands.wait();
    const auto* data = static_cast<const std::byte*>(buffer.mapped().data());
    return {data, data + bytes};
  }

  std::unique_ptr<Structure> structure;
  BuildConstants constants{};

private:
  gpu::Commands m_commands;
  parts::PlainRecorder m_recorder;
  std::optional<gpu::VolumeTexture> m_texture;
};

/// Stored integers (signed ones shifted, as on the GPU) or floats.
float rawAt(const Volume& volume, glm::ivec3 voxel) {
  const glm::ivec3 dims = volume.grid().dims;
  const std::size_t index = (static_cast<std::size_t>(voxel.z) * dims.y + voxel.y) * dims.x + voxel.x;
  const std::byte* bytes = volume.voxels(0).data();
  const auto read = [&]<class Voxel>(Voxel) {
    Voxel value;
    std::memcpy(&value, bytes + index * sizeof(Voxel), sizeof(Voxel));
    return value;
  };
  switch (volume.type()) {
  case ScalarType::int8: return static_cast<float>(read(std::int8_t{}) + 128);
  case ScalarType::uint8: return static_cast<float>(read(std::uint8_t{}));
  case ScalarType::int16: return static_cast<float>(read(std::int16_t{}) + 32768);
  case ScalarType::uint16: return static_cast<float>(read(std::uint16_t{}));
  case ScalarType::float32: return read(float{});
  }
  return 0;
}

float scalarAt(const Volume& volume, const BuildConstants& build, glm::ivec3 voxel) {
  const float product = build.scalarScale * rawAt(volume, voxel);
  return std::clamp(product + build.scalarBias, 0.0f, 1.0f);
}

/// What the corners of one cell (or one voxel) span.
struct Span {
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  void add(float value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Span spanOfCell(const Volume& volume, const BuildConstants& build, glm::ivec3 cell, bool voxels) {
  Span span;
  for (int corner = 0; corner < (voxels ? 1 : 8); ++corner) {
    const glm::ivec3 voxel = cell + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
    span.add(scalarAt(volume, build, glm::min(voxel, volume.grid().dims - 1)));
  }
  return span;
}

/// Calls `visit` for each cell of a block that there is.
template <class Visit> void forCells(glm::ivec3 cells, glm::ivec3 block, int edge, Visit visit) {
  const glm::ivec3 low = block * edge;
  const glm::ivec3 high = glm::min(low + edge, cells);
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x)
        visit(glm::ivec3(x, y, z));
}

/// The paper's definition, straight: for every cell all bins from its lowest to its highest corner.
glm::uvec4 binsOfBlock(const Volume& volume, const BuildConstants& build, const StructureSettings& settings,
                       glm::ivec3 block) {
  glm::uvec4 bits(0);
  forCells(cellsOf(volume.grid(), settings.voxelBlocks), block, settings.blockEdge, [&](glm::ivec3 cell) {
    const Span span = spanOfCell(volume, build, cell, settings.voxelBlocks);
    const auto binOf = [&](float scalar) {
      return std::min(static_cast<int>(scalar * static_cast<float>(settings.bits)), settings.bits - 1);
    };
    for (int bin = binOf(span.low); bin <= binOf(span.high); ++bin)
      bits[bin / 32] |= 1u << (bin % 32);
  });
  return bits;
}

VisibleScalars randomVisible(parts::Numbers& numbers) {
  return VisibleScalars(parts::postClassifiedTable(*parts::randomTransferFunction(numbers), 4096, 1));
}

template <class Visit> void forNodes(glm::ivec3 size, Visit visit) {
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        visit(glm::ivec3(x, y, z));
}

struct Shape {
  glm::ivec3 dims;
  ScalarType type;
};
const Shape kShapes[] = {{{33, 30, 35}, ScalarType::uint8},   {{65, 5, 17}, ScalarType::int16},
                         {{20, 21, 22}, ScalarType::float32}, {{1, 2, 3}, ScalarType::uint8},
                         {{16, 16, 16}, ScalarType::uint16},  {{70, 66, 3}, ScalarType::int8}};

class Bits : public testing::TestWithParam<int> {};

TEST_P(Bits, EqualThoseOfTheCpuOnEveryLevel) {
  parts::Numbers numbers(21);
  for (const Shape& shape : kShapes) {
    const Scene scene =
        parts::makeScene(parts::randomVolume(numbers, shape.dims, shape.type, {1, 1, 1}), ShadingModel::none);
    for (const int edge : {2, 4, 16})
      for (const bool voxels : {false, true}) {
        const StructureSettings settings{
            .blockEdge = edge, .bits = GetParam(), .skippedLevels = 0, .voxelBlocks = voxels};
        Built built(scene, settings, {});
        const auto& octree = dynamic_cast<const Octree&>(*built.structure);
        const parts::OctreeShape& tree = octree.shape();
        EXPECT_EQ(tree.initialLevel, tree.rootLevel);
        const std::size_t bytes = static_cast<std::size_t>(GetParam()) / 8;
        std::vector<glm::uvec4> below;
        for (int level = 0; level <= tree.rootLevel; ++level) {
          const glm::ivec3 size = tree.leaves >> level;
          const auto found = built.read(octree.nodes(), static_cast<std::uint32_t>(level), size, bytes);
          std::vector<glm::uvec4> expected;
          std::size_t wrong = 0;
          forNodes(size, [&](glm::ivec3 node) {
            glm::uvec4 bits(0);
            if (level == 0) {
              bits = binsOfBlock(*scene.volume, built.constants, settings, node);
            } else {
              const glm::ivec3 children = tree.leaves >> (level - 1);
              forNodes({2, 2, 2}, [&](glm::ivec3 child) {
                const glm::ivec3 at = 2 * node + child;
                bits |= below[(static_cast<std::size_t>(at.z) * children.y + at.y) * children.x + at.x];
              });
            }
            if (std::memcmp(&bits, found.data() + expected.size() * bytes, bytes) != 0) ++wrong;
            expected.push_back(bits);
          });
          EXPECT_EQ(wrong, 0u) << fmt::format("level {}, leaf {}, {}", level, edge, voxels ? "voxels" : "cells");
          below = std::move(expected);
        }
        EXPECT_EQ(below.size(), 1u) << "the root holds everything";
      }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Bits, testing::Values(8, 16, 32, 64, 128));

TEST(Octree, LabelsAreThoseOfAllVoxelsNearestToABlocksPlaces) {
  parts::Numbers numbers(24);
  for (const Shape& shape : kShapes) {
    const Scene scene = parts::makeScene(parts::randomLabels(numbers, shape.dims, {1, 1, 1}), ShadingModel::none);
    const Scene raw{.name = "labels", .volume = scene.volume, .visualisationRange = {0, 255}};
    for (const int edge : {2, 4, 16})
      for (const bool voxels : {false, true}) {
        const StructureSettings settings{
            .kind = StructureKind::labelOctree, .blockEdge = edge, .skippedLevels = 0, .voxelBlocks = voxels};
        Built built(raw, settings, {});
        const auto& octree = dynamic_cast<const Octree&>(*built.structure);
        const auto found = built.read(octree.nodes(), 0, octree.shape().leaves, sizeof(glm::uvec4));
        std::size_t index = 0;
        std::size_t wrong = 0;
        forNodes(octree.shape().leaves, [&](glm::ivec3 node) {
          glm::uvec4 bits(0);
          forCells(cellsOf(raw.volume->grid(), voxels), node, edge, [&](glm::ivec3 cell) {
            for (int corner = 0; corner < (voxels ? 1 : 8); ++corner) {
              const glm::ivec3 at =
                  glm::min(cell + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2), shape.dims - 1);
              const auto label = static_cast<int>(raw.volume->value(at.x, at.y, at.z));
              bits[label / 32] |= 1u << (label % 32);
            }
          });
          if (std::memcmp(&bits, found.data() + index * sizeof(bits), sizeof(bits)) != 0) ++wrong;
          ++index;
        });
        EXPECT_EQ(wrong, 0u) << fmt::format("leaf {}, {}", edge, voxels ? "voxels" : "cells");
      }
  }
}

TEST(Octree, RangesAndFlagsEqualThoseOfTheCpu) {
  parts::Numbers numbers(22);
  for (const Shape& shape : kShapes) {
    const Scene scene =
        parts::makeScene(parts::randomVolume(numbers, shape.dims, shape.type, {1, 1, 1}), ShadingModel::none);
    const VisibleScalars visible = randomVisible(numbers);
    for (const int edge : {2, 4, 16}) {
      StructureSettings settings{.kind = StructureKind::booleanOctree, .blockEdge = edge, .skippedLevels = 0};
      Built flags(scene, settings, visible);
      settings.kind = StructureKind::minMaxOctree;
      Built ranges(scene, settings, visible);
      const auto& flagTree = dynamic_cast<const Octree&>(*flags.structure);
      const auto& rangeTree = dynamic_cast<const MinMaxOctree&>(*ranges.structure);
      const glm::ivec3 size = flagTree.shape().leaves;
      const bool isFloat = shape.type == ScalarType::float32;
      const std::size_t bytes = isFloat ? 4 : ranges.constants.rawScale > 255 ? 2 : 1;
      const auto foundFlags = flags.read(flagTree.nodes(), 0, size, 1);
      const auto foundRanges = ranges.read(rangeTree.grid().image(), 0, size, 2 * bytes);
      const auto root =
          flags.read(flagTree.nodes(), static_cast<std::uint32_t>(flagTree.shape().rootLevel), {1, 1, 1}, 1);
      bool any = false;
      std::size_t index = 0;
      forNodes(size, [&](glm::ivec3 node) {
        Span scalars;
        Span raws;
        bool isBlock = false;
        forCells(cellsOf(scene.volume->grid(), false), node, edge, [&](glm::ivec3 cell) {
          isBlock = true;
          const Span span = spanOfCell(*scene.volume, flags.constants, cell, false);
          scalars.add(span.low);
          scalars.add(span.high);
          for (int corner = 0; corner < 8; ++corner)
            raws.add(rawAt(*scene.volume, glm::min(cell + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2),
                                                   scene.volume->grid().dims - 1)));
        });
        const bool shows = isBlock && visible.anyBetween(scalars.low, scalars.high);
        any = any || shows;
        EXPECT_EQ(foundFlags[index] != std::byte(0), shows);
        if (isBlock) {
          float found[2];
          for (int end = 0; end < 2; ++end) {
            const std::byte* at = foundRanges.data() + (2 * index + static_cast<std::size_t>(end)) * bytes;
            std::uint16_t stored = 0;
            if (isFloat)
              std::memcpy(&found[end], at, 4);
            else
              found[end] = static_cast<float>((std::memcpy(&stored, at, bytes), stored));
          }
          EXPECT_EQ(found[0], raws.low);
          EXPECT_EQ(found[1], raws.high);
        }
        ++index;
      });
      EXPECT_EQ(root[0] != std::byte(0), any);
    }
  }
}

TEST(Bricks, AreThoseThatShowInMortonOrder) {
  if (!parts::device().facts().rayQuery) GTEST_SKIP() << "no ray queries";
  parts::Numbers numbers(25);
  for (const Shape& shape : kShapes) {
    const Scene scene =
        parts::makeScene(parts::randomVolume(numbers, shape.dims, shape.type, {1, 1, 1}), ShadingModel::none);
    const VisibleScalars visible = randomVisible(numbers);
    for (const int edge : {2, 8}) {
      Built built(scene, {.kind = StructureKind::bricks, .blockEdge = edge}, visible);
      const std::vector<BrickBox>& boxes = dynamic_cast<const BrickBoxes&>(*built.structure).boxes();
      const auto placeOf = [&](const BrickBox& box) { return glm::ivec3(glm::round(box.low)) / edge; };
      const auto isBoxed = [&](glm::ivec3 brick) {
        return std::any_of(boxes.begin(), boxes.end(), [&](const BrickBox& box) { return placeOf(box) == brick; });
      };
      std::size_t occupied = 0;
      forNodes(parts::blocksOf(cellsOf(scene.volume->grid(), false), glm::ivec3(edge)), [&](glm::ivec3 brick) {
        Span block;
        forCells(cellsOf(scene.volume->grid(), false), brick, edge, [&](glm::ivec3 cell) {
          const Span span = spanOfCell(*scene.volume, built.constants, cell, false);
          block.add(span.low);
          block.add(span.high);
        });
        const bool shows = visible.anyBetween(block.low, block.high);
        occupied += shows ? 1 : 0;
        EXPECT_EQ(isBoxed(brick), shows);
      });
      EXPECT_EQ(boxes.size(), occupied);
      // Neighbours in the order are neighbours in space: halves, quarters ... of the tree are compact.
      for (std::size_t i = 1; i < boxes.size(); ++i) {
        const glm::ivec3 a = placeOf(boxes[i - 1]);
        const glm::ivec3 b = placeOf(boxes[i]);
        int axis = 0; // the one with the highest bit that differs; z before y before x
        for (int other = 1; other < 3; ++other)
          if (std::bit_width(static_cast<unsigned>(a[other] ^ b[other])) >=
              std::bit_width(static_cast<unsigned>(a[axis] ^ b[axis])))
            axis = other;
        EXPECT_LT(a[axis], b[axis]);
      }
    }
  }
}

/// Squared gap between the boxes of two texels, or the texels to go, one way; nothing if it lies the other way.
std::optional<int> gapBetween(StructureKind kind, int octant, glm::ivec3 from, glm::ivec3 to) {
  int sum = 0;
  int largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int way = to[axis] - from[axis];
    const int gap = std::max(std::abs(way) - 1, 0);
    sum += gap * gap;
    if (kind == StructureKind::chebyshevMap && way * ((octant >> axis) & 1 ? 1 : -1) < 0) return std::nullopt;
    largest = std::max(largest, std::abs(way));
  }
  return kind == StructureKind::chebyshevMap ? largest : sum;
}

class Distances : public testing::TestWithParam<StructureKind> {};

TEST_P(Distances, EqualThoseOfTheCpu) {
  parts::Numbers numbers(23);
  for (const Shape& shape : kShapes) {
    const Scene scene =
        parts::makeScene(parts::randomVolume(numbers, shape.dims, shape.type, {1, 1, 1}), ShadingModel::none);
    const VisibleScalars visible = randomVisible(numbers);
    for (const int edge : {2, 4, 16}) {
      Built built(scene, {.kind = GetParam(), .blockEdge = edge}, visible);
      const auto& map = dynamic_cast<const DistanceMap&>(*built.structure);
      const glm::ivec3 texels = map.texels();
      std::vector<glm::ivec3> occupied;
      forNodes(texels, [&](glm::ivec3 texel) {
        bool shows = false;
        Span block;
        forCells(cellsOf(scene.volume->grid(), false), texel, edge, [&](glm::ivec3 cell) {
          const Span span = spanOfCell(*scene.volume, built.constants, cell, false);
          block.add(span.low);
          block.add(span.high);
        });
        shows = visible.anyBetween(block.low, block.high);
        if (shows) occupied.push_back(texel);
      });
      const int octants = GetParam() == StructureKind::chebyshevMap ? 8 : 1;
      const auto found = built.read(map.distances(), 0, {texels.x, texels.y, texels.z * octants}, 1);
      std::size_t index = 0;
      std::size_t wrong = 0;
      for (int octant = 0; octant < octants; ++octant)
        forNodes(texels, [&](glm::ivec3 texel) {
          int best = std::numeric_limits<int>::max();
          bool here = false;
          for (const glm::ivec3& other : occupied) {
            here = here || other == texel;
            if (const auto gap = gapBetween(GetParam(), octant, texel, other)) best = std::min(best, *gap);
          }
          int expected = 0;
          if (!here && GetParam() == StructureKind::chebyshevMap)
            expected = std::min(best, 255);
          else if (!here)
            expected = 1 + static_cast<int>(std::min(254.0, std::floor(std::sqrt(double(best)) * edge)));
          if (static_cast<int>(found[index++]) != expected) ++wrong;
        });
      EXPECT_EQ(wrong, 0u) << fmt::format("texel {} of {} x {} x {}", edge, shape.dims.x, shape.dims.y, shape.dims.z);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Distances, testing::Values(StructureKind::distanceMap, StructureKind::chebyshevMap));

// --- Transfer functions as bits ------------------------------------------------------------------------------

TEST(VisibleScalars, MasksHoldEveryVisibleScalar) {
  parts::Numbers numbers(24);
  for (int i = 0; i < 50; ++i) {
    const auto function = parts::randomTransferFunction(numbers);
    for (const bool preintegrated : {false, true}) {
      const parts::TransferTable table =
          preintegrated ? parts::preintegratedTable(*function, 64, 1) : parts::postClassifiedTable(*function, 4096, 1);
      const VisibleScalars visible(table);
      for (const int bits : {8, 16, 32, 64, 128}) {
        const glm::uvec4 mask = visible.mask(bits);
        for (int k = 0; k <= 1000; ++k) {
          const double scalar = k / 1000.0;
          // Functions between the entries of a table are lost in pictures, too.
          const double seen = preintegrated ? scalar : std::round(scalar * 4095) / 4095;
          if (function->evaluate(seen).a <= 1e-9) continue;
          const int bin = std::min(static_cast<int>(scalar * bits), bits - 1);
          EXPECT_TRUE(mask[bin / 32] >> (bin % 32) & 1) << scalar << " of " << bits;
        }
      }
    }
  }
}

TEST(VisibleScalars, WiderMasksNest) {
  parts::Numbers numbers(25);
  for (int i = 0; i < 200; ++i) {
    const VisibleScalars visible = randomVisible(numbers);
    for (const int bits : {8, 16, 32, 64}) {
      const glm::uvec4 narrow = visible.mask(bits);
      const glm::uvec4 wide = visible.mask(2 * bits);
      for (int bit = 0; bit < bits; ++bit) {
        const auto has = [](const glm::uvec4& mask, int b) { return (mask[b / 32] >> (b % 32) & 1) != 0; };
        EXPECT_EQ(has(narrow, bit), has(wide, 2 * bit) || has(wide, 2 * bit + 1));
      }
    }
  }
}

TEST(VisibleScalars, NothingVisibleSetsNothing) {
  const TransferFunction nothing("nothing", {{0, {1, 1, 1}, 0}, {1, {1, 1, 1}, 0}});
  const VisibleScalars visible(parts::postClassifiedTable(nothing, 4096, 1));
  EXPECT_EQ(visible.mask(128), glm::uvec4(0));
  EXPECT_FALSE(visible.anyBetween(0, 1));
}

} // namespace
} // namespace volmark::empty_space_skipping
