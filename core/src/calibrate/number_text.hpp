#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace octurn {

/// A number in words for people, up to 95 characters.
/// @param format  of printf, for one double
inline std::string number_text(const char* format, double value) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

}  // namespace octurn
