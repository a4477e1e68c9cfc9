// Programs of volmark whose workers draw: this one, or builds that are compared.
#pragma once

#include "technique/catalogue.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace volmark {

/// `--build NAME=PROGRAM`. The program may be a script that ends in `exec .../volmark "$@"`.
struct BuildChoice {
  std::string name;
  std::filesystem::path program;
};

/// Reads "base=/path/to/volmark". Throws InputError.
BuildChoice parseBuild(const std::string& text);

class Build {
public:
  /// This program with the modules that it has loaded.
  explicit Build(const TechniqueCatalogue& catalogue);
  /// Starts the program and asks it. Throws InputError if it can't be started or speaks another protocol.
  explicit Build(const BuildChoice& choice);

  /// Empty for this program: its runs have no label `build`.
  const std::string& name() const { return m_name; }
  const std::filesystem::path& program() const { return m_program; }

  struct TechniqueDigests {
    std::string module;
    std::string build; ///< program, libvolmark and module: part of the run hash
  };
  /// Nothing if the build doesn't have the technique.
  std::optional<TechniqueDigests> digestsOf(const std::string& technique) const;

private:
  std::string m_name;
  std::filesystem::path m_program;
  std::map<std::string, TechniqueDigests> m_techniques;
};

} // namespace volmark
