// Extracts the triangles of a list of cells (Kreskowski et al. 2022, section 3.4.2). Vertices are indexed within a cell.
// Macros: VERTEX_LIMIT, of a list; TRIANGLE_LIMIT, what these can make; VIEWS, of the picture: one extraction for all of them;
// CLIP, with clipping planes.
// One invocation classifies one cell, then computes every 32nd vertex; a workgroup is one list. surface.frag.glsl runs next.
#version 460

#include <direct_rasterization/payload.glsl>

layout(local_size_x = kTaskThreads) in;
layout(triangles, max_vertices = VERTEX_LIMIT * VIEWS, max_primitives = TRIANGLE_LIMIT * VIEWS) out;

#include <parts/surface_mesh_output.glsl>

shared uint vertexEdges[VERTEX_LIMIT]; // cell (8 bits), edge
shared uint cellSizes[kTaskThreads];   // vertices, triangles << 16

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint offset = uint(payload.offsets[gl_WorkGroupID.x]);
  uint cells = uint(payload.lengths[gl_WorkGroupID.x]);
  uint block = payload.block;
  bool isUsed = lane < cells;
  uint cell = isUsed ? uint(payload.cells[offset + lane]) : 0u;
  uint corners = isUsed ? caseOfCell(cellOf(block, cell)) : 0u;
  uint edges = crossedEdges(corners);
  uint triangles = triangleCount(corners);
  cellSizes[lane] = uint(bitCount(edges)) | triangles << 16;
  barrier();

  // Sums before this cell, and of all. Too few to be worth what subgroups of all sizes would need.
  uint before = 0u;
  uint total = 0u;
  for (uint i = 0u; i < uint(kTaskThreads); ++i) {
    if (i < lane) before += cellSizes[i];
    total += cellSizes[i];
  }
  uint firstVertex = before & 0xffffu;
  uint firstTriangle = before >> 16;
  uint vertexCount = total & 0xffffu;
  uint triangleTotal = total >> 16;
  SetMeshOutputsEXT(vertexCount * VIEWS, triangleTotal * VIEWS);

  uint vertex = firstVertex;
  for (uint left = edges; left != 0u; left &= left - 1u) {
    vertexEdges[vertex] = cell << 4 | uint(findLSB(left));
    ++vertex;
  }
  for (uint i = 0u; i < triangles; ++i) {
    uvec3 at = triangleEdges(cellTriangles[corners], i);
    uvec3 indices = firstVertex + uvec3(vertexIndex(edges, at.x), vertexIndex(edges, at.y), vertexIndex(edges, at.z));
    writeTriangle(firstTriangle + i, triangleTotal, indices, vertexCount);
  }
  barrier();

  for (uint i = lane; i < vertexCount; i += uint(kTaskThreads)) {
    uint edge = vertexEdges[i] & 15u;
    SurfaceVertex vertex = vertexOnEdge(cellOf(block, vertexEdges[i] >> 4) + lowerEnd(edge), edgeDirection(edge));
    writeVertex(i, vertexCount, vertex.position, vertex.normal);
  }
  if (kCounting && lane == 0u) {
    addToCounter(uint(kCountVertices), vertexCount);
    addToCounter(uint(kCountTriangles), triangleTotal);
  }
}
