#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace octurn {

/// An indexed triangle mesh, metres.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices = {};
  std::vector<std::array<std::uint32_t, 3>> triangles = {};
};

}  // namespace octurn
