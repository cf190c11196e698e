#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rig/laser_simulation.hpp"

namespace octurn {

/// Inverts Brown's radial distortion by fixed-point iteration: the normalised coordinates of a
/// pinhole camera that appear at `shown`.
Eigen::Vector2d undistorted(const Eigen::Vector2d& shown, double k1, double k2);

/// The ray (x, y, 1) of a pixel of the simulated lens.
Eigen::Vector2d ray_at(const LaserSimulation& simulation, double u, double v);

/// Distorts the picture of a lens without distortion like the simulated lens; black outside of that
/// picture.
/// @param samples   of a picture of the lens's size, row by row
/// @param channels  samples of a pixel
std::vector<std::uint8_t> distorted(std::span<const std::uint8_t> samples, std::size_t channels,
                                    const LaserSimulation& simulation);

}  // namespace octurn
