#include "results/files.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <fstream>
#include <unistd.h>

namespace volmark {

namespace {

[[noreturn]] void failToWrite(const std::filesystem::path& path, int error) {
  throw DeviceError(fmt::format("{}: can't be written: {}", path.string(), std::strerror(error)));
}

class OpenFile {
public:
  OpenFile(const std::filesystem::path& path, int flags) : m_path(path), m_file(open(path.c_str(), flags, 0644)) {
    if (m_file < 0) failToWrite(path, errno);
  }
  ~OpenFile() {
    if (m_file >= 0) close(m_file);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  void write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(m_file, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) failToWrite(m_path, errno);
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  // Some file systems report a full disk only here, others on close.
  void sync() {
    if (fsync(m_file) != 0 && errno != EINVAL && errno != EROFS) failToWrite(m_path, errno);
  }
  void finish() {
    if (close(std::exchange(m_file, -1)) != 0) failToWrite(m_path, errno);
  }

private:
  std::filesystem::path m_path;
  int m_file;
};

} // namespace

void writeFile(const std::filesystem::path& path, std::string_view text) {
  OpenFile file(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
  file.write(text);
  file.finish();
}

void replaceFile(const std::filesystem::path& path, std::string_view text) {
  const auto staged = path.parent_path() / fmt::format(".{}.{}", path.filename().string(), getpid());
  try {
    writeFile(staged, text);
    syncPath(staged);
    if (rename(staged.c_str(), path.c_str()) != 0) failToWrite(path, errno);
  } catch (...) {
    unlink(staged.c_str());
    throw;
  }
  syncPath(path.parent_path());
}

void syncPath(const std::filesystem::path& path) {
  OpenFile(path, O_RDONLY | O_CLOEXEC).sync();
}

std::optional<nlohmann::json> readJson(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  auto value = nlohmann::json::parse(file, nullptr, false);
  if (value.is_discarded()) return std::nullopt;
  return value;
}

std::string utcNow() {
  const auto now = std::chrono::system_clock::now();
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  return fmt::format("{}.{:03}Z", text.data(), milliseconds);
}

std::string hostName() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

} // namespace volmark
