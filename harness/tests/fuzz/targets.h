// What is fuzzed: each takes the bytes of one file and must either accept them or throw InputError of one line.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace volmark::fuzz {

struct Target {
  std::string name;
  std::function<bool(const std::string& bytes)> run; ///< whether they were accepted
  std::vector<std::string> seeds;                    ///< whole files that are accepted
};

/// nrrd, raw, metaimage, nifti, nifti_gz, vtk, dicom, scene.
const std::vector<Target>& targets();

} // namespace volmark::fuzz
