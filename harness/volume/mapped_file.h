// A file's bytes in memory without a copy.
#pragma once

#include "volmark/volume.h"

#include <filesystem>

namespace volmark {

/// The bytes from `offset` to the end, read-only and shared with every process that maps the file. Throws InputError
/// if it can't be mapped. The file must not be shortened while the bytes are used.
SharedBytes mapFile(const std::filesystem::path& path, std::uint64_t offset);

} // namespace volmark
