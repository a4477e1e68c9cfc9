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
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <sstream>
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

// Tells processes of one pid apart: in ticks since the machine started. Empty if there is no such process, or one that
// has ended and that nobody has waited for yet.
std::string startOfProcess(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string text((std::istreambuf_iterator<char>(file)), {});
  // "pid (name) state ...": the name may hold anything; the start is field 22, the 20th behind it.
  const auto name = text.rfind(')');
  if (name == std::string::npos) return "";
  std::istringstream fields(text.substr(name + 1));
  std::string field;
  fields >> field;
  if (field == "Z" || field == "X") return "";
  for (int i = 1; i < 20; ++i)
    fields >> field;
  return field;
}

// Containers of one host name may number their processes apart.
std::string pidNamespace() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/ns/pid", error).string();
}

std::string claimText() {
  nlohmann::ordered_json document{{"format", "volmark.claim"}, {"version", 1},
                                  {"host", hostName()},        {"pid_namespace", pidNamespace()},
                                  {"pid", getpid()},           {"process_started", startOfProcess(getpid())},
                                  {"started", utcNow()}};
  return document.dump() + "\n";
}

enum class Owner { lives, gone, unknown };

// Only of processes of this host and namespace can this be told at once.
Owner ownerOf(const nlohmann::json& claim) {
  if (!claim.is_object()) return Owner::unknown;
  const auto text = [&claim](const char* key) { return claim.contains(key) ? claim[key] : nlohmann::json(); };
  if (text("host") != hostName() || text("pid_namespace") != pidNamespace()) return Owner::unknown;
  if (!text("pid").is_number_integer()) return Owner::unknown;
  const std::string started = startOfProcess(claim["pid"].get<pid_t>());
  return !started.empty() && text("process_started") == started ? Owner::lives : Owner::gone;
}

std::string heartbeatOf(int file, const std::string& text) {
  struct stat facts {};
  if (fstat(file, &facts) != 0) return text;
  return fmt::format("{}.{} {}", facts.st_mtim.tv_sec, facts.st_mtim.tv_nsec, text);
}

// A file without readable text may be one that is being made right now: it is watched like a foreign one.
bool isAbandoned(const std::filesystem::path& path, int file, ClaimWatch& watch) {
  const std::string text = readAll(file);
  const Owner owner = ownerOf(nlohmann::json::parse(text, nullptr, false));
  if (owner == Owner::unknown) return watch.isAbandoned(path, heartbeatOf(file, text));
  return owner == Owner::gone;
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

std::unique_ptr<Claim> Claim::take(const std::filesystem::path& path, ClaimWatch& watch) {
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
    if (!isAbandoned(path, existing.get(), watch)) return nullptr;
    if (!overwrite(existing.get(), text)) failToClaim(path, errno);
    watch.forget(path);
    return std::unique_ptr<Claim>(new Claim(path, text));
  }
}

bool ClaimWatch::isAbandoned(const std::filesystem::path& file, const std::string& state) {
  const auto now = Clock::now();
  const auto [found, isNew] = m_seen.emplace(file, Seen{state, now, false});
  Seen& seen = found->second;
  if (seen.state != state) seen = {state, now, true};
  return !isNew && now - seen.since >= m_lifetime;
}

bool ClaimWatch::isUndecided() const {
  const auto now = Clock::now();
  for (const auto& [ignored, seen] : m_seen)
    if (!seen.beats && now - seen.since < m_lifetime + m_lifetime / 10) return true;
  return false;
}

ClaimFacts readClaim(const std::filesystem::path& path) {
  ClaimFacts facts;
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return facts;
  struct stat status {};
  timespec now{};
  if (fstat(file, &status) == 0 && clock_gettime(CLOCK_REALTIME, &now) == 0)
    facts.heartbeatSeconds = static_cast<double>(now.tv_sec - status.st_mtim.tv_sec);
  const auto claim = nlohmann::json::parse(readAll(file), nullptr, false);
  close(file);
  if (!claim.is_object()) return facts;
  facts.host = claim.value("host", "");
  facts.pid = claim.value("pid", 0);
  const Owner owner = ownerOf(claim);
  facts.active = owner == Owner::unknown
                     ? facts.heartbeatSeconds < std::chrono::duration<double>(kClaimLifetime).count()
                     : owner == Owner::lives;
  return facts;
}

} // namespace volmark
