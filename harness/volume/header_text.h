// Words and numbers of text headers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace volmark {

/// A whole number that fills the whole text and lies in the range; nothing otherwise.
std::optional<std::int64_t> parseInteger(std::string_view text, std::int64_t minimum, std::int64_t maximum);
/// A number, infinity or NaN that fills the whole text; nothing otherwise.
std::optional<double> parseNumber(std::string_view text);
/// Parts between white space.
std::vector<std::string> splitWords(std::string_view text);
std::string lowerCase(std::string_view text);
/// Without white space at both ends.
std::string_view trimmed(std::string_view text);
/// In quotes, shortened, without control characters: for error texts.
std::string shown(std::string_view text);
/// The first bytes of a regular file, at most `maximumBytes`. Throws InputError if it can't be read.
std::string readFileStart(const std::filesystem::path& path, std::size_t maximumBytes);

} // namespace volmark
