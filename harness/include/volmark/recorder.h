// Named, scoped parts of a frame or of generation. The name is the column in the results.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace volmark {

namespace gpu {
class Commands;
}

class Recorder;

/// Ends its pass when it goes out of scope. Passes must not nest.
class Pass {
public:
  ~Pass();
  Pass(const Pass&) = delete;
  Pass& operator=(const Pass&) = delete;

private:
  friend class Recorder;
  Pass(Recorder& recorder, int index) : m_recorder(recorder), m_index(index) {}
  Recorder& m_recorder;
  int m_index;
};

/// A technique records its work here; whether and how a pass is timed is the harness's business (headline
/// orbits carry two stamps only, breakdown orbits stamp every pass).
class Recorder {
public:
  virtual ~Recorder() = default;

  /// A part that runs on the GPU: everything recorded to gpu() until the end of the scope. No render pass
  /// may be open at either end (stamps inside one are wrong on some drivers).
  [[nodiscard]] Pass pass(std::string_view name) { return Pass(*this, beginGpuPass(name)); }
  /// A part that runs on the host: all that happens until the end of the scope, threads joined.
  [[nodiscard]] Pass hostPass(std::string_view name) { return Pass(*this, beginHostPass(name)); }

  /// The command buffer of this frame. Techniques with needs.gpu = false must not call it.
  virtual gpu::Commands& gpu() = 0;

protected:
  virtual int beginGpuPass(std::string_view name) = 0;
  virtual int beginHostPass(std::string_view name) = 0;
  virtual void endPass(int index) noexcept = 0;

private:
  friend class Pass;
};

inline Pass::~Pass() {
  m_recorder.endPass(m_index);
}

} // namespace volmark
