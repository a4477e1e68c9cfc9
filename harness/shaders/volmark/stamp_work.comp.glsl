// Stamp self-test, dispatches. One invocation is one chain of hashes. Nothing runs after it.
#version 460
#include <volmark/stamp_work.glsl>

layout(local_size_x = 64) in;
layout(set = 0, binding = 0) writeonly buffer Results {
  uint results[];
};

void main() {
  results[gl_GlobalInvocationID.x] = hashRepeatedly(gl_GlobalInvocationID.x);
}
