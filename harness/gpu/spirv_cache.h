// SPIR-V on disk, by the hash of what it was made from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace volmark::gpu {

/// Where the SPIR-V of `key` (hex digits) is kept.
std::filesystem::path spirvCacheFile(const std::string& key);

/// Nothing when the file is missing, of another version or damaged.
std::optional<std::vector<std::uint32_t>> readSpirv(const std::filesystem::path& file);

/// Appears by atomic rename. An unwritable cache is not an error.
void writeSpirv(const std::filesystem::path& file, std::span<const std::uint32_t> words) noexcept;

} // namespace volmark::gpu
