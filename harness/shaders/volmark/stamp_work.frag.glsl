// Stamp self-test, draws. One invocation is one pixel and one chain of hashes. Nothing runs after it.
#version 460
#include <volmark/stamp_work.glsl>

layout(location = 0) out float result;

void main() {
  result = toUnitFloat(hashRepeatedly(uint(gl_FragCoord.y) * 64u + uint(gl_FragCoord.x)));
}
