#include "worker/messages.h"

#include <cerrno>
#include <poll.h>
#include <unistd.h>

namespace volmark {

bool LineChannel::send(const nlohmann::json& message) {
  const std::string line = message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  std::size_t sent = 0;
  while (sent < line.size()) {
    const ssize_t n = ::write(m_write, line.data() + sent, line.size() - sent);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

LineChannel::Result LineChannel::receive(nlohmann::json& message, int timeoutMs) {
  for (;;) {
    if (const auto end = m_buffer.find('\n'); end != std::string::npos) {
      message = nlohmann::json::parse(m_buffer.substr(0, end), nullptr, false);
      m_buffer.erase(0, end + 1);
      if (message.is_discarded()) return Result::closed;
      return Result::message;
    }
    pollfd wait{m_read, POLLIN, 0};
    const int ready = ::poll(&wait, 1, timeoutMs);
    if (ready == 0 || (ready < 0 && errno == EINTR)) return Result::timeout;
    if (ready < 0) return Result::closed;
    char chunk[4096];
    const ssize_t n = ::read(m_read, chunk, sizeof(chunk));
    if (n < 0 && errno == EINTR) return Result::timeout;
    if (n <= 0) return Result::closed;
    m_buffer.append(chunk, static_cast<std::size_t>(n));
  }
}

} // namespace volmark
