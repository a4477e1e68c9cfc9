// Emission and absorption, front to back, without acceleration: the "None" column of Faludi et al. 2021,
// Table 1, with its transfer function as a 1-D or a 2-D pre-integrated table (section 3.2).
// One invocation is one pixel of one view (z); a workgroup is 8 x 8 pixels. Nothing runs after it.
#version 460

#include <parts/emission_absorption.glsl>

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  uint view = gl_WorkGroupID.z;
  VolumeGrid grid = volumeGrid(frame);
  Accumulation sum = Accumulation(vec3(0), 1.0, 0u, 0u, 0u);
  bool inPicture = all(lessThan(pixel, frame.size));
  Path path;
  bool entered = inPicture && makePath(grid, pixel, view, true, path);
  if (entered) {
    Classification by = classification(grid);
    accumulateBeginning(grid, path, by, sum);
    accumulate(grid, path, by, firstSample(path), sampleEnd(path), sum);
  }
  finishRay(pixel, view, inPicture, entered, sum, 0u);
}
