#pragma once

#include <algorithm>
#include <string_view>

namespace octurn {

/// Whether a name prints on one line: it has no ASCII control characters, such as line breaks.
inline bool is_one_line(std::string_view text) {
  return std::ranges::none_of(
      text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; });
}

}  // namespace octurn
