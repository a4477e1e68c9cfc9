// Emission and absorption, front to back, of those samples alone that a structure does not know to be transparent: the
// ray marcher of Faludi et al. 2021, section 3.4, with each of the structures of its Table 1.
// Macros: BITFIELD, MINMAX or BOOLEAN (octrees), EUCLIDEAN or CHEBYSHEV (distances), BRICKS (ray queries).
// One invocation is one pixel of one view (z); a workgroup is 8 x 8 pixels. Nothing runs after it.
#version 460

#if defined(BRICKS)
#include <empty_space_skipping/bricks.glsl>
#elif defined(EUCLIDEAN) || defined(CHEBYSHEV)
#include <empty_space_skipping/distance.glsl>
#else
#include <empty_space_skipping/octree.glsl>
#endif

layout(constant_id = kIdSharedSlabs) const bool kSharedSlabs = true;

// Samples of occupied nodes are gathered until there are so many, or until an empty node follows: the texture units, and
// the lanes of a subgroup, then have work for several turns.
const int kRun = 32;

// Adds what the samples [first, end) show. `drawn`: the end of the slabs that have been drawn.
void drawRun(VolumeGrid grid, Path path, Classification by, Walk walk, int first, int end, inout int drawn,
             inout Accumulation sum) {
#ifdef PREINTEGRATED
  // Leaving a skip, the slab from the last empty sample into the run counts, too.
  int start = max(first - 1, drawn);
  drawn = min(end, walk.end - 1);
  accumulate(grid, path, by, start, drawn, sum);
#else
  accumulate(grid, path, by, first, end, sum);
#endif
}

void skipAndDraw(VolumeGrid grid, Path path, Classification by, inout Walk walk, inout Accumulation sum) {
  int index = firstSample(path);
  int drawn = index; // slabs before it
  while (index < walk.end && goesOn(sum.transmittance)) {
    int first = index; // the run is [first, end)
    int end = index;
    while (index < walk.end && end - first < kRun) {
      int last;
      bool empty = findEmpty(by, walk, index, last);
#ifdef PREINTEGRATED
      // Values may jump between nodes that don't touch, with something visible in between.
      if (empty && !kSharedSlabs && end == first && index > drawn)
        drawRun(grid, path, by, walk, index, index, drawn, sum);
#endif
      index = last + 1;
      if (!empty) {
        end = index;
      } else if (end > first) {
        break;
      } else {
        first = end = index;
      }
    }
    if (end > first) drawRun(grid, path, by, walk, first, end, drawn, sum);
  }
}

// Pixels of a workgroup in Z order: the invocations of a subgroup are a compact block of the picture, whose rays take
// about as many turns.
ivec2 pixelInZOrder() {
  uint n = gl_LocalInvocationIndex;
  ivec2 within = ivec2((n & 1u) | ((n >> 1) & 2u) | ((n >> 2) & 4u), ((n >> 1) & 1u) | ((n >> 2) & 2u) | ((n >> 3) & 4u));
  return ivec2(gl_WorkGroupID.xy) * kGroupSize + within;
}

void main() {
  ivec2 pixel = pixelInZOrder();
  uint view = gl_WorkGroupID.z;
  VolumeGrid grid = volumeGrid(frame);
  Accumulation sum = nothingYet();
  uint nodes = 0u;
  Path path;
  bool entered = beginRay(grid, pixel, view, path);
  for (int n = 0; entered && n < kPortions; ++n) {
    Classification by = beginPortion(grid, n, path);
    accumulateBeginning(grid, path, by, sum);
    Walk walk = makeWalk(grid, path);
    skipAndDraw(grid, path, by, walk, sum);
    nodes += walk.nodes;
  }
  finishRay(pixel, view, entered, sum, nodes);
}
