// OpenEXR: R G B A half, Z float; stereo as multi-view; camera matrices and the run's hash as attributes.
#pragma once

#include "volmark/picture.h"
#include "volmark/view.h"

#include <filesystem>
#include <string>
#include <vector>

namespace volmark {

struct ExrAttributes {
  std::string run;                 ///< hash, or empty
  std::string comments;
  std::vector<View> views;         ///< of the pictures, for worldToCamera and worldToNDC
};

/// One picture, or two as OpenEXR multi-view ("left" is the default view, the other channels are "right.R"
/// ...). Written to a temporary name and renamed. Throws InputError when it can't be written.
void writeExr(const std::filesystem::path& path, const std::vector<Picture>& pictures,
              const ExrAttributes& attributes);

/// Reads what writeExr wrote. Throws InputError.
std::vector<Picture> readExr(const std::filesystem::path& path);

} // namespace volmark
