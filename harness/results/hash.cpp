#include "results/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cmath>
#include <cstdint>

namespace volmark {

namespace {

// Whole numbers become integers, so that a config that says 1.0 is the point of one that says 1.
void unifyNumbers(nlohmann::json& value) {
  if (value.is_structured()) {
    for (auto& element : value)
      unifyNumbers(element);
  } else if (value.is_number_unsigned()) {
    if (value.get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX)) value = value.get<std::int64_t>();
  } else if (value.is_number_float()) {
    constexpr double kExactIntegers = 9007199254740992.0; // 2^53
    const double number = value.get<double>();
    if (std::abs(number) <= kExactIntegers && number == std::floor(number)) value = static_cast<std::int64_t>(number);
  }
}

} // namespace

std::string canonicalText(const nlohmann::json& value) {
  nlohmann::json unified = value;
  unifyNumbers(unified);
  return unified.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string digestOf(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string pointHash(const nlohmann::json& config, const std::string& volumeIdentity) {
  nlohmann::json measured = config;
  measured.erase("measure");
  return digestOf(canonicalText({{"format", "volmark.point 1"}, {"config", measured}, {"volume", volumeIdentity}}));
}

std::string runHash(const std::string& point, const std::string& build, const std::string& device, int replicate) {
  return digestOf(canonicalText(
      {{"format", "volmark.run 1"}, {"point", point}, {"build", build}, {"device", device}, {"replicate", replicate}}));
}

} // namespace volmark
