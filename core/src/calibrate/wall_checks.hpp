#pragma once

#include <string>

#include "calibrate/smooth_blocks.hpp"
#include "calibrate/wall_blocks.hpp"

namespace octurn {

/// Why a view does not show a flat wall, for people; empty if it does.
/// @param residuals  of the blocks, to the plane, 1/m
std::string refuse_wall(const WallBlocks& wall, const WallPlane& plane,
                        const BlockValues& residuals);

/// Removes blocks that lie off an accepted wall, such as a nail.
void drop_outliers(BlockValues& residuals);

}  // namespace octurn
