// Stands in for itk_reader.cpp in builds without ITK.
#include "volmark/error.h"
#include "volume/itk_reader.h"

#include <fmt/format.h>

namespace volmark {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path) {
  throw InputError(fmt::format("{}: MetaImage, NIfTI, DICOM and VTK files are read through ITK, and this volmark was "
                               "built without it; install libinsighttoolkit5-dev and build again, or convert to NRRD",
                               path.string()));
}

} // namespace

std::shared_ptr<const Volume> loadWithItk(const std::filesystem::path& path, ItkFormat, std::uint64_t) {
  refuse(path);
}

std::shared_ptr<const Volume> loadDicomSeries(const std::filesystem::path& folder, std::uint64_t) {
  refuse(folder);
}

} // namespace volmark
