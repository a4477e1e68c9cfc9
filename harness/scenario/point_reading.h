// From overrides to a typed, checked point.
#pragma once

#include "scenario/overrides.h"
#include "scenario/point.h"
#include "scenario/scenario.h"
#include "scenario/scene_library.h"
#include "technique/catalogue.h"

namespace volmark {

/// Defaults where nothing is given. `place` is where errors about missing keys point to. Throws InputError.
PointSettings readSettings(const Overrides& overrides, const JsonValue& place, const TechniqueCatalogue& techniques,
                           SceneLibrary& scenes);

/// Makes resolution, generated volume and frames small enough. Millimetres stay: a volume of fewer voxels is as
/// large as before.
void applyLimits(const Limits& limits, PointSettings& settings);

/// Settings, canonical configuration and group; labels: the technique alone.
Point pointOf(PointSettings settings);

} // namespace volmark
