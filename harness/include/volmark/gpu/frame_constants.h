// Fills the constants that every shader gets (shaders/volmark/frame.glsl).
#pragma once

#include "volmark/gpu/volume_texture.h"
#include "volmark/shared/frame_constants.h"
#include "volmark/technique.h"

namespace volmark::gpu {

/// `seed`: of the run, as given to reset(). At most kMaxViews views (asserted). Of work
/// before a frame has a target, `size` is 0.
FrameConstants frameConstants(const Frame& frame, const Scene& scene, const VolumeTexture& texture, std::uint64_t seed);

} // namespace volmark::gpu
