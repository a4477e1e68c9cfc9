// What every shader is told of its frame. A technique declares where it is bound, once, at file scope:
//   #include <volmark/frame.glsl>
//   VOLMARK_FRAME(0)
// and then reads `frame` (FrameConstants, volmark/frame_constants.h).
#ifndef VOLMARK_FRAME_GLSL
#define VOLMARK_FRAME_GLSL

#extension GL_EXT_scalar_block_layout : require

#include <volmark/frame_constants.h>

// Declares the uniform block `frame` at binding `slot` of set 0.
#define VOLMARK_FRAME(slot)                                              \
  layout(set = 0, binding = slot, scalar) uniform VolmarkFrameBlock {   \
    FrameConstants frame;                                                \
  };

#endif
