// What goes wrong, in three classes: bad input and failed environments are exceptions with one line for
// the user; our own bugs are assertions; expected failures are return values.
#pragma once

#include <stdexcept>
#include <string>

namespace volmark {

/// Bad input: a config, file, parameter or command line that volmark refuses. The text is one line that
/// names the place, what was found and what is allowed.
class InputError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The point can't run here (missing feature, limit, memory). The text is one sentence; the run becomes a
/// row with status "unsupported".
class UnsupportedError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// A call to the graphics driver or the operating system failed.
class DeviceError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

} // namespace volmark
