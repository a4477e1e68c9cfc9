// A new claim is made with O_EXCL. An abandoned one is taken over in place: whoever holds the file's lock (which
// the kernel releases when its holder dies) judges the claim and overwrites it, so that of several processes that
// see the same abandoned claim exactly one gets it; the others then read a fresh claim. Nobody removes a file but
// its owner, also under the lock.
#include "results/claim.h"

#include "results/files.h"
#include "volmark/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace volmark {

namespace {

/// An open claim file, locked while this lives. Without locks on the file system, works unlocked.
class LockedFile {
public:
  LockedFile(const std::filesystem::path& path, int flags) : m_file(open(path.c_str(), flags | O_CLOEXEC, 0644)) {
    if (m_file < 0) return;
    while (flock(m_file, LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~LockedFile() {
    if (m_file >= 0) close(m_file);
  }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;
  int get() const { return m_file; }

  /// The path still names this file: nobody removed it while the lock was waited for.
  bool stillAt(const std::filesystem::path& path) const {
    struct stat mine {
    }, there{};
    return fstat(m_file, &mine) == 0 && stat(path.c_str(), &there) == 0 && mine.st_ino == there.st_ino &&
           mine.st_dev == there.st_dev;
  }

private:
  int m_file;
};

std::string readAll(int file) {
  std::array<char, 1024> buffer;
  const ssize_t bytes = pread(file, buffer.data(), buffer.size(), 0);
  return bytes > 0 ? std::string(buffer.data(), static_cast<std::size_t>(bytes)) : std::string();
}

bool overwrite(int file, const std::string& text) {
  return ftruncate(file, 0) == 0 && pwrite(file, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()) &&
         futimens(file, nullptr) == 0;
}

std::string claimText() {
  nlohmann::ordered_json document{
      {"format", "volmark.claim"}, {"version", 1}, {"host", hostName()}, {"pid", getpid()}, {"started", utcNow()}};
  return document.dump() + "\n";
}

bool isGoneFromThisHost(const nlohmann::json& claim) {
  if (!claim.is_object() || !claim.contains("host") || !claim.contains("pid")) return false;
  if (claim["host"] != hostName() || !claim["pid"].is_number_integer()) return false;
  const auto pid = claim["pid"].get<pid_t>();
  return pid > 0 && kill(pid, 0) != 0 && errno == ESRCH;
}

// A file without readable text may be one that is being made right now: only its age counts.
bool isAbandoned(int file) {
  struct stat facts {};
  timespec now{};
  if (fstat(file, &facts) != 0 || clock_gettime(CLOCK_REALTIME, &now) != 0) return false;
  const double age = static_cast<double>(now.tv_sec - facts.st_mtim.tv_sec);
  return age > kClaimLifetimeSeconds || isGoneFromThisHost(nlohmann::json::parse(readAll(file), nullptr, false));
}

[[noreturn]] void failToClaim(const std::filesystem::path& path, int error) {
  throw DeviceError(fmt::format("{}: can't be written: {}", path.string(), std::strerror(error)));
}

} // namespace

Claim::Claim(std::filesystem::path file, std::string text)
    : m_file(std::move(file)), m_text(std::move(text)), m_owner(getpid()) {
}

Claim::~Claim() {
  if (getpid() != m_owner) return;
  const LockedFile file(m_file, O_RDWR);
  if (isMine(file.get()) && file.stillAt(m_file)) unlink(m_file.c_str());
}

bool Claim::isMine(int openFile) const {
  return openFile >= 0 && readAll(openFile) == m_text;
}

bool Claim::beat() {
  const LockedFile file(m_file, O_RDWR);
  return isMine(file.get()) && futimens(file.get(), nullptr) == 0;
}

std::unique_ptr<Claim> Claim::take(const std::filesystem::path& path) {
  const std::string text = claimText();
  // Again whenever a claim disappears between two steps: its owner has released it.
  for (;;) {
    const LockedFile created(path, O_RDWR | O_CREAT | O_EXCL);
    if (created.get() >= 0) {
      if (!readAll(created.get()).empty()) return nullptr; // taken over before it was locked
      if (!overwrite(created.get(), text)) {
        const int error = errno;
        unlink(path.c_str());
        failToClaim(path, error);
      }
      return std::unique_ptr<Claim>(new Claim(path, text));
    }
    if (errno != EEXIST) failToClaim(path, errno);

    const LockedFile existing(path, O_RDWR);
    if (existing.get() < 0 && errno == ENOENT) continue;
    if (existing.get() < 0) failToClaim(path, errno);
    if (!existing.stillAt(path)) continue;
    if (!isAbandoned(existing.get())) return nullptr;
    if (!overwrite(existing.get(), text)) failToClaim(path, errno);
    return std::unique_ptr<Claim>(new Claim(path, text));
  }
}

} // namespace volmark
