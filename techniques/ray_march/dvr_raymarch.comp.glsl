// Emission and absorption, front to back, without acceleration: the "None" column of Faludi et al. 2021,
// Table 1, with its transfer function as a 1-D or a 2-D pre-integrated table (section 3.2).
// One invocation is one pixel of one view (z); a workgroup is 8 x 8 pixels. Nothing runs after it.
#version 460

#include <parts/emission_absorption.glsl>

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  uint view = gl_WorkGroupID.z;
  VolumeGrid grid = volumeGrid(frame);
  Accumulation sum = nothingYet();
  Path path;
  bool entered = beginRay(grid, pixel, view, path);
  for (int n = 0; entered && n < kPortions; ++n) {
    Classification by = beginPortion(grid, n, path);
    accumulateBeginning(grid, path, by, sum);
    accumulate(grid, path, by, firstSample(path), sampleEnd(path), sum);
  }
  finishRay(pixel, view, entered, sum, 0u);
}
