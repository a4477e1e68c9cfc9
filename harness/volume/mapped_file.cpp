#include "volume/mapped_file.h"

#include "volmark/error.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace volmark {

SharedBytes mapFile(const std::filesystem::path& path, std::uint64_t offset) {
  const std::uint64_t length = fileLength(path);
  const auto fail = [&] {
    throw InputError(fmt::format("{}: can't be read: {}", path.string(), std::strerror(errno)));
  };
  if (offset >= length) return SharedBytes(std::vector<std::byte>{});
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail();
  // From the start: offsets of mappings are whole pages.
  void* const start = ::mmap(nullptr, length, PROT_READ, MAP_SHARED, file, 0);
  const int error = errno;
  ::close(file);
  errno = error;
  if (start == MAP_FAILED) fail();
  std::shared_ptr<const void> owner(start, [length](const void* pages) { ::munmap(const_cast<void*>(pages), length); });
  return {std::move(owner), {static_cast<const std::byte*>(start) + offset, length - offset}};
}

} // namespace volmark
