// Finds technique modules on disk and knows what they offer.
#pragma once

#include "volmark/module.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// One technique of a loaded module.
struct CatalogueEntry {
  const TechniqueFactory* factory;
  std::string family;
  std::filesystem::path module; ///< the file
  std::string moduleDigest;     ///< XXH3-128 of the file
};

class TechniqueCatalogue {
public:
  TechniqueCatalogue() = default;
  /// Loads every module (*.so) in `folders`. A module that can't be loaded or was built against another SDK
  /// is refused: one line in problems(), and the others still work. Two techniques of one name: the first
  /// stays, the second is a problem.
  explicit TechniqueCatalogue(const std::vector<std::filesystem::path>& folders);

  const std::vector<CatalogueEntry>& entries() const { return m_entries; } ///< by name
  const std::vector<std::string>& problems() const { return m_problems; }
  const CatalogueEntry* find(const std::string& name) const;
  /// Throws InputError with the nearest name, or with the problems if nothing was loaded.
  const CatalogueEntry& get(const std::string& name) const;

  /// For tests: an entry without a module. The factory must outlive the catalogue.
  void add(const TechniqueFactory& factory, std::string family);

private:
  std::vector<CatalogueEntry> m_entries;
  std::vector<std::string> m_problems;
};

/// VOLMARK_TECHNIQUES (':'-separated), then the folder "techniques" beside the program, then
/// <prefix>/lib/volmark/techniques of an installed one.
std::vector<std::filesystem::path> techniqueFolders();

} // namespace volmark
