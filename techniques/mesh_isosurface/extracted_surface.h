// What both techniques of this family keep: the volume, and the surface extracted from it when isovalue or time step
// change.
#pragma once

#include "extractor.h"
#include "parts/surface_raster.h"

#include <optional>
#include <vector>

namespace volmark::mesh_isosurface {

class ExtractedSurface {
public:
  /// Generation passes "upload", "upload_table", "pipelines" and "build_ranges".
  ExtractedSurface(const Preparation& preparation, Recorder& recorder);

  /// Passes "build_ranges" and "extract" where needed. True if the surface is a new one.
  bool update(const FrameInputs& inputs, Recorder& recorder);

  parts::SurfaceRaster& raster() { return m_raster; }
  const parts::SurfaceRaster& raster() const { return m_raster; }
  const Extractor& extractor() const { return *m_extractor; }

private:
  void buildRanges(int timeStep, Recorder& recorder);

  parts::SurfaceRaster m_raster;
  std::optional<Extractor> m_extractor;
  std::optional<int> m_builtStep;
  std::optional<double> m_isovalue;
};

/// Of the ledger, now: `prepared` without what of it is the extractor's surface, and that as it is.
std::vector<gpu::MemoryItem> memoryNow(std::vector<gpu::MemoryItem> prepared, const Extractor& extractor);

std::vector<PassDescriptor> extractionPasses();
std::vector<PassDescriptor> extractionGeneration();

std::optional<std::string> whyExtractionUnsupported(const Scene& scene, const ParameterValues& parameters,
                                                    const OutputSize& size, const gpu::Device* device);

} // namespace volmark::mesh_isosurface
