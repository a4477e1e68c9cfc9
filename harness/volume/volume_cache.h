// Decoded voxels of files that take time to read (compressed, converted, voxelised), kept in the cache folder and
// mapped: the second process to open a volume neither decodes nor copies it.
#pragma once

#include "volmark/volume.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// Size of the cache, in bytes: $VOLMARK_VOLUME_CACHE_GIB, default 32; 0 turns it off. Throws InputError on other text.
std::uint64_t volumeCacheBytes();

/// `sources`: the files that the voxels are made from; they are identified by path, length and time of change, so
/// that they need not be read. `settings`: everything else that the voxels depend on. Maps what is in the cache for
/// them, else calls `decode` and stores its result, dropping the files used longest ago where the cache would be over
/// its size. A cache that can't be written, or whose file is damaged (its voxels' hash differs), only costs time.
/// Volumes under 1 MiB are not kept, nor are those of files that changed within the last two seconds: their next change
/// could have the same time. Throws what `decode` throws, and InputError over `maximumBytes`: what is kept was
/// checked against the limit of another day.
std::shared_ptr<const Volume> cachedVolume(const std::vector<std::filesystem::path>& sources,
                                           const std::string& settings, std::uint64_t maximumBytes,
                                           const std::function<std::shared_ptr<const Volume>()>& decode);

} // namespace volmark
