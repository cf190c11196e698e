#pragma once

#include <exception>

namespace octurn {

/// Thrown when an octree or a TSDF volume would exceed its memory budget. It then still holds all
/// earlier data, and some leaves or voxels of the triangle or snapshot that did not fit.
struct OutOfBudget : std::exception {
  const char* what() const noexcept override { return "the memory budget is spent"; }
};

}  // namespace octurn
