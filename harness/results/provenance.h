// On what a run was made.
#pragma once

#include "volmark/gpu/device.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace volmark {

struct ProgramVersion {
  std::string version;       ///< "0.1.0"
  std::string commit;        ///< 40 hex digits, or "unknown" if built outside a Git checkout
  std::optional<bool> dirty; ///< tracked files differed from the commit; nothing if unknown
};

/// As of the last build of the program.
ProgramVersion programVersion();

/// Digest of the program, libvolmark and a technique's module; part of the run hash. The first call reads the
/// program's files, later ones remember. Throws DeviceError if they can't be read.
std::string buildDigest(const std::string& moduleDigest);

/// {"program", "build", "libraries", "host", "environment", "device", "process", "started"}: see harness/README.md,
/// Results. `device` may be null. "started" is the time of the call.
nlohmann::json provenance(const gpu::DeviceFacts* device);

/// Short identity of a device for the run hash: name, driver and driver version; "host" without one.
std::string deviceIdentity(const gpu::DeviceFacts* device);

/// What is known of this machine, read anew: load and memory are those of now.
nlohmann::json hostFacts();

} // namespace volmark
