#include "fuzz/targets.h"

#include "scenario/scene_file.h"
#include "scenario/strict_json.h"
#include "volmark/error.h"
#include "volume/file_bytes.h"
#include "volume/file_claims.h"
#include "volume/nrrd.h"
#include "volume/raw.h"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace volmark::fuzz {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLimit = 1u << 20;

/// Of this process, in memory where the machine has such a place; gone at the end.
class Folder {
public:
  Folder() : m_path((fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path()) / name()) {
    fs::create_directories(m_path);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(m_path, ignored);
  }
  const fs::path& path() const { return m_path; }

private:
  static std::string name() { return fmt::format("volmark_fuzz_{}", ::getpid()); }
  fs::path m_path;
};

/// Writes the bytes to a file and lets `read` have it; aborts on an error text that is no single short line.
template <class Read> std::function<bool(const std::string&)> onFile(const std::string& ending, Read read) {
  return [ending, read](const std::string& bytes) {
    static const Folder folder;
    const fs::path path = folder.path() / ("input" + ending);
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    try {
      read(path);
      return true;
    } catch (const InputError& error) {
      const std::string text = error.what();
      if (text.empty() || text.size() > 2000 || text.find('\n') != std::string::npos) std::abort();
      return false;
    }
  };
}

using test::gzipped;

const std::string kVoxels(48, '\1'); // 4 x 3 x 2 of 16 bits

std::string nrrdHeader(const std::string& encoding) {
  return "NRRD0005\ntype: short\ndimension: 3\nsizes: 4 3 2\nspace: left-posterior-superior\n"
         "space directions: (1,0,0) (0,-1,0) (0,0,2)\nendian: little\nencoding: " +
         encoding + "\n\n";
}

std::string niftiFile() {
  return test::niftiHeader({4, 3, 2}, 4) + kVoxels;
}

std::string metaImage(bool compressed) {
  return std::string("ObjectType = Image\nNDims = 3\nBinaryData = True\nCompressedData = ") +
         (compressed ? "True" : "False") + "\nDimSize = 4 3 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
         (compressed ? gzipped(kVoxels) : kVoxels);
}

std::string vtkFile() {
  return "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 2\nSPACING 1 1 1\n"
         "ORIGIN 0 0 0\nPOINT_DATA 24\nSCALARS scalars short 1\nLOOKUP_TABLE default\n" +
         kVoxels;
}

std::string dicomFile() {
  const auto element = [](std::uint16_t group, std::uint16_t number, const char* type, const std::string& value) {
    std::string text(4, '\0');
    std::memcpy(text.data(), &group, 2);
    std::memcpy(text.data() + 2, &number, 2);
    const auto length = static_cast<std::uint16_t>(value.size());
    return text + type + std::string(reinterpret_cast<const char*>(&length), 2) + value;
  };
  const std::string sequence("\x08\x00\x15\x11SQ\0\0\xff\xff\xff\xff\xfe\xff\x00\xe0\xff\xff\xff\xff"
                             "\xfe\xff\x0d\xe0\0\0\0\0\xfe\xff\xdd\xe0\0\0\0\0",
                             36);
  const std::string pixels("\xe0\x7f\x10\x00OW\0\0\x18\0\0\0", 12);
  return std::string(128, '\0') + "DICM" + element(2, 0x10, "UI", "1.2.840.10008.1.2.1") + sequence +
         element(0x20, 0xe, "UI", "1.2.3.4") + element(0x28, 2, "US", std::string("\1\0", 2)) +
         element(0x28, 0x10, "US", std::string("\3\0", 2)) + element(0x28, 0x11, "US", std::string("\4\0", 2)) +
         element(0x28, 0x100, "US", std::string("\x10\0", 2)) + pixels + std::string(24, '\1');
}

const char* const kScene = R"({"volmark_scene": 1, "title": "t", "volume": {"raw": {"file": "a.raw", "dims": [4, 3, 2],
 "type": "int16", "spacing_mm": [1, 1, 2.5], "endian": "big"}}, "source": {"license": "CC0"},
 "visualisation_range": [-1, 1e3], "isovalues": {"bone": {"raw": 3}},
 "transfer_functions": {"f": {"points": [{"value": 0, "color": [0, 0.5, 1], "opacity": 0.1}]}},
 "framing": {"up": [0, 0, 1], "front": [0, -1, 0]}, "light": {"direction": [1, 2, 3], "color": [1, 1, 1]}})";

std::vector<Target> makeTargets() {
  std::vector<Target> all;
  all.push_back({"nrrd",
                 onFile(".nrrd", [](const fs::path& path) { loadNrrd(path, kLimit); }),
                 {nrrdHeader("raw") + kVoxels, nrrdHeader("gzip") + gzipped(kVoxels)}});
  all.push_back({"raw",
                 onFile(".raw",
                        [](const fs::path& path) {
                          loadRaw(path, {Grid{{4, 3, 2}, {1, 1, 1}}, ScalarType::float32, true, 0, 1}, kLimit);
                        }),
                 {std::string(96, '\1')}});
  all.push_back({"metaimage",
                 onFile(".mha", [](const fs::path& path) { checkMetaImage(path, kLimit); }),
                 {metaImage(false), metaImage(true)}});
  all.push_back({"nifti", onFile(".nii", [](const fs::path& path) { checkNifti(path, kLimit); }), {niftiFile()}});
  all.push_back(
      {"nifti_gz", onFile(".nii.gz", [](const fs::path& path) { checkNifti(path, kLimit); }), {gzipped(niftiFile())}});
  all.push_back({"vtk", onFile(".vtk", [](const fs::path& path) { checkVtk(path, kLimit); }), {vtkFile()}});
  all.push_back({"dicom", onFile(".dcm", [](const fs::path& path) { checkDicom(path, kLimit); }), {dicomFile()}});
  all.push_back({"scene", onFile(".json", [](const fs::path& path) { readScene(path); }), {kScene}});
  return all;
}

} // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> all = makeTargets();
  return all;
}

} // namespace volmark::fuzz
