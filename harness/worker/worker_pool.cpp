#include "worker/worker_pool.h"

#include <algorithm>

namespace volmark {

std::string volumeKeyOf(const Point& point) {
  return point.settings.scene.path.string() + point.config.value("volume", nlohmann::json()).dump();
}

std::unique_ptr<WorkerLink> WorkerPool::take(const std::filesystem::path& program, const std::string& volume) {
  std::erase_if(m_idle, [&](const Idle& idle) { return idle.volume != volume; });
  const auto found =
      std::find_if(m_idle.begin(), m_idle.end(), [&](const Idle& idle) { return idle.program == program; });
  if (found == m_idle.end()) return std::make_unique<WorkerLink>(program);
  auto link = std::move(found->link);
  m_idle.erase(found);
  return link;
}

void WorkerPool::giveBack(std::unique_ptr<WorkerLink> link, const std::filesystem::path& program,
                          const std::string& volume) {
  m_idle.push_back({std::move(link), program, volume});
}

} // namespace volmark
