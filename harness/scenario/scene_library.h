// Finds scenes by name and reads each file once.
#pragma once

#include "scenario/scene_file.h"
#include "scenario/strict_json.h"

#include <filesystem>
#include <map>
#include <string>

namespace volmark {

class SceneLibrary {
public:
  explicit SceneLibrary(std::filesystem::path folder) : m_folder(std::move(folder)) {}

  struct Entry {
    std::string name; ///< of a file in the scenes folder, or the path where it was found
    SceneDescription description;
  };

  /// `name` is a name in the scenes folder, or (with a '/' or ending in .json or like a volume file) a path: from
  /// the current folder, else from the folder of the file that says so. A folder there (a DICOM series) needs no '/'
  /// where no scene has its name. Throws InputError.
  const Entry& get(const JsonValue& name);

private:
  Entry load(const JsonValue& name) const;

  std::filesystem::path m_folder;
  std::map<std::string, Entry> m_entries;
};

} // namespace volmark
