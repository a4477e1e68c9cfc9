// "key.path=value" from a command line.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace volmark {

struct Assignment {
  std::string path;
  nlohmann::ordered_json value; ///< JSON, or a bare word as text
  std::string place;            ///< stands for the file in errors
};

/// Throws InputError: no '=', malformed JSON that is no bare word either.
Assignment parseAssignment(const std::string& text);

} // namespace volmark
