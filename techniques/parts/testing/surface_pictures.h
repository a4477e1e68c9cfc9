// Pictures of meshes against the reference.
#pragma once

#include "volmark/picture.h"
#include "volmark/scene.h"

namespace volmark::parts {

/// Expects view 0 of the picture to be the reference's, as near as triangles in cells can be: where both hit and no
/// edge of the picture is near, depths differ by less than half a cell; a pixel that only one of them hits has one
/// beside it that the other sees like this one; colours are the same on average.
void expectNearReference(const Picture& picture, const Scene& scene, const FrameInputs& inputs);

} // namespace volmark::parts
