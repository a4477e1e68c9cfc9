#include "extracted_surface.h"

#include <algorithm>

namespace volmark::mesh_isosurface {

ExtractedSurface::ExtractedSurface(const Preparation& preparation, Recorder& recorder)
    : m_raster(preparation, 0, recorder) {
  {
    const Pass pass = recorder.hostPass("pipelines");
    m_extractor.emplace(*preparation.device, preparation.scene, m_raster);
  }
  buildRanges(0, recorder);
}

void ExtractedSurface::buildRanges(int timeStep, Recorder& recorder) {
  const Pass pass = recorder.pass("build_ranges");
  m_extractor->buildRanges(recorder.gpu(), m_raster.voxels(timeStep));
  m_builtStep = timeStep;
  m_isovalue.reset();
}

bool ExtractedSurface::update(const FrameInputs& inputs, Recorder& recorder) {
  if (m_builtStep != inputs.timeStep) buildRanges(inputs.timeStep, recorder);
  if (m_isovalue == inputs.isovalue) return false;
  const Pass pass = recorder.pass("extract");
  m_raster.beginUpdate(inputs, recorder);
  m_extractor->extract(recorder.gpu(), m_raster);
  m_isovalue = inputs.isovalue;
  return true;
}

std::vector<gpu::MemoryItem> memoryNow(std::vector<gpu::MemoryItem> prepared, const Extractor& extractor) {
  for (const gpu::MemoryItem& item : extractor.surfaceMemory()) {
    std::erase_if(prepared, [&](const gpu::MemoryItem& old) { return old.name == item.name; });
    prepared.push_back(item);
  }
  return prepared;
}

std::vector<PassDescriptor> extractionPasses() {
  return {{"build_ranges", "Smallest and largest voxel of each block, when the time step has changed."},
          {"extract", "The surface, when isovalue or time step have changed. Waits for its size."}};
}

std::vector<PassDescriptor> extractionGeneration() {
  return {{"upload", "The volume's voxels to the GPU."},
          {"upload_table", "The table of marching cubes."},
          {"build_ranges", "Smallest and largest voxel of each block."},
          {"pipelines", "Pipelines and buffers."}};
}

std::optional<std::string> whyExtractionUnsupported(const Scene& scene, const ParameterValues&, const OutputSize&,
                                                    const gpu::Device* device) {
  if (auto why = parts::whySurfaceUnsupported(scene, device)) return why;
  return Extractor::whyUnsupported(*device, *scene.volume);
}

} // namespace volmark::mesh_isosurface
