// On what a run was made.
#pragma once

#include "volmark/gpu/device.h"

#include <nlohmann/json.hpp>

#include <string>

namespace volmark {

/// Digest of program and technique module; part of the run hash.
std::string buildDigest(const std::string& moduleDigest);

/// Program version, commit, dirty flag, flags, compiler, host, CPU, cores, governor, load, memory, kernel,
/// the driver's environment variables, versions of libraries, UTC time. `device` may be null.
nlohmann::json provenance(const gpu::DeviceFacts* device);

/// Short identity of a device for the run hash: name, driver and driver version; "host" without one.
std::string deviceIdentity(const gpu::DeviceFacts* device);

} // namespace volmark
