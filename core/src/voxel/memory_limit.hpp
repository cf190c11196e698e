#pragma once

#include <cstddef>
#include <exception>

#include "io/number_text.hpp"
#include "octurn/error.hpp"

namespace octurn {

constexpr std::size_t mebibyte = std::size_t{1} << 20U;

/// @throws Error "memory-limit"  if the limit is below the minimum that a method needs
inline void check_memory_limit(std::size_t limit, std::size_t min) {
  if (limit != 0 && limit < min) {
    throw Error(ErrorCode::memory_limit, "memory limit: " + mb_text(limit) + " is too little",
                "Allow at least " + mb_text(min) + ".",
                {{"limit_mb", rounded_up_mb(limit)}, {"needed_mb", rounded_up_mb(min)}});
  }
}

/// Thrown when an octree or a TSDF volume would exceed its memory budget. It then still holds all
/// earlier data, and some leaves or voxels of the triangle or snapshot that did not fit.
struct OutOfBudget : std::exception {
  const char* what() const noexcept override { return "the memory budget is spent"; }
};

}  // namespace octurn
