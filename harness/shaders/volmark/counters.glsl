// Work counters (gpu/counter_buffer.h): 64-bit counters made of two 32-bit words, low word first.
//   VOLMARK_COUNTERS(4)   binds the counter buffer and declares
//     void addToCounter(uint counter, uint amount)             one atomic add per invocation
//     void addToCounterBySubgroup(uint counter, uint amount)   one per subgroup; all active invocations must
//                                                              name the same counter; their sum must fit 32 bits
#ifndef VOLMARK_COUNTERS_GLSL
#define VOLMARK_COUNTERS_GLSL

#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

#define VOLMARK_COUNTERS(slot)                                                          \
  layout(set = 0, binding = slot, scalar) buffer VolmarkCounters {                      \
    uint counterWords[];                                                                \
  };                                                                                    \
  void addToCounter(uint counter, uint amount) {                                        \
    if (amount == 0u) return;                                                           \
    uint before = atomicAdd(counterWords[2u * counter], amount);                        \
    if (before + amount < before) atomicAdd(counterWords[2u * counter + 1u], 1u);       \
  }                                                                                     \
  void addToCounterBySubgroup(uint counter, uint amount) {                              \
    uint sum = subgroupAdd(amount);                                                     \
    if (subgroupElect()) addToCounter(counter, sum);                                    \
  }

#endif
