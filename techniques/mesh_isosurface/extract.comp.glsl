// Triangles of a block of cells, with vertices shared within it (after Liu et al. 2016, parallel marching blocks).
// Compiled twice: with COUNT, which counts them, and without, which writes them where the sums of the counts say.
// Together the invocations of a workgroup, which is one block, take its voxels, then its edges, then its cells. The surface is
// drawn next.
#version 460

#include <mesh_isosurface/vertices.glsl>
#include <parts/surface.glsl>

layout(local_size_x = kExtractThreads) in;

layout(set = 0, binding = kBindingBlocks, scalar) uniform BlockBlock {
  BlockConstants grid;
};
layout(set = 0, binding = kBindingChosen, scalar) readonly buffer ChosenBlock {
  uint chosen[];
};
layout(set = 0, binding = kBindingList, scalar) readonly buffer ListBlock {
  uint list[];
};
layout(set = 0, binding = kBindingVertexCounts, scalar) buffer VertexCountsBlock {
  uint vertexCounts[];
};
layout(set = 0, binding = kBindingTriangleCounts, scalar) buffer TriangleCountsBlock {
  uint triangleCounts[];
};
layout(buffer_reference, scalar) writeonly buffer Indices {
  uvec3 triangle[];
};
layout(push_constant, scalar) uniform ExtractPush {
  ExtractConstants extract;
};

const int kSide = kBlockEdge + 1;            // voxels along an axis
const int kVoxels = kSide * kSide * kSide;
const int kEdges = 3 * kVoxels;              // edge: axis * kVoxels + its lower voxel; some lead out of the block
const int kVoxelWords = (kVoxels + 31) / 32;
const int kEdgeWords = (kEdges + 31) / 32;
const int kCells = kBlockEdge * kBlockEdge * kBlockEdge;
const int kCellsOfThread = kCells / kExtractThreads;

shared uint insideBits[kVoxelWords];
shared uint edgeBits[kEdgeWords];
shared uint verticesBefore[kEdgeWords]; // of each word of edges
shared uint trianglesOf[kExtractThreads];
#ifndef COUNT
shared uint vertexEdges[kEdges]; // edge of each vertex
#endif

int voxelIndex(ivec3 place) {
  return (place.z * kSide + place.y) * kSide + place.x;
}

bool insideBit(int voxel) {
  return (insideBits[voxel >> 5] >> (voxel & 31) & 1u) != 0u;
}

uint vertexOfEdge(int edge) {
  return verticesBefore[edge >> 5] + uint(bitCount(edgeBits[edge >> 5] & ((1u << (edge & 31)) - 1u)));
}

uint caseInBlock(ivec3 cell) {
  uint corners = 0u;
  for (int c = 0; c < 8; ++c)
    corners |= (insideBit(voxelIndex(cell + ivec3(c & 1, (c >> 1) & 1, c >> 2))) ? 1u : 0u) << c;
  return corners;
}

ivec3 cellInBlock(int index) {
  return placeOf(uint(index), ivec3(kBlockEdge));
}

void main() {
  uint item = workgroupIndex(gl_WorkGroupID);
  // The same for all of the workgroup.
  if (item >= chosen[extract.totalIndex]) return;
  int lane = int(gl_LocalInvocationIndex);
  ivec3 low = placeOf(list[item], grid.blocks) * kBlockEdge;
  ivec3 cells = min(grid.cells - low, ivec3(kBlockEdge)); // of this block

  for (int word = lane; word < kVoxelWords; word += kExtractThreads) insideBits[word] = 0u;
  for (int word = lane; word < kEdgeWords; word += kExtractThreads) edgeBits[word] = 0u;
  barrier();
  for (int voxel = lane; voxel < kVoxels; voxel += kExtractThreads) {
    ivec3 place = placeOf(uint(voxel), ivec3(kSide));
    if (all(lessThanEqual(place, cells)) && isInside(low + place) != 0u)
      atomicOr(insideBits[voxel >> 5], 1u << (voxel & 31));
  }
  barrier();
  for (int voxel = lane; voxel < kVoxels; voxel += kExtractThreads) {
    ivec3 place = placeOf(uint(voxel), ivec3(kSide));
    if (any(greaterThan(place, cells))) continue;
    bool inside = insideBit(voxel);
    for (int axis = 0; axis < 3; ++axis) {
      ivec3 direction = ivec3(axis == 0, axis == 1, axis == 2);
      if (any(greaterThan(place + direction, cells)) || insideBit(voxelIndex(place + direction)) == inside) continue;
      int edge = axis * kVoxels + voxel;
      atomicOr(edgeBits[edge >> 5], 1u << (edge & 31));
    }
  }
  // Triangles of this invocation's cells, which follow each other.
  uint triangles = 0u;
  for (int i = 0; i < kCellsOfThread; ++i) {
    ivec3 cell = cellInBlock(lane * kCellsOfThread + i);
    if (all(lessThan(cell, cells))) triangles += triangleCount(caseInBlock(cell));
  }
  trianglesOf[lane] = triangles;
  barrier();
  for (int word = lane; word < kEdgeWords; word += kExtractThreads) {
    uint before = 0u;
    for (int i = 0; i < word; ++i) before += uint(bitCount(edgeBits[i]));
    verticesBefore[word] = before;
  }
  uint trianglesBefore = 0u;
  for (int i = 0; i < lane; ++i) trianglesBefore += trianglesOf[i];
  barrier();
  uint vertices = verticesBefore[kEdgeWords - 1] + uint(bitCount(edgeBits[kEdgeWords - 1]));

#ifdef COUNT
  if (lane == kExtractThreads - 1) {
    vertexCounts[item] = vertices;
    triangleCounts[item] = trianglesBefore + triangles;
  }
#else
  for (int word = lane; word < kEdgeWords; word += kExtractThreads) {
    uint vertex = verticesBefore[word];
    for (uint left = edgeBits[word]; left != 0u; left &= left - 1u) {
      vertexEdges[vertex] = uint(32 * word + findLSB(left));
      ++vertex;
    }
  }
  barrier();
  uint firstVertex = vertexCounts[item];
  uint firstTriangle = triangleCounts[item];
  Vertices target = Vertices(extract.vertices);
  for (uint i = uint(lane); i < vertices; i += uint(kExtractThreads)) {
    int edge = int(vertexEdges[i]);
    int axis = edge / kVoxels;
    ivec3 place = low + placeOf(uint(edge - axis * kVoxels), ivec3(kSide));
    vec3 world = vertexAt(place, ivec3(axis == 0, axis == 1, axis == 2));
    target.vertex[firstVertex + i] = Vertex(world, vertexNormal(world));
  }
  Indices indices = Indices(extract.indices);
  uint triangle = firstTriangle + trianglesBefore;
  for (int i = 0; i < kCellsOfThread; ++i) {
    ivec3 cell = cellInBlock(lane * kCellsOfThread + i);
    if (any(greaterThanEqual(cell, cells))) continue;
    uint corners = caseInBlock(cell);
    uint count = triangleCount(corners);
    for (uint k = 0u; k < count; ++k) {
      uvec3 edges = triangleEdges(corners, k);
      uvec3 at;
      for (int c = 0; c < 3; ++c)
        at[c] = vertexOfEdge(int(edges[c] >> 2) * kVoxels + voxelIndex(cell + lowerEnd(edges[c])));
      indices.triangle[triangle] = firstVertex + at;
      ++triangle;
    }
  }
#endif
}
