// Triangles of a block of cells, with vertices shared within it (after Liu et al. 2016, parallel marching blocks).
// Compiled twice: with COUNT, which counts them, and without, which writes them where the sums of the counts say.
// Together the invocations of a workgroup, which is one block, take its rows of voxels, then of edges, then of cells, an
// invocation a row: bits instead of voxels wherever possible. The surface is drawn next.
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

const int kSide = kBlockEdge + 1; // voxels along an axis
const int kRows = kSide * kSide;   // of voxels along x
const int kRowGroups = (kRows + 7) / 8;
const int kCellRows = kBlockEdge * kBlockEdge;
// Edges of a row of voxels, by bit: along x, y and z from the voxel with the lower coordinate.
const int kAlongY = kBlockEdge;
const int kAlongZ = kBlockEdge + kSide;

shared uint insideRows[kRows];      // a bit for each voxel
shared uint edgeRows[kRows];        // a bit for each crossed edge
shared uint verticesOfRows[kRows];  // before each row
shared uint verticesOfGroups[kRowGroups];
shared uint trianglesOfRows[kCellRows];
shared uint trianglesOfGroups[kCellRows / 8];
#ifndef COUNT
shared uint vertexEdges[3 * kSide * kRows]; // of each vertex: its row, and its bit in the lowest five bits
#endif

// Of rows numbered y fastest.
ivec2 rowPlace(int row, int side) {
  int z = row / side;
  return ivec2(row - z * side, z);
}

uint lowBits(int count) {
  return (1u << count) - 1u;
}

// Place of an edge's vertex among those of the block.
uint vertexOfEdge(int row, int bit) {
  return verticesOfRows[row] + uint(bitCount(edgeRows[row] & lowBits(bit)));
}

uint vertexOfCellEdge(ivec3 cell, uint edge) {
  ivec3 low = cell + lowerEnd(edge);
  int bit = low.x + (edge < 4u ? 0 : edge < 8u ? kAlongY : kAlongZ);
  return vertexOfEdge(low.z * kSide + low.y, bit);
}

// Inside bits of the four rows around a row of cells.
uvec4 rowsAround(ivec2 place) {
  int row = place.y * kSide + place.x;
  return uvec4(insideRows[row], insideRows[row + 1], insideRows[row + kSide], insideRows[row + kSide + 1]);
}

// Corner bits x, y, z are 1, 2, 4.
uint caseInRow(uvec4 rows, int x) {
  uvec4 pairs = (rows >> x) & 3u;
  return pairs.x | pairs.y << 2 | pairs.z << 4 | pairs.w << 6;
}

// Whether the surface goes through any of `cells` cells of a row.
bool isRowOccupied(uvec4 rows, int cells) {
  uint all = lowBits(cells + 1);
  uint any = (rows.x | rows.y | rows.z | rows.w) & all;
  return any != 0u && (rows.x & rows.y & rows.z & rows.w & all) != all;
}

void main() {
  uint item = workgroupIndex(gl_WorkGroupID);
  // The same for all of the workgroup.
  if (item >= chosen[extract.totalIndex]) return;
  int lane = int(gl_LocalInvocationIndex);
  ivec3 low = placeOf(list[item], grid.blocks) * kBlockEdge;
  ivec3 cells = min(grid.cells - low, ivec3(kBlockEdge)); // of this block

  for (int row = lane; row < kRows; row += kExtractThreads) {
    ivec2 place = rowPlace(row, kSide);
    uint bits = 0u;
    if (all(lessThanEqual(place, cells.yz)))
      for (int x = 0; x <= cells.x; ++x) bits |= isInside(low + ivec3(x, place)) << x;
    insideRows[row] = bits;
  }
  barrier();

  for (int row = lane; row < kRows; row += kExtractThreads) {
    ivec2 place = rowPlace(row, kSide);
    uint edges = 0u;
    if (all(lessThanEqual(place, cells.yz))) {
      uint own = insideRows[row];
      edges = (own ^ (own >> 1)) & lowBits(cells.x);
      if (place.x < cells.y) edges |= (own ^ insideRows[row + 1]) << kAlongY;
      if (place.y < cells.z) edges |= (own ^ insideRows[row + kSide]) << kAlongZ;
    }
    edgeRows[row] = edges;
  }
  uint triangles = 0u;
  ivec2 cellRow = rowPlace(lane, kBlockEdge);
  uvec4 rows = rowsAround(cellRow);
  bool isUsed = all(lessThan(cellRow, cells.yz)) && isRowOccupied(rows, cells.x);
  if (isUsed)
    for (int x = 0; x < cells.x; ++x) triangles += triangleCount(caseInRow(rows, x));
  trianglesOfRows[lane] = triangles;
  barrier();

  // Sums over groups of eight rows, then within a group: short loops, and right for any subgroup size.
  if (lane < kRowGroups) {
    uint sum = 0u;
    for (int row = 8 * lane; row < min(8 * lane + 8, kRows); ++row) sum += uint(bitCount(edgeRows[row]));
    verticesOfGroups[lane] = sum;
  }
  if (lane < kCellRows / 8) {
    uint sum = 0u;
    for (int row = 8 * lane; row < 8 * lane + 8; ++row) sum += trianglesOfRows[row];
    trianglesOfGroups[lane] = sum;
  }
  barrier();
  uint vertices = 0u;
  for (int group = 0; group < kRowGroups; ++group) vertices += verticesOfGroups[group];
  uint trianglesBefore = 0u;
  uint trianglesInBlock = 0u;
  for (int group = 0; group < kCellRows / 8; ++group) {
    if (group < lane / 8) trianglesBefore += trianglesOfGroups[group];
    trianglesInBlock += trianglesOfGroups[group];
  }
  for (int row = lane / 8 * 8; row < lane; ++row) trianglesBefore += trianglesOfRows[row];

#ifdef COUNT
  if (lane == 0) {
    vertexCounts[item] = vertices;
    triangleCounts[item] = trianglesInBlock;
  }
#else
  for (int row = lane; row < kRows; row += kExtractThreads) {
    uint vertex = 0u;
    for (int group = 0; group < row / 8; ++group) vertex += verticesOfGroups[group];
    for (int other = row / 8 * 8; other < row; ++other) vertex += uint(bitCount(edgeRows[other]));
    verticesOfRows[row] = vertex;
    for (uint left = edgeRows[row]; left != 0u; left &= left - 1u) {
      vertexEdges[vertex] = uint(row) << 5 | uint(findLSB(left));
      ++vertex;
    }
  }
  barrier();

  uint firstVertex = vertexCounts[item];
  Vertices target = Vertices(extract.vertices);
  for (uint i = uint(lane); i < vertices; i += uint(kExtractThreads)) {
    int bit = int(vertexEdges[i] & 31u);
    int axis = bit < kAlongY ? 0 : bit < kAlongZ ? 1 : 2;
    int x = bit - (axis == 0 ? 0 : axis == 1 ? kAlongY : kAlongZ);
    ivec3 place = low + ivec3(x, rowPlace(int(vertexEdges[i] >> 5), kSide));
    vec3 world = vertexAt(place, ivec3(axis == 0, axis == 1, axis == 2));
    target.vertex[firstVertex + i] = Vertex(world, vertexNormal(world));
  }
  if (!isUsed) return;
  Indices indices = Indices(extract.indices);
  uint triangle = triangleCounts[item] + trianglesBefore;
  for (int x = 0; x < cells.x; ++x) {
    uint corners = caseInRow(rows, x);
    uint count = triangleCount(corners);
    for (uint k = 0u; k < count; ++k) {
      uvec3 edges = triangleEdges(corners, k);
      ivec3 cell = ivec3(x, cellRow);
      indices.triangle[triangle] = firstVertex + uvec3(vertexOfCellEdge(cell, edges.x), vertexOfCellEdge(cell, edges.y),
                                                       vertexOfCellEdge(cell, edges.z));
      ++triangle;
    }
  }
#endif
}
