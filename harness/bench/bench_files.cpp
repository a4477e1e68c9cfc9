#include "bench/bench_files.h"

#include "tests/volume/file_bytes.h"
#include "volume/generators/generator.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <unistd.h>

namespace volmark::bench {

namespace fs = std::filesystem;

namespace {

class Folder {
public:
  Folder() : path(fs::temp_directory_path() / fmt::format("volmark_bench_{}", ::getpid())) {
    fs::create_directories(path);
    ::setenv("VOLMARK_VOLUME_CACHE_GIB", "0", 1); // readers are measured, not the cache
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  fs::path path;
};

std::string headerOf(const std::string& form, int side) {
  if (form == ".raw") return "";
  if (form.starts_with(".nii")) return test::niftiHeader(glm::ivec3(side), 2);
  if (form == ".mha")
    return fmt::format(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nCompressedData = False\nElementSpacing = 1 1 1\n"
        "DimSize = {0} {0} {0}\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
        side);
  return fmt::format("NRRD0004\ntype: uint8\ndimension: 3\nsizes: {0} {0} {0}\nencoding: {1}\n\n", side,
                     form == ".nrrd gzip" ? "gzip" : "raw");
}

void writeGzip(const fs::path& path, const std::string& plain, const std::string& compressed) {
  std::ofstream(path, std::ios::binary) << plain;
  const gzFile file = gzopen(path.c_str(), "ab6");
  gzwrite(file, compressed.data(), static_cast<unsigned>(compressed.size()));
  gzclose(file);
}

} // namespace

const fs::path& folder() {
  static const Folder mine;
  return mine.path;
}

std::shared_ptr<const Volume> volume(int side) {
  static std::map<int, std::shared_ptr<const Volume>> made;
  auto& entry = made[side];
  if (!entry) {
    GeneratorSettings settings;
    settings.name = "marschner_lobb";
    settings.dims = glm::ivec3(side);
    settings.type = ScalarType::uint8;
    entry = generateVolume(settings);
  }
  return entry;
}

fs::path volumeFile(const std::string& form, int side) {
  const std::string ending = form == ".nrrd gzip" ? "_gzip.nrrd" : form;
  const fs::path path = folder() / fmt::format("volume_{}{}", side, ending);
  if (fs::exists(path)) return path;
  const auto bytes = volume(side)->voxels();
  const std::string voxels(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string header = headerOf(form, side);
  if (form == ".nii.gz") {
    writeGzip(path, "", header + voxels);
  } else if (form == ".nrrd gzip") {
    writeGzip(path, header, voxels);
  } else {
    std::ofstream(path, std::ios::binary) << header << voxels;
  }
  return path;
}

Picture picture(int width, int height, double seed) {
  Picture result(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = result.index(x, y);
      const auto wave = static_cast<float>(0.5 + 0.5 * std::sin(0.05 * x + seed) * std::cos(0.07 * y));
      result.color[i] = {wave, 1 - wave, 0.5F * wave, 1};
      result.distance[i] = 100 + 10 * wave;
    }
  return result;
}

} // namespace volmark::bench
