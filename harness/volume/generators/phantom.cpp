#include "volume/generators/phantom.h"

#include "volume/generators/portable_math.h"
#include "volume/generators/tubes.h"

namespace volmark {

namespace {

constexpr int kVertebrae = 9;
constexpr glm::dvec3 kLung(0.31, 0.4, 0.62); ///< semi-axes

glm::dvec3 lungCentre(int side) {
  return {side * 0.42, 0.0, 0.02};
}

double heightOfVertebra(int i) {
  return -0.6 + 0.165 * i;
}

std::vector<Tube> spine() {
  std::vector<Tube> tubes;
  for (int i = 0; i < kVertebrae; ++i) {
    const double z = heightOfVertebra(i);
    tubes.push_back({{-0.05, 0.36, z}, {0.05, 0.36, z}, 0.075});             // body
    tubes.push_back({{-0.2, 0.44, z + 0.02}, {0.2, 0.44, z + 0.02}, 0.024}); // transverse processes
    tubes.push_back({{0, 0.44, z + 0.02}, {0, 0.53, z - 0.05}, 0.024});      // spinous process
  }
  return tubes;
}

/// Half a ring from the spine around a lung; those of the upper seven vertebrae reach the breastbone.
void addRib(int vertebra, int side, std::vector<Tube>& tubes) {
  constexpr int kPieces = 16;
  const double back = heightOfVertebra(vertebra);
  const double reach = vertebra >= 2 ? 1.9 : 1.5; // quarter turns from the spine
  const double width = vertebra >= 2 && vertebra < kVertebrae - 1 ? 0.78 : 0.7;
  glm::dvec3 last(side * 0.16, 0.44, back);
  for (int i = 1; i <= kPieces; ++i) {
    const double turn = 0.3 + (reach - 0.3) * (i - 1) / (kPieces - 1);
    const glm::dvec3 point(side * width * sineOfQuarterTurns(turn), 0.5 * cosineOfQuarterTurns(turn),
                           back - 0.14 * turn);
    tubes.push_back({last, point, 0.026});
    last = point;
  }
}

std::vector<Tube> ribs() {
  std::vector<Tube> tubes = {{{0, -0.53, -0.4}, {0, -0.5, 0.46}, 0.05}}; // breastbone
  for (int vertebra = 0; vertebra < kVertebrae; ++vertebra)
    for (const int side : {-1, 1})
      addRib(vertebra, side, tubes);
  return tubes;
}

std::vector<Tube> windpipe() {
  const glm::dvec3 fork(0, 0.12, 0.3);
  return {{{0, 0.12, 0.82}, fork, 0.06}, {fork, {0.22, 0.1, 0.12}, 0.042}, {fork, {-0.22, 0.1, 0.12}, 0.042}};
}

/// Up from the heart, over in an arch, and down before the spine.
std::vector<Tube> aorta() {
  constexpr int kPieces = 12;
  std::vector<Tube> tubes;
  glm::dvec3 last(0.02, -0.12, 0.0);
  for (int i = 0; i <= kPieces; ++i) {
    const double turn = 2.0 * i / kPieces;
    const glm::dvec3 point(0.02 + 0.03 * turn, 0.05 - 0.17 * cosineOfQuarterTurns(turn),
                           0.3 + 0.14 * sineOfQuarterTurns(turn));
    tubes.push_back({last, point, 0.06});
    last = point;
  }
  tubes.push_back({last, {0.06, 0.24, -0.85}, 0.055});
  return tubes;
}

std::vector<Tube> lungVessels(int side, const PhantomSettings& settings) {
  const glm::dvec3 along(side * 0.8, 0.0, -0.6);
  return tubesOf(growTree({.root = {side * 0.1, 0.02, 0.08},
                           .direction = along,
                           .radius = 0.045,
                           .length = 0.26,
                           .generations = settings.vesselGenerations,
                           .centre = lungCentre(side),
                           .semiAxes = kLung - 0.05,
                           .seed = settings.seed * 2 + (side > 0 ? 1 : 0)}));
}

} // namespace

double plateauOf(Tissue tissue) {
  switch (tissue) {
  case Tissue::air: return 0;
  case Tissue::soft: return 0.35;
  case Tissue::bone: return 0.9;
  case Tissue::vessel: return 0.6;
  }
  return 0;
}

std::vector<Layer> phantomLayers(const PhantomSettings& settings) {
  std::vector<Layer> layers;
  const auto paint = [&](std::shared_ptr<const Field> share, Tissue tissue) {
    layers.push_back({std::move(share), plateauOf(tissue), static_cast<int>(tissue)});
  };
  const auto ellipsoid = [&](const glm::dvec3& centre, const glm::dvec3& semiAxes) {
    return std::make_shared<Ellipsoid>(centre, semiAxes, settings.edgeWidth);
  };
  const auto tubes = [&](std::vector<Tube> bodies) {
    return std::make_shared<Tubes>(std::move(bodies), settings.edgeWidth);
  };
  paint(std::make_shared<Barrel>(glm::dvec3(0.9, 0.66, 0.95), settings.edgeWidth), Tissue::soft);
  for (const int side : {-1, 1})
    paint(ellipsoid(lungCentre(side), kLung), Tissue::air);
  paint(tubes(windpipe()), Tissue::air);
  paint(ellipsoid({0.1, -0.14, -0.16}, {0.26, 0.22, 0.26}), Tissue::soft); // heart
  paint(tubes(spine()), Tissue::bone);
  paint(tubes(ribs()), Tissue::bone);
  paint(tubes(aorta()), Tissue::vessel);
  for (const int side : {-1, 1})
    paint(tubes(lungVessels(side, settings)), Tissue::vessel);
  return layers;
}

} // namespace volmark
