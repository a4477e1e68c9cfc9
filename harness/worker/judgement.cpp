// Captured pictures against the reference.
#include "image/exr.h"
#include "image/metrics.h"
#include "worker/replay.h"

#include <fmt/format.h>

namespace volmark {

namespace {

namespace fs = std::filesystem;

/// Visible history: what it cost to get here, sum of frame_ms since reset.
double cumulativeMs(const std::vector<FrameRow>& rows, std::size_t traceIndex) {
  double sum = 0;
  for (std::size_t i = 0; i <= traceIndex && i < rows.size(); ++i)
    sum += rows[i].frameMs;
  return sum;
}

PictureErrors errorsOf(const Session& session, const Picture& picture, const Picture& reference) {
  PictureErrors errors = compareColor(picture, reference, session.settings().pictures.background);
  if (session.info().draws == Draws::isosurface)
    compareDistance(picture, reference, session.scene().volume->grid().smallestSpacingMm(), errors);
  return errors;
}

} // namespace

std::vector<PictureRow> judgePictures(const Judgement& judgement,
                                      const std::map<std::size_t, std::vector<Picture>>& captured,
                                      const std::vector<FrameRow>& rows) {
  const Session& session = judgement.session;
  const PointSettings& settings = session.settings();
  const bool judged = settings.pictures.reference == "cpu" && session.info().draws != Draws::both;
  const ReferenceCache cache(judgement.experimentFolder / "references");

  std::vector<PictureRow> result;
  for (const auto& [index, pictures] : captured) {
    const double phase = judgement.trace.phases[index];
    const FrameInputs inputs = session.timeline().at(phase);
    const int frame = static_cast<int>(index - judgement.trace.lastOrbitBegin);
    const std::string file = fmt::format("frame_{:04}.exr", frame);
    ExrAttributes attributes;
    attributes.run = judgement.run;
    attributes.comments = fmt::format("volmark {} {}", session.info().name, settings.sceneName);
    attributes.views = inputs.views;
    writeExr(judgement.runFolder / file, pictures, attributes);

    ReferenceCache::Entry reference;
    if (judged) reference = cache.get(session.scene(), inputs, settings.width, settings.height, session.info().draws);
    for (std::size_t view = 0; view < pictures.size(); ++view) {
      PictureRow row;
      row.frame = frame;
      row.phase = phase;
      row.view = static_cast<int>(view);
      row.file = file;
      row.reference = judged ? "cpu" : "none";
      if (judged) {
        row.referenceFile = fs::path("references") / reference.file.filename();
        row.errors = errorsOf(session, pictures[view], reference.pictures[view]);
      }
      row.cumulativeMs = cumulativeMs(rows, index);
      result.push_back(std::move(row));
    }
  }
  return result;
}

} // namespace volmark
