// Writing files so that they survive a crash, and reading them back.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace volmark {

/// Creates or overwrites a file; syncPath() brings it to disk. Throws DeviceError, one line.
void writeFile(const std::filesystem::path& path, std::string_view text);

/// Replaces a file at once: a reader sees the old text or the new one. Throws DeviceError and leaves the old file.
void replaceFile(const std::filesystem::path& path, std::string_view text);

/// Waits until a file, or the names in a folder, are on disk. Throws DeviceError.
void syncPath(const std::filesystem::path& path);

/// The file's JSON; nothing if it is absent, unreadable or not JSON.
std::optional<nlohmann::json> readJson(const std::filesystem::path& path);

/// 2025-01-31T12:00:00.123Z: now.
std::string utcNow();

std::string hostName();

} // namespace volmark
