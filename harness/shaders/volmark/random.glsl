// Counter-based random numbers: the same functions as include/volmark/random.h, bit for bit.
#ifndef VOLMARK_RANDOM_GLSL
#define VOLMARK_RANDOM_GLSL

// PCG-RXS-M-XS 32 as a hash (Jarzynski, Olano: Hash Functions for GPU Rendering, JCGT 2020).
uint hash(uint value) {
  uint state = value * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// 32 random bits keyed by run seed, pixel, frame and a running index.
uint randomBits(uint seed, uint pixel, uint frameIndex, uint index) {
  return hash(index + hash(frameIndex + hash(pixel + hash(seed))));
}

// Uniform in [0,1), 24 bits.
float toUnitFloat(uint bits) {
  return float(bits >> 8u) * 5.9604644775390625e-8;
}

#endif
