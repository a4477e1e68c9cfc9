#include "volume/itk/decode_apart.h"

#include "volmark/error.h"
#include "volume/mapped_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace volmark {

namespace {

// Far above what decoding takes (8-bit voxels that become doubles on their way, copies while they are turned; a
// compressed voxel takes some nanoseconds), far below what hurts.
constexpr std::uint64_t kFreeBytes = 512u << 20;
constexpr std::uint64_t kBytesPerClaimed = 32;
constexpr std::uint64_t kFreeSeconds = 30;
constexpr std::uint64_t kClaimedPerSecond = 1u << 20;

/// A file in memory.
class MemoryFile {
public:
  explicit MemoryFile(const char* name) : m_file(::memfd_create(name, MFD_CLOEXEC)) {
    if (m_file < 0) throw DeviceError(fmt::format("no memory file: {}", std::strerror(errno)));
  }
  ~MemoryFile() { ::close(m_file); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  void write(const void* bytes, std::size_t count) const {
    const auto* at = static_cast<const char*>(bytes);
    while (count > 0) {
      const ssize_t written = ::write(m_file, at, count);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) throw std::runtime_error(fmt::format("no memory for {} bytes of voxels", count));
      at += written;
      count -= static_cast<std::size_t>(written);
    }
  }
  /// Its bytes stay while they are used.
  SharedBytes bytes() const { return mapFile(fmt::format("/proc/self/fd/{}", m_file), 0); }

private:
  int m_file;
};

std::uint64_t addressSpaceBytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void lower(decltype(RLIMIT_AS) resource, std::uint64_t limit) {
  rlimit present{};
  ::getrlimit(resource, &present);
  present.rlim_cur = std::min<rlim_t>(present.rlim_cur, limit);
  ::setrlimit(resource, &present);
}

std::uint64_t secondsFor(std::uint64_t claimedBytes) {
  return kFreeSeconds + claimedBytes / kClaimedPerSecond;
}

void becomeHarmless(pid_t parent, std::uint64_t claimedBytes) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  // Ctrl-C is for the parent, which goes on until a volume is read.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_DFL);
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  lower(RLIMIT_CORE, 0);
  lower(RLIMIT_AS, addressSpaceBytes() + kFreeBytes + kBytesPerClaimed * claimedBytes);
  lower(RLIMIT_CPU, secondsFor(claimedBytes));
}

/// In the child, out of which nothing may be thrown: leaves the voxels in one file and what describes them, or what is
/// wrong, in the other.
[[noreturn]] void decodeAndExit(const std::filesystem::path& path, const std::function<DecodedVolume()>& decode,
                                const MemoryFile& voxels, const MemoryFile& head) noexcept {
  nlohmann::json document;
  try {
    const DecodedVolume volume = decode();
    voxels.write(volume.voxels.data(), volume.voxels.size());
    document = {{"name", volume.name},
                {"dims", {volume.grid.dims.x, volume.grid.dims.y, volume.grid.dims.z}},
                {"spacing_mm", {volume.grid.spacingMm.x, volume.grid.spacingMm.y, volume.grid.spacingMm.z}},
                {"type", nameOf(volume.type)},
                {"time_steps", volume.timeSteps},
                {"notes", volume.notes}};
  } catch (const InputError& error) {
    document = {{"error", error.what()}};
  } catch (const std::exception& error) {
    document = {{"error", fmt::format("{}: {}", path.string(), error.what())}};
  }
  const std::string text = document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  head.write(text.data(), text.size());
  ::_exit(0);
}

/// What ended the child, empty if it came to its end.
std::string endOf(pid_t child, std::uint64_t claimedBytes) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  if (!WIFSIGNALED(status)) return fmt::format("exit code {}", WEXITSTATUS(status));
  if (WTERMSIG(status) == SIGXCPU) return fmt::format("not done after {} s", secondsFor(claimedBytes));
  return ::strsignal(WTERMSIG(status));
}

} // namespace

std::shared_ptr<const Volume> decodeApart(const std::filesystem::path& path, std::uint64_t claimedBytes,
                                          const std::function<DecodedVolume()>& decode) {
  const MemoryFile voxels("volmark voxels");
  const MemoryFile head("volmark head");
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0) throw DeviceError(fmt::format("no process to decode {}: {}", path.string(), std::strerror(errno)));
  if (child == 0) {
    becomeHarmless(parent, claimedBytes);
    decodeAndExit(path, decode, voxels, head);
  }
  if (const std::string end = endOf(child, claimedBytes); !end.empty())
    throw InputError(fmt::format("{}: the library that reads it gave up ({}): the file is damaged, or made to do harm",
                                 path.string(), end));

  const SharedBytes text = head.bytes();
  const auto* begin = reinterpret_cast<const char*>(text.view().data());
  const auto document = nlohmann::json::parse(begin, begin + text.view().size());
  if (document.contains("error")) throw InputError(document.at("error").get<std::string>());
  Grid grid;
  for (int axis = 0; axis < 3; ++axis) {
    grid.dims[axis] = document.at("dims").at(static_cast<std::size_t>(axis)).get<int>();
    grid.spacingMm[axis] = document.at("spacing_mm").at(static_cast<std::size_t>(axis)).get<double>();
  }
  return std::make_shared<const Volume>(
      document.at("name").get<std::string>(), grid, scalarTypeFromName(document.at("type").get<std::string>()),
      voxels.bytes(), document.at("time_steps").get<int>(), document.at("notes").get<std::vector<std::string>>());
}

} // namespace volmark
