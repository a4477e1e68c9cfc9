#include "results/files.h"
#include "results/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <sched.h>
#include <set>
#include <string>
#include <sys/utsname.h>
#include <unistd.h>
#include <utility>

namespace volmark {

namespace {

std::string firstLine(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

nlohmann::json textOrNull(const std::string& text) {
  return text.empty() ? nlohmann::json(nullptr) : nlohmann::json(text);
}

struct CpuFacts {
  std::string model;
  double frequencyMhz = 0;
  std::set<std::pair<std::string, std::string>> cores; ///< package, core
};

// "key<tab>: value" lines; a blank line ends a logical processor.
CpuFacts readCpuFacts() {
  CpuFacts facts;
  std::ifstream file("/proc/cpuinfo");
  std::string line, package;
  while (std::getline(file, line)) {
    const auto colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::string key = line.substr(0, line.find_last_not_of(" \t", colon - 1) + 1);
    const std::string value = colon + 2 <= line.size() ? line.substr(colon + 2) : "";
    if ((key == "model name" || key == "Model") && facts.model.empty()) facts.model = value;
    if (key == "cpu MHz") facts.frequencyMhz = std::max(facts.frequencyMhz, std::strtod(value.c_str(), nullptr));
    if (key == "physical id") package = value;
    if (key == "core id") facts.cores.emplace(package, value);
  }
  return facts;
}

// "MemTotal:       16384 kB".
nlohmann::json memoryBytes(const std::string& name) {
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name + ":")) return std::strtoull(line.c_str() + name.size() + 1, nullptr, 10) * 1024;
  return nullptr;
}

int usableCores() {
  cpu_set_t cpus;
  return sched_getaffinity(0, sizeof cpus, &cpus) == 0 ? CPU_COUNT(&cpus) : 0;
}

} // namespace

nlohmann::json hostFacts() {
  utsname system{};
  uname(&system);
  const CpuFacts cpu = readCpuFacts();
  std::array<double, 3> load{};
  const int loads = std::max(0, getloadavg(load.data(), 3));
  return {{"name", hostName()},
          {"kernel", fmt::format("{} {} {}", system.sysname, system.release, system.machine)},
          {"cpu", textOrNull(cpu.model)},
          {"frequency_mhz", cpu.frequencyMhz > 0 ? nlohmann::json(cpu.frequencyMhz) : nlohmann::json(nullptr)},
          {"logical_cores", sysconf(_SC_NPROCESSORS_ONLN)},
          {"physical_cores", cpu.cores.empty() ? nlohmann::json(nullptr) : nlohmann::json(cpu.cores.size())},
          {"usable_cores", usableCores()},
          {"governor", textOrNull(firstLine("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"))},
          {"load_average", std::vector<double>(load.begin(), load.begin() + loads)},
          {"memory_total_bytes", memoryBytes("MemTotal")},
          {"memory_available_bytes", memoryBytes("MemAvailable")}};
}

} // namespace volmark
