#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace octurn {

/// A cell of a grid in the object's frame, by its number along x, y and z from the origin.
using ObjectCell = std::array<std::int16_t, 3>;

/// Metres: side of a cell. Two stops see one surface within less.
inline constexpr double object_cell_side = 0.005;

/// @param point  metres, object's frame
ObjectCell to_object_cell(const Eigen::Vector3d& point);

/// The centre of a cell: metres, object's frame.
Eigen::Vector3d find_middle(const ObjectCell& cell);

/// The cells that more than one stop has, in their order.
/// @param stops  the cells of each, none twice
std::vector<ObjectCell> cells_of_several(std::span<const std::vector<ObjectCell>* const> stops);

}  // namespace octurn
