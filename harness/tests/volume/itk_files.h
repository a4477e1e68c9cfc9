// Files written by ITK itself, for the tests of what reads them.
#pragma once

#include "volmark/volume.h"

#include <filesystem>
#include <itkImageIOBase.h>
#include <itkMetaDataObject.h>
#include <map>
#include <string>
#include <vector>

namespace volmark::test {

struct ItkImage {
  glm::ivec3 dims{1};
  int timeSteps = 1;
  glm::dvec3 spacing{1.0};
  glm::dvec3 origin{0.0};
  glm::dmat3 directions{1.0}; ///< columns, LPS
  itk::CommonEnums::IOComponent component = itk::CommonEnums::IOComponent::SHORT;
  bool compressed = false;
  bool bigEndian = false;
  std::map<std::string, std::string> metadata; ///< DICOM tags as "0020|000e"
};

/// `bytes`: the voxels in native order, x fastest.
inline void writeWithItk(itk::ImageIOBase& io, const std::filesystem::path& path, const ItkImage& image,
                         const void* bytes) {
  const unsigned dimensions = image.timeSteps > 1 ? 4 : 3;
  io.SetNumberOfDimensions(dimensions);
  itk::ImageIORegion region(dimensions);
  for (unsigned axis = 0; axis < dimensions; ++axis) {
    const int i = static_cast<int>(axis);
    const auto size = static_cast<std::size_t>(axis < 3 ? image.dims[i] : image.timeSteps);
    io.SetDimensions(axis, size);
    region.SetSize(axis, size);
    io.SetSpacing(axis, axis < 3 ? image.spacing[i] : 1);
    io.SetOrigin(axis, axis < 3 ? image.origin[i] : 0);
    std::vector<double> direction(dimensions, 0.0);
    for (int j = 0; j < 3 && axis < 3; ++j)
      direction[static_cast<std::size_t>(j)] = image.directions[i][j];
    if (axis == 3) direction[3] = 1;
    io.SetDirection(axis, direction);
  }
  for (const auto& [key, value] : image.metadata)
    itk::EncapsulateMetaData<std::string>(io.GetMetaDataDictionary(), key, value);
  io.SetComponentType(image.component);
  io.SetPixelType(itk::CommonEnums::IOPixel::SCALAR);
  io.SetNumberOfComponents(1);
  io.SetUseCompression(image.compressed);
  if (image.bigEndian) io.SetByteOrderToBigEndian();
  io.SetIORegion(region);
  io.SetFileName(path.string());
  io.WriteImageInformation();
  io.Write(bytes);
}

} // namespace volmark::test
