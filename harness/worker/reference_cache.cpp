#include "worker/reference_cache.h"

#include "image/exr.h"
#include "reference/reference.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cassert>
#include <cstdlib>
#include <unistd.h>

namespace volmark {

namespace {

namespace fs = std::filesystem;

/// Grows when the reference's pictures change, so that older files are not taken for new ones.
constexpr int kReferenceVersion = 1;

/// Everything that a reference picture depends on, as text; doubles in hexadecimal, so exact.
class ContentKey {
public:
  ContentKey& add(const glm::dvec3& v) { return add(v.x).add(v.y).add(v.z); }
  ContentKey& add(double value) {
    m_text += fmt::format("{:a} ", value);
    return *this;
  }
  ContentKey& add(const TransferFunction& function) {
    for (const ControlPoint& point : function.points())
      add(point.value).add(point.color).add(point.opacity);
    return add(std::string("end"));
  }
  ContentKey& add(const std::string& text) {
    m_text += text + " ";
    return *this;
  }
  std::string digest() const {
    const XXH128_hash_t hash = XXH3_128bits(m_text.data(), m_text.size());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

private:
  std::string m_text;
};

std::string keyOf(const Scene& scene, const FrameInputs& inputs, int width, int height, Draws draws) {
  ContentKey key;
  key.add(kReferenceVersion).add(scene.volume->identity()).add(double(width)).add(double(height));
  key.add(double(static_cast<int>(draws))).add(double(static_cast<int>(scene.shading.model)));
  key.add(scene.visualisationRange.minimum).add(scene.visualisationRange.maximum);
  for (const View& view : inputs.views) {
    key.add(view.pose.position).add(view.pose.right).add(view.pose.up).add(view.pose.forward);
    key.add(view.frustum.left).add(view.frustum.right).add(view.frustum.down).add(view.frustum.up);
  }
  for (const ClippingPlane& plane : inputs.clippingPlanes)
    key.add(plane.normal).add(plane.offset);
  key.add(inputs.timeStep).add(inputs.light.headlight ? 1 : 0).add(inputs.light.direction).add(inputs.light.color);
  key.add(inputs.light.ambient).add(inputs.light.isSpot() ? inputs.light.distance : 0);
  if (draws == Draws::isosurface) {
    key.add(inputs.isovalue).add(scene.shading.surfaceColor);
  } else {
    key.add(scene.shading.shadows ? 1 : 0).add(*inputs.transferFunction);
    if (inputs.hiddenSegments.any()) key.add(inputs.hiddenSegments.to_string());
    if (scene.functionBeyond) key.add(*scene.functionBeyond);
  }
  return key.digest();
}

std::vector<Picture> drawAll(const Scene& scene, const FrameInputs& inputs, int width, int height, Draws draws) {
  std::vector<Picture> pictures;
  for (int view = 0; view < static_cast<int>(inputs.views.size()); ++view) {
    if (draws == Draws::isosurface)
      pictures.push_back(reference::renderIsosurface(scene, inputs, view, width, height));
    else
      pictures.push_back(reference::renderVolume(scene, inputs, view, width, height, {}));
  }
  return pictures;
}

/// Copies without ever showing a half-written file under the final name.
void copyAtomically(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  const fs::path partial = to.string() + fmt::format(".{}.partial", ::getpid());
  fs::copy_file(from, partial, fs::copy_options::overwrite_existing);
  fs::rename(partial, to);
}

} // namespace

fs::path cacheFolder() {
  if (const char* own = std::getenv("VOLMARK_CACHE"); own && *own) return own;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return fs::path(xdg) / "volmark";
  const char* home = std::getenv("HOME");
  return (home && *home ? fs::path(home) : fs::temp_directory_path()) / ".cache" / "volmark";
}

ReferenceCache::ReferenceCache(fs::path folder) : m_folder(std::move(folder)) {
}

ReferenceCache::Entry ReferenceCache::get(const Scene& scene, const FrameInputs& inputs, int width, int height,
                                          Draws draws) const {
  assert(draws != Draws::both);
  const std::string name = keyOf(scene, inputs, width, height, draws) + ".exr";
  const fs::path file = m_folder / name;
  const fs::path shared = cacheFolder() / "references" / name;

  if (!fs::exists(file) && fs::exists(shared)) copyAtomically(shared, file);
  if (!fs::exists(file)) {
    fs::create_directories(m_folder);
    ExrAttributes attributes;
    attributes.comments = "volmark CPU reference";
    attributes.views = inputs.views;
    writeExr(file, drawAll(scene, inputs, width, height, draws), attributes);
    try {
      copyAtomically(file, shared);
    } catch (const fs::filesystem_error&) {
      // The shared cache only saves time; a full or read-only disk there costs nobody a result.
    }
  }
  return {readExr(file), file};
}

} // namespace volmark
