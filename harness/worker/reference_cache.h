// Pictures of the CPU reference, kept by content.
#pragma once

#include "volmark/picture.h"
#include "volmark/scene.h"
#include "volmark/technique.h"

#include <filesystem>
#include <functional>
#include <vector>

namespace volmark {

class ReferenceCache {
public:
  /// `folder`: results/<experiment>/references. Pictures made before are looked for there and in
  /// $VOLMARK_CACHE/references.
  explicit ReferenceCache(std::filesystem::path folder);

  struct Entry {
    std::vector<Picture> pictures; ///< one per view, as read back from the file
    std::filesystem::path file;
  };
  /// Draws the views of `inputs` unless a file of equal content is there. `draws` must be isosurface or
  /// volume.
  Entry get(const Scene& scene, const FrameInputs& inputs, int width, int height, Draws draws) const;

private:
  std::filesystem::path m_folder;
};

/// $VOLMARK_CACHE, else $XDG_CACHE_HOME/volmark, else ~/.cache/volmark.
std::filesystem::path cacheFolder();

} // namespace volmark
