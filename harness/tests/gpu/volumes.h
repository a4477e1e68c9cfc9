// Volumes for the tests, and the field that a shader should see, in double precision.
#pragma once

#include "volmark/scene.h"

#include <cstdint>
#include <memory>

namespace volmark::gpu::test {

/// Random voxels over the type's whole range (float: [-3, 5]), its smallest and largest values among them.
std::shared_ptr<const Volume> randomVolume(ScalarType type, glm::ivec3 dims, glm::dvec3 spacing, int timeSteps = 1,
                                           std::uint32_t seed = 1);

/// A scene over the volume's data range.
Scene sceneOf(std::shared_ptr<const Volume> volume);

/// harness/README.md, Conventions: normalised, clamped after trilinear interpolation, positions clamped to the box.
double fieldAt(const Scene& scene, const glm::dvec3& world, int timeStep = 0);
glm::dvec3 gradientAt(const Scene& scene, const glm::dvec3& world);

} // namespace volmark::gpu::test
