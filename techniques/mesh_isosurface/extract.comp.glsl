// Triangles of a block of cells, with vertices shared within it (after Liu et al. 2016, parallel marching blocks).
// Compiled twice: with COUNT, which counts them, and without, which writes them where the sums of the counts say.
// Together the invocations of a workgroup, which is one block, take its rows of voxels, then of edges, then of cells, an
// invocation a row: bits instead of voxels wherever possible. Then each takes vertices, and then occupied cells, from
// lists. The surface is drawn next.
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
layout(buffer_reference, scalar) buffer Rows {
  uint word[]; // kRowWords of each block: a bit for each inside voxel, kRowsInWord rows in a word
};
layout(push_constant, scalar) uniform ExtractPush {
  ExtractConstants extract;
};

const int kSide = kBlockEdge + 1; // voxels along an axis
const int kRows = kSide * kSide;   // of voxels along x
const int kCellRows = kBlockEdge * kBlockEdge;
// Crossed edges of a row of voxels, by bit: along x, y and z from the voxel with the lower coordinate.
const int kAlongY = kBlockEdge;
const int kAlongZ = kBlockEdge + kSide;
// Edges of a row along one axis, and above them how many vertices the block has before them.
const int kBeforeShift = kSide;
// A cell in 32 bits: its case, its x and its row, and how many triangles the block has before it.
const int kCellShift = 8;
const int kTriangleShift = kCellShift + 9;
// Sums are made in groups of eight rows: short loops, and right for any subgroup size.
const int kVertexGroups = (kRows + 7) / 8;
const int kCellGroups = kCellRows / 8;

shared uint insideRows[kRows];    // a bit for each voxel
shared uint edgeRows[kRows];      // a bit for each crossed edge
shared uvec2 cellRows[kCellRows]; // occupied cells, triangles; then those before it in its group
shared uint verticesInGroups[kVertexGroups];
shared uvec2 cellsInGroups[kCellGroups];
#ifndef COUNT
shared uint verticesBefore[kRows];              // in its group
shared uint verticesBeforeGroups[kVertexGroups + 1];
shared uvec2 cellsBeforeGroups[kCellGroups + 1];
shared uint edgesOfRows[3 * kRows];             // along each axis
shared uint vertexEdges[(kAlongZ + kSide) * kRows]; // of each vertex: z, y, and its bit in the lowest five bits
shared uint cells[kBlockEdge * kCellRows];      // occupied ones
#endif

// Of rows numbered y fastest.
ivec2 rowPlace(int row, int side) {
  int z = row / side;
  return ivec2(row - z * side, z);
}

uint lowBits(int count) {
  return (1u << count) - 1u;
}

#ifndef COUNT
// Vertex of an edge of a cell, among those of the block.
uint vertexOfCellEdge(ivec3 cell, uint edge) {
  ivec3 low = cell + lowerEnd(edge);
  uint edges = edgesOfRows[int(edge >> 2) * kRows + low.z * kSide + low.y];
  return (edges >> kBeforeShift) + uint(bitCount(edges & lowBits(low.x)));
}
#endif

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

// A bit for each cell of a row that the surface goes through.
uint occupiedCells(uvec4 rows, int count) {
  uint any = rows.x | rows.y | rows.z | rows.w;
  uint all = rows.x & rows.y & rows.z & rows.w;
  return (any | any >> 1) & ~(all & all >> 1) & lowBits(count);
}

void findInside(int lane, ivec3 low, ivec3 size) {
  for (int row = lane; row < kRows; row += kExtractThreads) {
    ivec2 place = rowPlace(row, kSide);
    uint bits = 0u;
    if (all(lessThanEqual(place, size.yz)))
      for (int x = 0; x <= size.x; ++x) bits |= isInside(low + ivec3(x, place)) << x;
    insideRows[row] = bits;
  }
}

void findEdges(int lane, ivec3 size) {
  for (int row = lane; row < kRows; row += kExtractThreads) {
    ivec2 place = rowPlace(row, kSide);
    uint edges = 0u;
    if (all(lessThanEqual(place, size.yz))) {
      uint own = insideRows[row];
      edges = (own ^ (own >> 1)) & lowBits(size.x);
      if (place.x < size.y) edges |= (own ^ insideRows[row + 1]) << kAlongY;
      if (place.y < size.z) edges |= (own ^ insideRows[row + kSide]) << kAlongZ;
    }
    edgeRows[row] = edges;
  }
}

void main() {
  uint item = workgroupIndex(gl_WorkGroupID);
  // The same for all of the workgroup.
  if (item >= chosen[extract.totalIndex]) return;
  int lane = int(gl_LocalInvocationIndex);
  ivec3 low = placeOf(list[item], grid.blocks) * kBlockEdge;
  ivec3 size = min(grid.cells - low, ivec3(kBlockEdge)); // of this block
  Rows found = Rows(extract.rows);
  // Whether voxels are inside is found once: what writes the surface finds here what counted it has seen.
#ifdef COUNT
  findInside(lane, low, size);
  barrier();
  if (lane < kRowWords && item < extract.rowBlocks) {
    uint word = 0u;
    for (int i = 0; i < kRowsInWord; ++i) word |= insideRows[kRowsInWord * lane + i] << (kSide * i);
    found.word[item * uint(kRowWords) + uint(lane)] = word;
  }
#else
  for (int row = lane; row < kRows; row += kExtractThreads) {
    int index = row / kRowsInWord;
    insideRows[row] = bitfieldExtract(found.word[item * uint(kRowWords) + uint(index)],
                                      kSide * (row - kRowsInWord * index), kSide);
  }
  barrier();
#endif

  findEdges(lane, size);
  ivec2 cellRow = rowPlace(lane, kBlockEdge);
  uvec4 rows = rowsAround(cellRow);
  uint occupied = all(lessThan(cellRow, size.yz)) ? occupiedCells(rows, size.x) : 0u;
  uint countsInRow = 0u; // triangles of the occupied cells in order, four bits each
  uint trianglesInRow = 0u;
  int shift = 0;
  for (uint left = occupied; left != 0u; left &= left - 1u) {
    uint count = triangleCount(caseInRow(rows, findLSB(left)));
    countsInRow |= count << shift;
    trianglesInRow += count;
    shift += 4;
  }
  cellRows[lane] = uvec2(bitCount(occupied), trianglesInRow);
  barrier();

  if (lane < kVertexGroups) {
    uint sum = 0u;
    for (int row = 8 * lane; row < min(8 * lane + 8, kRows); ++row) {
#ifndef COUNT
      verticesBefore[row] = sum;
#endif
      sum += uint(bitCount(edgeRows[row]));
    }
    verticesInGroups[lane] = sum;
  }
  if (lane < kCellGroups) {
    uvec2 sum = uvec2(0);
    for (int row = 8 * lane; row < 8 * lane + 8; ++row) {
      uvec2 own = cellRows[row];
      cellRows[row] = sum;
      sum += own;
    }
    cellsInGroups[lane] = sum;
  }
  barrier();
#ifdef COUNT
  if (lane == 0) {
    uint vertices = 0u;
    for (int group = 0; group < kVertexGroups; ++group) vertices += verticesInGroups[group];
    uint triangles = 0u;
    for (int group = 0; group < kCellGroups; ++group) triangles += cellsInGroups[group].y;
    vertexCounts[item] = vertices;
    triangleCounts[item] = triangles;
  }
#else
  if (lane <= kVertexGroups) {
    uint sum = 0u;
    for (int group = 0; group < lane; ++group) sum += verticesInGroups[group];
    verticesBeforeGroups[lane] = sum;
  }
  if (lane <= kCellGroups) {
    uvec2 sum = uvec2(0);
    for (int group = 0; group < lane; ++group) sum += cellsInGroups[group];
    cellsBeforeGroups[lane] = sum;
  }
  barrier();

  for (int row = lane; row < kRows; row += kExtractThreads) {
    ivec2 place = rowPlace(row, kSide);
    uint edges = edgeRows[row];
    uint vertex = verticesBeforeGroups[row / 8] + verticesBefore[row];
    uvec3 ofAxes = uvec3(edges, edges >> kAlongY, edges >> kAlongZ) & uvec3(lowBits(kBlockEdge), uvec2(lowBits(kSide)));
    uvec3 counts = uvec3(bitCount(ofAxes));
    edgesOfRows[row] = vertex << kBeforeShift | ofAxes.x;
    edgesOfRows[kRows + row] = (vertex + counts.x) << kBeforeShift | ofAxes.y;
    edgesOfRows[2 * kRows + row] = (vertex + counts.x + counts.y) << kBeforeShift | ofAxes.z;
    for (uint left = edges; left != 0u; left &= left - 1u) {
      vertexEdges[vertex] = uint(place.y << 9 | place.x << 5 | findLSB(left));
      ++vertex;
    }
  }
  uvec2 before = cellsBeforeGroups[lane / 8] + cellRows[lane];
  for (uint left = occupied; left != 0u; left &= left - 1u) {
    int x = findLSB(left);
    cells[before.x] = before.y << kTriangleShift | uint(lane * kBlockEdge + x) << kCellShift | caseInRow(rows, x);
    before += uvec2(1, countsInRow & 15u);
    countsInRow >>= 4;
  }
  barrier();

  uint firstVertex = vertexCounts[item];
  uint vertices = verticesBeforeGroups[kVertexGroups];
  Vertices vertexTarget = Vertices(extract.vertices);
  for (uint i = uint(lane); i < vertices; i += uint(kExtractThreads)) {
    uint edge = vertexEdges[i];
    int bit = int(edge & 31u);
    int axis = bit < kAlongY ? 0 : bit < kAlongZ ? 1 : 2;
    ivec3 place = ivec3(bit - (axis == 0 ? 0 : axis == 1 ? kAlongY : kAlongZ), (edge >> 5) & 15u, edge >> 9);
    SurfaceVertex vertex = vertexOnEdge(low + place, ivec3(axis == 0, axis == 1, axis == 2));
    vertexTarget.vertex[firstVertex + i] = Vertex(vertex.position, vertex.normal);
  }
  uint firstTriangle = triangleCounts[item];
  uint cellCount = cellsBeforeGroups[kCellGroups].x;
  Indices triangleTarget = Indices(extract.indices);
  for (uint i = uint(lane); i < cellCount; i += uint(kExtractThreads)) {
    uint packed = cells[i];
    uvec2 ofCell = cellTriangles[packed & 255u];
    uint index = bitfieldExtract(packed, kCellShift, kTriangleShift - kCellShift);
    ivec3 cell = ivec3(index % uint(kBlockEdge), index / uint(kBlockEdge) % uint(kBlockEdge), index / uint(kCellRows));
    uint triangle = firstTriangle + (packed >> kTriangleShift);
    uint count = ofCell.y >> 28;
    for (uint k = 0u; k < count; ++k) {
      uvec3 edges = triangleEdges(ofCell, k);
      triangleTarget.triangle[triangle + k] = firstVertex + uvec3(vertexOfCellEdge(cell, edges.x),
                                                                  vertexOfCellEdge(cell, edges.y),
                                                                  vertexOfCellEdge(cell, edges.z));
    }
  }
#endif
}
