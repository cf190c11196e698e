#pragma once

#include <cstddef>
#include <string>

#include "octurn/error.hpp"

namespace octurn {

constexpr std::size_t mebibyte = std::size_t{1} << 20U;

/// Whole megabytes, rounded up, so that the limit that an error names is enough.
inline std::string mb_text(std::size_t bytes) {
  return std::to_string((bytes + mebibyte - 1) / mebibyte) + " MB";
}

/// @throws Error "memory-limit"  if the limit is below what a method needs at least
inline void check_memory_limit(std::size_t limit, std::size_t min) {
  if (limit != 0 && limit < min) {
    throw Error(ErrorCode::memory_limit, "memory limit: " + mb_text(limit) + " is too little",
                "Allow at least " + mb_text(min) + ".");
  }
}

}  // namespace octurn
