// A chest with labels.
#pragma once

#include "volume/generators/painting.h"

namespace volmark {

/// Values of the plateaus as in CT with contrast agent in the vessels, and labels, of the phantom's materials.
enum class Tissue : std::uint8_t { air = 0, soft = 1, bone = 2, vessel = 3 };
double plateauOf(Tissue tissue); ///< air 0, soft tissue 0.35, vessels 0.6, bone 0.9

struct PhantomSettings {
  double edgeWidth = 0.03;   ///< see Ellipsoid
  int vesselGenerations = 7; ///< bifurcations from the root of a lung's tree to its tips
  std::uint32_t seed = 1;    ///< of the trees
};

/// A body with a windpipe, two lungs, a heart, spine, ribs and breastbone, an aorta, and a vessel tree in each lung. x
/// points to the left side, y to the back, z to the head; the faces of the cube are air. Paint it for values, or
/// for labels of the very same bodies.
std::vector<Layer> phantomLayers(const PhantomSettings& settings);

} // namespace volmark
