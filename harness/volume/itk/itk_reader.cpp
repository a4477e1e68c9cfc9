// The only file that sees ITK. Its image readers are used directly, without its pipeline: they give sizes,
// directions and bytes, which is all that is needed here.
#include "volume/itk_reader.h"

#include "volmark/error.h"
#include "volume/file_claims.h"
#include "volume/header_text.h"
#include "volume/itk/decode_apart.h"
#include "volume/orientation.h"
#include "volume/volume_cache.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <itkGDCMImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkVTKImageIO.h>
#include <limits>
#include <map>
#include <set>

namespace volmark {

namespace {

namespace fs = std::filesystem;
using Component = itk::CommonEnums::IOComponent;

constexpr double kMaximumSpacing = 1e9;
constexpr double kEvenSpacing = 0.01; ///< largest deviation of a slice distance from their mean, of the mean
constexpr double kGantryMm = 0.01;    ///< largest shift within the slices' plane that is no tilt

/// Runs `action` and turns ITK's and the standard library's exceptions into one line.
template <class Action> auto reading(const fs::path& path, Action action) {
  try {
    return action();
  } catch (const InputError&) {
    throw;
  } catch (const itk::ExceptionObject& error) {
    std::string text = error.GetDescription();
    std::replace(text.begin(), text.end(), '\n', ' ');
    // "ITK ERROR: NiftiImageIO(0x55a1aa2ada50): " says nothing to a user.
    if (const std::size_t address = text.find("): "); text.starts_with("ITK ERROR") && address != std::string::npos)
      text.erase(0, address + 3);
    throw InputError(fmt::format("{}: {}", path.string(), text.substr(0, 300)));
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

/// Voxels as a file stores them, or as float32 if no ScalarType holds them.
struct Decoded {
  ScalarType type = ScalarType::uint8;
  std::vector<std::byte> voxels;
  bool narrowed = false; ///< from a wider type
};

template <class From> std::vector<std::byte> toFloat(std::span<const std::byte> bytes) {
  const std::size_t count = bytes.size() / sizeof(From);
  std::vector<std::byte> result = allocateVoxels("conversion to float32", count * sizeof(float));
  for (std::size_t i = 0; i < count; ++i) {
    From value;
    std::memcpy(&value, bytes.data() + i * sizeof(From), sizeof(From));
    const auto narrow = static_cast<float>(value);
    std::memcpy(result.data() + i * sizeof(float), &narrow, sizeof(float));
  }
  return result;
}

Decoded decoded(Component component, std::vector<std::byte> bytes) {
  switch (component) {
  case Component::CHAR: return {ScalarType::int8, std::move(bytes)};
  case Component::UCHAR: return {ScalarType::uint8, std::move(bytes)};
  case Component::SHORT: return {ScalarType::int16, std::move(bytes)};
  case Component::USHORT: return {ScalarType::uint16, std::move(bytes)};
  case Component::FLOAT: return {ScalarType::float32, std::move(bytes)};
  case Component::INT: return {ScalarType::float32, toFloat<int>(bytes), true};
  case Component::UINT: return {ScalarType::float32, toFloat<unsigned>(bytes), true};
  case Component::LONG: return {ScalarType::float32, toFloat<long>(bytes), true};
  case Component::ULONG: return {ScalarType::float32, toFloat<unsigned long>(bytes), true};
  case Component::DOUBLE: return {ScalarType::float32, toFloat<double>(bytes), true};
  default: throw InputError(fmt::format("voxels of type {}", itk::ImageIOBase::GetComponentTypeAsString(component)));
  }
}

std::vector<std::byte> toFloat(const Decoded& slice) {
  switch (slice.type) {
  case ScalarType::int8: return toFloat<std::int8_t>(slice.voxels);
  case ScalarType::uint8: return toFloat<std::uint8_t>(slice.voxels);
  case ScalarType::int16: return toFloat<std::int16_t>(slice.voxels);
  case ScalarType::uint16: return toFloat<std::uint16_t>(slice.voxels);
  case ScalarType::float32: break;
  }
  return slice.voxels;
}

double checkedSpacing(const fs::path& path, double spacing) {
  if (spacing >= 1 / kMaximumSpacing && spacing <= kMaximumSpacing) return spacing;
  throw InputError(fmt::format("{}: found a voxel spacing of {}, allowed: {:g} to {:g}", path.string(), spacing,
                               1 / kMaximumSpacing, kMaximumSpacing));
}

glm::dvec3 directionOf(const itk::ImageIOBase& io, unsigned axis) {
  const std::vector<double> direction = io.GetDirection(axis);
  glm::dvec3 result(0);
  for (int i = 0; i < 3 && i < static_cast<int>(direction.size()); ++i)
    result[i] = direction[static_cast<std::size_t>(i)];
  return result;
}

/// Reads everything; what the library says must be what the file claimed to our own check.
Decoded readAll(itk::ImageIOBase& io, const fs::path& path, const FileClaim& claim) {
  const unsigned dimensions = io.GetNumberOfDimensions();
  std::array<std::uint64_t, 4> sizes = {1, 1, 1, 1};
  bool equal = dimensions <= 4 && io.GetNumberOfComponents() == 1;
  for (unsigned axis = 0; axis < std::min(dimensions, 4u); ++axis)
    sizes[axis] = io.GetDimensions(axis);
  for (int axis = 0; axis < 3; ++axis)
    equal = equal && sizes[static_cast<std::size_t>(axis)] == static_cast<std::uint64_t>(claim.dims[axis]);
  equal = equal && sizes[3] == static_cast<std::uint64_t>(claim.timeSteps);
  if (!equal)
    throw InputError(fmt::format("{}: ITK finds {} x {} x {}, {} time steps, {} values a voxel, but the header says "
                                 "{} x {} x {}, {} time steps, 1 value",
                                 path.string(), sizes[0], sizes[1], sizes[2], sizes[3], io.GetNumberOfComponents(),
                                 claim.dims.x, claim.dims.y, claim.dims.z, claim.timeSteps));
  itk::ImageIORegion region(dimensions);
  for (unsigned axis = 0; axis < dimensions; ++axis)
    region.SetSize(axis, io.GetDimensions(axis));
  io.SetIORegion(region);
  std::vector<std::byte> bytes =
      allocateVoxels(path.string(), claim.bytes() / claim.scalarBytes * io.GetComponentSize());
  io.Read(bytes.data());
  return decoded(io.GetComponentType(), std::move(bytes));
}

FileClaim checkedClaim(const fs::path& path, ItkFormat format, std::uint64_t maximumBytes) {
  switch (format) {
  case ItkFormat::metaImage: return checkMetaImage(path, maximumBytes);
  case ItkFormat::nifti: return checkNifti(path, maximumBytes);
  case ItkFormat::vtk: break;
  }
  return checkVtk(path, maximumBytes);
}

itk::ImageIOBase::Pointer readerOf(ItkFormat format) {
  switch (format) {
  case ItkFormat::metaImage: return itk::MetaImageIO::New().GetPointer();
  case ItkFormat::nifti: return itk::NiftiImageIO::New().GetPointer();
  case ItkFormat::vtk: break;
  }
  return itk::VTKImageIO::New().GetPointer();
}

// --- DICOM series ----------------------------------------------------------------------------------------------

struct Slice {
  fs::path path;
  itk::GDCMImageIO::Pointer io;
  FileClaim claim;
  glm::dvec3 origin{0};
  double place = 0; ///< along the normal, mm
};

std::vector<Slice> findSlices(const fs::path& folder, std::uint64_t maximumBytes) {
  std::vector<Slice> slices;
  std::map<std::string, int> series;
  std::uint64_t bytes = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code unreachable; // a link to itself
    if (!entry.is_regular_file(unreachable) || !isDicom(entry.path())) continue;
    const DicomClaim claim = checkDicom(entry.path(), maximumBytes);
    ++series[claim.series];
    bytes += claim.slice.bytes();
    if (bytes > maximumBytes)
      throw InputError(
          fmt::format("{}: over {} bytes of slices, allowed: {} bytes", folder.string(), bytes, maximumBytes));
    slices.push_back({entry.path(), itk::GDCMImageIO::New(), claim.slice});
  }
  if (error) throw InputError(fmt::format("{}: {}", folder.string(), error.message()));
  if (slices.empty()) throw InputError(fmt::format("{}: there is no DICOM file in this folder", folder.string()));
  if (series.size() > 1) {
    std::string list;
    for (const auto& [name, count] : series)
      list += fmt::format("{}{} ({} files)", list.empty() ? "" : ", ", shown(name), count);
    throw InputError(fmt::format("{}: found {} series: {}, allowed: one; put each into a folder of its own",
                                 folder.string(), series.size(), list.substr(0, 300)));
  }
  std::sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) { return a.path < b.path; });
  return slices;
}

/// Reads each slice's place and sorts by it. Returns the unit normal.
glm::dvec3 sortAlongNormal(std::vector<Slice>& slices) {
  for (Slice& slice : slices) {
    slice.io->SetFileName(slice.path.string());
    reading(slice.path, [&] { slice.io->ReadImageInformation(); });
    for (unsigned i = 0; i < 3; ++i)
      slice.origin[static_cast<int>(i)] = slice.io->GetOrigin(i);
  }
  const Slice& first = slices.front();
  const glm::dvec3 normal = glm::normalize(glm::cross(directionOf(*first.io, 0), directionOf(*first.io, 1)));
  for (Slice& slice : slices) {
    slice.place = glm::dot(normal, slice.origin);
    const bool alike = slice.claim.dims == first.claim.dims &&
                       std::abs(slice.io->GetSpacing(0) - first.io->GetSpacing(0)) < 1e-6 &&
                       std::abs(slice.io->GetSpacing(1) - first.io->GetSpacing(1)) < 1e-6 &&
                       glm::length(directionOf(*slice.io, 0) - directionOf(*first.io, 0)) < 1e-3 &&
                       glm::length(directionOf(*slice.io, 1) - directionOf(*first.io, 1)) < 1e-3;
    if (!alike)
      throw InputError(fmt::format("{}: its size, pixel spacing or direction is not that of {}", slice.path.string(),
                                   first.path.filename().string()));
  }
  std::sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) { return a.place < b.place; });
  return normal;
}

/// Mean distance of the slices; notes what is uneven or tilted.
double sliceSpacing(const std::vector<Slice>& slices, const glm::dvec3& normal, std::vector<std::string>& notes) {
  if (slices.size() == 1) return slices.front().io->GetSpacing(2);
  const double mean = (slices.back().place - slices.front().place) / static_cast<double>(slices.size() - 1);
  double least = std::numeric_limits<double>::max();
  double most = 0;
  double shift = 0;
  for (std::size_t i = 1; i < slices.size(); ++i) {
    const double distance = slices[i].place - slices[i - 1].place;
    if (!(distance > 1e-6))
      throw InputError(fmt::format("{}: lies where {} lies, allowed: one slice in a place", slices[i].path.string(),
                                   slices[i - 1].path.filename().string()));
    least = std::min(least, distance);
    most = std::max(most, distance);
    const glm::dvec3 step = slices[i].origin - slices[i - 1].origin;
    shift = std::max(shift, glm::length(step - normal * distance));
  }
  if (most - least > kEvenSpacing * mean)
    notes.push_back(fmt::format("slices are {:.4g} to {:.4g} mm apart (one may be missing); the mean, {:.4g} mm, is "
                                "taken for all",
                                least, most, mean));
  if (shift > kGantryMm)
    notes.push_back(
        fmt::format("tilted gantry: each slice is shifted by {:.3g} mm within its plane; shown unsheared", shift));
  return mean;
}

Decoded readSlices(const std::vector<Slice>& slices) {
  std::vector<Decoded> parts;
  bool alike = true;
  for (const Slice& slice : slices) {
    parts.push_back(reading(slice.path, [&] { return readAll(*slice.io, slice.path, slice.claim); }));
    alike = alike && parts.back().type == parts.front().type;
  }
  // Slopes of their own give slices types of their own.
  Decoded all{alike ? parts.front().type : ScalarType::float32, {}, parts.front().narrowed};
  for (Decoded& part : parts) {
    const std::vector<std::byte> voxels = alike ? std::move(part.voxels) : toFloat(part);
    all.voxels.insert(all.voxels.end(), voxels.begin(), voxels.end());
  }
  return all;
}

DecodedVolume decodeFile(const fs::path& path, ItkFormat format, const FileClaim& claim) {
  return reading(path, [&] {
    const itk::ImageIOBase::Pointer io = readerOf(format);
    io->SetFileName(path.string());
    io->ReadImageInformation();
    Decoded all = readAll(*io, path, claim);
    std::vector<std::string> notes;
    if (all.narrowed) notes.push_back("voxels were wider than float32 and were rounded to it");
    Grid grid{claim.dims, {1, 1, 1}};
    glm::dmat3 directions(1.0);
    for (unsigned axis = 0; axis < std::min(3u, io->GetNumberOfDimensions()); ++axis) {
      grid.spacingMm[static_cast<int>(axis)] = checkedSpacing(path, io->GetSpacing(axis));
      directions[static_cast<int>(axis)] = directionOf(*io, axis);
    }
    all.voxels = turnToPatientAxes(std::move(all.voxels), all.type, claim.timeSteps, directions, grid, notes);
    return DecodedVolume{path.filename().string(), grid, all.type, claim.timeSteps, std::move(all.voxels),
                         std::move(notes)};
  });
}

DecodedVolume decodeSeries(const fs::path& folder, std::vector<Slice> slices) {
  const glm::dvec3 normal = sortAlongNormal(slices);
  std::vector<std::string> notes;
  const double spacing = sliceSpacing(slices, normal, notes);
  const itk::GDCMImageIO& io = *slices.front().io;
  Grid grid;
  grid.dims = {slices.front().claim.dims.x, slices.front().claim.dims.y, static_cast<int>(slices.size())};
  grid.spacingMm = {checkedSpacing(folder, io.GetSpacing(0)), checkedSpacing(folder, io.GetSpacing(1)),
                    checkedSpacing(folder, spacing)};
  const glm::dmat3 directions(directionOf(io, 0), directionOf(io, 1), normal);
  Decoded all = readSlices(slices);
  if (all.narrowed) notes.push_back("voxels were wider than float32 and were rounded to it");
  all.voxels = turnToPatientAxes(std::move(all.voxels), all.type, 1, directions, grid, notes);
  return {folder.filename().string(), grid, all.type, 1, std::move(all.voxels), std::move(notes)};
}

} // namespace

std::shared_ptr<const Volume> loadWithItk(const fs::path& path, ItkFormat format, std::uint64_t maximumBytes) {
  std::vector<fs::path> sources = {path};
  if (format == ItkFormat::metaImage) sources.push_back(metaImageDataFile(path));
  return cachedVolume(sources, "itk", maximumBytes, [&] {
    const FileClaim claim = checkedClaim(path, format, maximumBytes);
    return decodeApart(path, claim.bytes(), [&] { return decodeFile(path, format, claim); });
  });
}

std::shared_ptr<const Volume> loadDicomSeries(const fs::path& folder, std::uint64_t maximumBytes) {
  const std::vector<Slice> slices = findSlices(folder, maximumBytes);
  std::vector<fs::path> sources;
  std::uint64_t claimedBytes = 0;
  for (const Slice& slice : slices) {
    sources.push_back(slice.path);
    claimedBytes += slice.claim.bytes();
  }
  return cachedVolume(sources, "dicom series", maximumBytes,
                      [&] { return decodeApart(folder, claimedBytes, [&] { return decodeSeries(folder, slices); }); });
}

} // namespace volmark
