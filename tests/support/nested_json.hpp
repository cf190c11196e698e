#pragma once

#include <string>

namespace octurn {

/// Nested arrays: "[[[]]]" for a depth of 3.
inline std::string nested_arrays(std::size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

/// Nested objects: `{"a":{"a":{}}}` for a depth of 3.
inline std::string nested_objects(std::size_t depth) {
  std::string text;
  for (std::size_t level = 1; level < depth; ++level) {
    text += R"({"a":)";
  }
  return text + "{}" + std::string(depth - 1, '}');
}

}  // namespace octurn
