// The work of the stamp self-test (gpu/stamp_self_test.cpp): a chain of hashes that no compiler can shorten.
#ifndef VOLMARK_STAMP_WORK_GLSL
#define VOLMARK_STAMP_WORK_GLSL

#include <volmark/random.glsl>

layout(push_constant) uniform StampWork {
  uint rounds;
};

uint hashRepeatedly(uint value) {
  for (uint i = 0u; i < rounds; ++i) value = hash(value);
  return value;
}

#endif
