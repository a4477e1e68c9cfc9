// The text of an NRRD header as fields, before their meaning is looked at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace volmark {

/// Fields of one header, each at most once, by lower-case name in its spelling with a space ("data file").
class NrrdFields {
public:
  /// Reads up to the blank line that ends the header, or to the end of the file in a detached one. Throws
  /// InputError: wrong magic, over 64 KiB, unknown or repeated field.
  explicit NrrdFields(const std::filesystem::path& path);

  const std::string& file() const { return m_file; }
  std::uint64_t headerBytes() const { return m_headerBytes; } ///< with the blank line
  bool endsWithBlankLine() const { return m_endsWithBlankLine; }

  std::optional<std::string> find(const std::string& name) const;
  /// Throws InputError if the field is missing.
  std::string at(const std::string& name) const;
  /// The words of a field. Throws InputError if it is missing or has not `count` words.
  std::vector<std::string> words(const std::string& name, std::size_t count) const;

  /// Throws InputError "<file>: field "<name>": found <found>, allowed: <allowed>".
  [[noreturn]] void refuse(const std::string& name, std::string_view found, std::string_view allowed) const;

private:
  void add(std::string_view line);

  std::string m_file;
  std::uint64_t m_headerBytes = 0;
  bool m_endsWithBlankLine = false;
  std::map<std::string, std::string> m_fields;
};

} // namespace volmark
