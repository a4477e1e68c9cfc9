// A choice of points by number.
#pragma once

#include <string>
#include <vector>

namespace volmark {

/// "3,7-12": numbers of points (their index in the expansion) and ranges with both ends, in any order; sorted,
/// without repeats. Throws InputError naming `option` for other text and for numbers outside [0, count).
std::vector<int> parsePointList(const std::string& text, int count, const std::string& option);

} // namespace volmark
