// Counter-based random numbers: the same key always gives the same value, in any order, on any thread.
// shaders/volmark/random.glsl holds the same functions, bit for bit.
#pragma once

#include <cstdint>

namespace volmark {

/// PCG-RXS-M-XS 32 as a hash (Jarzynski, Olano: Hash Functions for GPU Rendering, JCGT 2020).
constexpr std::uint32_t hash(std::uint32_t value) {
  const std::uint32_t state = value * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

/// 32 random bits keyed by run seed, pixel, frame and a running index.
constexpr std::uint32_t randomBits(std::uint32_t seed, std::uint32_t pixel, std::uint32_t frame, std::uint32_t index) {
  return hash(index + hash(frame + hash(pixel + hash(seed))));
}

/// Uniform in [0,1), 24 bits.
constexpr float toUnitFloat(std::uint32_t bits) {
  return static_cast<float>(bits >> 8u) * 0x1p-24f;
}

} // namespace volmark
