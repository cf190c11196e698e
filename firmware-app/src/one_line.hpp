#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace octurn {

/// Whether a name prints on one line: it has no ASCII control characters, such as line breaks.
inline bool is_one_line(std::string_view text) {
  return std::ranges::none_of(
      text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; });
}

/// Text with spaces in place of its control characters.
inline std::string to_one_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }, ' ');
  return text;
}

}  // namespace octurn
