// Transfer functions as tables, opacity correction, pre-integrated tables.
//   VOLMARK_TRANSFER_FUNCTION(3)        binds TransferFunction::table() as a storage buffer of vec4 and declares
//                                       vec4 transferFunction(float value): straight colour, opacity per voxel
//   VOLMARK_PREINTEGRATED_TABLE(3, n)   binds TransferFunction::preintegratedTable(n, step) the same way and declares
//                                       vec4 preintegrated(float front, float back): premultiplied; n is any
//                                       integer expression, constant or not
// Both interpolate linearly in 32-bit floats. The functions below read the same tables from textures.
#ifndef VOLMARK_TRANSFER_FUNCTION_GLSL
#define VOLMARK_TRANSFER_FUNCTION_GLSL

#extension GL_EXT_scalar_block_layout : require

#define VOLMARK_TRANSFER_FUNCTION(slot)                                                                        \
  layout(set = 0, binding = slot, scalar) readonly buffer VolmarkTransferFunction {                            \
    vec4 transferFunctionTable[];                                                                              \
  };                                                                                                           \
  vec4 transferFunction(float value) {                                                                         \
    int last = transferFunctionTable.length() - 1;                                                             \
    float position = clamp(value, 0.0, 1.0) * float(last);                                                     \
    int low = min(int(position), last - 1);                                                                    \
    return mix(transferFunctionTable[low], transferFunctionTable[low + 1], position - float(low));             \
  }

#define VOLMARK_PREINTEGRATED_TABLE(slot, size)                                                                \
  layout(set = 0, binding = slot, scalar) readonly buffer VolmarkPreintegratedTable {                          \
    vec4 preintegratedTable[];                                                                                 \
  };                                                                                                           \
  vec4 preintegrated(float front, float back) {                                                                \
    int width = int(size);                                                                                     \
    vec2 position = clamp(vec2(front, back), 0.0, 1.0) * float(width - 1);                                     \
    ivec2 low = min(ivec2(position), ivec2(width - 2));                                                        \
    vec2 fraction = position - vec2(low);                                                                      \
    int index = low.y * width + low.x;                                                                         \
    vec4 lowRow = mix(preintegratedTable[index], preintegratedTable[index + 1], fraction.x);                   \
    index += width;                                                                                            \
    vec4 highRow = mix(preintegratedTable[index], preintegratedTable[index + 1], fraction.x);                  \
    return mix(lowRow, highRow, fraction.y);                                                                   \
  }

// Colour and opacity at `value` from a table of one row.
vec4 lookUpTable(sampler2D table, float value) {
  float size = float(textureSize(table, 0).x);
  return textureLod(table, vec2((clamp(value, 0.0, 1.0) * (size - 1.0) + 0.5) / size, 0.5), 0.0);
}

// Premultiplied colour and opacity of a slab from a square table: column front, row back.
vec4 lookUpPreintegrated(sampler2D table, float front, float back) {
  vec2 size = vec2(textureSize(table, 0));
  return textureLod(table, (clamp(vec2(front, back), 0.0, 1.0) * (size - 1.0) + 0.5) / size, 0.0);
}

// Opacity of a step of `stepVoxels` voxel lengths from the opacity of one: 1 - (1-a)^s. `opacity` <= 0.9999.
float opacityOfStep(float opacity, float stepVoxels) {
  return stepVoxels == 1.0 ? opacity : 1.0 - exp2(stepVoxels * log2(1.0 - opacity));
}

// A pre-integrated slab cut to `share` (0 to 1) of its length: opacity by the power of the share, the colour
// scaled along.
vec4 shortenSlab(vec4 slab, float share) {
  if (slab.a <= 0.0) return slab * share;
  float opacity = opacityOfStep(slab.a, share);
  return vec4(slab.rgb * (opacity / slab.a), opacity);
}

// Adds what lies behind, front to back; both premultiplied.
void composite(inout vec4 front, vec4 behind) {
  front += (1.0 - front.a) * behind;
}

#endif
