// OpenEXR: R G B A half; Z, N.X N.Y N.Z and steps float; stereo as multi-view; camera matrices and the run's hash as
// attributes.
#pragma once

#include "volmark/picture.h"
#include "volmark/view.h"

#include <filesystem>
#include <string>
#include <vector>

namespace volmark {

struct ExrAttributes {
  std::string run; ///< hash, or empty
  std::string comments;
  std::vector<View> views; ///< of the pictures, for worldToCamera and worldToNDC
};

/// One picture, or two of equal size as OpenEXR multi-view ("left" is the default view, the other channels are
/// "right.R" ...; names with a dot carry the view before the last part: "N.left.X", "N.right.X"). Colours are rounded
/// to half float. Of Z, N and steps those are there that the pictures have: all of them or none.
///
/// Attributes: `volmark.format` (int) 1; `volmark.run` and `comments`, unless empty; with views, the matrices
/// `worldToCamera` and `worldToNDC` of the first and `right.worldToCamera` and `right.worldToNDC` of the second.
/// As OpenEXR defines them, matrices multiply row vectors, [x y z 1] * M; camera space is left-handed with z along
/// the view; NDC goes from (0, 0), top left, to (1, 1), with w the distance along the view and z/w its inverse.
///
/// Written to a temporary name in the same folder and renamed. Throws InputError when it can't be written.
void writeExr(const std::filesystem::path& path, const std::vector<Picture>& pictures, const ExrAttributes& attributes);

/// Reads the pictures that writeExr wrote. Throws InputError.
std::vector<Picture> readExr(const std::filesystem::path& path);

} // namespace volmark
