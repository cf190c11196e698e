#pragma once

#include "simulator/mesh.hpp"

namespace octurn {

/// Adds a parallelogram, metres.
void add_rectangle(Mesh& mesh, const Eigen::Vector3f& corner, const Eigen::Vector3f& side,
                   const Eigen::Vector3f& other_side);

/// The platform, its table and the wall behind them, in the platform's frame, metres.
Mesh surroundings();

}  // namespace octurn
