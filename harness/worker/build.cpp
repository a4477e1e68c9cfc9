#include "worker/build.h"

#include "measure/clocks.h"
#include "results/provenance.h"
#include "volmark/error.h"
#include "worker/worker_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <unistd.h>

namespace volmark {

namespace {

/// Loading all modules takes well under a second; sanitized builds and valgrind need longer.
constexpr double kAnswerMs = 60000;
constexpr std::size_t kLongestName = 64;

bool isNamePart(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

nlohmann::json askForDescription(const BuildChoice& choice) {
  WorkerLink link(choice.program);
  link.describe();
  const double deadline = monotonicMs() + kAnswerMs;
  while (monotonicMs() < deadline) {
    const WorkerLink::Answer answer = link.wait(200);
    using Kind = WorkerLink::Answer::Kind;
    if (answer.kind == Kind::described) return answer.message;
    if (answer.kind == Kind::died)
      throw InputError(fmt::format("--build {}: {} did not answer as a worker ({}), allowed: a program of volmark that "
                                   "knows --build itself",
                                   choice.name, choice.program.string(), answer.reason));
  }
  throw InputError(
      fmt::format("--build {}: {} gave no answer in {} s, allowed: a program of volmark that knows --build "
                  "itself",
                  choice.name, choice.program.string(), kAnswerMs / 1000));
}

} // namespace

BuildChoice parseBuild(const std::string& text) {
  const std::size_t equals = text.find('=');
  BuildChoice choice;
  choice.name = text.substr(0, equals);
  const bool named = !choice.name.empty() && choice.name.size() <= kLongestName &&
                     std::all_of(choice.name.begin(), choice.name.end(), isNamePart);
  if (equals == std::string::npos || !named)
    throw InputError(
        fmt::format("--build: found \"{}\", allowed: NAME=PROGRAM, as in base=../old/build/release/volmark, "
                    "a name of letters, digits, '_', '-' and '.'",
                    text));
  // Absolute, because a script must find itself wherever the worker is started.
  std::error_code error;
  choice.program = std::filesystem::absolute(text.substr(equals + 1), error);
  if (error || !std::filesystem::is_regular_file(choice.program, error) || ::access(choice.program.c_str(), X_OK) != 0)
    throw InputError(fmt::format("--build {}: found {}, allowed: a program that can be started", choice.name,
                                 text.substr(equals + 1)));
  return choice;
}

Build::Build(const TechniqueCatalogue& catalogue) : m_program("/proc/self/exe") {
  for (const CatalogueEntry& entry : catalogue.entries())
    m_techniques[entry.factory->info.name] = {entry.moduleDigest, buildDigest(entry.moduleDigest)};
}

Build::Build(const BuildChoice& choice) : m_name(choice.name), m_program(choice.program) {
  const nlohmann::json description = askForDescription(choice);
  if (description.value("protocol", 0) != kWorkerProtocol)
    throw InputError(fmt::format("--build {}: {} speaks protocol {} of workers, allowed: {}", choice.name,
                                 choice.program.string(), description.value("protocol", 0), kWorkerProtocol));
  for (const auto& [technique, digests] : description.at("techniques").items())
    m_techniques[technique] = {digests.at("module_digest"), digests.at("build_digest")};
}

std::optional<Build::TechniqueDigests> Build::digestsOf(const std::string& technique) const {
  const auto found = m_techniques.find(technique);
  return found == m_techniques.end() ? std::nullopt : std::optional(found->second);
}

} // namespace volmark
