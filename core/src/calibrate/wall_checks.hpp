#pragma once

#include <string>

#include "calibrate/smooth_blocks.hpp"
#include "calibrate/wall_blocks.hpp"

namespace octurn {

/// Why that is no view of a flat wall, for people; empty if it is one.
/// @param residuals  of the blocks, to the plane, 1/m
std::string refuse_wall(const WallBlocks& wall, const WallPlane& plane,
                        const BlockValues& residuals);

/// Leaves out blocks that lie off an accepted wall, such as a nail's.
void drop_outliers(BlockValues& residuals);

}  // namespace octurn
