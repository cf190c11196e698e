#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// For each vertex the index of its strip.
using VertexStrips = std::vector<std::uint16_t>;

/// Divides vertices into strips across an axis, about as many vertices in each.
/// @param axis   0 to 2
/// @param count  of strips, at least 1
VertexStrips make_strips(std::span<const MeshVertex> vertices, std::size_t axis, int count,
                         ThreadTeam& team = ThreadTeam::alone());

}  // namespace octurn
