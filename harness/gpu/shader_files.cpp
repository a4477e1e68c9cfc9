#include "gpu/shader_files.h"

#include "volmark/gpu/shader.h"

#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>

// Written by volmark_embed_shaders() in harness/CMakeLists.txt.
namespace volmark_sdk_embedded {
extern const std::vector<volmark::gpu::EmbeddedShader> shaders;
}

namespace volmark::gpu {

namespace {

struct EmbeddedFiles {
  std::mutex mutex;
  std::map<std::string, const char*, std::less<>> texts;

  void add(std::span<const EmbeddedShader> files) {
    for (const EmbeddedShader& file : files)
      texts[file.path] = file.text;
  }
};

EmbeddedFiles& embeddedFiles() {
  static EmbeddedFiles files;
  static std::once_flag once;
  std::call_once(once, [] { files.add(volmark_sdk_embedded::shaders); });
  return files;
}

std::optional<std::string> readLiveFile(const std::string& path) {
  const char* folders = std::getenv("VOLMARK_SHADERS");
  if (!folders) return std::nullopt;
  std::istringstream list(folders);
  for (std::string folder; std::getline(list, folder, ':');) {
    if (folder.empty()) continue;
    std::ifstream file(folder + "/" + path, std::ios::binary);
    if (file) return std::string(std::istreambuf_iterator<char>(file), {});
  }
  return std::nullopt;
}

} // namespace

void registerShaders(std::span<const EmbeddedShader> files) {
  EmbeddedFiles& all = embeddedFiles();
  const std::lock_guard lock(all.mutex);
  all.add(files);
}

std::optional<std::string> findShaderFile(const std::string& path) {
  if (auto text = readLiveFile(path)) return text;
  EmbeddedFiles& all = embeddedFiles();
  const std::lock_guard lock(all.mutex);
  const auto found = all.texts.find(path);
  if (found == all.texts.end()) return std::nullopt;
  return std::string(found->second);
}

std::vector<std::string> embeddedShaderNames() {
  EmbeddedFiles& all = embeddedFiles();
  const std::lock_guard lock(all.mutex);
  std::vector<std::string> names;
  for (const auto& [name, text] : all.texts)
    names.push_back(name);
  return names;
}

} // namespace volmark::gpu
