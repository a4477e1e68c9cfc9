// What names points and runs.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace volmark {

/// What names a run: see harness/README.md, Results.
struct RunIdentity {
  std::string point; ///< pointHash()
  std::string run;   ///< runHash(): 32 hex digits
  int replicate = 0;
};

/// 32 hex digits (XXH3-128) of the resolved point configuration without `measure`, and of the volume's identity
/// (a digest of its voxels). Neither the order of keys nor the spelling of a number (1, 1.0) matters.
std::string pointHash(const nlohmann::json& config, const std::string& volumeIdentity);

/// 32 hex digits of everything that tells one run from another.
std::string runHash(const std::string& point, const std::string& build, const std::string& device, int replicate);

/// JSON text that is equal for equal values: sorted keys, no spaces, whole numbers without a fraction.
std::string canonicalText(const nlohmann::json& value);

/// XXH3-128 as 32 hex digits.
std::string digestOf(std::string_view bytes);

} // namespace volmark
